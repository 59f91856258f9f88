//! The phase-only image.

use std::f64::consts::PI;

use ndarray::{Array2, ArrayView2};
use rustfft::num_complex::Complex32;

use super::noise::{NoiseFloor, Powers};

/// Takes the modulus out of the spectra of pictures of one size, so that only their phase is left.
///
/// The picture with the spectrum `F / |F|` is the phase-only image: the phase-only image of the sharp picture convolved
/// with that of the blur kernel. Every bin would count alike, those that hold nothing but noise too; so each is weighted
/// by `cos^2(pi s) max(0, 1 - noise / P)`, where `s` is its radius in cycles per pixel (0 beyond one half), `P` the mean
/// power of the ring of that radius and the noise is the median power beyond 0.4 cycles per pixel.
///
/// # Reference
///
/// A. V. Oppenheim and J. S. Lim, "The importance of phase in signals", Proc. IEEE 69(5), 1981; L. Pan et al. 2019,
/// see [`PhaseAutocorrelation`](crate::estimate::joint::PhaseAutocorrelation). The weights are our own.
#[derive(Debug)]
pub struct PhaseOnly {
    shape: (usize, usize),
    noise: NoiseFloor,
    ring_sum: Vec<f64>,
    ring_count: Vec<f64>,
    ring_weight: Vec<f32>,
}

impl PhaseOnly {
    /// For the half spectra of pictures of `rows` x `columns` pixels.
    pub fn new(rows: usize, columns: usize) -> Self {
        let rings = ring_of(0.5_f64.hypot(0.5), rows.min(columns)) + 1;
        Self {
            shape: (rows, columns),
            noise: NoiseFloor::new(),
            ring_sum: vec![0.0; rings],
            ring_count: vec![0.0; rings],
            ring_weight: vec![0.0; rings],
        }
    }

    /// Writes the weighted phase of `spectrum` into `out`, both half spectra as those of [`Dft2`](super::Dft2),
    /// `rows` x `columns / 2 + 1`. Bins without power become 0.
    pub fn apply(&mut self, spectrum: ArrayView2<'_, Complex32>, out: &mut Array2<Complex32>) {
        let (rows, columns) = self.shape;
        let side = rows.min(columns);
        // A picture of variance 1 then has mean power 1, as the noise floor expects.
        let scale = 1.0 / (rows * columns) as f32;
        let radius = |j: usize, k: usize| {
            let (v, u) = (j.min(rows - j) as f64 / rows as f64, k as f64 / columns as f64);
            (u * u + v * v).sqrt()
        };
        self.ring_sum.fill(0.0);
        self.ring_count.fill(0.0);
        for ((j, k), value) in spectrum.indexed_iter() {
            let ring = ring_of(radius(j, k), side);
            self.ring_sum[ring] += f64::from(value.norm_sqr() * scale);
            self.ring_count[ring] += 1.0;
        }
        let power = |j: usize, k: usize| spectrum[[j, k]].norm_sqr() * scale;
        let noise = f64::from(self.noise.read(spectrum.dim(), Powers::OfComplex, radius, power));
        let means = self.ring_sum.iter().zip(&self.ring_count).map(|(sum, count)| sum / count.max(1.0));
        for (ring, (weight, mean)) in self.ring_weight.iter_mut().zip(means).enumerate() {
            let s = (ring as f64 / side as f64).min(0.5);
            let signal = if mean > noise { 1.0 - noise / mean } else { 0.0 };
            *weight = ((PI * s).cos().powi(2) * signal) as f32;
        }
        for (((j, k), value), phase) in spectrum.indexed_iter().zip(out.iter_mut()) {
            let modulus = value.norm();
            // Below that the modulus has no digits left.
            *phase = if modulus > f32::MIN_POSITIVE {
                value * (self.ring_weight[ring_of(radius(j, k), side)] / modulus)
            } else {
                Complex32::default()
            };
        }
    }
}

/// Rings are as wide as one bin of the shorter side.
fn ring_of(radius: f64, side: usize) -> usize {
    (radius * side as f64).round() as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A spectrum that falls from 1000 to nothing at 0.3 cycles per pixel, above noise of modulus 1, of rising phase.
    fn spectrum() -> Array2<Complex32> {
        Array2::from_shape_fn((40, 26), |(j, k)| {
            let radius = (j.min(40 - j) as f32 / 40.0).hypot(k as f32 / 50.0);
            Complex32::from_polar(1.0 + 1000.0 * (1.0 - radius / 0.3).max(0.0), (3 * j + 7 * k) as f32)
        })
    }

    #[test]
    fn the_phase_stays_and_the_modulus_goes() {
        let spectrum = spectrum();
        let mut out = Array2::zeros(spectrum.dim());
        PhaseOnly::new(40, 50).apply(spectrum.view(), &mut out);
        for (j, k) in [(0, 0), (3, 2), (37, 5), (0, 8)] {
            let turned = out[[j, k]] * spectrum[[j, k]].conj();
            assert!(turned.im.abs() < 1e-4 * turned.re, "[{j}, {k}]: {turned}");
        }
        // cos^2(pi s) at s = 0.16: the power is 10^5 times the noise.
        assert!((out[[0, 8]].norm() - (0.16 * std::f32::consts::PI).cos().powi(2)).abs() < 0.03, "{}", out[[0, 8]]);
    }

    #[test]
    fn bins_of_noise_do_not_count() {
        let mut out = Array2::zeros((40, 26));
        PhaseOnly::new(40, 50).apply(spectrum().view(), &mut out);
        for (j, k) in [(0, 20), (16, 0), (20, 25), (14, 14)] {
            assert!(out[[j, k]].norm() < 1e-6, "[{j}, {k}]: {}", out[[j, k]]);
        }
    }

    #[test]
    fn bins_without_power_stay_empty() {
        let mut out = Array2::ones((40, 26));
        PhaseOnly::new(40, 50).apply(Array2::zeros((40, 26)).view(), &mut out);
        assert!(out.iter().all(|value| *value == Complex32::default()));
    }
}
