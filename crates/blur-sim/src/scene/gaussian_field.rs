//! Gaussian random fields with a power-law spectrum.

use crate::rng::Rng;
use crate::transform::{Filter, Planners, fast_size};
use crate::{Result, check};
use ndarray::Array2;
use rustfft::num_complex::Complex;

/// Stream of the seed.
const STREAM: u64 = 0x5ce0_0002;

/// Mean grey level of every field.
pub const FIELD_MEAN: f64 = 127.5;
/// Standard deviation of the grey levels of every field.
pub const FIELD_STD: f64 = 40.0;

/// A Gaussian random field of `rows` x `cols` pixels (2 to 16384 each) whose power spectrum falls as `f^-exponent`
/// in every direction.
///
/// `exponent` is 0 (white noise) to 6; photographs have about 2 to 2.4. The field is cut from one at least twice as
/// large each way, so that it does not wrap around. It is scaled to [`FIELD_MEAN`] and [`FIELD_STD`]; the few values
/// outside 0..255 are kept, since clipping would change the spectrum.
///
/// # Errors
/// [`Error::Size`](crate::Error::Size) and [`Error::Parameter`](crate::Error::Parameter) out of these ranges.
///
/// *Reference*: Field, *Relations between the statistics of natural images and the response properties of cortical
/// cells*, JOSA A 4 (1987) 2379.
pub fn gaussian_field(seed: u64, rows: usize, cols: usize, exponent: f64) -> Result<Array2<f64>> {
    check::size_within(rows, cols, 2, check::MAX_SIDE / 2)?;
    check::range("exponent of the power spectrum", exponent, 0.0, 6.0, "0 to 6")?;
    let (all_rows, all_cols) = (fast_size(2 * rows), fast_size(2 * cols));
    let mut rng = Rng::new(seed, STREAM);
    let mut field: Vec<f64> = (0..all_rows * all_cols).map(|_| rng.gaussian()).collect();
    Filter::new(&mut Planners::new(), all_rows, all_cols).apply(&mut field, |u, v| {
        let square = u * u + v * v;
        let gain = if square > 0.0 { libm::pow(square, -0.25 * exponent) } else { 0.0 };
        Complex::new(gain, 0.0)
    })?;
    let cut = Array2::from_shape_fn((rows, cols), |(row, col)| field[row * all_cols + col]);
    Ok(scaled(cut))
}

fn scaled(mut field: Array2<f64>) -> Array2<f64> {
    let count = field.len() as f64;
    let mean = field.iter().sum::<f64>() / count;
    field -= mean;
    let std = (field.iter().map(|x| x * x).sum::<f64>() / count).sqrt();
    let scale = if std > 0.0 { FIELD_STD / std } else { 0.0 };
    field.mapv_inplace(|x| FIELD_MEAN + scale * x);
    field
}
