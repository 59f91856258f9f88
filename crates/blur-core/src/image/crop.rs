//! Regions of a picture.

use ndarray::{ArrayView2, Axis, Slice};

use crate::{Error, Result};

/// A rectangle of whole pixels: column `x`, row `y` of its top left corner, and its size.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Region {
    /// Left column.
    pub x: usize,
    /// Top row.
    pub y: usize,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

impl Region {
    /// The part of `image` inside the region; an error when the region does not lie inside the picture.
    pub fn of(self, image: ArrayView2<'_, f32>) -> Result<ArrayView2<'_, f32>> {
        let (image_height, image_width) = image.dim();
        let Self { x, y, width, height } = self;
        let inside = |start: usize, length: usize, end: usize| {
            length > 0 && start.checked_add(length).is_some_and(|stop| stop <= end)
        };
        if inside(x, width, image_width) && inside(y, height, image_height) {
            Ok(rectangle(image, y, x, height, width))
        } else {
            Err(Error::RegionOutside { x, y, width, height, image_width, image_height })
        }
    }
}

/// The largest square at the centre of a picture, of at most `side` pixels.
pub fn centre_square(image: ArrayView2<'_, f32>, side: usize) -> ArrayView2<'_, f32> {
    let (rows, columns) = image.dim();
    let n = side.min(rows).min(columns);
    let (top, left) = ((rows - n) / 2, (columns - n) / 2);
    rectangle(image, top, left, n, n)
}

fn rectangle(
    mut image: ArrayView2<'_, f32>,
    top: usize,
    left: usize,
    rows: usize,
    columns: usize,
) -> ArrayView2<'_, f32> {
    image.slice_axis_inplace(Axis(0), Slice::from(top..top + rows));
    image.slice_axis_inplace(Axis(1), Slice::from(left..left + columns));
    image
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use super::*;

    #[test]
    fn a_region_is_counted_from_the_top_left() {
        let picture = Array2::from_shape_fn((40, 60), |(r, c)| (100 * r + c) as f32);
        let part = Region { x: 3, y: 5, width: 10, height: 4 }.of(picture.view()).unwrap();
        assert_eq!(part.dim(), (4, 10));
        assert_eq!(part[[0, 0]], 503.0);
    }

    #[test]
    fn regions_outside_are_refused_without_overflow() {
        let picture = Array2::<f32>::zeros((40, 60));
        for (x, y, width, height) in [(60, 0, 1, 1), (0, 0, 61, 1), (0, 0, 0, 5), (usize::MAX, 0, 2, 1)] {
            let error = Region { x, y, width, height }.of(picture.view()).unwrap_err();
            assert!(matches!(error, Error::RegionOutside { image_width: 60, image_height: 40, .. }), "{error}");
        }
    }

    #[test]
    fn the_centre_square_is_centred() {
        let picture = Array2::from_shape_fn((40, 61), |(r, c)| (100 * r + c) as f32);
        assert_eq!(centre_square(picture.view(), 512).dim(), (40, 40));
        assert_eq!(centre_square(picture.view(), 20)[[0, 0]], 1020.0);
    }
}
