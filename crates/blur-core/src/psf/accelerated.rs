//! The PSF of a motion of constant acceleration.

use std::f64::consts::PI;

use rustfft::num_complex::Complex64;

use super::{chirp, finite, positive};
use crate::{Error, Result};

/// `|r|` may exceed 1 by this much from rounding in `v0`, `a` and `T`.
const RATIO_SLACK: f64 = 1e-12;

/// Blur by a motion of constant acceleration along a straight path that never turns back.
///
/// Seen by itself the motion has two parameters, the length `L` of its path and the acceleration ratio
///
/// `r = a T / (2 vbar)`, `vbar = L / T`,
///
/// which runs from -1 (braking to a stop) over 0 (uniform) to 1 (starting from rest):
/// `s(t) = L [(1 - r) t/T + r (t/T)²]`, and the speed runs from `(1 - r) vbar` to `(1 + r) vbar`. The thesis's
/// `R = v0²/a` is `L (1 - r)² / (2 r)`.
///
/// # Reference
/// Thesis section 3.1.2 (eq. 3.15-3.24) after Som (1971), and section 3.2.2 (eq. 3.32-3.56). Where the formulas printed
/// there differ from the integrals they start from, the integrals are followed here; the methods say where.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AcceleratedBlur {
    length: f64,
    ratio: f64,
}

impl AcceleratedBlur {
    /// A blur of `length` in any one unit, with the acceleration ratio `r = a T / (2 vbar)` in `[-1, 1]`.
    ///
    /// # Errors
    /// [`Error::Parameter`] unless `length` is finite and greater than 0 and `ratio` lies in `[-1, 1]`.
    pub fn new(length: f64, ratio: f64) -> Result<Self> {
        let length = positive("blur length", length)?;
        if ratio.abs() <= 1.0 {
            Ok(Self { length, ratio })
        } else {
            Err(Error::Parameter { name: "acceleration ratio", value: ratio, expected: "in [-1, 1]" })
        }
    }

    /// The blur of an exposure: speed `v0 >= 0` at its begin, acceleration `a` of either sign, duration `T > 0`, in one
    /// system of units (m/s, m/s², s; or px/s, px/s², s).
    ///
    /// # Errors
    /// [`Error::Parameter`] when a number is not finite, `v0` is negative, `T` is not greater than 0, nothing moves, or
    /// the motion turns back before the exposure ends (`v0 + a T < 0`).
    pub fn from_exposure(v0: f64, a: f64, duration: f64) -> Result<Self> {
        let v0 = start_speed(v0)?;
        let a = finite("acceleration", a)?;
        let duration = positive("exposure time", duration)?;
        let gained = a * duration;
        let doubled_mean = 2.0 * v0 + gained;
        let ratio = gained / doubled_mean;
        if doubled_mean > 0.0 && ratio.abs() <= 1.0 + RATIO_SLACK {
            Self::new(0.5 * doubled_mean * duration, ratio.clamp(-1.0, 1.0))
        } else {
            Err(turns_back(a))
        }
    }

    /// The blur of a path: speed `v0 >= 0` at its begin, acceleration `a` of either sign, length `x > 0`, in one system
    /// of units. The duration is the time that the motion takes for the path, `2 x / (v0 + sqrt(v0² + 2 a x))`.
    ///
    /// The thesis gives its figures 3.2-3.7 and 3.9 by `v0`, `a` and `x`, and `T = 0.5 s` beside them. The four do not
    /// belong together (in 0.5 s its first motion covers 125.5 mm, not 0.05 mm), so its density does not integrate to
    /// 1 and has to be normalised; the `T` cancels. Its `L(0) = 0.180998` is ten times
    /// `(sqrt(K2) - sqrt(K1)) / (T sqrt(pi a)) = 0.0180998`, the integral of the density not normalised: the share of
    /// the 0.5 s in which the 0.05 mm were covered.
    ///
    /// # Errors
    /// [`Error::Parameter`] when a number is not finite, `v0` is negative, `x` is not greater than 0, nothing moves, or
    /// the motion turns back before the path ends (`v0² + 2 a x < 0`).
    pub fn from_path(v0: f64, a: f64, length: f64) -> Result<Self> {
        let v0 = start_speed(v0)?;
        let a = finite("acceleration", a)?;
        let length = positive("blur length", length)?;
        let mut end_squared = v0 * v0 + 2.0 * a * length;
        if end_squared.abs() <= RATIO_SLACK * v0 * v0 {
            end_squared = 0.0;
        }
        let end = end_squared.sqrt();
        // r = a T / (2 vbar) with T = 2 x / (v0 + end) and vbar = (v0 + end) / 2.
        let ratio = 2.0 * a * length / ((v0 + end) * (v0 + end));
        if ratio.abs() <= 1.0 + RATIO_SLACK { Self::new(length, ratio.clamp(-1.0, 1.0)) } else { Err(turns_back(a)) }
    }

    /// Length of the path, in the unit it was given in.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// The acceleration ratio `r = a T / (2 vbar)`, in `[-1, 1]`.
    pub fn ratio(&self) -> f64 {
        self.ratio
    }

    /// The density `l(s) = 1 / (T sqrt(v0² + 2 a s))` at position `s` along the path, for `s` in `[0, length]`; 0
    /// elsewhere (thesis eq. 3.18). Infinite at the end where the motion rests, when `|r| = 1`; it integrates to 1 all
    /// the same.
    pub fn psf(&self, s: f64) -> f64 {
        if s.is_nan() {
            f64::NAN
        } else if (0.0..=self.length).contains(&s) {
            1.0 / (self.length * relative_speed(s / self.length, self.ratio))
        } else {
            0.0
        }
    }

    /// The share of the exposure, in `[0, 1]`, in which the motion is at most at position `s`: the integral of the
    /// [`psf`](Self::psf) up to `s`.
    pub fn cumulative(&self, s: f64) -> f64 {
        elapsed((s / self.length).clamp(0.0, 1.0), self.ratio)
    }

    /// The transfer function `∫ l(s) e^{-2 pi i u s} ds` over the path, at `u` cycles per unit length: 1 at 0, complex
    /// elsewhere.
    ///
    /// By the sums of spherical Bessel functions of thesis eq. 3.19-3.24 where they are stable (see below for what
    /// they should read), else by the auxiliary functions of the Fresnel integrals. At `z` cycles per path the error is
    /// below `2e-14 + 2e-16 |z|` for every ratio: a few roundings, and that of the phase.
    ///
    /// With `K1 = pi v0²/a` and `K2 = K1 + 2 pi x`,
    ///
    /// `L(u) = e^{i u K1} [sqrt(K2) Σ(u K2) - sqrt(K1) Σ(u K1)] / [sqrt(K2) - sqrt(K1)]`,
    /// `Σ(X) = Σ_{n>=0} j_{2n}(X) - i j_{2n+1}(X)`.
    ///
    /// The thesis starts the sums at `n = 1`, gives each sum the square root that belongs to the other, divides the
    /// last root of `L(0)` by `T` twice with the sign turned, and takes as magnitude what is the complex value and as
    /// phase what is only one of its factors. In eq. 3.12 it integrates over the path up to `T`; the path ends at `x`.
    pub fn transfer(&self, u: f64) -> Complex64 {
        chirp::transfer(u * self.length, self.ratio)
    }

    /// The modulation transfer function `|L(u)|` at `u` cycles per unit length.
    ///
    /// It is the same for `r` and `-r`: a magnitude does not tell speeding up from braking. Where a uniform blur has
    /// its first zero it is `|L(1/x)| = (|r|/pi) [1 - (21/(2 pi²) - 1) r² + O(r⁴)]`: `|r|/pi` is the first order and
    /// not exact, the true value lies 1.6 % below it at `|r| = 0.5` and 6.2 % at 1.
    pub fn mtf(&self, u: f64) -> f64 {
        self.transfer(u).norm()
    }

    /// The cosine transform `∫ l(x) cos(omega x) dx` over the path, `omega` in radians per unit length, by Fresnel
    /// integrals: the right form of thesis eq. 3.32-3.56,
    ///
    /// `F(omega) = (1/(a T)) sqrt(pi a / omega) { cos(phi) [C(y2) - C(y1)] + sin(phi) [S(y2) - S(y1)] }`,
    /// `phi = omega v²/(2 a)`,
    ///
    /// `y = w sqrt(omega / (pi a))` at the speeds `w = v` and `w = sqrt(v² + 2 a L)`, evaluated by the auxiliary
    /// functions so that it stays exact when `a` vanishes. Multiply by the duration `T` for the `F` of the thesis: its
    /// `f(x)` has no `1/T`.
    ///
    /// The thesis puts the limits of `x` on the integral over the speed `u` in eq. 3.36, loses the `1/a` of
    /// `dx = u du / a` there, and turns `sqrt(pi a / omega)` over in eq. 3.44.
    pub fn cosine_transform(&self, omega: f64) -> f64 {
        chirp::transfer_by_fresnel(self.cycles(omega), self.ratio).re
    }

    /// The sine transform `∫ l(x) sin(omega x) dx` over the path, `omega` in radians per unit length, by Fresnel
    /// integrals. With it, `L(u) = F_cos(2 pi u) - i F_sin(2 pi u)`.
    pub fn sine_transform(&self, omega: f64) -> f64 {
        -chirp::transfer_by_fresnel(self.cycles(omega), self.ratio).im
    }

    fn cycles(&self, omega: f64) -> f64 {
        omega * self.length / (2.0 * PI)
    }
}

/// The speed in units of the mean speed where the share `p` of the path is covered: `sqrt((1-r)² + 4 r p)`, written for
/// each sign of `r` without a difference.
fn relative_speed(p: f64, r: f64) -> f64 {
    let squared =
        if r < 0.0 { (1.0 + r) * (1.0 + r) - 4.0 * r * (1.0 - p) } else { (1.0 - r) * (1.0 - r) + 4.0 * r * p };
    squared.sqrt()
}

/// The share of the exposure in which the share `p` of the path is covered: `(w - (1-r)) / (2r)` at the speed `w`,
/// written so that `r = 0` is no exception.
pub(super) fn elapsed(p: f64, r: f64) -> f64 {
    if p <= 0.0 { 0.0 } else { (2.0 * p / (relative_speed(p, r) + (1.0 - r))).clamp(0.0, 1.0) }
}

fn start_speed(v0: f64) -> Result<f64> {
    if v0.is_finite() && v0 >= 0.0 {
        Ok(v0)
    } else {
        Err(Error::Parameter {
            name: "start speed",
            value: v0,
            expected: "a finite number, at least 0: let the path point where the motion goes",
        })
    }
}

fn turns_back(a: f64) -> Error {
    Error::Parameter {
        name: "acceleration",
        value: a,
        expected: "such that something moves and the motion does not turn back",
    }
}
