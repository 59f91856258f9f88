//! Edges on their way from the interrupt to the main loop.

use crate::message::{Edge, Level};

/// Edges that fit: two passes of thirteen teeth and some.
pub const CAPACITY: usize = 64;
const MASK: u8 = CAPACITY as u8 - 1;

const HIGH: u8 = 1;
const LATE: u8 = 2;

/// A first-in, first-out ring of edges.
///
/// Once it has overflowed it takes nothing more until [`EdgeRing::clear`], so that what comes out is always an unbroken
/// beginning of what happened; the rest is counted.
///
/// Times and flags lie in arrays of their own: slots of four bytes and of one need no multiplication.
#[derive(Debug, Clone)]
pub struct EdgeRing {
    ticks: [u32; CAPACITY],
    flags: [u8; CAPACITY],
    next_in: u8,
    next_out: u8,
    /// Places that are not there any more: none until an edge is lost, then all.
    shut: u8,
    lost: u16,
}

impl Default for EdgeRing {
    fn default() -> Self {
        Self::new()
    }
}

impl EdgeRing {
    /// An empty ring.
    #[must_use]
    pub const fn new() -> Self {
        Self { ticks: [0; CAPACITY], flags: [0; CAPACITY], next_in: 0, next_out: 0, shut: 0, lost: 0 }
    }

    /// Adds an edge, or counts it as lost.
    #[inline]
    pub fn push(&mut self, edge: Edge) {
        if self.len() + self.shut >= CAPACITY as u8 {
            self.lose(1);
            return;
        }
        let at = usize::from(self.next_in & MASK);
        self.ticks[at] = edge.tick;
        self.flags[at] = if edge.level == Level::High { HIGH } else { 0 } | if edge.late { LATE } else { 0 };
        self.next_in = self.next_in.wrapping_add(1);
    }

    /// Takes the oldest edge.
    #[inline]
    pub fn pop(&mut self) -> Option<Edge> {
        if self.next_in == self.next_out {
            return None;
        }
        let at = usize::from(self.next_out & MASK);
        self.next_out = self.next_out.wrapping_add(1);
        let flags = self.flags[at];
        let level = if flags & HIGH != 0 { Level::High } else { Level::Low };
        Some(Edge { tick: self.ticks[at], level, late: flags & LATE != 0 })
    }

    /// Edges in it.
    #[inline]
    #[must_use]
    pub const fn len(&self) -> u8 {
        self.next_in.wrapping_sub(self.next_out)
    }

    /// Whether there is nothing in it.
    #[inline]
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.next_in == self.next_out
    }

    /// Edges lost since it was cleared; 65535 if more.
    #[must_use]
    pub const fn lost(&self) -> u16 {
        self.lost
    }

    /// Counts edges that are known to have happened and never came here.
    #[cold]
    pub fn lose(&mut self, edges: u16) {
        self.shut = CAPACITY as u8;
        self.lost = self.lost.saturating_add(edges);
    }

    /// Empties it and forgets what was lost.
    pub fn clear(&mut self) {
        self.next_out = self.next_in;
        self.shut = 0;
        self.lost = 0;
    }
}
