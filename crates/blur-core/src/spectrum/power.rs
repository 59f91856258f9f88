//! The power spectrum of a windowed picture as a list of bins, for looking at it.

use ndarray::{Array2, ArrayView2};

use super::Dft2;
use crate::image::{Taper, Window};
use crate::{Result, image};

/// Powers fall about as the frequency to this power in photographs; see [`PowerSpectrum::whitening`].
const FALL: f64 = 2.2;
/// The window's own lobe fills the bins nearest to 0.
const LEAST_BINS: f64 = 3.0;
/// Highest frequency in cycles per pixel.
const MOST_FREQUENCY: f64 = 0.5;

/// One bin of a power spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerBin {
    /// Frequency along rows in cycles per pixel, at least 0.
    pub u: f32,
    /// Frequency along columns, downwards, in cycles per pixel.
    pub v: f32,
    /// Power `|DFT(g w)|^2 / sum w^2` of the picture `g` scaled to variance 1 under the window `w`: white noise of the
    /// variance `s^2` has the mean power `s^2`.
    pub power: f32,
}

/// Powers on the half plane of frequencies, from three bins of the shorter side to 0.5 cycles per pixel.
///
/// The other half is its mirror image. [`map`](Self::map) and [`along`](Self::along) sum up anything that belongs to the
/// bins: the powers, what a model expects of them, or the ratio of both.
#[derive(Debug, Clone, PartialEq)]
pub struct PowerSpectrum {
    bins: Vec<PowerBin>,
}

impl PowerSpectrum {
    /// The spectrum of `image` under `window`. Fails as the estimators do on a picture that is too small, constant or
    /// not finite.
    pub fn of(image: ArrayView2<'_, f32>, window: Window) -> Result<Self> {
        image::check(image)?;
        let (rows, columns) = image.dim();
        let mut dft = Dft2::new(rows, columns);
        Taper::new(window, rows, columns).apply(image, dft.input());
        let square = |n: usize| window.weights(n).iter().map(|&w| f64::from(w).powi(2)).sum::<f64>();
        let scale = (1.0 / (square(rows) * square(columns))) as f32;
        let least = LEAST_BINS / rows.min(columns) as f64;
        let mut bins = Vec::new();
        for ((row, column), value) in dft.transform().indexed_iter() {
            let signed = if row <= rows / 2 { row as f64 } else { row as f64 - rows as f64 };
            let (u, v) = (column as f64 / columns as f64, signed / rows as f64);
            // The axis u = 0 holds each bin twice.
            let is_mirror = column == 0 && v <= 0.0;
            if !is_mirror && (least..MOST_FREQUENCY).contains(&u.hypot(v)) {
                bins.push(PowerBin { u: u as f32, v: v as f32, power: value.norm_sqr() * scale });
            }
        }
        Ok(Self { bins })
    }

    pub(crate) fn from_bins(bins: Vec<PowerBin>) -> Self {
        Self { bins }
    }

    /// All bins.
    pub fn bins(&self) -> &[PowerBin] {
        &self.bins
    }

    /// `(f / 0.1)^2.2` at the frequency `(u, v)`: a power times this is flat over the spectrum of an ordinary photograph.
    pub fn whitening(u: f32, v: f32) -> f64 {
        (f64::from(u).hypot(f64::from(v)) / 0.1).powf(FALL)
    }

    /// Mean of `value` over the bins that fall on each point of a square lattice of `side` points from `-edge` to `edge`
    /// (cycles per pixel) both ways; not a number where there is no bin. `value` gets the index of a bin and the bin.
    ///
    /// Element `[row, column]` belongs to `v = 2 edge (row - side/2) / side` and `u = 2 edge (column - side/2) / side`.
    pub fn map(&self, side: usize, edge: f64, value: impl Fn(usize, &PowerBin) -> f64) -> Array2<f64> {
        let side = side.max(2);
        let mut sums = Array2::<(f64, f64)>::from_elem((side, side), (0.0, 0.0));
        let place = |frequency: f64| {
            let at = (0.5 * frequency / edge * side as f64).round() + (side / 2) as f64;
            (at >= 0.0 && at < side as f64).then_some(at as usize)
        };
        for (index, bin) in self.bins.iter().enumerate() {
            let (u, v) = (f64::from(bin.u), f64::from(bin.v));
            for sign in [1.0, -1.0] {
                if let (Some(row), Some(column)) = (place(sign * v), place(sign * u)) {
                    let (sum, count) = &mut sums[[row, column]];
                    *sum += value(index, bin);
                    *count += 1.0;
                }
            }
        }
        sums.mapv(|(sum, count)| sum / count)
    }

    /// Mean of `value` over the bins of each step of the frequency along the direction `angle_rad`, either sign, up to
    /// `most_frequency` (cycles per pixel, radius of the bin): element `k` belongs to `k * step <= |s| < (k + 1) * step`,
    /// `s = u cos angle - v sin angle`. Not a number where there is no bin.
    pub fn along(
        &self,
        angle_rad: f64,
        step: f64,
        most_frequency: f64,
        value: impl Fn(usize, &PowerBin) -> f64,
    ) -> Vec<f64> {
        let (sin, cos) = angle_rad.sin_cos();
        let mut sums = vec![(0.0, 0.0); (most_frequency.min(MOST_FREQUENCY) / step).ceil() as usize];
        for (index, bin) in self.bins.iter().enumerate() {
            let (u, v) = (f64::from(bin.u), f64::from(bin.v));
            if u.hypot(v) > most_frequency {
                continue;
            }
            let s = (u * cos - v * sin).abs();
            if let Some((sum, count)) = sums.get_mut((s / step) as usize) {
                *sum += value(index, bin);
                *count += 1.0;
            }
        }
        sums.into_iter().map(|(sum, count)| sum / count).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wave of 7 periods over 64 columns and 3 over 48 rows, y down.
    fn wave() -> PowerSpectrum {
        let turn = std::f64::consts::TAU;
        let picture = Array2::from_shape_fn((48, 64), |(row, column)| {
            (turn * (7.0 * column as f64 / 64.0 + 3.0 * row as f64 / 48.0)).cos() as f32
        });
        PowerSpectrum::of(picture.view(), Window::None).unwrap()
    }

    #[test]
    fn a_wave_is_one_bin_that_holds_all_its_power() {
        let spectrum = wave();
        let peak = spectrum.bins().iter().max_by(|a, b| a.power.total_cmp(&b.power)).unwrap();
        assert!((peak.u - 7.0 / 64.0).abs() < 1e-6 && (peak.v - 3.0 / 48.0).abs() < 1e-6, "{peak:?}");
        // A picture of variance 1 has the mean power 1 over all bins; the wave holds it in a bin and its mirror image.
        assert!((peak.power - 48.0 * 64.0 / 2.0).abs() < 1.0, "{peak:?}");
    }

    #[test]
    fn a_map_has_the_origin_at_its_middle_and_both_halves() {
        let map = wave().map(64, 0.5, |_, bin| f64::from(bin.power));
        for (row, column) in [(32 + 4, 32 + 7), (32 - 4, 32 - 7)] {
            assert!(map[[row, column]] > 100.0, "{row} {column}");
        }
        assert!(map[[32, 32]].is_nan(), "the window's lobe is left out");
        assert!(map[[0, 0]].is_nan(), "beyond half a cycle per pixel there is nothing");
        // To a quarter of a cycle each point stands for half as much.
        let near = wave().map(64, 0.25, |_, bin| f64::from(bin.power));
        assert!(near[[32 + 8, 32 + 14]] > 100.0);
    }

    #[test]
    fn a_profile_sums_over_the_frequencies_across() {
        let spectrum = wave();
        // Along the wave all of it is at its frequency, hypot(7/64, 3/48); the direction with y up has -v.
        let angle = (-3.0_f64 / 48.0).atan2(7.0 / 64.0);
        let profile = spectrum.along(angle, 0.01, 0.5, |_, bin| f64::from(bin.power));
        let highest = (0..profile.len()).max_by(|&a, &b| profile[a].total_cmp(&profile[b])).unwrap();
        assert_eq!(highest, ((7.0_f64 / 64.0).hypot(3.0 / 48.0) / 0.01) as usize);
    }

    #[test]
    fn whitening_is_one_at_a_tenth_of_a_cycle() {
        assert!((PowerSpectrum::whitening(0.06, -0.08) - 1.0).abs() < 1e-6);
        assert!((PowerSpectrum::whitening(0.2, 0.0) - 2.0_f64.powf(2.2)).abs() < 1e-6);
    }
}
