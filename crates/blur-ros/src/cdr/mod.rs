//! The binary form of ROS 2 messages: XCDR version 1, little or big endian.
//!
//! OMG DDS-XTypes 1.3, 7.4.1 and 7.6.2: a message begins with four bytes, of which the first two tell the representation; numbers
//! are aligned to their own size, counted from behind those four bytes; strings and sequences begin with their length as a
//! `u32`, which for strings counts the zero at the end.

mod reader;
mod writer;

pub use reader::Reader;
pub use writer::Writer;

/// Bytes in front of a message that tell its representation.
const ENCAPSULATION_BYTES: usize = 4;

/// The order of the bytes of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ByteOrder {
    /// The highest byte first: representation `CDR_BE`.
    Big,
    /// The lowest byte first: representation `CDR_LE`.
    Little,
}

impl ByteOrder {
    /// That of this machine.
    pub const NATIVE: Self = if cfg!(target_endian = "big") { Self::Big } else { Self::Little };

    /// The identifier of the representation.
    fn id(self) -> u16 {
        match self {
            Self::Big => 0,
            Self::Little => 1,
        }
    }

    fn of_id(id: u16) -> Option<Self> {
        [Self::Big, Self::Little].into_iter().find(|order| order.id() == id)
    }
}
