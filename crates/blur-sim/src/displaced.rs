//! A blur somewhere else: the same exposure, with everything moved over the sensor.

use crate::expose::Blur;
use crate::{Result, check};
use rustfft::num_complex::Complex;
use std::f64::consts::TAU;

/// Farthest displacement in pixels.
const MAX_PX: f64 = 1e6;

/// A [`Blur`] and a displacement of the picture by `right_px` along its rows and `down_px` along its columns.
///
/// The displacement is exact at any fraction of a pixel: a factor `exp(-2 pi i (u right + v down))` on the transfer
/// function (the shift theorem). A [`Motion`](crate::motion::Motion) is centred on its path; displaced by half the
/// path it begins where the scene lies, and a motion of length 0 displaced by a fraction of a pixel is a sharp picture
/// that is not aligned with the scene.
///
/// ```
/// use blur_core::estimate::AxialAngle;
/// use blur_sim::{displaced::Displaced, expose::expose, motion::Motion, scene::DeadLeaves, scene::dead_leaves};
/// # fn main() -> blur_sim::Result<()> {
/// let from_the_scene_to_the_right =
///     Displaced::new(Motion::uniform(12.0, AxialAngle::from_deg(0.0))?, 6.0, 0.0)?;
/// let scene = dead_leaves(1, 100, 150 + 12 + 2 * 6, &DeadLeaves::default())?;
/// assert_eq!(expose(scene.view(), &from_the_scene_to_the_right)?.dim(), (100, 150));
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Displaced<B> {
    blur: B,
    right_px: f64,
    down_px: f64,
}

impl<B: Blur> Displaced<B> {
    /// `blur` with the picture displaced by -1e6 to 1e6 pixels each way.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) out of the range.
    pub fn new(blur: B, right_px: f64, down_px: f64) -> Result<Self> {
        check::range("displacement to the right in px", right_px, -MAX_PX, MAX_PX, "-1e6 to 1e6")?;
        check::range("displacement downwards in px", down_px, -MAX_PX, MAX_PX, "-1e6 to 1e6")?;
        Ok(Self { blur, right_px, down_px })
    }
}

impl<B: Blur> Blur for Displaced<B> {
    /// That of the blur, and the displacement on either side: the middle of the scene stays where it is.
    fn extent_px(&self) -> (usize, usize) {
        let (rows, cols) = self.blur.extent_px();
        // As for a motion, an integer but for its rounding counts as that integer.
        let both_sides = |px: f64| 2 * (px.abs() - 1e-9).ceil().max(0.0) as usize;
        (rows + both_sides(self.down_px), cols + both_sides(self.right_px))
    }

    fn gain(&self, uses: usize) -> impl Fn(f64, f64) -> Complex<f64> {
        let in_place = self.blur.gain(uses);
        move |u, v| {
            let (sin, cos) = libm::sincos(-TAU * (u * self.right_px + v * self.down_px));
            in_place(u, v) * Complex::new(cos, sin)
        }
    }
}
