//! Half of the samples of a row: sums of those at equal distances from its middle, or their differences.
//!
//! A stationary row is as likely as its mirror image, so that sums and differences are independent of each other: two
//! matrices of half the size do the work of one, in a quarter of the time.

use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

use ndarray::{ArrayView1, ArrayView2};

use super::integrals::{Integrals, LENGTH, NOISE, PARAMETERS, Parameters};
use super::symmetric::{add_forms, add_multiple, dot, invert, multiply, trace_of_product};

/// Which half.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Half {
    /// Sums; the mean of a row is in this half alone.
    Even,
    /// Differences.
    Odd,
}

pub(super) fn row_mean(pixels: ArrayView1<'_, f32>) -> f64 {
    pixels.iter().map(|&pixel| f64::from(pixel)).sum::<f64>() / pixels.len() as f64
}

/// Products with the inverse covariance: traces of one or two matrices `P C'`, `C'` the derivative by a parameter.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Traces {
    /// `tr(P C')`.
    pub(super) single: [f64; PARAMETERS],
    /// `tr(P S P C')`, `S` the mean outer product of the rows.
    pub(super) scatter: [f64; PARAMETERS],
    /// `tr(P S P S)`.
    pub(super) square: f64,
    /// `tr(P C' P C')` of two parameters.
    pub(super) pair: [[f64; PARAMETERS]; PARAMETERS],
}

/// One half of all rows and of their covariance.
#[derive(Debug)]
pub(super) struct Block {
    half: Half,
    width: usize,
    size: usize,
    /// One row after the other.
    rows: Vec<f64>,
    scatter: Vec<f64>,
    /// Inverse covariance, of contrasts alone in the even half.
    inverse: Vec<f64>,
    products: [Vec<f64>; NOISE],
    work: [Vec<f64>; 2],
}

impl Block {
    /// For so many rows of `width` samples.
    pub(super) fn new(half: Half, count: usize, width: usize) -> Self {
        let size = match half {
            Half::Even => width.div_ceil(2),
            Half::Odd => width / 2,
        };
        let square = || vec![0.0; size * size];
        Self {
            half,
            width,
            size,
            rows: vec![0.0; count * size],
            scatter: square(),
            inverse: square(),
            products: std::array::from_fn(|_| square()),
            work: std::array::from_fn(|_| square()),
        }
    }

    fn sign(&self) -> f64 {
        if self.half == Half::Even { 1.0 } else { -1.0 }
    }

    /// Weight of a pair of samples; the middle one of an odd number is its own partner.
    fn scale(&self, i: usize) -> f64 {
        if 2 * i + 1 == self.width { FRAC_1_SQRT_2 } else { 1.0 }
    }

    /// Takes the rows of a picture in, times `unit`.
    pub(super) fn set(&mut self, picture: ArrayView2<'_, f32>, unit: f64) {
        let (sign, last) = (self.sign(), self.width - 1);
        let share = 1.0 / picture.nrows() as f64;
        self.scatter.fill(0.0);
        for (row, pixels) in picture.rows().into_iter().enumerate() {
            // The mean drops out of the likelihood; without it nothing is lost to rounding.
            let mean = row_mean(pixels);
            let values = row * self.size..(row + 1) * self.size;
            for (i, at) in values.clone().enumerate() {
                let pair = (f64::from(pixels[i]) - mean) + sign * (f64::from(pixels[last - i]) - mean);
                self.rows[at] = FRAC_1_SQRT_2 * self.scale(i) * unit * pair;
            }
            let values = &self.rows[values];
            for (products, &a) in self.scatter.chunks_exact_mut(self.size).zip(values) {
                add_multiple(products, a * share, values);
            }
        }
    }

    /// The covariance of this half of a row from that of each lag into `out`.
    fn fill(&self, lags: &[f64], out: &mut [f64]) {
        let (sign, last) = (self.sign(), self.width - 1);
        for (i, row) in out.chunks_exact_mut(self.size).enumerate() {
            for (j, value) in row.iter_mut().enumerate() {
                *value = self.scale(i) * self.scale(j) * (lags[i.abs_diff(j)] + sign * lags[last - i - j]);
            }
        }
    }

    /// Inverts the covariance with this much `noise`. The logarithm of its determinant and `tr(P S)`; `None` when it is
    /// not positive definite.
    pub(super) fn invert(&mut self, lags: &Integrals, noise: f64) -> Option<(f64, f64)> {
        let mut inverse = std::mem::take(&mut self.inverse);
        self.fill(lags.values(), &mut inverse);
        for diagonal in inverse.iter_mut().step_by(self.size + 1) {
            *diagonal += noise;
        }
        self.inverse = inverse;
        let mut log_determinant = invert(&mut self.inverse, self.size, &mut self.work[0])?;
        if self.half == Half::Even {
            log_determinant += self.drop_mean()?;
        }
        Some((log_determinant, dot(&self.inverse, &self.scatter)))
    }

    /// Takes the mean of a row out of the inverse. What that adds to the logarithm of the determinant.
    fn drop_mean(&mut self) -> Option<f64> {
        let [along, _] = &mut self.work;
        for (i, row) in self.inverse.chunks_exact(self.size).enumerate() {
            along[i] = row.iter().sum::<f64>() * SQRT_2;
            if self.width % 2 == 1 {
                along[i] -= (SQRT_2 - 1.0) * row[self.size - 1];
            }
        }
        let along = &along[..self.size];
        let mut total = along.iter().sum::<f64>() * SQRT_2;
        if self.width % 2 == 1 {
            total -= (SQRT_2 - 1.0) * along[self.size - 1];
        }
        if total.is_nan() || total <= 0.0 {
            return None;
        }
        for (row, &a) in self.inverse.chunks_exact_mut(self.size).zip(along) {
            add_multiple(row, -a / total, along);
        }
        Some(total.ln())
    }

    /// Adds this half's traces; [`invert`](Self::invert) comes first.
    pub(super) fn add_traces(&mut self, lags: &Integrals, noise: f64, traces: &mut Traces) {
        let n = self.size;
        let [derivative, both] = &mut self.work;
        let (mut derivative, mut both) = (std::mem::take(derivative), std::mem::take(both));
        // P S P.
        multiply(&self.inverse, &self.scatter, &mut derivative, n);
        multiply(&derivative, &self.inverse, &mut both, n);
        traces.square += dot(&both, &self.scatter);
        for parameter in LENGTH..NOISE {
            self.fill(lags.derivatives(parameter), &mut derivative);
            traces.single[parameter] += dot(&self.inverse, &derivative);
            traces.scatter[parameter] += dot(&both, &derivative);
            multiply(&self.inverse, &derivative, &mut self.products[parameter], n);
        }
        traces.single[NOISE] += noise * self.inverse.iter().step_by(n + 1).sum::<f64>();
        traces.scatter[NOISE] += noise * both.iter().step_by(n + 1).sum::<f64>();
        for a in LENGTH..NOISE {
            for b in LENGTH..=a {
                let trace = trace_of_product(&self.products[a], &self.products[b], n);
                traces.pair[a][b] += trace;
            }
            traces.pair[NOISE][a] += noise * trace_of_product(&self.products[a], &self.inverse, n);
        }
        traces.pair[NOISE][NOISE] += noise * noise * dot(&self.inverse, &self.inverse);
        self.work = [derivative, both];
    }

    /// Adds to `out`, a value for each row `x`, `x' P D P x`: `D` is the derivative of the covariance along `direction`,
    /// and along that of its scale by `scale`. [`invert`](Self::invert) comes first.
    pub(super) fn add_slopes(
        &mut self,
        lags: &Integrals,
        noise: f64,
        direction: &Parameters,
        scale: f64,
        out: &mut [f64],
    ) {
        let n = self.size;
        let [slope, part] = &mut self.work;
        let (mut slope, mut part) = (std::mem::take(slope), std::mem::take(part));
        slope.fill(0.0);
        for (parameter, &share) in direction.iter().enumerate().take(NOISE) {
            self.fill(lags.derivatives(parameter), &mut part);
            add_multiple(&mut slope, share, &part);
        }
        for diagonal in slope.iter_mut().step_by(n + 1) {
            *diagonal += direction[NOISE] * noise;
        }
        // P D P + scale P.
        multiply(&self.inverse, &slope, &mut part, n);
        multiply(&part, &self.inverse, &mut slope, n);
        add_multiple(&mut slope, scale, &self.inverse);
        add_forms(&slope, &self.rows, n, out);
        self.work = [slope, part];
    }
}
