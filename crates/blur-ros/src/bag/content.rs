//! The content of the records of an MCAP file that are of use here, borrowed from its bytes.

use std::io;

use mcap::{McapError, McapResult};

/// The type of the messages of channels.
pub(super) struct Schema<'a> {
    pub(super) id: u16,
    pub(super) name: &'a str,
}

/// Where messages of one type on one topic go.
pub(super) struct Channel<'a> {
    pub(super) id: u16,
    pub(super) schema_id: u16,
    pub(super) topic: &'a str,
    pub(super) encoding: &'a str,
}

/// A message.
pub(super) struct Message<'a> {
    pub(super) channel_id: u16,
    pub(super) log_ns: u64,
    pub(super) publish_ns: u64,
    pub(super) data: &'a [u8],
}

impl<'a> Schema<'a> {
    pub(super) fn new(content: &'a [u8]) -> McapResult<Self> {
        let mut fields = Fields(content);
        Ok(Self { id: fields.u16()?, name: fields.string()? })
    }
}

impl<'a> Channel<'a> {
    pub(super) fn new(content: &'a [u8]) -> McapResult<Self> {
        let mut fields = Fields(content);
        let (id, schema_id) = (fields.u16()?, fields.u16()?);
        Ok(Self { id, schema_id, topic: fields.string()?, encoding: fields.string()? })
    }
}

impl<'a> Message<'a> {
    pub(super) fn new(content: &'a [u8]) -> McapResult<Self> {
        let mut fields = Fields(content);
        let channel_id = fields.u16()?;
        // Its number in the channel tells nothing that the stamp does not.
        fields.array::<4>()?;
        Ok(Self { channel_id, log_ns: fields.u64()?, publish_ns: fields.u64()?, data: fields.0 })
    }
}

/// The fields of a record that have not been read; numbers have the lowest byte first.
struct Fields<'a>(&'a [u8]);

impl<'a> Fields<'a> {
    fn array<const N: usize>(&mut self) -> McapResult<[u8; N]> {
        let (bytes, rest) = self.0.split_first_chunk().ok_or(McapError::UnexpectedEof)?;
        self.0 = rest;
        Ok(*bytes)
    }

    fn u16(&mut self) -> McapResult<u16> {
        self.array().map(u16::from_le_bytes)
    }

    fn u64(&mut self) -> McapResult<u64> {
        self.array().map(u64::from_le_bytes)
    }

    fn string(&mut self) -> McapResult<&'a str> {
        let length = u32::from_le_bytes(self.array()?) as usize;
        let (text, rest) = self.0.split_at_checked(length).ok_or(McapError::UnexpectedEof)?;
        self.0 = rest;
        std::str::from_utf8(text).map_err(|error| McapError::Io(io::Error::new(io::ErrorKind::InvalidData, error)))
    }
}
