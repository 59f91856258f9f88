//! The PSF of a motion at constant speed: a box.

use std::f64::consts::PI;

use rustfft::num_complex::Complex64;

use super::{chirp, positive};
use crate::Result;

/// `sin(pi x) / (pi x)`, and 1 at 0: the normalised sinc.
///
/// Exactly 0 at every other integer. The thesis writes `Sinc(x) = sin(x)/x` in chapter 3, so its `Sinc(pi u x)` is
/// `sinc(u x)` here.
pub fn sinc(x: f64) -> f64 {
    if x.is_infinite() {
        return 0.0;
    }
    // The argument is reduced while that is exact, so that large integers are zeros too.
    let nearest = x.round();
    let sine = (PI * (x - nearest)).sin();
    if x.abs() < 1e-150 {
        1.0
    } else if nearest % 2.0 == 0.0 {
        sine / (PI * x)
    } else {
        -sine / (PI * x)
    }
}

/// Blur by a motion at constant speed along a path of one length.
///
/// # Reference
/// Thesis section 3.1.1 (eq. 3.13-3.14), section 3.2.1 (eq. 3.25-3.31) and eq. 4.4-4.7.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UniformBlur {
    length: f64,
}

impl UniformBlur {
    /// A blur of `length`, in any one unit.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) unless `length` is finite and greater than 0.
    pub fn new(length: f64) -> Result<Self> {
        Ok(Self { length: positive("blur length", length)? })
    }

    /// Length of the path, in the unit it was given in.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// The density `l(s) = 1 / length` at position `s` along the path, for `s` in `[0, length]`; 0 elsewhere
    /// (thesis section 3.1.1).
    pub fn psf(&self, s: f64) -> f64 {
        if s.is_nan() {
            f64::NAN
        } else if (0.0..=self.length).contains(&s) {
            1.0 / self.length
        } else {
            0.0
        }
    }

    /// The transfer function `sinc(u length) e^{-i pi u length}` at `u` cycles per unit length (thesis eq. 3.14).
    ///
    /// The phase is that of a path starting at 0. It is not without effect, as the thesis says below its eq. 3.14: it
    /// moves the picture by half the length of the blur.
    pub fn transfer(&self, u: f64) -> Complex64 {
        let z = u * self.length;
        chirp::turn(0.5 * z) * sinc(z)
    }

    /// The modulation transfer function `|sinc(u length)|` at `u` cycles per unit length.
    pub fn mtf(&self, u: f64) -> f64 {
        sinc(u * self.length).abs()
    }

    /// The cosine transform over the path, `∫ l(x) cos(omega x) dx` for `x` from 0 to `length`, which is
    /// `sin(omega length) / (omega length)`; `omega` in radians per unit length (thesis eq. 3.26-3.31).
    ///
    /// The thesis gives the box the height `b`; multiply by `b length` for its `F(omega) = L b sinc(omega L)`. Its
    /// zeros are at multiples of `pi / length` ([`cosine_zeros`](Self::cosine_zeros)): this form depends on where the
    /// path begins. The box centred on 0 is [`gate_transform`](Self::gate_transform).
    pub fn cosine_transform(&self, omega: f64) -> f64 {
        sinc(omega * self.length / PI)
    }

    /// The cosine transform of the box centred on 0, `sin(omega length / 2) / (omega length / 2)`; `omega` in radians
    /// per unit length (thesis eq. 4.4-4.6 divided by `b length`).
    pub fn gate_transform(&self, omega: f64) -> f64 {
        sinc(omega * self.length / (2.0 * PI))
    }

    /// The positive zeros `n / length` of the [`mtf`](Self::mtf), ascending without end, in cycles per unit length.
    ///
    /// ```
    /// let blur = blur_core::psf::UniformBlur::new(10.0)?; // pixels
    /// let below_nyquist: Vec<f64> = blur.mtf_zeros().take_while(|&u| u <= 0.5).collect();
    /// assert_eq!(below_nyquist, [0.1, 0.2, 0.3, 0.4, 0.5]);
    /// # Ok::<(), blur_core::Error>(())
    /// ```
    pub fn mtf_zeros(&self) -> impl Iterator<Item = f64> + use<> {
        let length = self.length;
        counting().map(move |n| n / length)
    }

    /// The positive zeros `2 pi n / length` of the [`gate_transform`](Self::gate_transform), ascending without end, in
    /// radians per unit length (thesis eq. 4.7).
    pub fn gate_zeros(&self) -> impl Iterator<Item = f64> + use<> {
        let length = self.length;
        counting().map(move |n| 2.0 * PI * n / length)
    }

    /// The positive zeros `pi n / length` of the [`cosine_transform`](Self::cosine_transform), ascending without end,
    /// in radians per unit length: twice as dense as those of the gate.
    pub fn cosine_zeros(&self) -> impl Iterator<Item = f64> + use<> {
        let length = self.length;
        counting().map(move |n| PI * n / length)
    }
}

fn counting() -> impl Iterator<Item = f64> {
    (1_u32..).map(f64::from)
}
