//! Teeth and slits from edges.

use crate::clock::ticks_between;
use crate::message::{Edge, Level};

/// A part of the toothed sheet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Section {
    /// It blocks the light: the sensor is low.
    Tooth,
    /// It lets the light through: the sensor is high.
    Slit,
}

impl Section {
    /// The section that `level` means.
    #[must_use]
    pub const fn at(level: Level) -> Self {
        match level {
            Level::Low => Self::Tooth,
            Level::High => Self::Slit,
        }
    }
}

/// The passage of one section.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Interval {
    /// What passed.
    pub section: Section,
    /// When it began, in ticks.
    pub start_tick: u32,
    /// How long it took, in ticks.
    pub ticks: u32,
    /// Whether one of its two edges is late.
    pub late: bool,
}

/// Two edges in a row led to the same level, so the one between them is missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the edge at tick {tick} leads to {level:?} again: an edge is missing before it")]
pub struct LevelRepeated {
    /// Time of the second of them.
    pub tick: u32,
    /// The level.
    pub level: Level,
}

/// Follows the edges of a run.
///
/// ```
/// use slider_proto::section::{Section, Sections};
/// use slider_proto::{Edge, Level};
/// let mut sections = Sections::default();
/// let edge = |tick, level| Edge { tick, level, late: false };
/// assert_eq!(sections.push(edge(100, Level::Low)), Ok(None)); // the first tooth begins
/// let tooth = sections.push(edge(400, Level::High)).unwrap().unwrap();
/// assert_eq!((tooth.section, tooth.ticks), (Section::Tooth, 300));
/// assert!(sections.push(edge(500, Level::High)).is_err());
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Sections {
    last: Option<Edge>,
}

impl Sections {
    /// Before the first edge.
    pub const NEW: Self = Self { last: None };

    /// Takes the next edge and returns the section that it ends. After an error, the edge begins a section as usual.
    pub fn push(&mut self, edge: Edge) -> Result<Option<Interval>, LevelRepeated> {
        match self.last.replace(edge) {
            None => Ok(None),
            Some(last) if last.level == edge.level => Err(LevelRepeated { tick: edge.tick, level: edge.level }),
            Some(last) => Ok(Some(Interval {
                section: Section::at(last.level),
                start_tick: last.tick,
                ticks: ticks_between(last.tick, edge.tick),
                late: last.late || edge.late,
            })),
        }
    }
}
