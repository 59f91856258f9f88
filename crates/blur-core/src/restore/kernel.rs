//! The blur to undo.

use rustfft::num_complex::Complex64;

use crate::estimate::{Acceleration, MotionBlur, Status};
use crate::psf::{AcceleratedBlur, sinc};
use crate::{Error, Result};

/// The blur of a motion along a line, as its exact transfer function: any length, any angle, uniform or accelerated.
///
/// The middle of the path is the origin, so undoing the blur moves nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineBlur {
    length_px: f64,
    /// Direction of the motion in (column, row), a unit vector.
    direction: (f64, f64),
    /// `None` for a uniform motion.
    accelerated: Option<AcceleratedBlur>,
}

impl LineBlur {
    /// A uniform motion over `length_px` pixels, more than 0, along `angle_deg` degrees counter-clockwise from +x as seen.
    ///
    /// # Errors
    /// [`Error::Parameter`] when `length_px` is not a finite number greater than 0 or `angle_deg` is not finite.
    pub fn uniform(length_px: f64, angle_deg: f64) -> Result<Self> {
        if !(length_px.is_finite() && length_px > 0.0) {
            let expected = "a finite number greater than 0";
            return Err(Error::Parameter { name: "blur length (px)", value: length_px, expected });
        }
        if !angle_deg.is_finite() {
            return Err(Error::Parameter { name: "angle (deg)", value: angle_deg, expected: "a finite number" });
        }
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        Ok(Self { length_px, direction: (cos, -sin), accelerated: None })
    }

    /// A uniformly accelerated motion with the ratio `r = a T / (2 vbar)` in `[-1, 1]`, positive when the content speeds
    /// up along `angle_deg`; else as [`uniform`](Self::uniform).
    ///
    /// # Errors
    /// Those of [`uniform`](Self::uniform), and [`Error::Parameter`] when `ratio` is out of its range.
    pub fn accelerated(length_px: f64, angle_deg: f64, ratio: f64) -> Result<Self> {
        let uniform = Self::uniform(length_px, angle_deg)?;
        let accelerated = AcceleratedBlur::new(length_px, ratio)?;
        Ok(Self { accelerated: (ratio != 0.0).then_some(accelerated), ..uniform })
    }

    /// The blur that was measured, accelerated where the acceleration was detected; `None` when there is no blur.
    ///
    /// A picture alone does not tell speeding up from slowing down. Without the sign the motion is taken to speed up along
    /// the angle, in `[0, 180)`: see [`sign_is_assumed`](Self::sign_is_assumed). The wrong sign doubles contours by a few
    /// pixels.
    ///
    /// # Errors
    /// Those of [`accelerated`](Self::accelerated).
    pub fn measured(found: &MotionBlur) -> Result<Option<Self>> {
        if matches!(found.status, Status::NoMotionBlur(_)) {
            return Ok(None);
        }
        // The signed ratio refers to the direction of the content where that is known.
        let angle_deg = found.direction_deg.unwrap_or(found.angle.deg());
        let detected = found.acceleration.filter(Acceleration::is_detected);
        let ratio = detected.map_or(0.0, |found| found.signed.map_or(found.ratio, |signed| signed.ratio));
        Self::accelerated(found.length_px, angle_deg, ratio.clamp(-1.0, 1.0)).map(Some)
    }

    /// Whether [`measured`](Self::measured) has to assume the sign of the acceleration.
    pub fn sign_is_assumed(found: &MotionBlur) -> bool {
        found.acceleration.is_some_and(|acceleration| acceleration.is_detected() && acceleration.signed.is_none())
    }

    /// Length of the path in pixels.
    pub fn length_px(&self) -> f64 {
        self.length_px
    }

    /// A uniform blur of another length in the same direction.
    pub(super) fn with_length(&self, length_px: f64) -> Self {
        Self { length_px, direction: self.direction, accelerated: None }
    }

    /// Refuses a picture of `rows` x `columns` pixels that the blur is not shorter than.
    pub(super) fn check_fits(&self, (rows, columns): (usize, usize)) -> Result<()> {
        let (down, across) = self.extent_px();
        if down < rows && across < columns {
            return Ok(());
        }
        Err(Error::BlurTooLong { length_px: self.length_px, width: columns, height: rows })
    }

    /// Frequency along the motion of `u` along columns and `v` down, all in cycles per pixel.
    pub(super) fn along(&self, u: f64, v: f64) -> f64 {
        let (x, y) = self.direction;
        u * x + v * y
    }

    /// The transfer function at `u` cycles per pixel along columns and `v` along rows (downwards): 1 at 0.
    pub fn transfer(&self, u: f64, v: f64) -> Complex64 {
        let along = self.along(u, v);
        match &self.accelerated {
            None => Complex64::new(sinc(self.length_px * along), 0.0),
            // From a path that begins at the origin to one that is centred there.
            Some(blur) => blur.transfer(along) * Complex64::cis(std::f64::consts::PI * self.length_px * along),
        }
    }

    /// Rows and columns that the path extends over, rounded up.
    pub fn extent_px(&self) -> (usize, usize) {
        let (x, y) = self.direction;
        let whole = |share: f64| (self.length_px * share.abs() - 1e-9).ceil().max(0.0) as usize;
        (whole(y), whole(x))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a blur that is refused fails the test")]

    use super::*;

    #[test]
    fn the_zeros_of_a_uniform_blur_lie_across_its_motion() {
        // 30 degrees with y up: along the motion v is negative.
        let blur = LineBlur::uniform(20.0, 30.0).unwrap();
        let (sin, cos) = 30.0_f64.to_radians().sin_cos();
        assert!(blur.transfer(cos / 20.0, -sin / 20.0).norm() < 1e-12);
        assert!((blur.transfer(sin / 20.0, cos / 20.0).re - 1.0).abs() < 1e-12);
        assert_eq!(blur.extent_px(), (10, 18));
    }

    #[test]
    fn a_centred_path_turns_the_phase_by_its_centroid_only() {
        // Speeding up from rest, x = t^2 L: the mean of x - L/2 is L/3 - L/2.
        let blur = LineBlur::accelerated(12.0, 0.0, 1.0).unwrap();
        let u = 1e-4;
        let phase = blur.transfer(u, 0.0).arg();
        assert!((phase - 2.0 * std::f64::consts::PI * u * 2.0).abs() < 1e-6, "{phase}");
        let slowing = LineBlur::accelerated(12.0, 0.0, -1.0).unwrap();
        assert!((blur.transfer(0.07, 0.1) - slowing.transfer(0.07, 0.1).conj()).norm() < 1e-12);
    }

    #[test]
    fn impossible_blurs_are_refused() {
        assert!(LineBlur::uniform(0.0, 0.0).is_err());
        assert!(LineBlur::uniform(f64::NAN, 0.0).is_err());
        assert!(LineBlur::uniform(3.0, f64::INFINITY).is_err());
        assert!(LineBlur::accelerated(3.0, 0.0, 1.1).is_err());
        assert!(matches!(
            LineBlur::uniform(64.0, 0.0).unwrap().check_fits((100, 64)),
            Err(Error::BlurTooLong { width: 64, height: 100, .. })
        ));
    }
}
