//! The covariance of two samples of a row, lag by lag.

use std::f64::consts::{LN_10, PI};

use super::symmetric::dot;
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
/// ... so many up to the highest frequency, within each of which the longest lag turns less than four times.
const PANELS: usize = 12;
/// Nodes of a panel.
const NODES: usize = 16;

/// The covariance and its derivatives for one width.
#[derive(Debug)]
pub(super) struct Lags {
    frequencies: Vec<f64>,
    weights: Vec<f64>,
    /// The cosine of each lag, a row, at each frequency.
    cosines: Vec<f64>,
    /// The powers of the blurred scene at the nodes, and their derivatives.
    powers: [Vec<f64>; NOISE + 1],
    /// Their sums: the covariance at each lag and its derivatives, that by a parameter at the parameter's index plus one.
    sums: [Vec<f64>; NOISE + 1],
}

impl Lags {
    /// For rows of `width` samples.
    pub(super) fn new(width: usize) -> Self {
        let mut edges = STEEP.to_vec();
        let last = STEEP[STEEP.len() - 1];
        edges.extend((1..=PANELS).map(|k| last + (0.5 - last) * k as f64 / PANELS as f64));
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
        let cosines =
            (0..width).flat_map(|lag| frequencies.iter().map(move |f| (2.0 * PI * f * lag as f64).cos())).collect();
        let powers = std::array::from_fn(|_| vec![0.0; frequencies.len()]);
        Self { powers, sums: std::array::from_fn(|_| vec![0.0; width]), frequencies, weights, cosines }
    }

    /// The covariance at `parameters`, without the noise, and its derivatives.
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
            for (sum, cosines) in sums.iter_mut().zip(self.cosines.chunks_exact(self.frequencies.len())) {
                *sum = dot(powers, cosines);
            }
        }
    }

    /// The covariance at each lag.
    pub(super) fn covariance(&self) -> &[f64] {
        &self.sums[0]
    }

    /// Its derivative by a parameter, which is not the noise.
    pub(super) fn derivative(&self, parameter: usize) -> &[f64] {
        &self.sums[parameter + 1]
    }
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
        let mut lags = Lags::new(64);
        lags.set(&[f64::NEG_INFINITY, 0.0, -4.6, -7.0]);
        for (lag, covariance) in lags.covariance().iter().enumerate() {
            assert!((covariance - if lag == 0 { 1.0 } else { 0.0 }).abs() < 1e-9, "{lag}: {covariance}");
        }
        for length in [4.0_f64, 13.7, 38.0] {
            lags.set(&[length.ln(), 0.0, -4.6, -7.0]);
            for (lag, covariance) in lags.covariance().iter().enumerate() {
                // A triangle, whose corners the highest frequency rounds.
                let triangle = (length - lag as f64).max(0.0) / (length * length);
                assert!((covariance - triangle).abs() < 0.25 / (length * length), "{length} {lag}: {covariance}");
            }
        }
    }

    #[test]
    fn derivatives_are_limits_of_differences() {
        let at = [2.3, 1.9, -4.0, -7.0];
        let mut lags = Lags::new(40);
        for parameter in LENGTH..NOISE {
            let h = 1e-5;
            let [low, high] = [-h, h].map(|by| {
                let mut moved = at;
                moved[parameter] += by;
                lags.set(&moved);
                lags.covariance().to_vec()
            });
            lags.set(&at);
            for (lag, found) in lags.derivative(parameter).iter().enumerate() {
                let difference = (high[lag] - low[lag]) / (2.0 * h);
                let scale = lags.derivative(parameter)[0].abs();
                assert!((found - difference).abs() < 1e-6 * scale, "{parameter} {lag}: {found} {difference}");
            }
        }
    }
}
