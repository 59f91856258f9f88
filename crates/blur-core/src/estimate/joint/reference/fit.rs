//! Least squares of a path and an illumination.

use ndarray::Array2;
use rustfft::num_complex::Complex32;

use super::model::{GAINS, Model, Unknown, gain_of, of_path};
use super::normal::{MOST, Normal};
use super::path::Path;

/// Most steps of one fit.
const STEPS: usize = 25;
/// A fit has converged when the next step promises less than this share of a standard deviation, squared; without knowing
/// the noise, in units of the residual.
const CONVERGED: f64 = 1e-3;
/// Damping of the first step and factors by which it falls and rises.
const DAMPING: f64 = 1e-3;
const EASIER: f64 = 0.1;
const HARDER: f64 = 10.0;
const MOST_DAMPING: f64 = 1e6;
/// Shortest path of a fit in pixels: the transfer function is even in the length.
const SHORTEST_PX: f64 = 0.25;

/// A least-squares fit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fit {
    pub(super) path: Path,
    /// Values of all unknowns as a correction to the path (0) and as the illumination.
    pub(super) values: [f64; MOST],
    /// Coefficients of the gain.
    pub(super) gain: [f64; GAINS],
    /// Sum of the squares left, weighted.
    pub(super) rest: f64,
    /// Products of the columns at the solution.
    pub(super) normal: Normal,
}

/// A gain of 1 everywhere.
pub(super) const PLAIN: [f64; GAINS] = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];

/// Fits `unknowns` to the data of `model` by damped Gauss-Newton steps from `path` and `gain` (Levenberg, Marquardt), with
/// lengths of up to `most_length` pixels. The illumination is linear: at every path its best values are found exactly.
/// `None` when the columns depend on each other.
pub(super) fn fit(
    model: &mut Model,
    still: &Array2<Complex32>,
    unknowns: &[Unknown],
    start: (Path, [f64; GAINS]),
    most_length: f64,
) -> Option<Fit> {
    let free = of_path(unknowns);
    let mut best = at(model, still, unknowns, start.0, &start.1)?;
    let mut damping = DAMPING;
    let mut is_current = true;
    for _ in 0..STEPS {
        let (step, left) = best.normal.solve(0, free, damping)?;
        let converged = CONVERGED * best.rest / model.pixels();
        if best.rest - left < converged || damping > MOST_DAMPING {
            break;
        }
        let next = moved(&best.path, unknowns, &step, most_length);
        match at(model, still, unknowns, next, &gain_of(unknowns, &step)) {
            Some(found) if found.rest < best.rest => {
                let gained = best.rest - found.rest;
                (best, is_current) = (found, true);
                damping *= EASIER;
                if gained < converged {
                    break;
                }
            }
            _ => {
                is_current = false;
                damping *= HARDER;
            }
        }
    }
    if is_current { Some(best) } else { at(model, still, unknowns, best.path, &best.gain) }
}

/// The fit of the illumination alone.
fn at(
    model: &mut Model,
    still: &Array2<Complex32>,
    unknowns: &[Unknown],
    path: Path,
    gain: &[f64; GAINS],
) -> Option<Fit> {
    let normal = model.products(still, &path, unknowns, gain);
    let (values, rest) = normal.solve(of_path(unknowns), 0, 0.0)?;
    Some(Fit { path, values, gain: gain_of(unknowns, &values), rest, normal })
}

/// The path after a step.
fn moved(path: &Path, unknowns: &[Unknown], step: &[f64; MOST], most_length: f64) -> Path {
    let mut next = *path;
    for (unknown, step) in unknowns.iter().zip(step) {
        match unknown {
            Unknown::Right => next.centre[0] += step,
            Unknown::Down => next.centre[1] += step,
            Unknown::Length => next.length = (next.length + step).clamp(SHORTEST_PX, most_length),
            Unknown::Angle => next.angle += step,
            Unknown::Ratio => next.ratio = (next.ratio + step).clamp(-1.0, 1.0),
            Unknown::Gain(..) | Unknown::Offset | Unknown::Vignetting => {}
        }
    }
    next
}
