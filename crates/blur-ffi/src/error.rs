//! What can go wrong, as text and as a number.

use thiserror::Error;

/// Shorthand for results of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// What became of a call. The numbers never change.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Code {
    /// It did what it says.
    Ok = 0,
    /// A pointer is null that must not be.
    NullPointer = 1,
    /// The field struct_size of a structure is not a size that this library can read.
    StructSize = 2,
    /// A number is not one of its enumeration.
    UnknownValue = 3,
    /// Rows of a picture overlap, run backwards, or reach beyond what can be addressed.
    Layout = 4,
    /// The configuration is not allowed.
    Configuration = 5,
    /// The picture cannot be measured: too small, constant, not finite, or of another shape than the camera's.
    Picture = 6,
    /// Another thread is using the handle.
    Busy = 7,
    /// An earlier call on the handle failed with MB_CODE_INTERNAL: free it and make another.
    Poisoned = 8,
    /// A defect of the library.
    Internal = 9,
}

/// Why a call failed. The text is what [`mb_error_message`](crate::mb_error_message) gives.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// A pointer is null.
    #[error("{name} is null; it must point to something")]
    NullPointer {
        /// Of the argument or field.
        name: &'static str,
    },
    /// A structure says that it is smaller than its first version, or absurdly large.
    #[error("{structure}.struct_size is {bytes}, expected {least} to {most}: set it to sizeof({structure})")]
    StructSize {
        /// Name in C.
        structure: &'static str,
        /// The size given.
        bytes: usize,
        /// Size of its first version.
        least: usize,
        /// Largest size that is looked at.
        most: usize,
    },
    /// A structure of a newer header uses fields that this library does not know.
    #[error(
        "byte {offset} of {structure} is set, but this library knows its first {known} bytes only: it is older than the header"
    )]
    NewerField {
        /// Name in C.
        structure: &'static str,
        /// Of the first such byte.
        offset: usize,
        /// Bytes that this library knows.
        known: usize,
    },
    /// A number is not one of its enumeration.
    #[error("{field} = {value} is not allowed: it must be 0 to {most}, see {enumeration}")]
    UnknownValue {
        /// Structure and field in C.
        field: &'static str,
        /// The number.
        value: i32,
        /// Largest number of the enumeration.
        most: i32,
        /// The enumeration in C.
        enumeration: &'static str,
    },
    /// Rows of a picture overlap or run backwards.
    #[error("mb_picture.row_bytes = {row_bytes} is not allowed: rows of {width} pixels take {needed} bytes")]
    RowBytes {
        /// Bytes from the start of a row to that of the next.
        row_bytes: isize,
        /// Columns.
        width: usize,
        /// Bytes of a row.
        needed: usize,
    },
    /// A picture is larger than what can be addressed.
    #[error("a picture of {width}x{height} pixels with rows {row_bytes} bytes apart is larger than any memory")]
    TooLarge {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// Bytes from the start of a row to that of the next.
        row_bytes: isize,
    },
    /// The name of a method is not text.
    #[error("mb_configuration.method is not UTF-8 from byte {valid_bytes} on")]
    MethodText {
        /// Bytes that are text.
        valid_bytes: usize,
    },
    /// The configuration is not allowed.
    #[error(transparent)]
    Configuration(blur_core::Error),
    /// The picture cannot be measured.
    #[error(transparent)]
    Picture(blur_core::Error),
    /// Two threads use one handle.
    #[error("another thread is using this mb_meter: give every thread its own")]
    Busy,
    /// The handle was left half changed.
    #[error("an earlier call on this mb_meter failed inside the library: free it and make another")]
    Poisoned,
    /// The library panicked.
    #[error("defect of the library: {message}")]
    Internal {
        /// What the panic said.
        message: String,
    },
}

impl Error {
    /// Its number.
    pub fn code(&self) -> Code {
        match self {
            Self::NullPointer { .. } => Code::NullPointer,
            Self::StructSize { .. } | Self::NewerField { .. } => Code::StructSize,
            Self::UnknownValue { .. } => Code::UnknownValue,
            Self::RowBytes { .. } | Self::TooLarge { .. } => Code::Layout,
            Self::MethodText { .. } | Self::Configuration(_) => Code::Configuration,
            Self::Picture(_) => Code::Picture,
            Self::Busy => Code::Busy,
            Self::Poisoned => Code::Poisoned,
            Self::Internal { .. } => Code::Internal,
        }
    }
}
