//! The command-line tools as a library: from files on a disk to printed measurements.

mod error;
pub mod exif;
pub mod input;
pub mod picture;
pub mod sample;
pub mod units;

pub use error::{Error, Result};
