//! What the methods are timed on.

use blur_core::estimate::AxialAngle;
use blur_sim::expose::expose;
use blur_sim::motion::Motion;
use blur_sim::scene::{DeadLeaves, dead_leaves};
use blur_sim::sensor::{Sensor, f32_from_u8};
use ndarray::Array2;

/// Direction of the motion in degrees.
pub const ANGLE_DEG: f64 = 30.0;
/// Length of the blur in pixels.
pub const LENGTH_PX: f64 = 24.5;
const PSNR_DB: f64 = 36.0;
const SEED: u64 = 1;

/// A blurred 8-bit picture of `side` x `side` pixels.
///
/// # Errors
/// [`blur_sim::Error::Size`] for a side of 0 or beyond what the simulation makes.
pub fn blurred_picture(side: usize) -> blur_sim::Result<Array2<f32>> {
    blurred_frame((side, side))
}

/// A blurred 8-bit picture of so many rows and columns.
///
/// # Errors
/// As for [`blurred_picture`].
pub fn blurred_frame(size: (usize, usize)) -> blur_sim::Result<Array2<f32>> {
    frame(size, LENGTH_PX, SEED)
}

/// The scene of [`blurred_picture`], sharp and with noise of its own.
///
/// # Errors
/// As for [`blurred_picture`].
pub fn sharp_picture(side: usize) -> blur_sim::Result<Array2<f32>> {
    frame((side, side), 0.0, SEED + 1)
}

/// The middle of the scene, moved by `length_px` to either side of where the sharp picture shows it.
fn frame((height, width): (usize, usize), length_px: f64, noise_seed: u64) -> blur_sim::Result<Array2<f32>> {
    // The scene is as large for a sharp picture as for a blurred one: it is the same.
    let (rows, columns) = Motion::uniform(LENGTH_PX, AxialAngle::from_deg(ANGLE_DEG))?.extent_px();
    let scene = dead_leaves(SEED, height + rows, width + columns, &DeadLeaves::default())?;
    let motion = Motion::uniform(length_px, AxialAngle::from_deg(ANGLE_DEG))?;
    let exposure = expose(scene.view(), &motion)?;
    let (top, left) = ((exposure.nrows() - height) / 2, (exposure.ncols() - width) / 2);
    let middle = Array2::from_shape_fn((height, width), |(row, column)| exposure[[row + top, column + left]]);
    let picture = Sensor::ideal().with_psnr_db(PSNR_DB)?.record(middle.view(), noise_seed)?;
    Ok(f32_from_u8(picture.view()))
}
