//! One run, put together from its messages.

use slider_proto::section::Sections;
use slider_proto::{Edge, EdgeBatch, EndReason, Level, ticks_between};

use crate::run::{End, Run};

use super::Missing;

/// A run that is over.
#[derive(Debug, Clone, PartialEq)]
pub struct Ended {
    /// What was received.
    pub run: Run,
    /// Why its end is missing, if it is.
    pub missing: Option<Missing>,
}

/// What the timer tells at the end of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ToldEnd {
    pub(crate) reason: EndReason,
    pub(crate) edges: u16,
    pub(crate) late: u16,
    pub(crate) lost: u16,
}

/// A run that goes on. It takes nothing that does not follow from what it has.
#[derive(Debug)]
pub(crate) struct Assembly {
    number: u16,
    tick_hz: u32,
    start_tick: u32,
    edges: Vec<Edge>,
    sections: Sections,
}

impl Assembly {
    pub(crate) fn new(number: u16, start_tick: u32, tick_hz: u32) -> Self {
        Self { number, tick_hz, start_tick, edges: Vec::new(), sections: Sections::NEW }
    }

    pub(crate) fn number(&self) -> u16 {
        self.number
    }

    /// Takes the edges that follow from those before. Returns them, and what is wrong with the one after them.
    pub(crate) fn batch(&mut self, batch: &EdgeBatch) -> (EdgeBatch, Option<Missing>) {
        let mut accepted = EdgeBatch::new(self.number, batch.first_index);
        // A run numbers at most 65535 edges.
        let expected = u16::try_from(self.edges.len()).unwrap_or(u16::MAX);
        if batch.run != self.number {
            return (accepted, Some(Missing::OtherRun(batch.run)));
        }
        if batch.first_index != expected || self.edges.len() + batch.edges().len() > usize::from(u16::MAX) {
            return (accepted, Some(Missing::Index { expected, found: batch.first_index }));
        }
        for &edge in batch.edges() {
            if let Err(missing) = self.edge(edge) {
                return (accepted, Some(missing));
            }
            // It holds as many as the batch that they come from.
            let _ = accepted.push(edge);
        }
        (accepted, None)
    }

    fn edge(&mut self, edge: Edge) -> Result<(), Missing> {
        match self.edges.last() {
            None if edge.tick != self.start_tick => {
                return Err(Missing::Start { told: self.start_tick, found: edge.tick });
            }
            None if edge.level != Level::Low => return Err(Missing::SlitFirst),
            // The longest silence that a run survives is 66 s, half the counter's turn 17 min.
            Some(before) if !(1..=u32::MAX / 2).contains(&ticks_between(before.tick, edge.tick)) => {
                return Err(Missing::Order { index: self.edges.len(), tick: edge.tick, before: before.tick });
            }
            _ => {}
        }
        self.sections.push(edge)?;
        self.edges.push(edge);
        Ok(())
    }

    /// Its end was told.
    pub(crate) fn end(self, told: ToldEnd) -> Ended {
        let ToldEnd { reason, edges, late, lost } = told;
        let received = self.edges.len();
        let received_late = self.edges.iter().filter(|edge| edge.late).count();
        if received != usize::from(edges) {
            self.without_end(Missing::Count { told: edges, received })
        } else if received_late != usize::from(late) {
            self.without_end(Missing::Late { told: late, received: received_late })
        } else {
            self.close(End::Told { reason, edges, lost }, None)
        }
    }

    /// Its end will not come.
    pub(crate) fn without_end(self, missing: Missing) -> Ended {
        self.close(End::Missing, Some(missing))
    }

    fn close(self, end: End, missing: Option<Missing>) -> Ended {
        let Self { number, tick_hz, edges, .. } = self;
        Ended { run: Run { number, tick_hz, edges, end }, missing }
    }
}
