//! Smoothing, halving and reading between pixels.

use nalgebra::Vector2;
use ndarray::{Array1, Array2, ArrayView2, Axis, Zip};

/// A Gaussian reaches so many standard deviations.
const REACH: f64 = 3.0;

/// The picture under a Gaussian of standard deviation `sigma_px`; the border is repeated outwards.
pub(super) fn gaussian(picture: ArrayView2<'_, f32>, sigma_px: f64) -> Array2<f32> {
    let reach = (REACH * sigma_px).ceil() as isize;
    let weights: Vec<f32> = (-reach..=reach).map(|i| (-0.5 * (i as f64 / sigma_px).powi(2)).exp() as f32).collect();
    let sum: f32 = weights.iter().sum();
    let weights: Vec<f32> = weights.iter().map(|w| w / sum).collect();
    let mut smooth = picture.to_owned();
    for axis in [Axis(0), Axis(1)] {
        for mut lane in smooth.lanes_mut(axis) {
            let source: Array1<f32> = lane.to_owned();
            let last = source.len() as isize - 1;
            for (at, value) in lane.iter_mut().enumerate() {
                *value = (-reach..=reach)
                    .zip(&weights)
                    .map(|(offset, weight)| weight * source[(at as isize + offset).clamp(0, last) as usize])
                    .sum();
            }
        }
    }
    smooth
}

/// The picture at half the size: means of two by two pixels. Its pixel `x` is at `2 x + 0.5` of the picture.
pub(super) fn halved(picture: ArrayView2<'_, f32>) -> Array2<f32> {
    let (rows, columns) = (picture.nrows() / 2, picture.ncols() / 2);
    let mut half = Array2::zeros((rows, columns));
    Zip::from(&mut half).and(picture.exact_chunks((2, 2))).for_each(|mean: &mut f32, four| *mean = 0.25 * four.sum());
    half
}

/// The value at `(u, v)`, linear between pixels; `None` outside of the picture.
pub(super) fn at(picture: ArrayView2<'_, f32>, point: Vector2<f64>) -> Option<f64> {
    let (left, top) = (point.x.floor(), point.y.floor());
    if !(left >= 0.0 && top >= 0.0) {
        return None;
    }
    let (x, y) = (point.x - left, point.y - top);
    let (column, row) = (left as usize, top as usize);
    let value = |down: usize, right: usize| picture.get([row + down, column + right]).map(|&v| f64::from(v));
    let upper = value(0, 0)? * (1.0 - x) + value(0, 1)? * x;
    let lower = value(1, 0)? * (1.0 - x) + value(1, 1)? * x;
    Some(upper * (1.0 - y) + lower * y)
}

/// Means over the squares of `2 reach + 1` pixels a side around each pixel, as far as they lie in the picture.
pub(super) fn box_mean(picture: ArrayView2<'_, f32>, reach: usize) -> Array2<f32> {
    let (rows, columns) = picture.dim();
    // Sums of all pixels above and left: differences of four give the sum over any box.
    let mut sums = Array2::<f64>::zeros((rows + 1, columns + 1));
    for v in 0..rows {
        let mut row = 0.0;
        for u in 0..columns {
            row += f64::from(picture[[v, u]]);
            sums[[v + 1, u + 1]] = sums[[v, u + 1]] + row;
        }
    }
    Array2::from_shape_fn((rows, columns), |(v, u)| {
        let (top, bottom) = (v.saturating_sub(reach), (v + reach + 1).min(rows));
        let (left, right) = (u.saturating_sub(reach), (u + reach + 1).min(columns));
        let sum = sums[[bottom, right]] - sums[[top, right]] - sums[[bottom, left]] + sums[[top, left]];
        (sum / ((bottom - top) * (right - left)) as f64) as f32
    })
}
