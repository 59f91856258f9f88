//! Integers in and out of a payload.

use crate::frame::ProtoError;

/// Writes to a buffer; what does not fit is counted, and [`Writer::finish`] tells.
pub struct Writer<'a> {
    bytes: &'a mut [u8],
    at: usize,
}

impl<'a> Writer<'a> {
    pub(crate) fn new(bytes: &'a mut [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    pub(crate) fn u8(&mut self, value: u8) {
        if let Some(slot) = self.bytes.get_mut(self.at) {
            *slot = value;
        }
        self.at += 1;
    }

    pub(crate) fn u16(&mut self, value: u16) {
        for byte in value.to_le_bytes() {
            self.u8(byte);
        }
    }

    pub(crate) fn u32(&mut self, value: u32) {
        for byte in value.to_le_bytes() {
            self.u8(byte);
        }
    }

    /// Seven bits a byte, low bits first, the top bit set in all bytes but the last.
    pub(crate) fn varint(&mut self, mut value: u32) {
        while value >= 0x80 {
            self.u8(value as u8 | 0x80);
            value >>= 7;
        }
        self.u8(value as u8);
    }

    /// What has been written so far, or `None` if it did not fit.
    pub(crate) fn written(&self) -> Option<&[u8]> {
        self.bytes.get(..self.at)
    }
}

/// Reads from a payload; every byte has to be used.
pub struct Reader<'a> {
    bytes: &'a [u8],
}

impl<'a> Reader<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes }
    }

    pub(crate) fn u8(&mut self) -> Result<u8, ProtoError> {
        let (&first, rest) = self.bytes.split_first().ok_or(ProtoError::Payload)?;
        self.bytes = rest;
        Ok(first)
    }

    pub(crate) fn u16(&mut self) -> Result<u16, ProtoError> {
        Ok(u16::from_le_bytes([self.u8()?, self.u8()?]))
    }

    pub(crate) fn u32(&mut self) -> Result<u32, ProtoError> {
        Ok(u32::from_le_bytes([self.u8()?, self.u8()?, self.u8()?, self.u8()?]))
    }

    pub(crate) fn bool(&mut self) -> Result<bool, ProtoError> {
        match self.u8()? {
            0 => Ok(false),
            1 => Ok(true),
            _ => Err(ProtoError::Payload),
        }
    }

    /// The inverse of [`Writer::varint`]; only the shortest form is accepted, so that every value has one.
    pub(crate) fn varint(&mut self) -> Result<u32, ProtoError> {
        let mut value = 0u32;
        for shift in [0, 7, 14, 21, 28] {
            let byte = self.u8()?;
            let bits = u32::from(byte & 0x7f);
            if shift == 28 && bits > 0x0f {
                return Err(ProtoError::Payload);
            }
            value |= bits << shift;
            if byte & 0x80 == 0 {
                let shortest = byte != 0 || shift == 0;
                return if shortest { Ok(value) } else { Err(ProtoError::Payload) };
            }
        }
        Err(ProtoError::Payload)
    }

    pub(crate) fn finish(self) -> Result<(), ProtoError> {
        if self.bytes.is_empty() { Ok(()) } else { Err(ProtoError::Payload) }
    }
}
