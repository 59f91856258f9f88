//! Bands of printed bars.

use crate::rng::Rng;
use crate::{Result, check};
use ndarray::Array2;

/// Stream of the seed.
const STREAM: u64 = 0x5ce0_0003;

/// Bars side by side in bands one below the other, as in printed bar codes, each bar of a grey level of its own.
///
/// Sizes and levels are uniform between their bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bars {
    /// Width of the narrowest bar in pixels, at least 1.
    pub width_min_px: f64,
    /// Width of the widest bar in pixels, at least the narrowest and at most 1e5.
    pub width_max_px: f64,
    /// Height of the lowest band in pixels, at least 1.
    pub height_min_px: f64,
    /// Height of the highest band in pixels, at least the lowest and at most 1e5.
    pub height_max_px: f64,
    /// Darkest bar, 0 to 255.
    pub grey_min: f64,
    /// Brightest bar, `grey_min` to 255.
    pub grey_max: f64,
}

impl Default for Bars {
    /// Bars 2 to 30 pixels wide in bands 8 to 50 pixels high, grey levels from 15 to 240.
    fn default() -> Self {
        Self {
            width_min_px: 2.0,
            width_max_px: 30.0,
            height_min_px: 8.0,
            height_max_px: 50.0,
            grey_min: 15.0,
            grey_max: 240.0,
        }
    }
}

impl Bars {
    fn check(&self) -> Result<()> {
        check::range("least width of a bar in px", self.width_min_px, 1.0, 1e5, "1 to 1e5")?;
        check::range("greatest width of a bar in px", self.width_max_px, self.width_min_px, 1e5, "the least to 1e5")?;
        check::range("least height of a band in px", self.height_min_px, 1.0, 1e5, "1 to 1e5")?;
        let least = self.height_min_px;
        check::range("greatest height of a band in px", self.height_max_px, least, 1e5, "the least to 1e5")?;
        check::range("darkest grey level", self.grey_min, 0.0, 255.0, "0 to 255")?;
        check::range("brightest grey level", self.grey_max, self.grey_min, 255.0, "the darkest to 255")?;
        Ok(())
    }
}

/// A picture of `rows` x `cols` pixels (1 to 32768 each) of bars, the same for a seed on every machine.
///
/// Edges are two pixels wide, as a lens and a pixel give together: the samples are nearly free of aliasing.
///
/// # Errors
/// [`Error::Size`](crate::Error::Size) and [`Error::Parameter`](crate::Error::Parameter) for values out of the ranges
/// above.
pub fn bars(seed: u64, rows: usize, cols: usize, bars: &Bars) -> Result<Array2<f64>> {
    check::size(rows, cols)?;
    bars.check()?;
    let mut rng = Rng::new(seed, STREAM);
    // One pixel more on every side for the soft edges.
    let mut sharp = Array2::zeros((rows + 2, cols + 2));
    let mut bottom = 0.0;
    let mut band = Vec::new();
    for (row, mut pixels) in sharp.rows_mut().into_iter().enumerate() {
        if row as f64 >= bottom {
            bottom += rng.uniform_in(bars.height_min_px, bars.height_max_px);
            band = one_band(&mut rng, cols + 2, bars);
        }
        pixels.assign(&ndarray::aview1(&band));
    }
    Ok(Array2::from_shape_fn((rows, cols), |(row, col)| {
        let across = |row: usize| 0.25 * (sharp[[row, col]] + 2.0 * sharp[[row, col + 1]] + sharp[[row, col + 2]]);
        0.25 * (across(row) + 2.0 * across(row + 1) + across(row + 2))
    }))
}

fn one_band(rng: &mut Rng, cols: usize, bars: &Bars) -> Vec<f64> {
    let mut right = 0.0;
    let mut grey = 0.0;
    let pixel = |col: usize| {
        if col as f64 >= right {
            right += rng.uniform_in(bars.width_min_px, bars.width_max_px);
            grey = rng.uniform_in(bars.grey_min, bars.grey_max);
        }
        grey
    };
    (0..cols).map(pixel).collect()
}
