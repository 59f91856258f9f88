//! Cepstra: spectra of log spectra, whose troughs are the lags that the blur imprints.

use std::f64::consts::PI;
use std::fmt;
use std::sync::Arc;

use ndarray::ArrayView2;
use realfft::{RealFftPlanner, RealToComplex};
use rustfft::num_complex::{Complex32, Complex64};

use super::bins::SpectrumBins;
use super::dft::InverseDft2;

/// Two-dimensional real cepstrum: the inverse DFT of a log spectrum (thesis eq. 4.9; Bogert 1963).
///
/// A uniform blur multiplies the spectrum by `sinc(L s)`, whose zeros repeat every `1/L` along the motion; in the
/// cepstrum that is a negative peak at the lag `+-L (cos angle, -sin angle)` pixels in (column, row).
#[derive(Debug)]
pub struct Cepstrum {
    inverse: InverseDft2,
}

impl Cepstrum {
    /// Cepstra of pictures of `rows` x `columns` pixels.
    pub fn new(rows: usize, columns: usize) -> Self {
        Self { inverse: InverseDft2::new(rows, columns) }
    }

    /// The cepstrum of log-spectrum values on the half plane of a DFT; bins outside their band count as 0.
    ///
    /// Element `[j, k]` is the lag of `j` rows and `k` columns, both modulo the picture's size:
    /// `c = 1/(M N) sum value exp(2 pi i (...))` over the whole plane.
    pub fn of_half_plane(&mut self, bins: &SpectrumBins) -> ArrayView2<'_, f32> {
        let (rows, _) = self.inverse.dim();
        let half = self.inverse.input();
        half.fill(Complex32::default());
        for row in &bins.rows {
            for (i, &value) in bins.values[row.start..row.start + row.length].iter().enumerate() {
                let column = row.first_column + i;
                half[[row.source_row, column]].re = value;
                // The axis column holds only v > 0; its other half is the mirror image.
                if column == 0 {
                    half[[(rows - row.source_row) % rows, 0]].re = value;
                }
            }
        }
        self.inverse.transform()
    }
}

/// The most striking trough of a [`LineCepstrum`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trough {
    /// Its lag in pixels, between samples.
    pub lag_px: f64,
    /// Its depth in standard deviations of the cepstrum around it.
    pub contrast: f64,
    /// Standard uncertainty of the lag in pixels, to first order from the scatter of the lags around it.
    pub std_px: f64,
}

/// Cepstrum of a one-dimensional log spectrum, at real lags (thesis eq. 4.10 after the collapse of algorithm 4.2).
///
/// `c(q) = sum_k taper_k residual_k cos(2 pi s_k q)`, where the residual is the log spectrum minus its least-squares
/// cubic in `ln s` (the fall-off of pictures) and the taper is the raised cosine that ends at the last sample. Lags
/// are a quarter of a pixel apart. With `s_k = k / 2N` this is the DCT of the log spectrum of a DCT: the
/// pseudo-cepstrum.
pub struct LineCepstrum {
    frequencies: Vec<f64>,
    taper: Vec<f64>,
    /// Orthonormal basis of the cubics in `ln s` over the samples.
    trend: Vec<Vec<f64>>,
    first: usize,
    residual: Vec<f64>,
    transform: Arc<dyn RealToComplex<f64>>,
    padded: Vec<f64>,
    spectrum: Vec<Complex64>,
    scratch: Vec<Complex64>,
    lags: Vec<f64>,
    sorted: Vec<f64>,
    /// Running sum of squares of the lags, from 0.
    squares: Vec<f64>,
    lag_step: f64,
}

const TREND_TERMS: i32 = 4;
/// Weight of the overall scatter against the local one, as a width of lags in pixels.
const PRIOR_PX: f64 = 10.0;

impl LineCepstrum {
    /// For log spectra sampled at `k * step` cycles per pixel; samples in `[least, most]` are used.
    pub fn new(step: f64, least: f64, most: f64) -> Self {
        let first = (least / step).ceil().max(1.0) as usize;
        let last = (most / step).floor() as usize;
        let frequencies: Vec<f64> = (first..=last.max(first)).map(|k| k as f64 * step).collect();
        let end = frequencies.last().copied().unwrap_or(most) + step;
        let taper = frequencies.iter().map(|s| 0.5 + 0.5 * (PI * s / end).cos()).collect();
        let trend = orthonormal_powers(&frequencies.iter().map(|s| (s / end).ln()).collect::<Vec<_>>());
        // The padded length makes the lags 1 / (length * step): a quarter of a pixel or a little less.
        let length = (4.0 / step).ceil() as usize;
        let transform = RealFftPlanner::new().plan_fft_forward(length);
        let half = length / 2 + 1;
        Self {
            residual: vec![0.0; frequencies.len()],
            taper,
            trend,
            first,
            padded: vec![0.0; length],
            spectrum: vec![Complex64::default(); half],
            scratch: vec![Complex64::default(); transform.get_scratch_len()],
            lags: vec![0.0; half],
            sorted: Vec::with_capacity(half),
            squares: vec![0.0; half + 1],
            lag_step: 1.0 / (length as f64 * step),
            frequencies,
            transform,
        }
    }

    /// Computes the cepstrum of a log spectrum whose element `k` belongs to the frequency `k * step`.
    pub fn compute(&mut self, log_spectrum: &[f64]) {
        let samples = log_spectrum.iter().skip(self.first);
        for (residual, &value) in self.residual.iter_mut().zip(samples) {
            *residual = value;
        }
        for basis in &self.trend {
            let amplitude: f64 = basis.iter().zip(&self.residual).map(|(b, r)| b * r).sum();
            for (residual, b) in self.residual.iter_mut().zip(basis) {
                *residual -= amplitude * b;
            }
        }
        self.padded.fill(0.0);
        let samples = self.residual.iter().zip(&self.taper);
        for (slot, (residual, taper)) in self.padded.iter_mut().skip(self.first).zip(samples) {
            *slot = residual * taper;
        }
        let done = self.transform.process_with_scratch(&mut self.padded, &mut self.spectrum, &mut self.scratch);
        debug_assert!(done.is_ok());
        for (lag, value) in self.lags.iter_mut().zip(&self.spectrum) {
            *lag = value.re;
        }
    }

    /// The trough of the last [`compute`](Self::compute) with a lag in `[least_px, most_px]` that is deepest for the
    /// scatter around it, refined by a parabola; `None` when the range holds fewer than three lags or the cepstrum is flat.
    pub fn deepest_trough(&mut self, least_px: f64, most_px: f64) -> Option<Trough> {
        let first = (least_px / self.lag_step).ceil() as usize;
        let last = ((most_px / self.lag_step).floor() as usize).min(self.lags.len().saturating_sub(2));
        if first == 0 || last < first + 2 {
            return None;
        }
        self.sorted.clear();
        self.sorted.extend(self.lags[first..=last].iter().map(|c| c.abs()));
        let middle = self.sorted.len() / 2;
        let (_, &mut median, _) = self.sorted.select_nth_unstable_by(middle, f64::total_cmp);
        // The median modulus of a normal variable is 0.6745 of its standard deviation.
        let overall = median / 0.6745;
        if overall <= 0.0 {
            return None;
        }
        let mut sum = 0.0;
        for (total, value) in self.squares.iter_mut().skip(1).zip(&self.lags) {
            sum += value * value;
            *total = sum;
        }
        let is_trough = |&lag: &usize| {
            let [before, at, after] = [lag - 1, lag, lag + 1].map(|lag| self.lags[lag]);
            at < 0.0 && at <= before && at <= after
        };
        // Long lags offer more chances for a trough: a length is as likely in one octave as in the next, so the
        // evidence z^2 / 2 of a trough is weighed against ln lag.
        let evidence = |lag: usize| {
            let contrast = -self.lags[lag] / self.scatter_around(lag, overall);
            (lag, contrast, 0.5 * contrast * contrast - (lag as f64).ln())
        };
        let (lowest, contrast, _) =
            (first..=last).filter(is_trough).map(evidence).max_by(|a, b| a.2.total_cmp(&b.2))?;
        let (before, at, after) = (self.lags[lowest - 1], self.lags[lowest], self.lags[lowest + 1]);
        let curvature = before - 2.0 * at + after;
        let shift = if curvature > 0.0 { (0.5 * (before - after) / curvature).clamp(-1.0, 1.0) } else { 0.0 };
        let lag_px = (lowest as f64 + shift) * self.lag_step;

        // c is a sum of cosines with scattered amplitudes: var c' / var c is the mean of (2 pi s)^2 under taper^2.
        let (mut power, mut slope_power) = (0.0, 0.0);
        for (s, taper) in self.frequencies.iter().zip(&self.taper) {
            power += taper * taper;
            slope_power += (2.0 * PI * s * taper).powi(2);
        }
        let curvature_per_px2 = curvature / (self.lag_step * self.lag_step);
        let std_px = if curvature > 0.0 {
            self.scatter_around(lowest, overall) * (slope_power / power).sqrt() / curvature_per_px2
        } else {
            most_px
        };
        Some(Trough { lag_px, contrast, std_px })
    }
}

impl LineCepstrum {
    /// Scatter of the cepstrum where a trough is: root mean square of the lags from half to nearly twice the trough's,
    /// without the trough itself. The picture's own structure is stronger at short lags, where only few lags tell of it:
    /// the overall scatter counts as [`PRIOR_PX`] of lags more.
    fn scatter_around(&self, lag: usize, overall: f64) -> f64 {
        let squares_in = |from: f64, to: f64| {
            let at = |ratio: f64| ((ratio * lag as f64) as usize).min(self.lags.len());
            (self.squares[at(to)] - self.squares[at(from)], (at(to) - at(from)) as f64)
        };
        let (below, above) = (squares_in(0.5, 0.85), squares_in(1.15, 1.8));
        let prior = PRIOR_PX / self.lag_step;
        ((below.0 + above.0 + prior * overall * overall) / (below.1 + above.1 + prior)).sqrt()
    }
}

impl fmt::Debug for LineCepstrum {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LineCepstrum").field("samples", &self.residual.len()).finish_non_exhaustive()
    }
}

/// The powers 0 to 3 of `x`, made orthonormal over its samples; fewer when there are not samples enough.
fn orthonormal_powers(x: &[f64]) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for power in (0..TREND_TERMS).take(x.len()) {
        let mut vector: Vec<f64> = x.iter().map(|x| x.powi(power)).collect();
        // Twice is enough for orthogonality to rounding.
        for _ in 0..2 {
            for earlier in &basis {
                let overlap: f64 = earlier.iter().zip(&vector).map(|(a, b)| a * b).sum();
                for (v, e) in vector.iter_mut().zip(earlier) {
                    *v -= overlap * e;
                }
            }
        }
        let norm = vector.iter().map(|v| v * v).sum::<f64>().sqrt();
        if norm > 0.0 {
            for value in &mut vector {
                *value /= norm;
            }
            basis.push(vector);
        }
    }
    basis
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::bins::Band;

    #[test]
    fn the_cepstrum_is_the_naive_inverse_transform() {
        for (rows, columns) in [(8, 8), (9, 7), (6, 11)] {
            let mut bins = SpectrumBins::half_plane(rows, columns, Band { min: 0.05, max: 0.42 });
            bins.update(|u, v, _| (17.0 * u + 3.0 * v).sin() + u);
            let mut cepstrum = Cepstrum::new(rows, columns);
            let fast = cepstrum.of_half_plane(&bins).to_owned();
            for ((j, k), &value) in fast.indexed_iter() {
                let mut sum = 0.0;
                bins.for_each(|u, v, x| {
                    sum += 2.0 * x * (std::f32::consts::TAU * (u * k as f32 + v * j as f32)).cos();
                });
                let naive = sum / (rows * columns) as f32;
                assert!((value - naive).abs() < 1e-5, "{rows}x{columns} [{j}, {k}]: {value} {naive}");
            }
        }
    }

    #[test]
    fn the_trough_of_a_sinc_is_its_length() {
        // ln sinc^2(L s) with a floor, on a spectrum that falls as s^-2.
        for length in [6.3_f64, 20.0, 47.7, 90.1] {
            let step = 1.0 / 1024.0;
            let log_spectrum: Vec<f64> = (0..512)
                .map(|k| {
                    let s = (f64::from(k) * step).max(step);
                    let x = PI * length * s;
                    ((x.sin() / x).powi(2) + 1e-3).ln() - 2.0 * s.ln()
                })
                .collect();
            let mut cepstrum = LineCepstrum::new(step, 2.0 * step, 0.4);
            cepstrum.compute(&log_spectrum);
            let trough = cepstrum.deepest_trough(4.0, 200.0).unwrap();
            assert!((trough.lag_px - length).abs() < 0.15, "{length}: {trough:?}");
            assert!(trough.contrast > 4.0, "{trough:?}");
        }
    }

    #[test]
    fn a_shallow_trough_at_a_shorter_lag_does_not_win() {
        let (step, length) = (1.0 / 1024.0, 47.7);
        let log_spectrum: Vec<f64> = (0..512)
            .map(|k| {
                let s = (f64::from(k) * step).max(step);
                let x = PI * length * s;
                // ln sinc^2 holds -2 cos(2 pi L s) and its overtones; the ripple is a quarter of that, at 12 px.
                ((x.sin() / x).powi(2) + 1e-3).ln() - 0.5 * (2.0 * PI * 12.0 * s).cos()
            })
            .collect();
        let mut cepstrum = LineCepstrum::new(step, 2.0 * step, 0.4);
        cepstrum.compute(&log_spectrum);
        let nearer = cepstrum.deepest_trough(8.0, 20.0).unwrap();
        assert!((nearer.lag_px - 12.0).abs() < 0.2, "{nearer:?}");
        let trough = cepstrum.deepest_trough(4.0, 200.0).unwrap();
        assert!((trough.lag_px - length).abs() < 0.15, "{trough:?}");
    }

    #[test]
    fn the_line_cepstrum_is_the_naive_cosine_sum_of_the_detrended_samples() {
        let step = 0.01;
        let log_spectrum: Vec<f64> = (0..50).map(|k| f64::from((k * k * 31) % 17)).collect();
        let mut cepstrum = LineCepstrum::new(step, 0.02, 0.4);
        cepstrum.compute(&log_spectrum);
        // The residual is orthogonal to every cubic in ln s.
        for power in 0..4 {
            let overlap: f64 =
                cepstrum.residual.iter().zip(&cepstrum.frequencies).map(|(r, s)| r * s.ln().powi(power)).sum();
            assert!(overlap.abs() < 1e-6, "{power}: {overlap}");
        }
        for (i, &lag) in cepstrum.lags.iter().enumerate() {
            let q = i as f64 * cepstrum.lag_step;
            let naive: f64 = (cepstrum.residual.iter().zip(&cepstrum.taper).zip(&cepstrum.frequencies))
                .map(|((r, t), s)| r * t * (2.0 * PI * s * q).cos())
                .sum();
            assert!((lag - naive).abs() < 1e-9, "{q}");
        }
    }

    #[test]
    fn a_flat_spectrum_has_no_trough() {
        let mut cepstrum = LineCepstrum::new(0.01, 0.02, 0.4);
        cepstrum.compute(&[0.0; 60]);
        assert_eq!(cepstrum.deepest_trough(4.0, 40.0), None);
        assert_eq!(cepstrum.deepest_trough(4.0, 4.1), None);
    }
}
