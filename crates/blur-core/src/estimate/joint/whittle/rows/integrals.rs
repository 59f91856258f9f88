//! What the spectrum of a row amounts to: the covariance of two samples at each lag, or the power seen in each bin.

use std::f64::consts::{LN_10, PI};
use std::ops::Range;

use rustfft::num_complex::Complex64;

use super::symmetric::dot;
use crate::image::Window;
use crate::psf::sinc;

/// What the likelihood is a function of, by the indices below; the scale of the scene is not among them.
pub(super) type Parameters = [f64; PARAMETERS];
pub(super) const PARAMETERS: usize = 4;
/// Logarithm of the length in pixels, minus infinity for no blur.
pub(super) const LENGTH: usize = 0;
/// The power of the frequency by which the scene's spectrum falls.
pub(super) const FALL: usize = 1;
/// Logarithm of the frequency below which it does not fall, in cycles per pixel.
pub(super) const KNEE: usize = 2;
/// Logarithm of the noise, relative to the scene's spectrum at the frequency 0.1.
pub(super) const NOISE: usize = 3;

/// Bounds of the panels in which the spectrum is integrated: fine where it is steep, and further on ...
const STEEP: [f64; 4] = [0.0, 0.0025, 0.01, 0.04];
/// ... so many samples of a row for each up to the highest frequency, so that the longest lag turns less than four times
/// within a panel.
const SAMPLES: usize = 6;
/// The least number of those panels: short rows see long blurs no finer than that.
const PANELS: usize = 8;
/// Nodes of a panel.
const NODES: usize = 16;
/// Bins from here on see nothing of the mean of a row, in units of the spacing.
const FIRST_BIN: usize = 2;

/// Integrals of the spectrum of a blurred scene times one function or another, and their derivatives.
#[derive(Debug)]
pub(super) struct Integrals {
    frequencies: Vec<f64>,
    weights: Vec<f64>,
    /// Each function, a row, at each frequency.
    functions: Vec<f64>,
    /// The powers of the blurred scene at the nodes, and their derivatives.
    powers: [Vec<f64>; NOISE + 1],
    /// The integrals and their derivatives, that by a parameter at the parameter's index plus one.
    sums: [Vec<f64>; NOISE + 1],
}

impl Integrals {
    /// The covariance at each lag of rows of `width` samples.
    pub(super) fn lags(width: usize) -> Self {
        Self::new(width, width, |lag, f| (2.0 * PI * f * lag as f64).cos())
    }

    /// The power expected in the bins of rows of `width` samples under a window, of which [`row_bins`] takes the spectrum.
    pub(super) fn bins(width: usize) -> Self {
        // Of a Hann window over `width + 1` steps, half of one Dirichlet kernel less a quarter of its two neighbours.
        let period = width as f64 + 1.0;
        let dirichlet = |f: f64| {
            let phase = Complex64::cis(-PI * f * width as f64);
            let sin = (PI * f).sin();
            if sin.abs() < 1e-9 { phase * period } else { phase * ((PI * f * period).sin() / sin) }
        };
        let seen = |f: f64| {
            let beside = dirichlet(f - 1.0 / period) + dirichlet(f + 1.0 / period);
            (0.5 * dirichlet(f) - 0.25 * beside).norm_sqr() * 8.0 / (3.0 * period)
        };
        let bins = row_bins(width);
        let first = bins.start;
        Self::new(width, bins.len(), move |bin, f| {
            let centre = (first + bin) as f64 / width as f64;
            0.5 * (seen(f - centre) + seen(f + centre))
        })
    }

    fn new(width: usize, count: usize, function: impl Fn(usize, f64) -> f64) -> Self {
        let mut edges = STEEP.to_vec();
        let last = STEEP[STEEP.len() - 1];
        let panels = width.div_ceil(SAMPLES).max(PANELS);
        edges.extend((1..=panels).map(|k| last + (0.5 - last) * k as f64 / panels as f64));
        let rule = gauss_legendre();
        let (mut frequencies, mut weights) = (Vec::new(), Vec::new());
        for panel in edges.windows(2) {
            let half = 0.5 * (panel[1] - panel[0]);
            for (x, weight) in rule {
                frequencies.push(panel[0] + half * (1.0 + x));
                // Frequencies of both signs.
                weights.push(2.0 * half * weight);
            }
        }
        let functions = (0..count).flat_map(|i| frequencies.iter().map(move |&f| (i, f)));
        let functions = functions.map(|(i, f)| function(i, f)).collect();
        let powers = std::array::from_fn(|_| vec![0.0; frequencies.len()]);
        Self { powers, sums: std::array::from_fn(|_| vec![0.0; count]), frequencies, weights, functions }
    }

    /// The integrals at `parameters`, without the noise, and their derivatives.
    pub(super) fn set(&mut self, parameters: &Parameters) {
        let (length, fall) = (parameters[LENGTH].exp(), parameters[FALL]);
        let knee2 = (2.0 * parameters[KNEE]).exp();
        let [value, by_length, by_fall, by_knee] = &mut self.powers;
        for (i, (&f, &weight)) in self.frequencies.iter().zip(&self.weights).enumerate() {
            let square = f * f + knee2;
            let log = 0.5 * square.ln() + LN_10;
            let x = length * f;
            let transfer = sinc(x);
            let scene = weight * (-fall * log).exp();
            value[i] = scene * transfer * transfer;
            by_length[i] = 2.0 * scene * transfer * ((PI * x).cos() - transfer);
            by_fall[i] = -log * value[i];
            by_knee[i] = -fall * knee2 / square * value[i];
        }
        for (sums, powers) in self.sums.iter_mut().zip(&self.powers) {
            for (sum, function) in sums.iter_mut().zip(self.functions.chunks_exact(self.frequencies.len())) {
                *sum = dot(powers, function);
            }
        }
    }

    /// The integrals.
    pub(super) fn values(&self) -> &[f64] {
        &self.sums[0]
    }

    /// Their derivatives by a parameter, which is not the noise.
    pub(super) fn derivatives(&self, parameter: usize) -> &[f64] {
        &self.sums[parameter + 1]
    }
}

/// The bins of rows of `width` samples that say something of their spectrum.
pub(super) fn row_bins(width: usize) -> Range<usize> {
    FIRST_BIN..width.div_ceil(2)
}

/// The window of those bins, with the sum of its squares 1, so that white noise has its own variance in each.
pub(super) fn row_window(width: usize) -> Vec<f64> {
    let weights: Vec<f64> = Window::Hann.weights(width).into_iter().map(f64::from).collect();
    let norm = weights.iter().map(|weight| weight * weight).sum::<f64>().sqrt();
    weights.into_iter().map(|weight| weight / norm).collect()
}

/// Nodes and weights on -1..1.
fn gauss_legendre() -> [(f64, f64); NODES] {
    std::array::from_fn(|i| {
        let mut x = (PI * (i as f64 + 0.75) / (NODES as f64 + 0.5)).cos();
        let mut slope = 1.0;
        // Newton's method doubles the digits of a first guess that has three.
        for _ in 0..5 {
            let (mut before, mut value) = (1.0, x);
            for k in 2..=NODES {
                let k = k as f64;
                (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
            }
            slope = NODES as f64 * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_noise_moved_is_correlated_as_far_as_the_motion() {
        // Without a blur 1 and 0 at all other lags; at a whole length L of samples band-limited like the scene the sum over
        // all lags is the power at the frequency 0, 1.
        let mut lags = Integrals::lags(64);
        lags.set(&[f64::NEG_INFINITY, 0.0, -4.6, -7.0]);
        for (lag, covariance) in lags.values().iter().enumerate() {
            assert!((covariance - if lag == 0 { 1.0 } else { 0.0 }).abs() < 1e-9, "{lag}: {covariance}");
        }
        for length in [4.0_f64, 13.7, 38.0] {
            lags.set(&[length.ln(), 0.0, -4.6, -7.0]);
            for (lag, covariance) in lags.values().iter().enumerate() {
                // A triangle, whose corners the highest frequency rounds.
                let triangle = (length - lag as f64).max(0.0) / (length * length);
                assert!((covariance - triangle).abs() < 0.25 / (length * length), "{length} {lag}: {covariance}");
            }
        }
    }

    #[test]
    fn derivatives_are_limits_of_differences() {
        let at = [2.3, 1.9, -4.0, -7.0];
        let mut lags = Integrals::lags(40);
        for parameter in LENGTH..NOISE {
            let h = 1e-5;
            let [low, high] = [-h, h].map(|by| {
                let mut moved = at;
                moved[parameter] += by;
                lags.set(&moved);
                lags.values().to_vec()
            });
            lags.set(&at);
            for (lag, found) in lags.derivatives(parameter).iter().enumerate() {
                let difference = (high[lag] - low[lag]) / (2.0 * h);
                let scale = lags.derivatives(parameter)[0].abs();
                assert!((found - difference).abs() < 1e-6 * scale, "{parameter} {lag}: {found} {difference}");
            }
        }
    }
}
