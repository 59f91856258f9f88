//! What lies over a picture before its transform, and what that does to the spectrum.

use ndarray::{Array2, ArrayView2};

use crate::image::{Taper, Window};
use crate::spectrum::{Dft2, InverseDft2, fast_size};

/// A window over the whole picture, or weights of any shape.
#[derive(Debug)]
pub(super) enum Overlay {
    Window(Separable),
    Weights(Box<Weights>),
}

/// A window that is a product of one along the rows and one along the columns.
#[derive(Debug)]
pub(super) struct Separable {
    taper: Taper,
    scale: f32,
    independence: f64,
    /// Autocorrelations of the window along a column and along a row, 1 at lag 0.
    lag_rows: Vec<f64>,
    lag_columns: Vec<f64>,
}

/// Weights of any shape in the corner of a transform that is no smaller; everything else weighs nothing.
#[derive(Debug)]
pub(super) struct Weights {
    /// Rows and columns of the transform.
    dim: (usize, usize),
    weights: Array2<f32>,
    scale: f32,
    independence: f64,
    /// Autocorrelation of squares of this many pixels a side, by columns and rows, cyclic over twice the transform at least, 1 at
    /// lag 0.
    square: usize,
    lags: Array2<f32>,
    dft: Dft2,
    inverse: InverseDft2,
}

/// Squares across the least extent of weights of which their autocorrelation is made: what it misses of that of a Hann window
/// is below 3e-4.
const SQUARES: f64 = 128.0;

impl Overlay {
    /// `window` over pictures of `rows` x `columns` pixels.
    pub(super) fn window(rows: usize, columns: usize, window: Window) -> Self {
        let (row_weights, column_weights) = (window.weights(rows), window.weights(columns));
        let square = |w: &[f32]| w.iter().map(|&w| f64::from(w).powi(2)).sum::<f64>();
        Self::Window(Separable {
            taper: Taper::new(window, rows, columns),
            scale: (1.0 / (square(&row_weights) * square(&column_weights))) as f32,
            independence: 1.0 / (window.variance_factor(rows) * window.variance_factor(columns)),
            lag_rows: autocorrelation(&row_weights),
            lag_columns: autocorrelation(&column_weights),
        })
    }

    /// Weights for transforms of `rows` x `columns` pixels, none yet; they will measure `extent_px` where they are narrowest.
    pub(super) fn weights(rows: usize, columns: usize, extent_px: f64) -> Self {
        let square = ((extent_px / SQUARES) as usize).max(1);
        let lags = [rows, columns].map(|pixels| fast_size(2 * pixels.div_ceil(square)));
        Self::Weights(Box::new(Weights {
            dim: (rows, columns),
            weights: Array2::zeros((0, 0)),
            scale: 0.0,
            independence: 1.0,
            square,
            lags: Array2::zeros(lags),
            dft: Dft2::new(lags[0], lags[1]),
            inverse: InverseDft2::new(lags[0], lags[1]),
        }))
    }

    /// Writes the picture, scaled to a weighted mean of 0 and variance of 1, under the weights into `out`.
    pub(super) fn apply(&self, image: ArrayView2<'_, f32>, out: &mut Array2<f32>) {
        match self {
            Self::Window(window) => window.taper.apply(image, out),
            Self::Weights(weights) => weights.apply(image, out),
        }
    }

    /// `1 / sum w^2`.
    pub(super) fn scale(&self) -> f32 {
        match self {
            Self::Window(window) => window.scale,
            Self::Weights(weights) => weights.scale,
        }
    }

    /// Independent bins per bin: the weights correlate neighbours.
    ///
    /// The covariance of two powers `k` bins apart is `|W(k)|^2 / W(0)^2` of their squared mean, with `W` the DFT of `w^2`;
    /// summed over all `k` that is `n sum w^4 / (sum w^2)^2` for a transform of `n` pixels, those without weight included.
    pub(super) fn independence(&self) -> f64 {
        match self {
            Self::Window(window) => window.independence,
            Self::Weights(weights) => weights.independence,
        }
    }

    /// Autocorrelation of the weights at a lag of `x` columns and `y` rows, 1 at lag 0.
    pub(super) fn autocorrelation(&self, x: f64, y: f64) -> f64 {
        match self {
            Self::Window(window) => interpolate(&window.lag_columns, x.abs()) * interpolate(&window.lag_rows, y.abs()),
            Self::Weights(weights) => weights.autocorrelation(x, y),
        }
    }
}

impl Weights {
    /// Takes `weights`, no larger than the transform, for the pictures that follow.
    pub(super) fn set(&mut self, weights: ArrayView2<'_, f32>) {
        if self.weights == weights {
            return;
        }
        self.weights = weights.to_owned();
        let (mut squares, mut fourths) = (0.0_f64, 0.0_f64);
        for &weight in weights {
            let square = f64::from(weight).powi(2);
            squares += square;
            fourths += square * square;
        }
        self.scale = (1.0 / squares) as f32;
        self.independence = squares * squares / ((self.dim.0 * self.dim.1) as f64 * fourths);
        let input = self.dft.input();
        input.fill(0.0);
        for (row, weights) in weights.rows().into_iter().enumerate() {
            let mut squares = input.row_mut(row / self.square);
            for (column, &weight) in weights.iter().enumerate() {
                squares[column / self.square] += weight;
            }
        }
        self.inverse.input().zip_mut_with(&self.dft.transform(), |out, value| *out = value.norm_sqr().into());
        self.lags.assign(&self.inverse.transform());
        let energy = self.lags[[0, 0]];
        self.lags.mapv_inplace(|lag| lag / energy);
    }

    fn apply(&self, image: ArrayView2<'_, f32>, out: &mut Array2<f32>) {
        // Relative to one pixel, so that the squares of a large offset do not swamp the contrast.
        let origin = image.first().copied().map_or(0.0, f64::from);
        let (mut sum, mut squares, mut total) = (0.0_f64, 0.0_f64, 0.0_f64);
        for (&pixel, &weight) in image.iter().zip(&self.weights) {
            let (x, weight) = (f64::from(pixel) - origin, f64::from(weight));
            sum += weight * x;
            squares += weight * x * x;
            total += weight;
        }
        let mean = sum / total;
        let variance = (squares / total - mean * mean).max(0.0);
        let scale = if variance > 0.0 { 1.0 / variance.sqrt() } else { 0.0 };
        let shift = origin + mean;
        out.fill(0.0);
        for ((row, weights), mut out) in image.rows().into_iter().zip(self.weights.rows()).zip(out.rows_mut()) {
            for ((out, &pixel), &weight) in out.iter_mut().zip(row).zip(weights) {
                *out = ((f64::from(pixel) - shift) * scale) as f32 * weight;
            }
        }
    }

    fn autocorrelation(&self, x: f64, y: f64) -> f64 {
        let (rows, columns) = self.dim;
        if x.abs() >= columns as f64 || y.abs() >= rows as f64 {
            return 0.0;
        }
        let (x, y) = (x / self.square as f64, y / self.square as f64);
        let (left, top) = (x.floor(), y.floor());
        let (across, down) = (x - left, y - top);
        let at = |x: f64, y: f64| {
            let (rows, columns) = self.lags.dim();
            let (row, column) = (y.rem_euclid(rows as f64) as usize, x.rem_euclid(columns as f64) as usize);
            f64::from(self.lags[[row.min(rows - 1), column.min(columns - 1)]])
        };
        let row = |y: f64| at(left, y) + across * (at(left + 1.0, y) - at(left, y));
        row(top) + down * (row(top + 1.0) - row(top))
    }
}

fn autocorrelation(weights: &[f32]) -> Vec<f64> {
    let at = |lag: usize| weights.iter().zip(&weights[lag..]).map(|(&a, &b)| f64::from(a) * f64::from(b)).sum::<f64>();
    let energy = at(0);
    (0..weights.len()).map(|lag| at(lag) / energy).collect()
}

fn interpolate(values: &[f64], at: f64) -> f64 {
    let below = at as usize;
    match (values.get(below), values.get(below + 1)) {
        (Some(a), Some(b)) => a + (b - a) * (at - below as f64),
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_that_are_a_product_are_that_window() {
        let (rows, columns) = (36, 50);
        let (hann_rows, hann_columns) = (Window::Hann.weights(rows), Window::Hann.weights(columns));
        let hann = Array2::from_shape_fn((rows, columns), |(r, c)| hann_rows[r] * hann_columns[c]);
        let window = Overlay::window(rows, columns, Window::Hann);
        // In a transform of another size too; there fewer of the bins are independent.
        for (padded_rows, padded_columns) in [(rows, columns), (40, 64)] {
            let mut overlay = Overlay::weights(padded_rows, padded_columns, rows as f64);
            if let Overlay::Weights(weights) = &mut overlay {
                weights.set(hann.view());
            }
            assert!((overlay.scale() / window.scale() - 1.0).abs() < 1e-6);
            let share = (rows * columns) as f64 / (padded_rows * padded_columns) as f64;
            assert!((overlay.independence() / (share * window.independence()) - 1.0).abs() < 1e-6);
            for (x, y) in [(0.0, 0.0), (3.0, -2.0), (-7.3, 11.6), (20.5, 0.25), (49.5, 1.0), (55.0, 0.0), (0.0, -36.2)]
            {
                let (found, expected) = (overlay.autocorrelation(x, y), window.autocorrelation(x, y));
                assert!((found - expected).abs() < 1e-5, "({x}, {y}): {found} not {expected}");
            }
            let picture = Array2::from_shape_fn((rows, columns), |(r, c)| ((r * 13 + c * c * 7) % 97) as f32 + 4e4);
            let (mut a, mut b) = (Array2::zeros((rows, columns)), Array2::ones((padded_rows, padded_columns)));
            window.apply(picture.view(), &mut a);
            overlay.apply(picture.view(), &mut b);
            for ((r, c), &value) in b.indexed_iter() {
                let expected = a.get((r, c)).copied().unwrap_or(0.0);
                assert!((value - expected).abs() < 1e-4, "({r}, {c}): {value} not {expected}");
            }
        }
    }

    #[test]
    fn large_weights_correlate_as_their_squares_do() {
        let (rows, columns) = (500, 410);
        let (hann_rows, hann_columns) = (Window::Hann.weights(rows), Window::Hann.weights(columns));
        let hann = Array2::from_shape_fn((rows, columns), |(r, c)| hann_rows[r] * hann_columns[c]);
        let window = Overlay::window(rows, columns, Window::Hann);
        let mut overlay = Overlay::weights(rows, columns, columns as f64);
        if let Overlay::Weights(weights) = &mut overlay {
            weights.set(hann.view());
            assert_eq!(weights.square, 3);
        }
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (3.2, -2.0), (-77.3, 111.6), (205.0, 2.5), (405.0, 1.0), (0.0, -490.0)] {
            let (found, expected) = (overlay.autocorrelation(x, y), window.autocorrelation(x, y));
            assert!((found - expected).abs() < 3e-4, "({x}, {y}): {found} not {expected}");
        }
    }

    #[test]
    fn a_slanted_shape_correlates_along_its_slope() {
        // A band about the diagonal, rows downwards: lags (d, d) stay in it, lags (d, -d) leave it.
        let band = Array2::from_shape_fn((40, 40), |(r, c)| if r.abs_diff(c) <= 4 { 1.0 } else { 0.0_f32 });
        let mut overlay = Overlay::weights(40, 40, 11.0);
        if let Overlay::Weights(weights) = &mut overlay {
            weights.set(band.view());
        }
        let sum = |x: isize, y: isize| {
            let value = |r: isize, c: isize| band.get((r as usize, c as usize)).copied().unwrap_or(0.0);
            band.indexed_iter().map(|((r, c), &w)| w * value(r as isize + y, c as isize + x)).sum::<f32>()
        };
        for (x, y) in [(10, 10), (-10, -10), (10, -10), (3, -3), (5, 0)] {
            let expected = f64::from(sum(x, y) / sum(0, 0));
            let found = overlay.autocorrelation(x as f64, y as f64);
            assert!((found - expected).abs() < 1e-5, "({x}, {y}): {found} not {expected}");
        }
    }

    #[test]
    fn the_bins_of_white_noise_are_as_independent_as_stated() {
        use super::super::testing::Random;
        // The mean of all powers has the variance 2 / (independent bins), half of the bins being the conjugates of others.
        let (rows, columns) = (32, 40);
        let disk = Array2::from_shape_fn((24, 30), |(r, c)| {
            let radius = (r as f32 - 11.5).hypot(c as f32 - 14.5) / 12.0;
            (1.0 - radius * radius).max(0.0)
        });
        let mut overlay = Overlay::weights(rows, columns, 24.0);
        if let Overlay::Weights(weights) = &mut overlay {
            weights.set(disk.view());
        }
        let mut random = Random::new(5);
        let (mut sum, mut squares) = (0.0, 0.0);
        let draws = 8000;
        for _ in 0..draws {
            // By Parseval, the mean power is the energy under the weights over theirs.
            let energy: f64 = disk.iter().map(|&w| (f64::from(w) * random.normal()).powi(2)).sum();
            let mean = energy * f64::from(overlay.scale());
            sum += mean;
            squares += mean * mean;
        }
        let mean = sum / f64::from(draws);
        let variance = squares / f64::from(draws) - mean * mean;
        // The square of a sum of twelve uniform numbers has the variance 1.9, that of a normal one 2.
        let expected = 1.9 / (overlay.independence() * (rows * columns) as f64);
        // Four standard deviations of the mean and of the variance.
        assert!((mean - 1.0).abs() < 0.004, "{mean}");
        assert!((variance / expected - 1.0).abs() < 0.064, "{variance} not {expected}");
    }
}
