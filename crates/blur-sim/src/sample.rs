//! The sample picture that comes with the program, and its truth.

use crate::Result;
use crate::expose::expose;
use crate::motion::Motion;
use crate::scene::{DeadLeaves, dead_leaves};
use crate::sensor::Sensor;
use blur_core::estimate::AxialAngle;
use ndarray::Array2;

/// Rows and columns of the sample.
pub const SIDE_PX: usize = 512;
/// Direction of its motion in degrees, counter-clockwise from +x as seen.
pub const ANGLE_DEG: f64 = 30.0;
/// Length of its uniform blur in pixels.
pub const LENGTH_PX: f64 = 24.5;
/// Peak signal-to-noise ratio of its noise in dB, before rounding.
pub const PSNR_DB: f64 = 36.0;
/// Seed of its scene and its noise.
pub const SEED: u64 = 1;

/// The motion of the sample.
///
/// # Errors
/// None for the constants above; those of [`Motion::new`] otherwise.
pub fn sample_motion() -> Result<Motion> {
    Motion::uniform(LENGTH_PX, AxialAngle::from_deg(ANGLE_DEG))
}

/// The sample: a dead-leaves scene, moved during the exposure by [`sample_motion`], with noise of [`PSNR_DB`], eight
/// bits.
///
/// # Errors
/// None for the constants above.
pub fn sample_picture() -> Result<Array2<u8>> {
    let motion = sample_motion()?;
    let (rows, cols) = motion.extent_px();
    let scene = dead_leaves(SEED, SIDE_PX + rows, SIDE_PX + cols, &DeadLeaves::default())?;
    let exposure = expose(scene.view(), &motion)?;
    Sensor::ideal().with_psnr_db(PSNR_DB)?.record(exposure.view(), SEED)
}
