//! The one error type of the crate.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

/// Shorthand for results of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// Why a message, a bag or a frame gives no measurement.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// A message ends within a field.
    #[error("the message ends too early: {needed} bytes needed at {at} of {bytes}")]
    CdrEnd {
        /// Bytes that the field needs.
        needed: usize,
        /// Where it begins, behind the encapsulation.
        at: usize,
        /// Bytes of the message.
        bytes: usize,
    },
    /// A message is not in plain CDR.
    #[error("the message has representation {id:#06x}; only plain CDR, 0x0000 and 0x0001, can be read")]
    CdrRepresentation {
        /// Identifier of the representation.
        id: u16,
    },
    /// A string is not UTF-8.
    #[error("the string that ends at byte {at} is not UTF-8")]
    CdrText {
        /// Where it ends, behind the encapsulation.
        at: usize,
    },
    /// The pixels are of a kind that cannot be measured.
    #[error("pictures with encoding '{encoding}' cannot be measured: {advice}")]
    Encoding {
        /// The encoding.
        encoding: String,
        /// What to do.
        advice: &'static str,
    },
    /// The camera of a `CameraInfo` cannot be used.
    #[error("the CameraInfo cannot be used: {reason}")]
    CameraInfo {
        /// Why.
        reason: String,
    },
    /// A compressed picture cannot be decoded.
    #[error(transparent)]
    Picture(#[from] blur_picture::Error),
    /// The picture or a parameter of the measurement is refused.
    #[error(transparent)]
    Estimate(#[from] blur_core::Error),
    /// A value or its uncertainty is not a possible measurement.
    #[error(transparent)]
    Measurement(#[from] metrology::Error),
    /// A file cannot be read.
    #[error("{} cannot be read: {source}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A file cannot be written.
    #[error("{} cannot be written: {source}", .path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The content of a bag is damaged.
    #[error("{} is damaged or ends too early: {source}", .path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: mcap::McapError,
    },
    /// The bag cannot be written.
    #[error("{} cannot be written: {source}", .path.display())]
    Mcap {
        /// The file.
        path: PathBuf,
        /// Why.
        source: mcap::McapError,
    },
    /// The file is no MCAP file.
    #[error("{} is no bag in an MCAP file; convert other storage with 'ros2 bag convert'", .path.display())]
    NotABag {
        /// The file.
        path: PathBuf,
    },
    /// The folder of a bag cannot be used.
    #[error("{}: {reason}", .path.display())]
    BagFolder {
        /// Its `metadata.yaml`.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// The bag has no pictures.
    #[error("the bag has no topic with pictures (sensor_msgs/msg/Image or CompressedImage); its topics: {topics}")]
    NoImageTopic {
        /// What it has.
        topics: String,
    },
    /// The bag has several topics with pictures.
    #[error("the bag has {count} topics with pictures: choose one with --topic: {topics}")]
    ManyImageTopics {
        /// How many.
        count: usize,
        /// Their names.
        topics: String,
    },
    /// The bag has no such topic with pictures.
    #[error("the bag has no topic '{topic}' with pictures; it has: {topics}")]
    UnknownTopic {
        /// The topic asked for.
        topic: String,
        /// What it has.
        topics: String,
    },
    /// Zenoh refuses something.
    #[cfg(feature = "node")]
    #[error("Zenoh cannot {task}: {reason}")]
    Zenoh {
        /// What was to be done.
        task: &'static str,
        /// Why it cannot be.
        reason: String,
    },
    /// The worker of a node cannot be started, or has failed.
    #[cfg(feature = "node")]
    #[error(transparent)]
    Stream(#[from] blur_stream::Error),
    /// The bag would overwrite its input.
    #[error("the output {} would overwrite the input: name another file", .path.display())]
    Overwrites {
        /// The file.
        path: PathBuf,
    },
}
