//! From numbers, strings and sequences to bytes.

use super::{ByteOrder, ENCAPSULATION_BYTES};

/// Writes the fields of a message one after the other.
#[derive(Debug, Clone)]
pub struct Writer {
    bytes: Vec<u8>,
    order: ByteOrder,
}

impl Writer {
    /// A writer of a message in an order of bytes.
    pub fn new(order: ByteOrder) -> Self {
        let [high, low] = order.id().to_be_bytes();
        Self { bytes: vec![high, low, 0, 0], order }
    }

    /// The message.
    pub fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }

    /// A byte.
    pub fn u8(&mut self, value: u8) {
        self.bytes.push(value);
    }

    /// A boolean.
    pub fn bool(&mut self, value: bool) {
        self.u8(value.into());
    }

    /// A signed number of 32 bits.
    pub fn i32(&mut self, value: i32) {
        self.number(value.to_le_bytes());
    }

    /// An unsigned number of 32 bits.
    pub fn u32(&mut self, value: u32) {
        self.number(value.to_le_bytes());
    }

    /// A float of 64 bits.
    pub fn f64(&mut self, value: f64) {
        self.number(value.to_le_bytes());
    }

    /// An array of floats of 64 bits.
    pub fn f64s(&mut self, values: &[f64]) {
        for &value in values {
            self.f64(value);
        }
    }

    /// A string.
    pub fn string(&mut self, value: &str) {
        self.length(value.len() + 1);
        self.bytes.extend_from_slice(value.as_bytes());
        self.bytes.push(0);
    }

    /// A sequence of bytes.
    pub fn bytes(&mut self, values: &[u8]) {
        self.length(values.len());
        self.bytes.extend_from_slice(values);
    }

    /// A sequence.
    pub fn sequence<T>(&mut self, values: &[T], element: impl Fn(&mut Self, &T)) {
        self.length(values.len());
        for value in values {
            element(self, value);
        }
    }

    /// The format has no longer sequences than a `u32` counts; no message that is written here comes near.
    fn length(&mut self, length: usize) {
        self.u32(length as u32);
    }

    fn number<const N: usize>(&mut self, mut bytes: [u8; N]) {
        let padding = (self.bytes.len() - ENCAPSULATION_BYTES).wrapping_neg() % N;
        self.bytes.resize(self.bytes.len() + padding, 0);
        if self.order == ByteOrder::Big {
            bytes.reverse();
        }
        self.bytes.extend_from_slice(&bytes);
    }
}
