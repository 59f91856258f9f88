//! From edges and the sheet to points (t, x).
//!
//! [`Points::from_run`] leaves out pulses that are too short to be a tooth, finds which edge of the sheet each other edge
//! is, which way the sheet passed, and where the run stops being one pass; what it had to assume is in the warnings.
//! [`Points::from_csv`] takes points that something else measured.

mod csv;
mod glitch;
mod matching;

use nalgebra::DMatrix;
use slider_proto::{Edge, Unwrapper};

use crate::run::{End, Run};
use crate::sheet::Sheet;
use crate::{Error, points::matching::Matched};

/// Longest time, s, by which a late edge is stamped too late ([`slider_proto::Edge::late`]).
const LATE_S: f64 = 15e-6;

/// Points of one motion, in the order of time.
#[derive(Debug, Clone, PartialEq)]
pub struct Points {
    /// Times, s; of a run from its first edge.
    pub t_s: Vec<f64>,
    /// Positions, m; of a run from the first edge of the sheet.
    pub x_m: Vec<f64>,
    /// Standard uncertainties of the times, s, independent of each other.
    pub time_std_s: Vec<f64>,
    /// How well the positions are known.
    pub positions: Positions,
    /// What had to be left out or assumed.
    pub warnings: Vec<String>,
}

/// What positions are, and with that their uncertainty.
#[derive(Debug, Clone, PartialEq)]
pub enum Positions {
    /// Edges of a toothed sheet.
    Edges {
        /// The sheet in the order in which it passed.
        sheet: Sheet,
        /// Whether it passed with its last tooth first.
        reversed: bool,
        /// Which edge of `sheet` each point is; a tooth begins at the even ones.
        indices: Vec<usize>,
    },
    /// Measured one by one, with these standard uncertainties in m.
    Independent(Vec<f64>),
    /// Nothing is known but that all are equally good: their scatter tells.
    Unknown,
}

impl Positions {
    /// Covariance of the positions, m^2, without what scales all of them alike; `None` if nothing is known.
    pub fn covariance_m2(&self) -> Option<DMatrix<f64>> {
        match self {
            Self::Edges { sheet, indices, .. } => {
                let full = Sheet { scale_std: 0.0, ..sheet.clone() }.covariance_m2();
                Some(full.select_rows(indices).select_columns(indices))
            }
            Self::Independent(std) => {
                Some(DMatrix::from_fn(std.len(), std.len(), |i, j| if i == j { std[i] * std[i] } else { 0.0 }))
            }
            Self::Unknown => None,
        }
    }

    /// Relative standard uncertainty that scales all positions alike.
    pub fn scale_std(&self) -> f64 {
        match self {
            Self::Edges { sheet, .. } => sheet.scale_std,
            _ => 0.0,
        }
    }

    /// The name of point `index` for a user: its tooth and edge, or its number.
    pub fn label(&self, index: usize) -> String {
        match self {
            Self::Edges { indices, .. } if index < indices.len() => {
                let edge = indices[index];
                format!("{} of tooth {}", if edge.is_multiple_of(2) { "first edge" } else { "last edge" }, edge / 2 + 1)
            }
            _ => format!("point {}", index + 1),
        }
    }
}

/// An edge with its time from the first one.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Timed {
    t_s: f64,
    edge: Edge,
}

impl Points {
    /// The points of a run of the sheet.
    ///
    /// A time has the standard uncertainty `tick / sqrt(12)`: a capture is the number of whole ticks before the edge, which
    /// is late by half a tick on average for all edges alike, so differences need no correction. A late edge is stamped up
    /// to 15 us too late; half of that is taken off and its uncertainty is that of the rectangle (GUM 4.3.7).
    ///
    /// The first edge of a run is taken for the first edge of the sheet: the timer refuses to start on a tooth.
    pub fn from_run(run: &Run, sheet: &Sheet) -> Result<Self, Error> {
        let mut warnings = Vec::new();
        let timed = times(run, &mut warnings);
        let (kept, pulses) = glitch::without_short_pulses(&timed);
        if pulses > 0 {
            warnings.push(format!("{pulses} edges of pulses too short for a tooth or a slit are left out"));
        }
        if kept.len() < 3 {
            return Err(Error::TooFewEdges { edges: kept.len() });
        }
        let Matched { sheet, reversed, indices } = matching::matched(&kept, sheet, &mut warnings)?;
        let kept = &kept[..indices.len()];
        end_warnings(run, indices.last().copied().unwrap_or(0), sheet.sections.len(), &mut warnings);
        let late: Vec<_> =
            kept.iter().enumerate().filter(|(_, timed)| timed.edge.late).map(|(index, _)| index).collect();
        if !late.is_empty() {
            warnings.push(format!("{} edges were stamped late and count less", late.len()));
        }
        let tick_s = 1.0 / f64::from(run.tick_hz);
        let corrected = |timed: &Timed| timed.t_s - if timed.edge.late { LATE_S / 2.0 } else { 0.0 };
        let start_s = corrected(&kept[0]);
        let positions = sheet.positions_m();
        Ok(Self {
            t_s: kept.iter().map(|timed| corrected(timed) - start_s).collect(),
            x_m: indices.iter().map(|&index| positions[index]).collect(),
            time_std_s: kept
                .iter()
                .map(|timed| if timed.edge.late { tick_s.hypot(LATE_S) } else { tick_s } / 12f64.sqrt())
                .collect(),
            positions: Positions::Edges { sheet, reversed, indices },
            warnings,
        })
    }
}

/// Times from the first edge; edges that do not come after the one before are dropped.
fn times(run: &Run, warnings: &mut Vec<String>) -> Vec<Timed> {
    let mut unwrapper = Unwrapper::default();
    let mut timed: Vec<(u64, Edge)> = Vec::with_capacity(run.edges.len());
    for &edge in &run.edges {
        let tick = unwrapper.unwrap(edge.tick);
        match timed.last() {
            Some(&(last, _)) if tick <= last => {
                warnings.push(format!("edge at tick {} is not after the last", edge.tick));
            }
            _ => timed.push((tick, edge)),
        }
    }
    let start = timed.first().map_or(0, |&(tick, _)| tick);
    let tick_hz = f64::from(run.tick_hz);
    timed.into_iter().map(|(tick, edge)| Timed { t_s: (tick - start) as f64 / tick_hz, edge }).collect()
}

fn end_warnings(run: &Run, last: usize, sections: usize, warnings: &mut Vec<String>) {
    match run.end {
        End::Missing => warnings.push("the end of the run was not received".to_owned()),
        End::Told { lost, .. } if lost > 0 => warnings.push(format!("the timer lost {lost} edges")),
        End::Told { edges, .. } if usize::from(edges) != run.edges.len() => {
            warnings.push(format!("{} of {edges} edges were received", run.edges.len()));
        }
        End::Told { .. } => {}
    }
    if last < sections {
        warnings.push(format!("the run is incomplete: it ends with edge {} of {}", last + 1, sections + 1));
    }
}
