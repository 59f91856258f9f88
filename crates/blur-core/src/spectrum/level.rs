//! The log spectrum with the picture's own statistics taken out, so that the blur's pattern stands alone.

use ndarray::ArrayView2;
use rustfft::num_complex::Complex32;

use super::bins::{Band, SpectrumBins};
use super::log::ln;
use super::noise::{NoiseFloor, Powers};

/// Levels log spectra of pictures of one size.
///
/// The log power of a blurred picture is the log power of the sharp one plus `ln sinc^2(L s)`. Natural pictures have a
/// spectrum that falls with the radius and varies slowly with direction, so the pattern of the blur is what remains
/// when these are subtracted:
///
/// 1. `ln(P + noise)`: the noise floor, from the median power beyond the band, keeps bins without signal calm;
/// 2. minus the mean of each ring of one DFT bin width;
/// 3. minus the least-squares sum of `cos 2 phi, sin 2 phi, cos 4 phi, sin 4 phi`;
/// 4. divided by the standard deviation and limited to +-3, the smooth form of the thesis's binarisation (algorithm
///    4.1, step 4): no single bright line may decide.
#[derive(Debug, Clone)]
pub struct Levelled {
    bins: SpectrumBins,
    shape: (usize, usize),
    scale: f64,
    ring_sum: Vec<f64>,
    ring_count: Vec<f64>,
    /// Inverse Gram matrix of the angular harmonics over the bins.
    gram_inverse: [[f64; HARMONICS]; HARMONICS],
    noise: NoiseFloor,
}

const HARMONICS: usize = 4;
const LIMIT: f32 = 3.0;

impl Levelled {
    /// For DCT coefficients of pictures of `rows` x `columns` pixels, radii of 2/N to 0.4 cycles per pixel.
    pub fn for_dct(rows: usize, columns: usize) -> Self {
        let band = working_band(rows, columns);
        Self::new(SpectrumBins::quadrant(rows, columns, band), rows, columns)
    }

    /// For the half spectrum of the DFT of pictures of `rows` x `columns` pixels, radii as [`for_dct`](Self::for_dct).
    pub fn for_dft(rows: usize, columns: usize) -> Self {
        let band = working_band(rows, columns);
        Self::new(SpectrumBins::half_plane(rows, columns, band), rows, columns)
    }

    fn new(bins: SpectrumBins, rows: usize, columns: usize) -> Self {
        let rings = ring_of(bins.band.max as f32, 0.0, rows.min(columns)) + 2;
        let mut gram = [[0.0; HARMONICS]; HARMONICS];
        bins.for_each(|u, v, _| {
            let h = harmonics(u, v);
            for (row, &a) in gram.iter_mut().zip(&h) {
                for (cell, &b) in row.iter_mut().zip(&h) {
                    *cell += f64::from(a * b);
                }
            }
        });
        Self {
            bins,
            shape: (rows, columns),
            scale: 0.0,
            ring_sum: vec![0.0; rings],
            ring_count: vec![0.0; rings],
            gram_inverse: inverse(gram),
            noise: NoiseFloor::new(),
        }
    }

    /// The levelled values: mean near 0, variance near 1, within +-3.
    pub fn bins(&self) -> &SpectrumBins {
        &self.bins
    }

    /// Levelled values per unit of log power.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Levels the coefficients of [`Dct2`](super::Dct2), of the size given to [`for_dct`](Self::for_dct).
    pub fn set_from_dct(&mut self, coefficients: ArrayView2<'_, f32>) {
        let (rows, columns) = self.shape;
        let power = |row: usize, column: usize| coefficients[[row, column]].powi(2);
        let radius = |m: usize, n: usize| 0.5 * (m as f64 / rows as f64).hypot(n as f64 / columns as f64);
        let noise = self.noise.read((rows, columns), Powers::OfReal, radius, power);
        self.set(noise, power);
    }

    /// Levels the half spectrum of [`Dft2`](super::Dft2), of the size given to [`for_dft`](Self::for_dft).
    pub fn set_from_dft(&mut self, spectrum: ArrayView2<'_, Complex32>) {
        let (rows, columns) = self.shape;
        // The same scale as the orthonormal DCT: a picture of variance 1 has mean power 1.
        let scale = 1.0 / (rows * columns) as f32;
        let power = |row: usize, column: usize| spectrum[[row, column]].norm_sqr() * scale;
        let radius = |j: usize, k: usize| (j.min(rows - j) as f64 / rows as f64).hypot(k as f64 / columns as f64);
        let noise = self.noise.read(spectrum.dim(), Powers::OfComplex, radius, power);
        self.set(noise, power);
    }

    fn set(&mut self, noise: f32, power: impl Fn(usize, usize) -> f32) {
        let side = self.shape.0.min(self.shape.1);
        self.ring_sum.fill(0.0);
        self.ring_count.fill(0.0);
        for row in &self.bins.rows {
            for i in 0..row.length {
                let column = row.first_column + i;
                let value = ln(power(row.source_row, column) + noise);
                self.bins.values[row.start + i] = value;
                let ring = ring_of(column as f32 * self.bins.du, row.v, side);
                self.ring_sum[ring] += f64::from(value);
                self.ring_count[ring] += 1.0;
            }
        }
        for (sum, count) in self.ring_sum.iter_mut().zip(&self.ring_count) {
            *sum /= count.max(1.0);
        }
        let mut moments = [0.0_f64; HARMONICS];
        let ring_mean = &self.ring_sum;
        self.bins.update(|u, v, value| {
            let levelled = value - ring_mean[ring_of(u, v, side)] as f32;
            for (moment, h) in moments.iter_mut().zip(harmonics(u, v)) {
                *moment += f64::from(h * levelled);
            }
            levelled
        });
        let mut amplitudes = [0.0_f32; HARMONICS];
        for (amplitude, row) in amplitudes.iter_mut().zip(&self.gram_inverse) {
            *amplitude = row.iter().zip(&moments).map(|(g, m)| g * m).sum::<f64>() as f32;
        }
        let mut sum_of_squares = 0.0_f64;
        self.bins.update(|u, v, value| {
            let rest = value - harmonics(u, v).iter().zip(&amplitudes).map(|(h, a)| h * a).sum::<f32>();
            sum_of_squares += f64::from(rest * rest);
            rest
        });
        let std = (sum_of_squares / self.bins.len().max(1) as f64).sqrt() as f32;
        let scale = if std > 0.0 { 1.0 / std } else { 0.0 };
        self.scale = f64::from(scale);
        for value in &mut self.bins.values {
            *value = (*value * scale).clamp(-LIMIT, LIMIT);
        }
    }
}

/// Radii that the methods use. Below two bins of the shorter side the window's own lobe rules.
fn working_band(rows: usize, columns: usize) -> Band {
    Band { min: 2.0 / rows.min(columns) as f64, max: 0.4 }
}

fn ring_of(u: f32, v: f32, side: usize) -> usize {
    ((u * u + v * v).sqrt() * side as f32) as usize
}

/// `cos 2 phi, sin 2 phi, cos 4 phi, sin 4 phi` of the direction of a frequency.
fn harmonics(u: f32, v: f32) -> [f32; HARMONICS] {
    let r2 = u * u + v * v;
    let (c2, s2) = ((u * u - v * v) / r2, 2.0 * u * v / r2);
    [c2, s2, c2 * c2 - s2 * s2, 2.0 * c2 * s2]
}

/// Inverse of a small symmetric positive matrix by Gauss-Jordan; a singular direction gets the weight 0.
fn inverse(mut a: [[f64; HARMONICS]; HARMONICS]) -> [[f64; HARMONICS]; HARMONICS] {
    let mut inverse = [[0.0; HARMONICS]; HARMONICS];
    for (i, row) in inverse.iter_mut().enumerate() {
        row[i] = 1.0;
    }
    for i in 0..HARMONICS {
        let pivot = a[i][i];
        if pivot <= 1e-12 {
            return [[0.0; HARMONICS]; HARMONICS];
        }
        for k in 0..HARMONICS {
            a[i][k] /= pivot;
            inverse[i][k] /= pivot;
        }
        for j in (0..HARMONICS).filter(|&j| j != i) {
            let factor = a[j][i];
            for k in 0..HARMONICS {
                a[j][k] -= factor * a[i][k];
                inverse[j][k] -= factor * inverse[i][k];
            }
        }
    }
    inverse
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use super::*;

    #[test]
    fn a_power_law_with_slow_anisotropy_is_levelled_away() {
        // ln P = -2.2 ln f + 0.8 cos 2 phi + 0.3 sin 4 phi + noise of variance 1/3: the noise alone must remain.
        let noise = |m: usize, n: usize| ((m * 7919 + n * 104_729) % 1009) as f32 / 1009.0 * 2.0 - 1.0;
        let mut levelled = Levelled::for_dct(256, 256);
        levelled.set_from_dct(
            Array2::from_shape_fn((256, 256), |(m, n)| {
                let (u, v) = (n as f32 / 512.0, (m as f32 / 512.0).max(1e-4));
                let h = harmonics(u, v);
                (-1.1 * u.hypot(v).ln() + 0.4 * h[0] + 0.15 * h[3] + 0.5 * noise(m, n)).exp()
            })
            .view(),
        );
        let (mut same, mut values, mut noises) = (0.0, 0.0, 0.0);
        let (mut count, mut trends) = (0.0, [0.0_f32; HARMONICS]);
        levelled.bins().for_each(|u, v, value| {
            let (m, n) = ((v * 512.0).round() as usize, (u * 512.0).round() as usize);
            // Rings of a few bins lose much of their own noise with their mean.
            if u.hypot(v) > 0.05 {
                same += value * noise(m, n);
                values += value * value;
                noises += noise(m, n).powi(2);
            }
            count += 1.0;
            for (trend, h) in trends.iter_mut().zip(harmonics(u, v)) {
                *trend += h * value;
            }
        });
        // Correlation with the noise that was put in; amplitude of what is left of the anisotropy.
        let correlation = same / (values * noises).sqrt();
        assert!(correlation > 0.8, "{correlation}");
        assert!(trends.iter().all(|trend| (trend / count).abs() < 0.01), "{trends:?}");
    }

    #[test]
    fn values_have_unit_variance_and_are_limited() {
        let mut levelled = Levelled::for_dft(64, 80);
        levelled.set_from_dft(
            Array2::from_shape_fn((64, 41), |(j, k)| {
                let x = (j * 7919 + k * 104_729) % 1009;
                Complex32::new((x as f32 / 1009.0).powi(4), 0.1)
            })
            .view(),
        );
        let values = &levelled.bins().values;
        let mean = values.iter().sum::<f32>() / values.len() as f32;
        let variance = values.iter().map(|x| x * x).sum::<f32>() / values.len() as f32;
        assert!(mean.abs() < 0.05 && (0.8..=1.0 + 1e-3).contains(&variance), "{mean} {variance}");
        assert!(values.iter().all(|x| x.abs() <= LIMIT));
    }

    #[test]
    fn the_inverse_is_the_inverse() {
        let mut a = [[0.1; HARMONICS]; HARMONICS];
        for (i, row) in a.iter_mut().enumerate() {
            row[i] = 1.0 + i as f64;
        }
        let b = inverse(a);
        for (i, row) in a.iter().enumerate() {
            for j in 0..HARMONICS {
                let product: f64 = row.iter().zip(&b).map(|(x, column)| x * column[j]).sum();
                assert!((product - f64::from(u8::from(i == j))).abs() < 1e-12);
            }
        }
    }
}
