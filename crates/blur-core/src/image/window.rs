//! Windows: tapers that keep the border of a picture from leaking into its spectrum.

use std::f64::consts::PI;

use ndarray::{Array2, ArrayView2};

/// A separable taper; the 2-D window is the product of the two 1-D ones.
///
/// # Reference
///
/// F. J. Harris, "On the use of windows for harmonic analysis with the discrete Fourier transform", Proc. IEEE 66(1),
/// 1978. For spectral *variance* in two dimensions a Hann window costs a factor 3.78, a Tukey window of 0.25 only 1.32.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Window {
    /// No taper: the picture as it is.
    None,
    /// Raised cosine over the whole length.
    Hann,
    /// Flat in the middle with raised-cosine ends.
    Tukey {
        /// Share of the length that is tapered, both ends together, in `[0, 1]`; 1 is Hann. Values outside are
        /// clamped, NaN counts as 0.
        taper: f64,
    },
}

impl Window {
    /// Weight at sample `i` of `n`. The ends are never zero, so no pixel is wasted: the taper runs over `n + 2` points.
    pub fn weight(self, i: usize, n: usize) -> f64 {
        let taper = match self {
            Self::None => return 1.0,
            Self::Hann => 1.0,
            Self::Tukey { taper } if taper.is_nan() => return 1.0,
            Self::Tukey { taper } => taper.clamp(0.0, 1.0),
        };
        let t = (i as f64 + 1.0) / (n as f64 + 1.0);
        let edge = t.min(1.0 - t);
        if edge >= taper / 2.0 { 1.0 } else { 0.5 - 0.5 * (2.0 * PI * edge / taper).cos() }
    }

    /// Factor by which the window raises the variance of spectral estimates from `n` samples in one dimension:
    /// `n sum w^4 / (sum w^2)^2`, 1 without a window. In two dimensions the factors of both axes multiply.
    pub fn variance_factor(self, n: usize) -> f64 {
        let (mut squares, mut fourths) = (0.0, 0.0);
        for i in 0..n {
            let square = self.weight(i, n).powi(2);
            squares += square;
            fourths += square * square;
        }
        n as f64 * fourths / (squares * squares)
    }

    /// The weights of a window of `n` samples.
    pub fn weights(self, n: usize) -> Vec<f32> {
        (0..n).map(|i| self.weight(i, n) as f32).collect()
    }
}

/// A window for pictures of one size, ready to be laid over them.
#[derive(Debug, Clone)]
pub struct Taper {
    rows: Vec<f32>,
    columns: Vec<f32>,
}

impl Taper {
    /// The window's weights for pictures of `rows` x `columns` pixels.
    pub fn new(window: Window, rows: usize, columns: usize) -> Self {
        Self { rows: window.weights(rows), columns: window.weights(columns) }
    }

    /// Writes `(image - mean) / standard deviation * weight` into `out`, both of the taper's size.
    ///
    /// The mean is weighted by the window, so that the constant term vanishes; dividing by the standard deviation
    /// makes everything that follows independent of the picture's scale.
    pub fn apply(&self, image: ArrayView2<'_, f32>, out: &mut Array2<f32>) {
        // Relative to one pixel, so that the squares of a large offset do not swamp the contrast.
        let origin = image.first().copied().map_or(0.0, f64::from);
        for (row, mut out_row) in image.rows().into_iter().zip(out.rows_mut()) {
            out_row.assign(&row);
        }
        let (mut sum, mut sum_of_squares, mut total) = (0.0_f64, 0.0_f64, 0.0_f64);
        let column_total: f64 = self.columns.iter().map(|&weight| f64::from(weight)).sum();
        for (row, &row_weight) in out.rows().into_iter().zip(&self.rows) {
            let (s, s2) = row.as_slice().map_or((0.0, 0.0), |row| weighted_moments(row, &self.columns, origin));
            sum += f64::from(row_weight) * s;
            sum_of_squares += f64::from(row_weight) * s2;
            total += f64::from(row_weight) * column_total;
        }
        let mean = sum / total;
        let variance = (sum_of_squares / total - mean * mean).max(0.0);
        let scale = if variance > 0.0 { 1.0 / variance.sqrt() } else { 0.0 };
        let shift = origin + mean;
        for (mut row, &row_weight) in out.rows_mut().into_iter().zip(&self.rows) {
            let row_scale = scale * f64::from(row_weight);
            for (value, &weight) in row.iter_mut().zip(&self.columns) {
                *value = ((f64::from(*value) - shift) * row_scale) as f32 * weight;
            }
        }
    }
}

/// Sums of `weight * x` and `weight * x^2` with `x = pixel - origin`.
fn weighted_moments(row: &[f32], weights: &[f32], origin: f64) -> (f64, f64) {
    // Eight sums side by side: the compiler may not reorder floating-point additions by itself.
    const LANES: usize = 8;
    let (mut first, mut second) = ([0.0_f64; LANES], [0.0_f64; LANES]);
    for (pixels, weights) in row.chunks(LANES).zip(weights.chunks(LANES)) {
        for (((first, second), &pixel), &weight) in first.iter_mut().zip(&mut second).zip(pixels).zip(weights) {
            let x = f64::from(pixel) - origin;
            let weighted = f64::from(weight) * x;
            *first += weighted;
            *second += weighted * x;
        }
    }
    (first.iter().sum(), second.iter().sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tapered_picture_has_no_mean_and_does_not_know_its_scale() {
        let picture = Array2::from_shape_fn((40, 50), |(r, c)| ((r * 13 + c * c * 7) % 97) as f32);
        let taper = Taper::new(Window::Hann, 40, 50);
        let (mut a, mut b) = (Array2::zeros((40, 50)), Array2::zeros((40, 50)));
        taper.apply(picture.view(), &mut a);
        taper.apply(picture.mapv(|p| 3.0e30 * p + 5.0e31).view(), &mut b);
        assert!(a.sum().abs() < 1e-3);
        for (x, y) in a.iter().zip(&b) {
            assert!((x - y).abs() < 1e-4, "{x} {y}");
        }
    }

    #[test]
    fn hann_is_the_full_taper() {
        for i in 0..17 {
            let (hann, tukey) = (Window::Hann.weight(i, 17), Window::Tukey { taper: 1.0 }.weight(i, 17));
            assert!((hann - tukey).abs() < 1e-15);
        }
        // n + 1 = 18 intervals: sin^2(pi (i + 1) / 18).
        assert!((Window::Hann.weight(8, 17) - 1.0).abs() < 1e-15);
        assert!((Window::Hann.weight(2, 17) - (PI / 6.0).sin().powi(2)).abs() < 1e-15);
    }

    #[test]
    fn a_taper_is_symmetric_flat_in_the_middle_and_positive() {
        let w = Window::Tukey { taper: 0.25 }.weights(101);
        for i in 0..101 {
            assert!(w[i] > 0.0 && w[i] <= 1.0);
            assert!((w[i] - w[100 - i]).abs() < 1e-6);
        }
        assert!(w[13..88].iter().all(|&x| x == 1.0));
    }

    #[test]
    fn variance_factors_are_those_of_the_literature() {
        // 35/18 = 1.944 for Hann, 1.149 for Tukey 0.25.
        assert!((Window::Hann.variance_factor(4096) - 35.0 / 18.0).abs() < 1e-3);
        assert!((Window::Tukey { taper: 0.25 }.variance_factor(4096) - 1.149).abs() < 1e-3);
    }
}
