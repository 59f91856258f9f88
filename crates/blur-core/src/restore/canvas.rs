//! The picture with a margin around which everything is periodic, and its filters.

use std::f64::consts::PI;

use ndarray::{Array2, ArrayView2};
use rustfft::num_complex::Complex32;

use crate::spectrum::{Dft2, InverseDft2, fast_size};

/// A picture in the top left corner of a larger periodic one. The margin, right and below, is wide enough that no blurred
/// pixel of the picture sees its other side.
#[derive(Debug)]
pub(super) struct Canvas {
    layout: Layout,
    forward: Dft2,
    inverse: InverseDft2,
}

/// The sizes of the picture and of the whole, rows and columns.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    pub(super) picture: (usize, usize),
    pub(super) whole: (usize, usize),
}

/// Margin beyond the extent of the blur in pixels, for the scene to come round smoothly.
const ROOM_PX: usize = 16;

impl Canvas {
    /// For pictures of `rows` x `columns` pixels and blurs of `extent` rows and columns.
    pub(super) fn new(picture: (usize, usize), extent: (usize, usize)) -> Self {
        let rows = fast_size(picture.0 + extent.0 + ROOM_PX);
        let columns = fast_size(picture.1 + extent.1 + ROOM_PX);
        let layout = Layout { picture, whole: (rows, columns) };
        Self { layout, forward: Dft2::new(rows, columns), inverse: InverseDft2::new(rows, columns) }
    }

    /// Where the picture and its margin are.
    pub(super) fn layout(&self) -> Layout {
        self.layout
    }

    /// What is filtered next.
    pub(super) fn input(&mut self) -> &mut Array2<f32> {
        self.forward.input()
    }

    /// The input, which is destroyed, with each bin of its half spectrum changed by `response(index, bin)`.
    pub(super) fn filter(&mut self, response: impl Fn(usize, Complex32) -> Complex32) -> ArrayView2<'_, f32> {
        let spectrum = self.forward.transform();
        for (index, (out, &bin)) in self.inverse.input().iter_mut().zip(spectrum).enumerate() {
            *out = response(index, bin);
        }
        self.inverse.transform()
    }

    /// The half spectrum of the input, which is destroyed.
    pub(super) fn spectrum(&mut self) -> ArrayView2<'_, Complex32> {
        self.forward.transform()
    }

    /// The frequencies in cycles per pixel of all bins of the half spectrum, `u` along columns and `v` down.
    pub(super) fn frequencies(&self) -> impl Iterator<Item = (f64, f64)> + use<> {
        let (rows, columns) = self.layout.whole;
        (0..rows).flat_map(move |row| {
            let signed = if row <= rows / 2 { row as f64 } else { row as f64 - rows as f64 };
            (0..=columns / 2).map(move |column| (column as f64 / columns as f64, signed / rows as f64))
        })
    }

    /// Lays `picture - level` on the input, with zeros in the margin.
    pub(super) fn lay(&mut self, picture: ArrayView2<'_, f32>, level: f32) {
        let input = self.forward.input();
        input.fill(0.0);
        for (mut out, pixels) in input.rows_mut().into_iter().zip(picture.rows()) {
            out.iter_mut().zip(pixels).for_each(|(out, &pixel)| *out = pixel - level);
        }
    }

    /// Fills the margin of the input by the picture's reflections, one passing smoothly into the other.
    pub(super) fn reflect(&mut self) {
        let Layout { picture: (height, width), whole: (rows, columns) } = self.layout;
        let input = self.forward.input();
        for mut row in input.rows_mut().into_iter().take(height) {
            for column in width..columns {
                let (after, before, share) = sources(column, width, columns);
                row[column] = row[after] + share * (row[before] - row[after]);
            }
        }
        for row in height..rows {
            let (after, before, share) = sources(row, height, rows);
            for column in 0..columns {
                let (a, b) = (input[[after, column]], input[[before, column]]);
                input[[row, column]] = a + share * (b - a);
            }
        }
    }
}

impl Layout {
    /// Pixels of the margin.
    pub(super) fn margin_len(self) -> usize {
        self.whole.0 * self.whole.1 - self.picture.0 * self.picture.1
    }

    /// First column of the margin in a row.
    fn first(self, row: usize) -> usize {
        if row < self.picture.0 { self.picture.1 } else { 0 }
    }

    /// Writes `values` into the margin of `whole`.
    pub(super) fn write_margin(self, whole: &mut Array2<f32>, values: &[f32]) {
        let mut values = values.iter();
        for (row, mut pixels) in whole.rows_mut().into_iter().enumerate() {
            pixels.iter_mut().skip(self.first(row)).zip(&mut values).for_each(|(pixel, &value)| *pixel = value);
        }
    }

    /// Reads the margin of `whole` into `values`.
    pub(super) fn read_margin(self, whole: ArrayView2<'_, f32>, values: &mut [f32]) {
        let mut values = values.iter_mut();
        for (row, pixels) in whole.rows().into_iter().enumerate() {
            pixels.iter().skip(self.first(row)).zip(&mut values).for_each(|(&pixel, value)| *value = pixel);
        }
    }
}

/// What a pixel at `i` of the margin between `n` and `period` is made of: the reflection at the end, that at the begin,
/// and the share of the latter.
fn sources(i: usize, n: usize, period: usize) -> (usize, usize, f32) {
    let reflected = |k: usize| {
        let k = k % (2 * n);
        if k < n { k } else { 2 * n - 1 - k }
    };
    let t = ((i - n) as f64 + 0.5) / (period - n) as f64;
    (reflected(i), reflected(period - 1 - i), (0.5 - 0.5 * (PI * t).cos()) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_margin_comes_round_without_a_step() {
        // A ramp: its own period would jump by 10.
        let mut canvas = Canvas::new((40, 50), (9, 0));
        let picture = Array2::from_shape_fn((40, 50), |(r, c)| (r + c) as f32);
        canvas.lay(picture.view(), 3.0);
        canvas.reflect();
        let whole = canvas.input().clone();
        assert_eq!((whole[[0, 0]], whole[[39, 49]]), (-3.0, 85.0));
        let (rows, columns) = whole.dim();
        assert!(rows >= 40 + 9 + ROOM_PX && columns >= 50 + ROOM_PX);
        for r in 0..rows {
            for c in 0..columns {
                let (right, below) = (whole[[r, (c + 1) % columns]], whole[[(r + 1) % rows, c]]);
                assert!((right - whole[[r, c]]).abs() < 6.0 && (below - whole[[r, c]]).abs() < 5.0, "{r} {c}");
            }
        }
    }

    #[test]
    fn what_is_written_into_the_margin_is_read_from_it_and_the_picture_stays() {
        let layout = Layout { picture: (3, 4), whole: (5, 6) };
        let values: Vec<f32> = (1..=18).map(|k| k as f32).collect();
        assert_eq!(layout.margin_len(), values.len());
        let mut whole = Array2::from_elem(layout.whole, -1.0);
        layout.write_margin(&mut whole, &values);
        let mut read = vec![0.0; values.len()];
        layout.read_margin(whole.view(), &mut read);
        assert_eq!(read, values);
        assert_eq!(whole.iter().filter(|&&x| x == -1.0).count(), 12);
        assert_eq!((whole[[2, 3]], whole[[2, 4]], whole[[3, 0]]), (-1.0, 5.0, 7.0));
    }

    #[test]
    fn an_all_pass_filter_changes_nothing() {
        let mut canvas = Canvas::new((33, 47), (5, 7));
        let picture = Array2::from_shape_fn((33, 47), |(r, c)| ((r * 31 + c * 17) % 23) as f32);
        canvas.lay(picture.view(), 0.0);
        let out = canvas.filter(|_, bin| bin);
        for ((r, c), &pixel) in picture.indexed_iter() {
            assert!((out[[r, c]] - pixel).abs() < 1e-4);
        }
    }

    #[test]
    fn lengths_have_small_factors() {
        assert_eq!([33, 97, 1025, 4159].map(fast_size), [36, 100, 1080, 4320]);
    }
}
