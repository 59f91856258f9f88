//! Sinusoids, whose blur is known in closed form.

use crate::motion::Motion;
use crate::{Result, check};
use ndarray::Array2;
use std::f64::consts::TAU;

/// A sinusoid `amplitude cos(2 pi (u x + v y) + phase)` with `x` the column and `y` the row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneWave {
    /// Amplitude in grey levels.
    pub amplitude: f64,
    /// Cycles per pixel along the columns' numbers.
    pub u: f64,
    /// Cycles per pixel along the rows' numbers (downwards).
    pub v: f64,
    /// Phase at row 0, column 0 in radians.
    pub phase_rad: f64,
}

impl PlaneWave {
    /// Value at column `x`, row `y`; both may lie between pixels.
    pub fn at(&self, x: f64, y: f64) -> f64 {
        self.amplitude * libm::cos(TAU * (self.u * x + self.v * y) + self.phase_rad)
    }

    /// The wave that an exposure makes of this one: amplitude times `|H|`, phase plus `arg H`.
    #[must_use]
    pub fn exposed(&self, motion: &Motion) -> Self {
        let transfer = motion.transfer(motion.frequency_along(self.u, self.v));
        let turn = libm::atan2(transfer.im, transfer.re);
        let gain = libm::hypot(transfer.re, transfer.im);
        Self { amplitude: self.amplitude * gain, phase_rad: self.phase_rad + turn, ..*self }
    }
}

/// The sum of `waves` and a constant `offset` in grey levels on `rows` x `cols` pixels (1 to 32768 each).
///
/// # Errors
/// [`Error::Size`](crate::Error::Size) out of this range; [`Error::NotFinite`](crate::Error::NotFinite) when a wave or
/// the offset is no number.
pub fn plane_waves(rows: usize, cols: usize, offset: f64, waves: &[PlaneWave]) -> Result<Array2<f64>> {
    check::size(rows, cols)?;
    let scene = Array2::from_shape_fn((rows, cols), |(row, col)| {
        offset + waves.iter().map(|wave| wave.at(col as f64, row as f64)).sum::<f64>()
    });
    check::finite(scene.view())?;
    Ok(scene)
}
