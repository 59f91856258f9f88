//! Bags: MCAP files as `rosbag2` writes them, one or a folder of them.

mod content;
mod folder;
mod measure;
mod reader;
mod records;
mod topics;
mod writer;

pub use folder::{files, is_bag};
pub use measure::{FrameReport, Summary, Task, measure};
pub use reader::{Message, read};
pub use topics::{Topic, image_topic, topics};
pub use writer::Writer;

/// The topic of velocities.
pub const TWIST_TOPIC: &str = "/blur/twist";
/// The topic of diagnostics.
pub const DIAGNOSTICS_TOPIC: &str = "/diagnostics";
