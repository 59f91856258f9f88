//! Frames of a live camera through one worker thread.
//!
//! A camera does not wait. [`Stream`] takes its frames as they come, holds at most a few, and gives them to one worker in
//! their order; when the worker is too slow, the oldest frame is dropped and counted, and a frame that has waited beyond its
//! deadline is not begun. Buffers are made once and go round: in the long run nothing is allocated. The time from the arrival
//! of a frame to the end of its work is recorded, and [`Report`] tells its quantiles.
//!
//! The worker is a closure, so that this crate knows nothing of pictures:
//!
//! ```
//! use std::sync::mpsc;
//! use blur_stream::{Limits, Stream};
//!
//! let (sender, results) = mpsc::channel();
//! let limits = Limits { capacity: 4, deadline: None };
//! let mut stream = Stream::start(limits, Vec::new, move |frame: &mut Vec<u8>| {
//!     let _ = sender.send(frame.iter().map(|&pixel| u32::from(pixel)).sum::<u32>());
//! })?;
//! stream.push(|frame| {
//!     frame.clear();
//!     frame.extend_from_slice(&[1, 2, 3]);
//! });
//! assert_eq!(results.recv().unwrap(), 6);
//! let report = stream.stop()?;
//! assert_eq!((report.received, report.done, report.dropped), (1, 1, 0));
//! # Ok::<(), blur_stream::Error>(())
//! ```

mod error;
mod queue;
mod report;
mod stream;

pub use error::{Error, Result};
pub use report::Report;
pub use stream::{Limits, Stream};
