//! The transfer function of a motion of constant acceleration, in units of its own length and duration.
//!
//! All of it is one integral, `H = ∫ exp(-2 pi i z [(1-r) t + r t²]) dt` for `t` from 0 to 1, with `z` the frequency in
//! cycles per path. Three forms of it serve three regimes:
//!
//! | regime | form |
//! |---|---|
//! | `z < 1/4` | the time integral itself, by Gauss-Legendre: the others divide a small difference by `sqrt(r z)` |
//! | `pi z (1+r)²/(2r) <= 64` | sums of spherical Bessel functions, thesis eq. 3.19-3.24 |
//! | else | auxiliary Fresnel functions: the huge phases cancel on paper, so `r = 0` is no exception |

use std::f64::consts::PI;

use rustfft::num_complex::Complex64;

use super::bessel::{BesselSums, spherical_bessel_sums};
use super::fresnel::{FresnelAuxiliary, fresnel_auxiliary};

/// Below this frequency, in cycles per path, the time integral is taken by quadrature.
const SHORT: f64 = 0.25;
/// Up to this argument the Bessel sums are taken; they have about as many terms.
const BESSEL_END: f64 = 64.0;

/// `e^{-2 pi i z}`, with whole turns taken off `z` while that is exact.
pub(super) fn turn(z: f64) -> Complex64 {
    if z.is_infinite() {
        // A direction does not exist; whatever it multiplies is 0 there.
        return Complex64::ONE;
    }
    let (sin, cos) = (2.0 * PI * (z - z.round())).sin_cos();
    Complex64::new(cos, -sin)
}

/// `H` at `z` cycles per path, by Bessel sums where those are stable. Wants `r` in `[-1, 1]`.
pub(super) fn transfer(z: f64, r: f64) -> Complex64 {
    with_symmetries(z, r, |z, q| {
        if z < SHORT {
            time_integral(z, q)
        } else if PI * z * (1.0 + q) * (1.0 + q) <= 2.0 * q * BESSEL_END {
            bessel(z, q)
        } else {
            fresnel(z, q)
        }
    })
}

/// `H` at `z` cycles per path, by Fresnel integrals where those are stable. Wants `r` in `[-1, 1]`.
pub(super) fn transfer_by_fresnel(z: f64, r: f64) -> Complex64 {
    with_symmetries(z, r, |z, q| if z < SHORT { time_integral(z, q) } else { fresnel(z, q) })
}

/// Reduces any sign of `z` and `r` to `form(z >= 0, q = |r|)`: the PSF is real, and a motion that brakes is one that
/// speeds up seen backwards, `s -> 1 - s`.
fn with_symmetries(z: f64, r: f64, form: impl Fn(f64, f64) -> Complex64) -> Complex64 {
    if z.is_infinite() {
        return Complex64::ZERO;
    }
    let positive = z.abs();
    let speeding = form(positive, r.abs());
    let value = if r < 0.0 { turn(positive) * speeding.conj() } else { speeding };
    if z < 0.0 { value.conj() } else { value }
}

/// Thesis eq. 3.19-3.24, corrected: with `X = u K`, so that `X1 = pi z (1-q)²/(2q)` and `X2 = pi z (1+q)²/(2q)`,
///
/// `H = e^{i X1} { sqrt(X2) Σ(X2) - sqrt(X1) Σ(X1) } / (sqrt(X2) - sqrt(X1))`,
/// `Σ(X) = Σ_{n>=0} j_{2n}(X) - i j_{2n+1}(X)`.
fn bessel(z: f64, q: f64) -> Complex64 {
    let half = (0.5 * PI * z / q).sqrt();
    let (root_start, root_end) = (half * (1.0 - q), half * (1.0 + q));
    let weighted = |root: f64| {
        let BesselSums { even, odd } = spherical_bessel_sums(root * root);
        root * Complex64::new(even, -odd)
    };
    let (sin, cos) = (root_start * root_start).sin_cos();
    Complex64::new(cos, sin) * (weighted(root_end) - weighted(root_start)) / (2.0 * half * q)
}

/// Thesis eq. 3.56, corrected and with the sine part: with `y = w sqrt(z/q)` at the speeds `w = 1-q` and `w = 1+q`,
///
/// `H = { [g(y1) - i f(y1)] - [g(y2) - i f(y2)] e^{-2 pi i z} } / (2 sqrt(q z))`.
///
/// It is `e^{i pi y1²/2} {[C(y2) - C(y1)] - i [S(y2) - S(y1)]} / (2 sqrt(q z))` with the integrals written by their
/// auxiliary functions: the phases `pi y²/2`, beyond all bounds at small `q`, leave only their difference `2 pi z`.
fn fresnel(z: f64, q: f64) -> Complex64 {
    end_point(z, q, 1.0 - q) - end_point(z, q, 1.0 + q) * turn(z)
}

/// `[g(y) - i f(y)] / (2 sqrt(q z))` at `y = w sqrt(z/q)`, by the leading terms of `f` and `g` when `y` is large.
fn end_point(z: f64, q: f64, w: f64) -> Complex64 {
    if w * w * z > 1e8 * q {
        let sine = 1.0 / (2.0 * PI * w * z);
        return Complex64::new(sine * q / (PI * w * w * z), -sine);
    }
    let FresnelAuxiliary { f, g } = fresnel_auxiliary(w * (z / q).sqrt());
    Complex64::new(g, -f) / (2.0 * (q * z).sqrt())
}

/// The time integral about the middle of the exposure, `t = 1/2 + tau`, for `0 <= z < 1/4`:
///
/// `H = e^{-2 pi i z (1/2 - q/4)} 2 ∫ cos(2 pi z tau) e^{-2 pi i z q tau²} dtau` for `tau` from 0 to 1/2.
///
/// Eight nodes leave an error below 1e-19: the integrand turns by less than `pi/2`.
fn time_integral(z: f64, q: f64) -> Complex64 {
    /// Nodes of Gauss-Legendre on `[-1, 1]`, positive half, with their weights (Abramowitz and Stegun, table 25.4).
    const RULE: [(f64, f64); 4] = [
        (0.183_434_642_495_649_8, 0.362_683_783_378_362),
        (0.525_532_409_916_329, 0.313_706_645_877_887_3),
        (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
        (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
    ];
    let integrand = |tau: f64| turn(z * q * tau * tau) * (2.0 * PI * z * tau).cos();
    let sum: Complex64 =
        RULE.iter().map(|&(x, weight)| (integrand(0.25 + 0.25 * x) + integrand(0.25 - 0.25 * x)) * weight).sum();
    turn(z * (0.5 - 0.25 * q)) * sum * 0.5
}
