//! A rolling shutter: every row is exposed at its own time.

use crate::scene::PlaneWave;
use crate::{Result, check};
use ndarray::Array2;
use std::f64::consts::TAU;

/// A motion under a rolling shutter. Times are in exposures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RollingMotion {
    /// Pixels that the content moves to the right during the exposure of the first row.
    pub right_px: f64,
    /// Pixels that it moves down.
    pub down_px: f64,
    /// Time from the start of one row's exposure to that of the next row below, relative to the exposure.
    pub row_time: f64,
    /// By what part of the first row's speed the speed rises from each exposure to the next.
    pub speed_gain: f64,
}

/// The picture of `rows` x `cols` pixels (1 to 32768 each) of the sum of `waves` and `offset`, in grey levels: row `y`
/// is the time average from `y row_time` to `y row_time + 1` of the moving scene, in closed form: exact for a uniform motion;
/// otherwise the speed of the middle of a row's exposure stands for all of it, which misplaces its ends by an eighth of what
/// it gains meanwhile.
///
/// # Errors
/// [`Error::Size`](crate::Error::Size) out of this range; [`Error::NotFinite`](crate::Error::NotFinite) when a wave, the
/// offset or the motion is no number.
pub fn expose_rows(
    (rows, cols): (usize, usize),
    offset: f64,
    waves: &[PlaneWave],
    motion: &RollingMotion,
) -> Result<Array2<f64>> {
    check::size(rows, cols)?;
    let RollingMotion { right_px, down_px, row_time, speed_gain } = *motion;
    let mut picture = Array2::from_elem((rows, cols), offset);
    for wave in waves {
        // Turns that a fixed pixel sees the wave go back during one exposure.
        let turns = wave.u * right_px + wave.v * down_px;
        let (step_sin, step_cos) = libm::sincos(TAU * wave.u);
        for (row, mut pixels) in picture.rows_mut().into_iter().enumerate() {
            // After the middle of the first row's exposure, when the speed is that of the motion.
            let after = row as f64 * row_time;
            let moved = 0.5 + after * (1.0 + 0.5 * speed_gain * after);
            let shifted = PlaneWave {
                amplitude: wave.amplitude * blur_core::psf::sinc(turns * (1.0 + speed_gain * after)),
                phase_rad: wave.phase_rad - TAU * turns * moved,
                ..*wave
            };
            // From pixel to pixel the wave turns by the same angle: a product is faster than a cosine.
            let (mut sin, mut cos) = libm::sincos(TAU * shifted.v * row as f64 + shifted.phase_rad);
            for pixel in &mut pixels {
                *pixel += shifted.amplitude * cos;
                (sin, cos) = (sin * step_cos + cos * step_sin, cos * step_cos - sin * step_sin);
            }
        }
    }
    check::finite(picture.view())?;
    Ok(picture)
}
