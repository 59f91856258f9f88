//! Filtering of a periodic picture by its two-dimensional Fourier transform.

use crate::{Error, Result};
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};
use std::sync::Arc;

/// Side of the square tiles in which a matrix is transposed: two of them fit into the first cache.
const TILE: usize = 16;

/// Smallest even number from `min` on with no prime factor above 7: the transforms of such sizes are fast.
pub(crate) fn fast_size(min: usize) -> usize {
    let mut size = min.max(2).next_multiple_of(2);
    while !is_smooth(size) {
        size += 2;
    }
    size
}

fn is_smooth(mut size: usize) -> bool {
    for factor in [2, 3, 5, 7] {
        while size.is_multiple_of(factor) {
            size /= factor;
        }
    }
    size == 1
}

/// One-dimensional plans, kept by length.
pub(crate) struct Planners {
    rows: RealFftPlanner<f64>,
    columns: FftPlanner<f64>,
}

impl Planners {
    pub(crate) fn new() -> Self {
        Self { rows: RealFftPlanner::new(), columns: FftPlanner::new() }
    }
}

/// A linear, shift-invariant filter on pictures of one size, which wrap around at their borders.
pub(crate) struct Filter {
    rows: usize,
    cols: usize,
    rows_forward: Arc<dyn RealToComplex<f64>>,
    rows_inverse: Arc<dyn ComplexToReal<f64>>,
    columns_forward: Arc<dyn Fft<f64>>,
    columns_inverse: Arc<dyn Fft<f64>>,
    /// Half spectrum, one row of the picture after the other.
    half: Vec<Complex<f64>>,
    /// The same, one column after the other.
    turned: Vec<Complex<f64>>,
    scratch: Vec<Complex<f64>>,
}

impl Filter {
    pub(crate) fn new(planners: &mut Planners, rows: usize, cols: usize) -> Self {
        let rows_forward = planners.rows.plan_fft_forward(cols);
        let rows_inverse = planners.rows.plan_fft_inverse(cols);
        let columns_forward = planners.columns.plan_fft_forward(rows);
        let columns_inverse = planners.columns.plan_fft_inverse(rows);
        let scratch = [
            rows_forward.get_scratch_len(),
            rows_inverse.get_scratch_len(),
            columns_forward.get_inplace_scratch_len(),
            columns_inverse.get_inplace_scratch_len(),
        ];
        let scratch = vec![Complex::default(); scratch.into_iter().max().unwrap_or(0)];
        let half = vec![Complex::default(); rows * (cols / 2 + 1)];
        let turned = half.clone();
        Self { rows, cols, rows_forward, rows_inverse, columns_forward, columns_inverse, half, turned, scratch }
    }

    pub(crate) fn size(&self) -> (usize, usize) {
        (self.rows, self.cols)
    }

    /// Multiplies the spectrum of `picture` (rows one after the other, replaced by the result) with `gain(u, v)`,
    /// `u` along columns and `v` along rows in cycles per pixel, `gain(-u, -v)` being the conjugate of `gain(u, v)`.
    ///
    /// At the Nyquist frequency of an even side `+1/2` and `-1/2` are one bin; its gain is the mean of both, which
    /// keeps the result real.
    pub(crate) fn apply(&mut self, picture: &mut [f64], gain: impl Fn(f64, f64) -> Complex<f64>) -> Result<()> {
        let (rows, cols) = (self.rows, self.cols);
        let bins = cols / 2 + 1;
        let failed = |_| Error::Transform { rows, cols };
        for (row, spectrum) in picture.chunks_exact_mut(cols).zip(self.half.chunks_exact_mut(bins)) {
            self.rows_forward.process_with_scratch(row, spectrum, &mut self.scratch).map_err(failed)?;
        }
        transpose(&self.half, &mut self.turned, rows, bins);
        let norm = 1.0 / (rows as f64 * cols as f64);
        for (k, column) in self.turned.chunks_exact_mut(rows).enumerate() {
            self.columns_forward.process_with_scratch(column, &mut self.scratch);
            let u = k as f64 / cols as f64;
            let at_nyquist_u = 2 * k == cols;
            for (l, value) in column.iter_mut().enumerate() {
                let v = signed_frequency(l, rows);
                let gain = if at_nyquist_u || 2 * l == rows {
                    mean_gain(&gain, (u, at_nyquist_u), (v, 2 * l == rows))
                } else {
                    gain(u, v)
                };
                *value *= gain * norm;
            }
            self.columns_inverse.process_with_scratch(column, &mut self.scratch);
        }
        transpose(&self.turned, &mut self.half, bins, rows);
        for (row, spectrum) in picture.chunks_exact_mut(cols).zip(self.half.chunks_exact_mut(bins)) {
            // Real up to rounding, and the inverse transform asks for zero.
            spectrum[0].im = 0.0;
            if cols.is_multiple_of(2) {
                spectrum[bins - 1].im = 0.0;
            }
            self.rows_inverse.process_with_scratch(spectrum, row, &mut self.scratch).map_err(failed)?;
        }
        Ok(())
    }
}

fn signed_frequency(index: usize, len: usize) -> f64 {
    let index = if 2 * index > len { index as f64 - len as f64 } else { index as f64 };
    index / len as f64
}

/// Mean of the gain over the signs of the coordinates that lie at the Nyquist frequency.
fn mean_gain(
    gain: &impl Fn(f64, f64) -> Complex<f64>,
    (u, fold_u): (f64, bool),
    (v, fold_v): (f64, bool),
) -> Complex<f64> {
    let other_u = if fold_u { -u } else { u };
    let other_v = if fold_v { -v } else { v };
    (gain(u, v) + gain(other_u, v) + gain(u, other_v) + gain(other_u, other_v)) * 0.25
}

/// `to[c][r] = from[r][c]` for `from` of `rows` x `cols`.
fn transpose(from: &[Complex<f64>], to: &mut [Complex<f64>], rows: usize, cols: usize) {
    for top in (0..rows).step_by(TILE) {
        for left in (0..cols).step_by(TILE) {
            for c in left..(left + TILE).min(cols) {
                for r in top..(top + TILE).min(rows) {
                    to[c * rows + r] = from[r * cols + c];
                }
            }
        }
    }
}
