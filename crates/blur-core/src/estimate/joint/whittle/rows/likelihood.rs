//! The likelihood of all rows at given parameters.

use ndarray::{ArrayView1, ArrayView2};

use super::block::{Block, Half, Traces, row_mean};
use super::climb::{Matrix, Slope, Surface, Vector};
use super::integrals::{Integrals, NOISE, Parameters};

/// Rows of one picture and the matrices of their likelihood.
#[derive(Debug)]
pub(super) struct Likelihood {
    count: f64,
    /// Contrasts of a row.
    contrasts: f64,
    lags: Integrals,
    blocks: [Block; 2],
    /// Variance that the scene is scaled by.
    scale: f64,
    /// Of the last slope.
    traces: Traces,
}

impl Likelihood {
    pub(super) fn new(count: usize, width: usize) -> Self {
        Self {
            count: count as f64,
            contrasts: width as f64 - 1.0,
            lags: Integrals::lags(width),
            blocks: [Half::Even, Half::Odd].map(|half| Block::new(half, count, width)),
            scale: 1.0,
            traces: Traces::default(),
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

    /// What a change of each parameter changes in the logarithm of the scale, at the point of the last slope.
    pub(super) fn scale_slope(&self) -> Vector {
        Vector::from(self.traces.single) / self.contrasts
    }

    /// Mean square of the whitened powers at the point of the last slope, relative to that of as many normal rows.
    pub(super) fn peaks(&self) -> f64 {
        // A Wishart matrix for each half of the contrasts.
        let normal = self.contrasts * (1.0 + (0.5 * self.contrasts + 1.0) / self.count);
        self.traces.square / (self.scale * self.scale * normal)
    }

    /// What each row adds to the gradient along `direction`, at the point of the last slope; into `out`, one value a row,
    /// their mean taken away.
    pub(super) fn slopes(&mut self, at: &Parameters, direction: &Vector, out: &mut [f64]) {
        out.fill(0.0);
        let along: Parameters = (*direction).into();
        // The scale follows its best value.
        let scale = -self.scale_slope().dot(direction);
        for block in &mut self.blocks {
            block.add_slopes(&self.lags, at[NOISE].exp(), &along, scale, out);
        }
        let mean = out.iter().sum::<f64>() / out.len().max(1) as f64;
        for value in out {
            *value = -0.5 * (*value - mean) / self.scale;
        }
    }
}

impl Surface for Likelihood {
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
        0.5 * self.count * (log_determinant + self.contrasts * self.scale.ln())
    }

    fn slope(&mut self, at: &Parameters) -> Slope {
        self.traces = Traces::default();
        for block in &mut self.blocks {
            block.add_traces(&self.lags, at[NOISE].exp(), &mut self.traces);
        }
        let (traces, half) = (&self.traces, 0.5 * self.count);
        let gradient = Vector::from_fn(|i, _| half * (traces.single[i] - traces.scatter[i] / self.scale));
        let information = Matrix::from_fn(|i, j| {
            half * (traces.pair[i.max(j)][i.min(j)] - traces.single[i] * traces.single[j] / self.contrasts)
        });
        Slope { gradient, information }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Cholesky, DMatrix, DVector};
    use ndarray::Array2;

    use super::super::super::testing::Random;
    use super::super::integrals::{FALL, KNEE, LENGTH};
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
                let mut lags = Integrals::lags(width);
                lags.set(at);
                let noise = |i, j| if i == j { at[NOISE].exp() } else { 0.0 };
                let covariance =
                    DMatrix::from_fn(width, width, |i: usize, j: usize| lags.values()[i.abs_diff(j)] + noise(i, j));
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
                0.5 * (5.0 * log_determinant + values * (squares / values).ln())
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
        assert!(likelihood.loss(&AT).is_finite());
        let gradient = likelihood.slope(&AT).gradient;
        for parameter in [LENGTH, FALL, KNEE, NOISE] {
            let h = 1e-4;
            let mut loss = |by: f64| {
                let mut moved = AT;
                moved[parameter] += by;
                likelihood.loss(&moved)
            };
            let difference = (loss(h) - loss(-h)) / (2.0 * h);
            let found = gradient[parameter];
            assert!((found - difference).abs() < 1e-4 * found.abs().max(1.0), "{parameter}: {found} {difference}");
        }
        // The rows' own slopes add up to the gradient before their mean is taken away: so to nothing.
        assert!(likelihood.loss(&AT).is_finite());
        let _ = likelihood.slope(&AT);
        let mut slopes = [0.0; 5];
        likelihood.slopes(&AT, &Vector::new(1.0, 0.0, 0.0, 0.0), &mut slopes);
        assert!(slopes.iter().sum::<f64>().abs() < 1e-6 && slopes[0] != slopes[1], "{slopes:?}");
    }
}
