//! The command-line tools as a library: from files on a disk to printed measurements.

mod error;
pub mod exif;
pub mod picture;
pub mod units;

pub use error::{Error, Result};
