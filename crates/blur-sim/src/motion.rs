//! The motion of the picture over the sensor during the exposure, and its transfer function.

use crate::Result;
use crate::check;
use blur_core::estimate::AxialAngle;
use blur_core::psf::{AcceleratedBlur, sinc};
use rustfft::num_complex::Complex;
use std::f64::consts::PI;

/// Longest motion in pixels.
const MAX_LENGTH_PX: f64 = 1e6;

/// A straight motion with constant acceleration, seen by one exposure.
///
/// At the time `t` from 0 (shutter opens) to 1 (shutter closes) the picture has moved by
/// `d(t) = L ((1 - r) t + r t^2)` along the direction `(cos angle, -sin angle)` in (column, row). For a speed `v0` at
/// the start, an acceleration `a` (both in pixels) and an exposure `T` this is `L = v0 T + a T^2 / 2` and
/// `r = a T^2 / (2 L)`. The motion never reverses since `|r| <= 1`; `r = 1` starts from rest, `r = -1` ends at rest.
///
/// The angle is an axis: the motion the other way with acceleration `r` gives the same picture as this one with `-r`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    length_px: f64,
    angle: AxialAngle,
    accel_ratio: f64,
    /// Over a path of length 1 with the acceleration's magnitude; `None` at constant speed.
    speeding: Option<AcceleratedBlur>,
}

impl Motion {
    /// A motion of `length_px` (0 to 1e6 pixels) along `angle` with the acceleration ratio `accel_ratio` (-1 to 1).
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) when the length or the ratio is out of its range or NaN.
    pub fn new(length_px: f64, angle: AxialAngle, accel_ratio: f64) -> Result<Self> {
        check::range("length in px", length_px, 0.0, MAX_LENGTH_PX, "0 to 1e6")?;
        check::range("acceleration ratio", accel_ratio, -1.0, 1.0, "-1 to 1")?;
        let ratio = accel_ratio.abs();
        // Ratios in range are never refused.
        let speeding = if ratio > 0.0 { AcceleratedBlur::new(1.0, ratio).ok() } else { None };
        Ok(Self { length_px, angle, accel_ratio, speeding })
    }

    /// A motion at constant speed.
    ///
    /// # Errors
    /// Those of [`Motion::new`].
    pub fn uniform(length_px: f64, angle: AxialAngle) -> Result<Self> {
        Self::new(length_px, angle, 0.0)
    }

    /// Path length `L` in pixels: the width of the line PSF.
    pub fn length_px(&self) -> f64 {
        self.length_px
    }

    /// Axis of the motion.
    pub fn angle(&self) -> AxialAngle {
        self.angle
    }

    /// Acceleration ratio `r`.
    pub fn accel_ratio(&self) -> f64 {
        self.accel_ratio
    }

    /// Unit vector of the motion in (column, row); row numbers grow downwards.
    pub fn direction(&self) -> (f64, f64) {
        let (sin, cos) = libm::sincos(self.angle.rad());
        // The right angle is exact; its cosine in floating point is not.
        if self.angle.deg() == 90.0 { (0.0, -1.0) } else { (cos, -sin) }
    }

    /// Displacement in pixels at the time `t` in `[0, 1]`, counted from the middle of the path: `d(t) - L/2`.
    pub fn centred_displacement_px(&self, t: f64) -> f64 {
        self.length_px * ((1.0 - self.accel_ratio) * t + self.accel_ratio * t * t - 0.5)
    }

    /// Rows and columns that the exposure costs: `(ceil |L sin angle|, ceil |L cos angle|)`.
    ///
    /// A picture of `rows` x `cols` pixels needs a scene that is larger by this much. A product that is an integer
    /// but for its rounding counts as that integer.
    pub fn extent_px(&self) -> (usize, usize) {
        let (cos, sin) = self.direction();
        let whole = |share: f64| (self.length_px * share.abs() - 1e-9).ceil().max(0.0) as usize;
        (whole(sin), whole(cos))
    }

    /// Transfer function at the frequency `s` along the motion in cycles per pixel: the integral of
    /// `exp(-2 pi i s (d(t) - L/2))` over `t` from 0 to 1, to 1e-12.
    ///
    /// For a constant speed it is `sinc(L s) = sin(pi L s) / (pi L s)`, real: the path is centred and the blur moves
    /// nothing. With acceleration the magnitude at the first zero `s = 1/L` is `|r| / pi` to first order in `r`.
    /// `H(-s)` and the `H` of `-r` are the complex conjugate of `H(s)`.
    ///
    /// It is [`AcceleratedBlur::transfer`] of [`blur_core::psf`] with the path centred.
    pub fn transfer(&self, s: f64) -> Complex<f64> {
        let cycles = self.length_px * s;
        let forward = match self.speeding {
            None => Complex::new(sinc(cycles), 0.0),
            Some(blur) => half_turn(cycles.abs()) * blur.transfer(cycles.abs()),
        };
        // Turning the frequency and turning the acceleration each conjugate.
        if (cycles < 0.0) == (self.accel_ratio < 0.0) { forward } else { forward.conj() }
    }

    /// The frequency along the motion `s = u cos(angle) - v sin(angle)` for `u` along columns and `v` along rows
    /// (downwards), all in cycles per pixel.
    pub fn frequency_along(&self, u: f64, v: f64) -> f64 {
        let (x, y) = self.direction();
        u * x + v * y
    }
}

/// `exp(i pi cycles)`: moves the origin from the beginning of the path to its middle.
fn half_turn(cycles: f64) -> Complex<f64> {
    // Whole turns are taken off while that is exact.
    let (sin, cos) = libm::sincos(PI * (cycles - 2.0 * (0.5 * cycles).round()));
    Complex::new(cos, sin)
}
