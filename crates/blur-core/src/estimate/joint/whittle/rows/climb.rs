//! The climb to the maximum of a likelihood of the rows' parameters, by Fisher scoring.

use nalgebra::{Cholesky, Const, SMatrix, SVector};

use super::integrals::{FALL, LENGTH, PARAMETERS, Parameters};

/// Normal priors of the scene and the noise, mean and standard deviation: so wide that they count only where the rows say
/// nothing, and keep every step finite there.
const PRIORS: [(f64, f64); PARAMETERS] = [(0.0, f64::INFINITY), (2.0, 1.5), (-4.6, 2.0), (-7.0, 4.0)];
/// Bounds of all parameters but the length: the least noise leaves the covariance positive definite.
const BOUNDS: [[f64; 2]; PARAMETERS] = [[0.0, 0.0], [0.0, 6.0], [-7.0, -0.7], [-14.0, 5.0]];
/// Longest steps.
const STEPS: [f64; PARAMETERS] = [0.05, 0.7, 0.7, 1.5];
/// Damping after the first step that fails, its growth with each further one, and where a climb ends.
const FIRST_DAMPING: f64 = 0.1;
const DAMPING_GROWTH: f64 = 8.0;
const MOST_DAMPING: f64 = 1e4;

pub(super) type Vector = SVector<f64, PARAMETERS>;
pub(super) type Matrix = SMatrix<f64, PARAMETERS, PARAMETERS>;

/// Where a climb starts when nothing is known.
pub(super) const START: Parameters = [f64::NEG_INFINITY, 2.0, -4.6, -7.0];

/// A likelihood of rows, the scale of the scene at its best everywhere.
pub(super) trait Surface {
    /// The negative log-likelihood, without the prior; infinite where it cannot be computed.
    fn loss(&mut self, at: &Parameters) -> f64;

    /// Its slope at the point of the last loss.
    fn slope(&mut self, at: &Parameters) -> Slope;
}

/// How a negative log-likelihood changes at a point, and about how sharply it is bent there.
#[derive(Debug, Clone)]
pub(super) struct Slope {
    pub(super) gradient: Vector,
    /// Expected information.
    pub(super) information: Matrix,
}

/// How far a climb goes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Effort {
    pub(super) steps: usize,
    /// It ends with a step that gains less, in log-likelihood.
    pub(super) least_gain: f64,
}

/// Climbs from `at` to a maximum, with the length between `lengths`, logarithms of pixels, or as it is; the negative
/// log-likelihood there.
pub(super) fn maximise(
    surface: &mut impl Surface,
    at: &mut Parameters,
    lengths: Option<[f64; 2]>,
    effort: Effort,
) -> f64 {
    let mut loss = penalised(surface, at);
    if !loss.is_finite() {
        return loss;
    }
    let mut local = slope(surface, at);
    let mut damping = 0.0;
    for _ in 0..effort.steps {
        let mut trial = *at;
        let Some(step) = damped(&local, damping, lengths.is_some()) else { break };
        for (i, (value, step)) in trial.iter_mut().zip(step.iter()).enumerate() {
            let [least, most] = if i == LENGTH { lengths.unwrap_or([*value; 2]) } else { BOUNDS[i] };
            *value = (*value - step.clamp(-STEPS[i], STEPS[i])).clamp(least, most);
        }
        let found = penalised(surface, &trial);
        let gain = loss - found;
        if gain > 0.0 {
            (*at, loss) = (trial, found);
            if gain < effort.least_gain {
                break;
            }
            local = slope(surface, at);
            damping /= DAMPING_GROWTH;
        } else {
            if gain > -0.1 * effort.least_gain || damping > MOST_DAMPING {
                break;
            }
            damping = (damping * DAMPING_GROWTH).max(FIRST_DAMPING);
        }
    }
    loss
}

/// The negative log-likelihood with the prior.
fn penalised(surface: &mut impl Surface, at: &Parameters) -> f64 {
    let prior: f64 = (FALL..PARAMETERS).map(|i| 0.5 * ((at[i] - PRIORS[i].0) / PRIORS[i].1).powi(2)).sum();
    surface.loss(at) + prior
}

/// The slope of that at the point of the last loss.
pub(super) fn slope(surface: &mut impl Surface, at: &Parameters) -> Slope {
    let mut slope = surface.slope(at);
    for i in FALL..PARAMETERS {
        let (mean, std) = PRIORS[i];
        slope.gradient[i] += (at[i] - mean) / (std * std);
        slope.information[(i, i)] += 1.0 / (std * std);
    }
    slope
}

/// The step of Fisher scoring with this damping.
fn damped(slope: &Slope, damping: f64, moves_length: bool) -> Option<Vector> {
    let (mut matrix, mut gradient) = (slope.information, slope.gradient);
    for i in 0..PARAMETERS {
        matrix[(i, i)] *= 1.0 + damping;
    }
    if !moves_length {
        matrix.row_mut(LENGTH).fill(0.0);
        matrix.column_mut(LENGTH).fill(0.0);
        matrix[(LENGTH, LENGTH)] = 1.0;
        gradient[LENGTH] = 0.0;
    }
    let factor: Cholesky<f64, Const<PARAMETERS>> = Cholesky::new(matrix)?;
    Some(factor.solve(&gradient))
}
