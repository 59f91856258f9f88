//! Edges, one and several.

use super::Level;
use crate::frame::ProtoError;
use crate::wire::{Reader, Writer};

/// One edge of the sensor's output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Edge {
    /// Time in ticks of [`TICK_HZ`](crate::TICK_HZ), modulo 2^32.
    pub tick: u32,
    /// Level after the edge.
    pub level: Level,
    /// The edge came before the one before it had been served, so the hardware has not captured it. Its time is when
    /// the interrupt found it: too late by at most the length of that interrupt, some 15 us.
    pub late: bool,
}

/// Up to eight edges of a run, in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EdgeBatch {
    /// The run they belong to.
    pub run: u16,
    /// Number of edges of the run before the first of these.
    pub first_index: u16,
    edges: [Edge; Self::CAPACITY],
    length: u8,
}

impl EdgeBatch {
    /// Most edges in one batch.
    pub const CAPACITY: usize = 8;

    /// An empty batch.
    #[must_use]
    pub const fn new(run: u16, first_index: u16) -> Self {
        let none = Edge { tick: 0, level: Level::Low, late: false };
        Self { run, first_index, edges: [none; Self::CAPACITY], length: 0 }
    }

    /// Adds an edge; if the batch is full, gives it back.
    pub fn push(&mut self, edge: Edge) -> Result<(), Edge> {
        match self.edges.get_mut(usize::from(self.length)) {
            Some(slot) => {
                *slot = edge;
                self.length += 1;
                Ok(())
            }
            None => Err(edge),
        }
    }

    /// The edges.
    #[must_use]
    pub fn edges(&self) -> &[Edge] {
        self.edges.get(..usize::from(self.length)).unwrap_or_default()
    }

    /// Payload: run `u16`, first index `u16`, count `u8`, levels `u8` (bit i is the level of edge i), late `u8`
    /// (likewise), first tick `u32`, then the ticks from each edge to the next as varints.
    pub(super) fn write(&self, writer: &mut Writer<'_>) {
        writer.u16(self.run);
        writer.u16(self.first_index);
        writer.u8(self.length);
        let bits =
            |is: fn(&Edge) -> bool| self.edges().iter().rev().fold(0u8, |bits, edge| (bits << 1) | u8::from(is(edge)));
        writer.u8(bits(|edge| edge.level == Level::High));
        writer.u8(bits(|edge| edge.late));
        let mut before = None;
        for edge in self.edges() {
            match before {
                None => writer.u32(edge.tick),
                Some(before) => writer.varint(edge.tick.wrapping_sub(before)),
            }
            before = Some(edge.tick);
        }
    }

    pub(super) fn read(reader: &mut Reader<'_>) -> Result<Self, ProtoError> {
        let mut batch = Self::new(reader.u16()?, reader.u16()?);
        let length = reader.u8()?;
        let (levels, late) = (reader.u8()?, reader.u8()?);
        let beyond = if length < 8 { !0u8 << length } else { 0 };
        if length == 0 || usize::from(length) > Self::CAPACITY || (levels | late) & beyond != 0 {
            return Err(ProtoError::Payload);
        }
        let mut tick = reader.u32()?;
        for i in 0..length {
            if i > 0 {
                tick = tick.wrapping_add(reader.varint()?);
            }
            let level = if levels >> i & 1 == 0 { Level::Low } else { Level::High };
            let edge = Edge { tick, level, late: late >> i & 1 == 1 };
            batch.push(edge).map_err(|_| ProtoError::Payload)?;
        }
        Ok(batch)
    }
}
