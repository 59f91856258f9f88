//! Collapse of a two-dimensional log spectrum to the frequencies along the motion.

use ndarray::ArrayView2;
use rustfft::num_complex::Complex32;

use super::log::ln;
use super::noise::{NoiseFloor, Powers};

/// Averages the log powers of a spectrum over the frequencies across the motion (thesis algorithm 4.2, steps 4 and 5).
///
/// The motion lies along the rows of the picture. Each row of the spectrum, one frequency across the motion, weighs
/// `SNR / (SNR + 1)` by its power at low frequencies along the motion: rows that hold only noise cannot dilute the
/// others. `ln(P + noise)` keeps single empty bins from ruling a mean.
#[derive(Debug, Clone)]
pub struct Collapsed {
    values: Vec<f64>,
    noise: NoiseFloor,
}

/// Largest frequency across the motion that takes part, cycles per pixel.
const MOST_ACROSS: f64 = 0.25;
/// Frequencies along the motion below this (cycles per pixel) tell how much signal a row holds.
const MOST_SIGNAL: f64 = 0.05;

impl Collapsed {
    /// For the first `columns` frequencies along the motion.
    pub fn new(columns: usize) -> Self {
        Self { values: vec![0.0; columns], noise: NoiseFloor::new() }
    }

    /// The collapsed log spectrum: element `k` belongs to column `k`.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Collapses DCT coefficients `[m, n]` of frequencies `m / 2M` across and `n / 2N` along the motion.
    pub fn set_from_dct(&mut self, coefficients: ArrayView2<'_, f32>) {
        let dim = coefficients.dim();
        let step_along = 0.5 / dim.1 as f64;
        let across = |row: usize| 0.5 * row as f64 / dim.0 as f64;
        let power = |row: usize, column: usize| coefficients[[row, column]].powi(2);
        let radius = |row: usize, column: usize| across(row).hypot(column as f64 * step_along);
        let noise = self.noise.read(dim, Powers::OfReal, radius, power);
        self.set(noise, dim, across, step_along, power);
    }

    /// Collapses a half spectrum of `rows` x `columns / 2 + 1` bins, see [`Dft2`](super::Dft2), of a picture of
    /// `columns` columns.
    pub fn set_from_dft(&mut self, spectrum: ArrayView2<'_, Complex32>, columns: usize) {
        let dim = spectrum.dim();
        let step_along = 1.0 / columns as f64;
        let across = |row: usize| row.min(dim.0 - row) as f64 / dim.0 as f64;
        let scale = 1.0 / (dim.0 * columns) as f32;
        let power = |row: usize, column: usize| spectrum[[row, column]].norm_sqr() * scale;
        let radius = |row: usize, column: usize| across(row).hypot(column as f64 * step_along);
        let noise = self.noise.read(dim, Powers::OfComplex, radius, power);
        self.set(noise, dim, across, step_along, power);
    }

    fn set(
        &mut self,
        noise: f32,
        (rows, columns): (usize, usize),
        frequency_across: impl Fn(usize) -> f64,
        step_along: f64,
        power: impl Fn(usize, usize) -> f32,
    ) {
        let signal_columns = ((MOST_SIGNAL / step_along) as usize).clamp(1, columns);
        self.values.fill(0.0);
        let mut total = 0.0;
        for row in (0..rows).filter(|&row| frequency_across(row) <= MOST_ACROSS) {
            let mean = (0..signal_columns).map(|column| power(row, column)).sum::<f32>() / signal_columns as f32;
            let snr = f64::from((mean - noise).max(0.0) / noise);
            // Never quite 0, so that a picture of noise alone still has a mean.
            let weight = snr / (snr + 1.0) + 1e-6;
            total += weight;
            for (column, value) in self.values.iter_mut().enumerate().take(columns) {
                *value += weight * f64::from(ln(power(row, column) + noise));
            }
        }
        for value in &mut self.values {
            *value /= total;
        }
    }
}
