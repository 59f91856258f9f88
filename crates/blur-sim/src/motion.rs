//! The motion of the picture over the sensor during the exposure, and its transfer function.

use crate::Result;
use crate::check;
use crate::fresnel::FresnelTail;
use blur_core::estimate::AxialAngle;
use rustfft::num_complex::Complex;
use std::f64::consts::PI;

/// Longest motion in pixels.
const MAX_LENGTH_PX: f64 = 1e6;

/// Below this product of cycles and acceleration the transfer function is its expansion to first order in the
/// acceleration: what is left out is less than `(2 pi 1e-6)^2 / 60 < 1e-12`, and the Fresnel form would divide by
/// nearly nothing.
const FIRST_ORDER_BELOW: f64 = 1e-6;

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
}

impl Motion {
    /// A motion of `length_px` (0 to 1e6 pixels) along `angle` with the acceleration ratio `accel_ratio` (-1 to 1).
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) when the length or the ratio is out of its range or NaN.
    pub fn new(length_px: f64, angle: AxialAngle, accel_ratio: f64) -> Result<Self> {
        check::range("length in px", length_px, 0.0, MAX_LENGTH_PX, "0 to 1e6")?;
        check::range("acceleration ratio", accel_ratio, -1.0, 1.0, "-1 to 1")?;
        Ok(Self { length_px, angle, accel_ratio })
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
    /// *Reference*: the integral over a quadratic phase is a difference of Fresnel integrals (NIST DLMF 7.2(iii)).
    pub fn transfer(&self, s: f64) -> Complex<f64> {
        self.transfer_function().at(s)
    }

    /// The frequency along the motion `s = u cos(angle) - v sin(angle)` for `u` along columns and `v` along rows
    /// (downwards), all in cycles per pixel.
    pub fn frequency_along(&self, u: f64, v: f64) -> f64 {
        let (x, y) = self.direction();
        u * x + v * y
    }

    /// The transfer function with its constants computed once.
    pub(crate) fn transfer_function(&self) -> TransferFunction {
        TransferFunction { length_px: self.length_px, accel_ratio: self.accel_ratio, tail: FresnelTail::new() }
    }
}

/// [`Motion::transfer`] for many frequencies.
pub(crate) struct TransferFunction {
    length_px: f64,
    accel_ratio: f64,
    tail: FresnelTail,
}

impl TransferFunction {
    pub(crate) fn at(&self, s: f64) -> Complex<f64> {
        let cycles = self.length_px * s;
        let forward = self.at_positive(cycles.abs());
        // Turning the frequency and turning the acceleration each conjugate.
        if (cycles < 0.0) == (self.accel_ratio < 0.0) { forward } else { forward.conj() }
    }

    /// For `cycles = L s >= 0` and the magnitude of the acceleration.
    fn at_positive(&self, cycles: f64) -> Complex<f64> {
        let r = self.accel_ratio.abs();
        if cycles * r < FIRST_ORDER_BELOW {
            return first_order(cycles, r);
        }
        // With the square completed the phase is y^2 up to a constant, y = scale (t + (1 - r) / (2 r)). At the ends of
        // the path y^2 differs from the centred phase by that constant only, so the tails carry -+ pi cycles.
        let scale = (2.0 * PI * cycles * r).sqrt();
        let (start, end) = ((1.0 - r) / (2.0 * r) * scale, (1.0 + r) / (2.0 * r) * scale);
        let (sin, cos) = libm::sincos(PI * cycles);
        let turn = Complex::new(cos, sin);
        (turn * self.tail.at(start) - turn.conj() * self.tail.at(end)) / scale
    }
}

/// `sinc(c) - 2 pi i c r M(c)`, where `M` is the transform of `t^2 - t` about the middle of the path.
fn first_order(cycles: f64, r: f64) -> Complex<f64> {
    let b = PI * cycles;
    if b < 1e-2 {
        let square = b * b;
        let sinc = if b < 1e-4 { 1.0 - square / 6.0 } else { libm::sin(b) / b };
        return Complex::new(sinc, 2.0 * b * r * (1.0 / 6.0 - square / 60.0));
    }
    let (sin, cos) = libm::sincos(b);
    let sinc = sin / b;
    Complex::new(sinc, -r * (cos - sinc) / b)
}
