//! The likelihood of the rows' mean spectrum: less sure than that of the rows, and hundreds of times sooner known.

use std::f64::consts::PI;

use ndarray::ArrayView2;

use super::block::row_mean;
use super::climb::{Matrix, Slope, Surface, Vector};
use super::integrals::{Integrals, NOISE, Parameters, row_bins, row_window};

/// The power of the rows in each bin, as if bins were independent, held against what is expected there: window and finite
/// width are in the expectation, so that it has no bias.
///
/// # Reference
/// A. M. Sykulski et al., *The debiased Whittle likelihood*, Biometrika 106 (2019) 251.
#[derive(Debug)]
pub(super) struct Spectrum {
    count: f64,
    expected: Integrals,
    powers: Vec<f64>,
    /// The window times cosine and sine of each bin, a row each.
    waves: Vec<[f64; 2]>,
    /// The expected power in each bin at the scale 1.
    levels: Vec<f64>,
    /// Variance that the scene is scaled by.
    scale: f64,
}

impl Spectrum {
    /// For `count` rows of `width` samples.
    pub(super) fn new(count: usize, width: usize) -> Self {
        let (window, bins) = (row_window(width), row_bins(width));
        let wave = |bin: usize, x: usize| {
            let (sin, cos) = (2.0 * PI * ((bin * x) % width) as f64 / width as f64).sin_cos();
            [window[x] * cos, window[x] * sin]
        };
        let waves =
            bins.clone().flat_map(|bin| (0..width).map(move |x| (bin, x))).map(|(bin, x)| wave(bin, x)).collect();
        Self {
            count: count as f64,
            expected: Integrals::bins(width),
            powers: vec![0.0; bins.len()],
            waves,
            levels: vec![0.0; bins.len()],
            scale: 1.0,
        }
    }

    /// The picture to measure, of the size of the plan.
    pub(super) fn set(&mut self, picture: ArrayView2<'_, f32>) {
        self.powers.fill(0.0);
        for row in picture.rows() {
            let mean = row_mean(row);
            for (power, waves) in self.powers.iter_mut().zip(self.waves.chunks_exact(row.len())) {
                let (mut re, mut im) = (0.0, 0.0);
                for (&pixel, [cos, sin]) in row.iter().zip(waves) {
                    let value = f64::from(pixel) - mean;
                    (re, im) = (re + value * cos, im + value * sin);
                }
                *power += (re * re + im * im) / self.count;
            }
        }
    }
}

impl Surface for Spectrum {
    fn loss(&mut self, at: &Parameters) -> f64 {
        self.expected.set(at);
        let noise = at[NOISE].exp();
        let (mut log_sum, mut ratios) = (0.0, 0.0);
        for ((level, &signal), power) in self.levels.iter_mut().zip(self.expected.values()).zip(&self.powers) {
            *level = signal + noise;
            log_sum += level.ln();
            ratios += power / *level;
        }
        let bins = self.powers.len() as f64;
        self.scale = ratios / bins;
        if self.scale.is_nan() || self.scale <= 0.0 {
            return f64::INFINITY;
        }
        self.count * (log_sum + bins * self.scale.ln())
    }

    fn slope(&mut self, at: &Parameters) -> Slope {
        let noise = at[NOISE].exp();
        let (mut gradient, mut sums, mut products) = (Vector::zeros(), Vector::zeros(), Matrix::zeros());
        for (bin, (level, power)) in self.levels.iter().zip(&self.powers).enumerate() {
            let relative = Vector::from_fn(|i, _| match i {
                NOISE => noise / level,
                _ => self.expected.derivatives(i)[bin] / level,
            });
            gradient += relative * (1.0 - power / (self.scale * level));
            sums += relative;
            products += relative * relative.transpose();
        }
        let information = products - sums * sums.transpose() / self.powers.len().max(1) as f64;
        Slope { gradient: self.count * gradient, information: self.count * information }
    }
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use super::super::super::testing::Random;
    use super::super::integrals::{FALL, KNEE, LENGTH};
    use super::*;

    const AT: Parameters = [2.1, 1.7, -3.9, -5.0];

    #[test]
    fn what_is_expected_of_a_bin_is_what_the_covariance_makes_of_it() {
        for width in [19, 40] {
            let (mut lags, mut bins) = (Integrals::lags(width), Integrals::bins(width));
            lags.set(&AT);
            bins.set(&AT);
            let window = row_window(width);
            for (bin, &found) in row_bins(width).zip(bins.values()) {
                let mut written = 0.0;
                for (x, a) in window.iter().enumerate() {
                    for (y, b) in window.iter().enumerate() {
                        let turn = 2.0 * PI * bin as f64 * (x as f64 - y as f64) / width as f64;
                        written += a * b * lags.values()[x.abs_diff(y)] * turn.cos();
                    }
                }
                assert!((found - written).abs() < 1e-6 * written, "{width} {bin}: {found} {written}");
            }
        }
    }

    #[test]
    fn white_rows_have_their_variance_in_every_bin() {
        let mut random = Random::new(8);
        let picture = Array2::from_shape_simple_fn((4000, 24), || (7.0 + 3.0 * random.normal()) as f32);
        let mut spectrum = Spectrum::new(4000, 24);
        spectrum.set(picture.view());
        // 4000 exponential variables: their mean is known to 1.6 %.
        assert!(spectrum.powers.iter().all(|power| (power / 9.0 - 1.0).abs() < 0.06), "{:?}", spectrum.powers);
        assert_eq!(spectrum.powers.len(), 10);
    }

    #[test]
    fn the_gradient_is_the_limit_of_differences() {
        let mut random = Random::new(3);
        let picture = Array2::from_shape_simple_fn((5, 24), || random.normal() as f32);
        let mut spectrum = Spectrum::new(5, 24);
        spectrum.set(picture.view());
        assert!(spectrum.loss(&AT).is_finite());
        let gradient = spectrum.slope(&AT).gradient;
        for parameter in [LENGTH, FALL, KNEE, NOISE] {
            let h = 1e-4;
            let mut loss = |by: f64| {
                let mut moved = AT;
                moved[parameter] += by;
                spectrum.loss(&moved)
            };
            let difference = (loss(h) - loss(-h)) / (2.0 * h);
            let found = gradient[parameter];
            assert!((found - difference).abs() < 1e-4 * found.abs().max(1.0), "{parameter}: {found} {difference}");
        }
    }
}
