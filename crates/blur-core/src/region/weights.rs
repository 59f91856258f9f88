//! Weights of the pixels well inside a region.

use std::f32::consts::FRAC_PI_2;

use ndarray::{Array2, ArrayView1, ArrayView2, Axis, Slice};

/// Share of the blur that is left out along the border: there the background shows through.
const LEFT_OUT: f32 = 0.5;
/// No more than this share of the region's depth is left out, and the weights rise over this share of the rest.
const MOST_LEFT_OUT: f32 = 0.5;
const TAPER: f32 = 0.6;

/// Weights from 0 at the border of the pixels that have `label`, and at that of the picture, to 1 well inside.
pub(super) fn inside(labels: ArrayView2<'_, u8>, label: u8, length_px: f64) -> Array2<f32> {
    let mut weights = Array2::zeros(labels.dim());
    let is_labelled = |line: ArrayView1<'_, u8>| line.iter().any(|&other| other == label);
    let ends = |axis: Axis| {
        let mut lines = labels.axis_iter(axis).map(is_labelled);
        let first = lines.position(|is_labelled| is_labelled)?;
        Some(first..first + 1 + lines.rposition(|is_labelled| is_labelled).map_or(0, |last| last + 1))
    };
    let (Some(rows), Some(columns)) = (ends(Axis(0)), ends(Axis(1))) else { return weights };
    let (rows, columns) = (Slice::from(rows), Slice::from(columns));
    let mut depth = depth(labels.slice_axis(Axis(0), rows).slice_axis(Axis(1), columns), label);
    let most = depth.iter().copied().fold(0.0, f32::max);
    let out = (LEFT_OUT * length_px as f32).min(MOST_LEFT_OUT * most);
    let rise = (TAPER * (most - out)).max(1.0);
    depth.mapv_inplace(|depth| (FRAC_PI_2 * ((depth - out) / rise).clamp(0.0, 1.0)).sin().powi(2));
    weights.slice_axis_mut(Axis(0), rows).slice_axis_mut(Axis(1), columns).assign(&depth);
    weights
}

/// Distance in pixels of each pixel of the label to the nearest other one, or to what is beyond `labels`.
///
/// *Reference*: G. Borgefors, *Distance transformations in digital images*, Computer Vision, Graphics, and Image
/// Processing 34 (1986) 344: steps of 3 and 4 thirds of a pixel, within 8 % of the Euclidean distance.
fn depth(labels: ArrayView2<'_, u8>, label: u8) -> Array2<f32> {
    const DIAGONAL: f32 = 4.0 / 3.0;
    let (rows, columns) = labels.dim();
    let mut depth = labels.mapv(|other| if other == label { f32::INFINITY } else { 0.0 });
    let at = |depth: &Array2<f32>, row: Option<usize>, column: Option<usize>| {
        row.zip(column).and_then(|place| depth.get(place)).copied().unwrap_or(0.0)
    };
    for row in 0..rows {
        for column in 0..columns {
            let (up, left, right) = (row.checked_sub(1), column.checked_sub(1), Some(column + 1));
            let near = at(&depth, Some(row), left).min(at(&depth, up, Some(column))) + 1.0;
            let far = at(&depth, up, left).min(at(&depth, up, right)) + DIAGONAL;
            depth[(row, column)] = depth[(row, column)].min(near).min(far);
        }
    }
    for row in (0..rows).rev() {
        for column in (0..columns).rev() {
            let (down, left, right) = (Some(row + 1), column.checked_sub(1), Some(column + 1));
            let near = at(&depth, Some(row), right).min(at(&depth, down, Some(column))) + 1.0;
            let far = at(&depth, down, left).min(at(&depth, down, right)) + DIAGONAL;
            depth[(row, column)] = depth[(row, column)].min(near).min(far);
        }
    }
    depth
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_rise_from_the_border_of_a_region_and_are_0_outside() {
        let labels = Array2::from_shape_fn((120, 140), |(r, c)| u8::from(r.abs_diff(60) <= 40 && c.abs_diff(70) <= 50));
        let weights = inside(labels.view(), 1, 20.0);
        // 10 pixels are left out; the middle is 41 deep.
        for ((row, column), &weight) in weights.indexed_iter() {
            let deep = (41.0 - (row as f32 - 60.0).abs()).min(51.0 - (column as f32 - 70.0).abs());
            assert!((0.0..=1.0).contains(&weight));
            if deep <= 10.0 {
                assert_eq!(weight, 0.0, "{row} {column}");
            }
        }
        assert_eq!(weights[(60, 70)], 1.0);
        assert!((weights[(60, 130 - 20)] - weights[(60, 30)]).abs() < 1e-6);
        assert!(weights[(60, 40)] > weights[(60, 35)]);
    }

    #[test]
    fn the_border_of_the_picture_is_one_too() {
        let weights = inside(Array2::from_elem((80, 90), 3).view(), 3, 10.0);
        assert!(weights.row(0).iter().chain(weights.column(89)).all(|&weight| weight == 0.0));
        assert_eq!(weights[(40, 45)], 1.0);
    }
}
