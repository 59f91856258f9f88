//! What every entry point asks of its pictures.

use crate::{Error, Result};
use ndarray::ArrayView2;

/// Greatest number of rows and of columns of a scene: every product of sides then fits, padding included.
pub(crate) const MAX_SIDE: usize = 32_768;

/// The size is between 1 and [`MAX_SIDE`] each way.
pub(crate) fn size(rows: usize, cols: usize) -> Result<()> {
    size_within(rows, cols, 1, MAX_SIDE)
}

/// The size is between `min` and `max` each way.
pub(crate) fn size_within(rows: usize, cols: usize, min: usize, max: usize) -> Result<()> {
    let fits = |side: usize| (min..=max).contains(&side);
    if fits(rows) && fits(cols) { Ok(()) } else { Err(Error::Size { rows, cols, min, max }) }
}

/// Every pixel is a finite number.
pub(crate) fn finite(picture: ArrayView2<'_, f64>) -> Result<()> {
    match picture.indexed_iter().find(|(_, value)| !value.is_finite()) {
        Some(((row, col), &value)) => Err(Error::NotFinite { row, col, value }),
        None => Ok(()),
    }
}

/// `value` lies in `min..=max`; NaN does not.
pub(crate) fn range(name: &'static str, value: f64, min: f64, max: f64, expected: &'static str) -> Result<f64> {
    if value >= min && value <= max { Ok(value) } else { Err(Error::Parameter { name, value, expected }) }
}
