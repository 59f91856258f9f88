//! The lines of the file.

use serde::{Deserialize, Serialize};
use slider_proto::{Edge, EdgeBatch, EndReason, Level};

/// The beginning of a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// What kind of file it is: `slider-run`.
    pub(super) format: String,
    /// Version of the format.
    pub(super) version: u32,
    /// Version of the program that wrote it.
    pub program: String,
    /// The serial port.
    pub port: String,
    /// `timer`, or `drive`.
    pub unit: String,
    /// Version of the firmware.
    pub firmware: String,
    /// Ticks a second.
    pub tick_hz: u32,
    /// When the run began by the computer's clock, s since 1970-01-01 UTC.
    pub started_s: f64,
    /// Name of the sheet.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sheet: Option<String>,
    /// Number of the run.
    pub run: u16,
    /// Tick of the first edge, as the start of the run told it.
    pub tick: u32,
}

/// What `format` says.
pub(super) const FORMAT: &str = "slider-run";

/// One line.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Line<R> {
    Header(Header),
    Edges(Edges),
    End(TimerEnd),
    Incomplete(Incomplete),
    Result(R),
}

/// Edges of a batch; the three lists are of one length.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Edges {
    pub(super) first: u16,
    tick: Vec<u32>,
    level: Vec<u8>,
    late: Vec<u8>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TimerEnd {
    #[serde(with = "reason")]
    pub(super) reason: EndReason,
    pub(super) edges: u16,
    pub(super) late: u16,
    pub(super) lost: u16,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Incomplete {
    pub(super) reason: String,
    pub(super) edges: usize,
}

impl From<&EdgeBatch> for Edges {
    fn from(batch: &EdgeBatch) -> Self {
        let edges = batch.edges();
        Self {
            first: batch.first_index,
            tick: edges.iter().map(|edge| edge.tick).collect(),
            level: edges.iter().map(|edge| edge.level as u8).collect(),
            late: edges.iter().map(|edge| u8::from(edge.late)).collect(),
        }
    }
}

impl Edges {
    /// The batch of a run, or why it is none.
    pub(super) fn batch(&self, run: u16) -> Result<EdgeBatch, String> {
        let Self { first, tick, level, late } = self;
        if tick.len() != level.len() || tick.len() != late.len() || !(1..=EdgeBatch::CAPACITY).contains(&tick.len()) {
            let (ticks, levels, lates) = (tick.len(), level.len(), late.len());
            return Err(format!("{ticks} ticks, {levels} levels and {lates} marks of late edges are no batch"));
        }
        let mut batch = EdgeBatch::new(run, *first);
        for ((&tick, &level), &late) in tick.iter().zip(level).zip(late) {
            let level = match level {
                0 => Level::Low,
                1 => Level::High,
                other => return Err(format!("level {other} is neither 0 nor 1")),
            };
            let late = match late {
                0 => false,
                1 => true,
                other => return Err(format!("late {other} is neither 0 nor 1")),
            };
            // Its length was seen to fit.
            let _ = batch.push(Edge { tick, level, late });
        }
        Ok(batch)
    }
}

const REASONS: [(EndReason, &str); 5] = [
    (EndReason::Quiet, "quiet"),
    (EndReason::Limit, "limit"),
    (EndReason::Stopped, "stopped"),
    (EndReason::Full, "full"),
    (EndReason::Overrun, "overrun"),
];

/// Why a run ended, as the word that the file has.
pub fn reason_word(reason: EndReason) -> &'static str {
    REASONS.iter().find(|(one, _)| *one == reason).map_or("unknown", |(_, word)| word)
}

mod reason {
    use serde::{Deserialize, Deserializer, Serializer, de::Error};
    use slider_proto::EndReason;

    use super::{REASONS, reason_word};

    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands a reference")]
    pub(super) fn serialize<S: Serializer>(reason: &EndReason, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(reason_word(*reason))
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<EndReason, D::Error> {
        let word = String::deserialize(deserializer)?;
        let found = REASONS.iter().find(|(_, known)| *known == word);
        found.map(|(reason, _)| *reason).ok_or_else(|| D::Error::custom(format!("unknown reason '{word}'")))
    }
}
