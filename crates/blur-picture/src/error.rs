//! The one error type of the crate.

use std::io;

use thiserror::Error;

/// Shorthand for results of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// Why a file gives no picture. Its path is not repeated here: whoever reports an error knows it.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// A file or folder cannot be read.
    #[error("cannot be read: {0}")]
    Read(#[source] io::Error),
    /// A file is empty.
    #[error("the file is empty")]
    EmptyFile,
    /// The content of a file is no picture.
    #[error("not a picture in PNG, JPEG or TIFF format: the file begins with \"{start}\"")]
    NotAPicture {
        /// The first bytes, with unprintable ones escaped.
        start: String,
    },
    /// The content is a picture in a format that is not read.
    #[error("a picture in {format} format; only PNG, JPEG and TIFF can be read")]
    OtherFormat {
        /// Name of the format.
        format: &'static str,
    },
    /// The file is larger than any picture that can be decoded.
    #[error("the file is larger than {limit} bytes")]
    FileTooLarge {
        /// Largest size in bytes.
        limit: u64,
    },
    /// The header announces more pixels than the memory limit allows.
    #[error(
        "the header announces {width}x{height} pixels and {bytes} bytes; at most {max_pixels} pixels and {max_bytes} bytes are decoded"
    )]
    TooLarge {
        /// Columns announced.
        width: u32,
        /// Rows announced.
        height: u32,
        /// Size of the decoded picture in bytes.
        bytes: u64,
        /// Most pixels.
        max_pixels: u64,
        /// Most decoded bytes.
        max_bytes: u64,
    },
    /// The picture data end too early.
    #[error("the {format} data end too early: the file is truncated")]
    Truncated {
        /// Name of the format.
        format: &'static str,
    },
    /// The decoder refuses the content.
    #[error("cannot be decoded: {0}")]
    Decode(#[from] image::ImageError),
    /// The TIFF decoder refuses the content.
    #[error("cannot be decoded: {0}")]
    DecodeTiff(#[from] tiff::TiffError),
    /// The samples are of a kind that is not read.
    #[error("pictures with {kind} samples cannot be read")]
    Samples {
        /// What the samples are.
        kind: String,
    },
    /// The decoder gave fewer or more samples than the size announced.
    #[error("{samples} samples do not fill a picture of {width}x{height} pixels")]
    SampleCount {
        /// Samples decoded.
        samples: usize,
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// The decoder gave less than it announced.
    #[error(transparent)]
    Pixels(#[from] blur_core::Error),
}
