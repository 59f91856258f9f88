//! From bytes to numbers, strings and sequences.

use super::{ByteOrder, ENCAPSULATION_BYTES};
use crate::{Error, Result};

/// Reads the fields of a message one after the other. Strings and sequences of bytes are not copied.
#[derive(Debug, Clone)]
pub struct Reader<'a> {
    body: &'a [u8],
    at: usize,
    order: ByteOrder,
}

impl<'a> Reader<'a> {
    /// A reader behind the four bytes that tell the representation.
    ///
    /// # Errors
    /// [`Error::CdrEnd`] and [`Error::CdrRepresentation`].
    pub fn new(message: &'a [u8]) -> Result<Self> {
        let Some((&[high, low, _, _], body)) = message.split_first_chunk::<ENCAPSULATION_BYTES>() else {
            return Err(Error::CdrEnd { needed: ENCAPSULATION_BYTES, at: 0, bytes: message.len() });
        };
        // The identifier itself is always big endian.
        let id = u16::from_be_bytes([high, low]);
        let order = ByteOrder::of_id(id).ok_or(Error::CdrRepresentation { id })?;
        Ok(Self { body, at: 0, order })
    }

    /// The order of the bytes of its numbers.
    pub fn order(&self) -> ByteOrder {
        self.order
    }

    /// A byte.
    pub fn u8(&mut self) -> Result<u8> {
        Ok(self.number::<1>()?[0])
    }

    /// A boolean: any byte but 0 is true.
    pub fn bool(&mut self) -> Result<bool> {
        Ok(self.u8()? != 0)
    }

    /// A signed number of 32 bits.
    pub fn i32(&mut self) -> Result<i32> {
        self.number().map(i32::from_le_bytes)
    }

    /// An unsigned number of 32 bits.
    pub fn u32(&mut self) -> Result<u32> {
        self.number().map(u32::from_le_bytes)
    }

    /// A float of 64 bits.
    pub fn f64(&mut self) -> Result<f64> {
        self.number().map(f64::from_le_bytes)
    }

    /// An array of floats of 64 bits.
    pub fn f64s<const N: usize>(&mut self) -> Result<[f64; N]> {
        let mut values = [0.0; N];
        for value in &mut values {
            *value = self.f64()?;
        }
        Ok(values)
    }

    /// A string in UTF-8.
    pub fn string(&mut self) -> Result<&'a str> {
        let bytes = self.bytes()?;
        // Some writers leave out the zero of an empty string.
        let text = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        std::str::from_utf8(text).map_err(|_| Error::CdrText { at: self.at })
    }

    /// A sequence of bytes.
    pub fn bytes(&mut self) -> Result<&'a [u8]> {
        let length = self.u32()? as usize;
        self.take(length)
    }

    /// A sequence of elements that take at least `min_bytes` each.
    pub fn sequence<T>(&mut self, min_bytes: usize, element: impl Fn(&mut Self) -> Result<T>) -> Result<Vec<T>> {
        let length = self.u32()? as usize;
        let needed = length.saturating_mul(min_bytes);
        // Before memory is taken for what cannot be there.
        if needed > self.body.len() - self.at {
            return Err(self.end(needed));
        }
        (0..length).map(|_| element(self)).collect()
    }

    /// The bytes of a number, the lowest first.
    fn number<const N: usize>(&mut self) -> Result<[u8; N]> {
        let padding = self.at.wrapping_neg() % N;
        self.take(padding)?;
        let Some(&bytes) = self.body[self.at..].first_chunk::<N>() else { return Err(self.end(N)) };
        self.at += N;
        Ok(match self.order {
            ByteOrder::Little => bytes,
            ByteOrder::Big => {
                let mut bytes = bytes;
                bytes.reverse();
                bytes
            }
        })
    }

    fn take(&mut self, length: usize) -> Result<&'a [u8]> {
        let Some(bytes) = self.body[self.at..].get(..length) else { return Err(self.end(length)) };
        self.at += length;
        Ok(bytes)
    }

    fn end(&self, needed: usize) -> Error {
        Error::CdrEnd { needed, at: self.at, bytes: self.body.len() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_aligned_behind_the_first_four_bytes() {
        // A byte, three of padding, a u32, then a float at 8.
        let little = [0, 1, 0, 0, 7, 9, 9, 9, 1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0xF0, 0x3F];
        let mut reader = Reader::new(&little).unwrap();
        assert_eq!((reader.u8().unwrap(), reader.u32().unwrap(), reader.f64().unwrap()), (7, 0x0201, 1.0));
        let big = [0, 0, 0, 0, 7, 9, 9, 9, 0, 0, 2, 1, 0x3F, 0xF0, 0, 0, 0, 0, 0, 0];
        let mut reader = Reader::new(&big).unwrap();
        assert_eq!((reader.u8().unwrap(), reader.u32().unwrap(), reader.f64().unwrap()), (7, 0x0201, 1.0));
    }

    #[test]
    fn lengths_that_cannot_be_are_refused_before_memory_is_taken() {
        let bytes = [0, 1, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF, 1];
        let end = Error::CdrEnd { needed: 0xFFFF_FFFF, at: 4, bytes: 5 };
        assert_eq!(Reader::new(&bytes).unwrap().bytes().unwrap_err().to_string(), end.to_string());
        assert!(Reader::new(&bytes).unwrap().sequence(8, Reader::f64).is_err());
    }

    #[test]
    fn other_representations_are_refused() {
        for id in [2_u8, 3, 6, 7, 10] {
            let error = Reader::new(&[0, id, 0, 0]).unwrap_err();
            assert!(matches!(error, Error::CdrRepresentation { id: found } if found == u16::from(id)));
        }
        assert!(Reader::new(&[0, 1, 0]).is_err());
    }

    #[test]
    fn strings_end_before_their_zero() {
        let bytes = [0, 1, 0, 0, 3, 0, 0, 0, b'a', b'b', 0, 99, 0, 0, 0, 0, 1, 0, 0, 0, 0xFF];
        let mut reader = Reader::new(&bytes).unwrap();
        assert_eq!(reader.string().unwrap(), "ab");
        assert_eq!(reader.string().unwrap(), "");
        assert!(matches!(reader.string(), Err(Error::CdrText { .. })));
    }
}
