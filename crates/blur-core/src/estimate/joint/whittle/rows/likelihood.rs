//! The likelihood of all rows at given parameters, and the climb to its maximum.

use nalgebra::{Cholesky, Const, SMatrix, SVector};
use ndarray::{ArrayView1, ArrayView2};

use super::block::{Block, Half, Traces, row_mean};
use super::lags::{FALL, LENGTH, Lags, NOISE, PARAMETERS, Parameters};

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

/// How far a climb goes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Effort {
    pub(super) steps: usize,
    /// It ends with a step that gains less, in log-likelihood.
    pub(super) least_gain: f64,
}

/// The negative log-likelihood as it is at a point.
#[derive(Debug, Clone)]
pub(super) struct Score {
    pub(super) gradient: Vector,
    /// Expected information, the scale of the scene profiled out.
    pub(super) information: Matrix,
    /// What a change of each parameter changes in the logarithm of the scale.
    pub(super) scale: Vector,
    /// Mean square of the whitened powers, relative to that of as many normal rows.
    pub(super) peaks: f64,
}

/// Rows of one picture and the matrices of their likelihood.
#[derive(Debug)]
pub(super) struct Likelihood {
    count: f64,
    /// Contrasts of a row.
    contrasts: f64,
    lags: Lags,
    blocks: [Block; 2],
    /// Variance that the scene is scaled by.
    scale: f64,
}

impl Likelihood {
    pub(super) fn new(count: usize, width: usize) -> Self {
        Self {
            count: count as f64,
            contrasts: width as f64 - 1.0,
            lags: Lags::new(width),
            blocks: [Half::Even, Half::Odd].map(|half| Block::new(half, count, width)),
            scale: 1.0,
        }
    }

    /// The picture to measure, of the size of the plan.
    pub(super) fn set(&mut self, picture: ArrayView2<'_, f32>) {
        // In units of its own contrast, so that a picture twice as bright gives the same digits.
        let square = |pixels: ArrayView1<'_, f32>| {
            let mean = row_mean(pixels);
            pixels.iter().map(|&pixel| (f64::from(pixel) - mean).powi(2)).sum::<f64>()
        };
        let contrast = (picture.rows().into_iter().map(square).sum::<f64>() / picture.len() as f64).sqrt();
        let unit = if contrast > 0.0 { 1.0 / contrast } else { 1.0 };
        for block in &mut self.blocks {
            block.set(picture, unit);
        }
    }

    /// The negative log-likelihood, the scale of the scene at its best; infinite where it cannot be computed.
    fn loss(&mut self, at: &Parameters) -> f64 {
        self.lags.set(at);
        let noise = at[NOISE].exp();
        let (mut log_determinant, mut trace) = (0.0, 0.0);
        for block in &mut self.blocks {
            let Some((log, part)) = block.invert(&self.lags, noise) else { return f64::INFINITY };
            log_determinant += log;
            trace += part;
        }
        self.scale = trace / self.contrasts;
        if self.scale.is_nan() || self.scale <= 0.0 {
            return f64::INFINITY;
        }
        let prior: f64 = (FALL..PARAMETERS).map(|i| 0.5 * ((at[i] - PRIORS[i].0) / PRIORS[i].1).powi(2)).sum();
        0.5 * self.count * (log_determinant + self.contrasts * self.scale.ln()) + prior
    }

    /// Gradient and information at the point of the last loss.
    fn score(&mut self, at: &Parameters) -> Score {
        let mut traces = Traces::default();
        for block in &mut self.blocks {
            block.add_traces(&self.lags, at[NOISE].exp(), &mut traces);
        }
        let half = 0.5 * self.count;
        let gradient = Vector::from_fn(|i, _| {
            let prior = if i == LENGTH { 0.0 } else { (at[i] - PRIORS[i].0) / PRIORS[i].1.powi(2) };
            half * (traces.single[i] - traces.scatter[i] / self.scale) + prior
        });
        let information = Matrix::from_fn(|i, j| {
            let pair = traces.pair[i.max(j)][i.min(j)] - traces.single[i] * traces.single[j] / self.contrasts;
            half * pair + if i == j { PRIORS[i].1.powi(-2) } else { 0.0 }
        });
        // A Wishart matrix for each half of the contrasts.
        let normal = self.contrasts * (1.0 + (0.5 * self.contrasts + 1.0) / self.count);
        let peaks = traces.square / (self.scale * self.scale * normal);
        Score { gradient, information, scale: Vector::from_fn(|i, _| traces.single[i] / self.contrasts), peaks }
    }

    /// Climbs from `at` to a maximum, with the length between `lengths`, logarithms of pixels, or as it is; the negative
    /// log-likelihood there.
    pub(super) fn maximise(&mut self, at: &mut Parameters, lengths: Option<[f64; 2]>, effort: Effort) -> f64 {
        let mut loss = self.loss(at);
        if !loss.is_finite() {
            return loss;
        }
        let mut score = self.score(at);
        let mut damping = 0.0;
        for _ in 0..effort.steps {
            let mut trial = *at;
            let Some(step) = damped(&score, damping, lengths.is_some()) else { break };
            for (i, (value, step)) in trial.iter_mut().zip(step.iter()).enumerate() {
                let [least, most] = if i == LENGTH { lengths.unwrap_or([*value; 2]) } else { BOUNDS[i] };
                *value = (*value - step.clamp(-STEPS[i], STEPS[i])).clamp(least, most);
            }
            let found = self.loss(&trial);
            let gain = loss - found;
            if gain > 0.0 {
                (*at, loss) = (trial, found);
                if gain < effort.least_gain {
                    break;
                }
                score = self.score(at);
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

    /// The score at `at`; `None` where there is no likelihood.
    pub(super) fn score_at(&mut self, at: &Parameters) -> Option<Score> {
        self.loss(at).is_finite().then(|| self.score(at))
    }

    /// What each row adds to the gradient along `direction`, after [`score_at`](Self::score_at); into `out`, one value a
    /// row, their mean taken away.
    pub(super) fn slopes(&mut self, at: &Parameters, score: &Score, direction: &Vector, out: &mut [f64]) {
        out.fill(0.0);
        let along: Parameters = (*direction).into();
        // The scale follows its best value.
        let scale = -score.scale.dot(direction);
        for block in &mut self.blocks {
            block.add_slopes(&self.lags, at[NOISE].exp(), &along, scale, out);
        }
        let mean = out.iter().sum::<f64>() / out.len().max(1) as f64;
        for value in out {
            *value = -0.5 * (*value - mean) / self.scale;
        }
    }
}

/// The step of Fisher scoring with this damping.
fn damped(score: &Score, damping: f64, moves_length: bool) -> Option<Vector> {
    let (mut matrix, mut gradient) = (score.information, score.gradient);
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

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};
    use ndarray::Array2;

    use super::super::super::testing::Random;
    use super::super::lags::KNEE;
    use super::*;

    const AT: Parameters = [2.1, 1.7, -3.9, -5.0];

    fn noise(count: usize, width: usize) -> Array2<f32> {
        let mut random = Random::new(3);
        Array2::from_shape_simple_fn((count, width), || (5.0 + random.normal()) as f32)
    }

    #[test]
    fn it_is_the_density_of_contrasts_of_a_normal_vector() {
        for width in [16, 21] {
            let picture = noise(5, width);
            let mut likelihood = Likelihood::new(5, width);
            likelihood.set(picture.view());
            let found = likelihood.loss(&AT);
            // Written out: differences of neighbours are as good a set of contrasts as any, whose constant depends on the
            // width alone; so two points are compared.
            let written = |at: &Parameters| {
                let mut lags = Lags::new(width);
                lags.set(at);
                let noise = |i, j| if i == j { at[NOISE].exp() } else { 0.0 };
                let covariance =
                    DMatrix::from_fn(width, width, |i: usize, j: usize| lags.covariance()[i.abs_diff(j)] + noise(i, j));
                let contrasts = DMatrix::from_fn(width - 1, width, |i, j| f64::from(i == j) - f64::from(i + 1 == j));
                let factor = Cholesky::new(&contrasts * covariance * contrasts.transpose()).unwrap();
                let squares: f64 = picture
                    .rows()
                    .into_iter()
                    .map(|row| {
                        let row = &contrasts * DVector::from_iterator(width, row.iter().map(|&pixel| f64::from(pixel)));
                        row.dot(&factor.solve(&row))
                    })
                    .sum();
                let values = 5.0 * (width as f64 - 1.0);
                let log_determinant = 2.0 * factor.l().diagonal().map(f64::ln).sum();
                let prior: f64 = (FALL..PARAMETERS).map(|i| 0.5 * ((at[i] - PRIORS[i].0) / PRIORS[i].1).powi(2)).sum();
                0.5 * (5.0 * log_determinant + values * (squares / values).ln()) + prior
            };
            let other = [1.5, 0.8, -3.0, -1.0];
            let (change, expected) = (likelihood.loss(&other) - found, written(&other) - written(&AT));
            assert!((change - expected).abs() < 1e-6 * expected.abs(), "{width}: {change} {expected}");
        }
    }

    #[test]
    fn the_gradient_is_the_limit_of_differences() {
        let mut likelihood = Likelihood::new(5, 24);
        likelihood.set(noise(5, 24).view());
        let score = likelihood.score_at(&AT).unwrap();
        for parameter in [LENGTH, FALL, KNEE, NOISE] {
            let h = 1e-4;
            let mut loss = |by: f64| {
                let mut moved = AT;
                moved[parameter] += by;
                likelihood.loss(&moved)
            };
            let difference = (loss(h) - loss(-h)) / (2.0 * h);
            let found = score.gradient[parameter];
            assert!((found - difference).abs() < 1e-4 * found.abs().max(1.0), "{parameter}: {found} {difference}");
        }
        // The rows' own slopes add up to the gradient but for the prior, before their mean is taken away: so to nothing.
        let mut slopes = [0.0; 5];
        likelihood.slopes(&AT, &score, &Vector::new(1.0, 0.0, 0.0, 0.0), &mut slopes);
        assert!(slopes.iter().sum::<f64>().abs() < 1e-6 && slopes[0] != slopes[1], "{slopes:?}");
    }
}
