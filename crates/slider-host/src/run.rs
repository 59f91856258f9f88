//! A run as it was received.

use slider_proto::{Edge, EndReason};

/// Why a run has no end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// The timer told its end, and that it had sent so many edges.
    Told {
        /// Why it ended.
        reason: EndReason,
        /// Edges that the timer has sent.
        edges: u16,
        /// Edges that it lost by overrun; not 0: those received are only the beginning.
        lost: u16,
    },
    /// The line went away, or another run began: what there is, is what came before.
    Missing,
}

/// The edges of one pass of the sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Its number.
    pub number: u16,
    /// Ticks a second of the timer.
    pub tick_hz: u32,
    /// The edges received, in order, without a gap; [`slider_proto::Unwrapper`] makes times of their ticks.
    pub edges: Vec<Edge>,
    /// Its end.
    pub end: End,
}

impl Run {
    /// Whether the timer's count says that every edge is here.
    pub fn is_complete(&self) -> bool {
        matches!(self.end, End::Told { edges, lost: 0, .. } if usize::from(edges) == self.edges.len())
    }
}
