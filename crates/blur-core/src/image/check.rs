//! What every estimator demands of a picture.

use ndarray::{ArrayView1, ArrayView2};

use crate::{Error, Result};

/// Least number of rows and of columns of a picture: below it no method has spectrum enough to work on.
pub const MIN_SIDE: usize = 32;

/// Checks that a picture is large enough, finite and not constant.
pub fn check(image: ArrayView2<'_, f32>) -> Result<()> {
    let (height, width) = image.dim();
    if height < MIN_SIDE || width < MIN_SIDE {
        return Err(Error::TooSmall { width, height, min: MIN_SIDE });
    }
    check_pixels(image)
}

/// Checks that a picture is finite and not constant, whatever its size; a picture without pixels is constant.
pub fn check_pixels(image: ArrayView2<'_, f32>) -> Result<()> {
    // Without an early exit, so that rows are looked at many pixels at a time.
    let bad_row = |row: ArrayView1<'_, f32>| match row.as_slice() {
        Some(row) => row.iter().fold(false, |bad, pixel| bad | !pixel.is_finite()),
        None => row.iter().any(|pixel| !pixel.is_finite()),
    };
    for (row, pixels) in image.rows().into_iter().enumerate() {
        if bad_row(pixels)
            && let Some((column, &value)) = pixels.iter().enumerate().find(|(_, pixel)| !pixel.is_finite())
        {
            return Err(Error::NotFinite { row, column, value });
        }
    }
    let first = image.first().copied().unwrap_or_default();
    if image.iter().all(|&p| p == first) {
        return Err(Error::Constant { value: first });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use super::*;

    #[test]
    fn the_offending_pixel_is_named() {
        let mut picture = Array2::from_shape_fn((40, 50), |(r, c)| (r * c) as f32);
        assert_eq!(check(picture.view()), Ok(()));
        picture[[7, 9]] = f32::INFINITY;
        assert_eq!(check(picture.view()), Err(Error::NotFinite { row: 7, column: 9, value: f32::INFINITY }));
        picture[[7, 9]] = f32::NAN;
        assert!(matches!(check(picture.view()), Err(Error::NotFinite { row: 7, column: 9, .. })));
    }

    #[test]
    fn extreme_but_finite_pixels_pass() {
        let picture = Array2::from_shape_fn((32, 32), |(r, _)| if r % 2 == 0 { f32::MAX } else { f32::MIN });
        assert_eq!(check(picture.view()), Ok(()));
    }

    #[test]
    fn strips_and_constant_pictures_are_refused() {
        let strip = Array2::<f32>::zeros((20, 20_000));
        assert_eq!(check(strip.view()), Err(Error::TooSmall { width: 20_000, height: 20, min: 32 }));
        let grey = Array2::from_elem((64, 64), 128.0_f32);
        assert_eq!(check(grey.view()), Err(Error::Constant { value: 128.0 }));
    }
}
