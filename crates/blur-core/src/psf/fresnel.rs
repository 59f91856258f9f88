//! The Fresnel integrals and their auxiliary functions.

use std::f64::consts::{FRAC_PI_2, PI};

use rustfft::num_complex::Complex64;

/// Below this argument the power series is used; it loses less than one digit there.
const SERIES_END: f64 = 1.7;
/// Beyond this argument the leading term of the asymptotic series is exact in double precision.
const ASYMPTOTIC_START: f64 = 1e4;
/// The continued fraction needs about 60 steps at `SERIES_END` and fewer beyond.
const MAX_STEPS: u32 = 300;

/// The two Fresnel integrals of one argument.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fresnel {
    /// `S(x)`, the integral of `sin(pi t²/2)` from 0 to `x`.
    pub sine: f64,
    /// `C(x)`, the integral of `cos(pi t²/2)` from 0 to `x`.
    pub cosine: f64,
}

/// The auxiliary functions of the Fresnel integrals: what remains of them without their oscillation.
///
/// `C(x) = 1/2 + f sin(pi x²/2) - g cos(pi x²/2)` and `S(x) = 1/2 - f cos(pi x²/2) - g sin(pi x²/2)`; for large `x`,
/// `f` falls as `1/(pi x)` and `g` as `1/(pi² x³)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FresnelAuxiliary {
    /// `f(x)`, 1/2 at 0 and falling.
    pub f: f64,
    /// `g(x)`, 1/2 at 0 and falling.
    pub g: f64,
}

/// The Fresnel integrals `S(x)` and `C(x)` of thesis eq. 3.45-3.46 for any real `x`, to about 1e-15.
///
/// The thesis prints the upper limit of both integrals as `L`; it is the argument.
///
/// # Reference
/// Abramowitz and Stegun, 7.3.1-7.3.2, by the power series 7.3.11 and 7.3.13 and, beyond 1.7, the continued fraction
/// of the complementary error function 7.1.14.
pub fn fresnel(x: f64) -> Fresnel {
    let positive = x.abs();
    let Fresnel { sine, cosine } = if positive < SERIES_END {
        series(positive)
    } else {
        let FresnelAuxiliary { f, g } = fresnel_auxiliary(positive);
        let (sin, cos) = quarter_turns_of_square(positive);
        Fresnel { sine: 0.5 - f * cos - g * sin, cosine: 0.5 + f * sin - g * cos }
    };
    Fresnel { sine: sine.copysign(x), cosine: cosine.copysign(x) }
}

/// The auxiliary functions `f(x)` and `g(x)` for `x >= 0`, to about 1e-15; NaN for negative `x`.
///
/// # Reference
/// Abramowitz and Stegun, 7.3.5-7.3.6 and 7.3.27-7.3.28.
pub fn fresnel_auxiliary(x: f64) -> FresnelAuxiliary {
    if x.is_nan() || x < 0.0 {
        FresnelAuxiliary { f: f64::NAN, g: f64::NAN }
    } else if x < SERIES_END {
        let Fresnel { sine, cosine } = series(x);
        let (sin, cos) = quarter_turns_of_square(x);
        FresnelAuxiliary { f: (0.5 - sine) * cos - (0.5 - cosine) * sin, g: (0.5 - cosine) * cos + (0.5 - sine) * sin }
    } else if x < ASYMPTOTIC_START {
        continued_fraction(x)
    } else {
        let f = 1.0 / (PI * x);
        FresnelAuxiliary { f, g: f / x / (PI * x) }
    }
}

/// `sin(pi x²/2)` and `cos(pi x²/2)`, with the rounding of `x²` put back before whole turns are taken off.
fn quarter_turns_of_square(x: f64) -> (f64, f64) {
    if x > 1e100 {
        // The square may overflow; f and g have long made the phase irrelevant.
        return (0.0, 1.0);
    }
    let square = x * x;
    let rounding = x.mul_add(x, -square);
    (FRAC_PI_2 * (square % 4.0 + rounding)).sin_cos()
}

fn series(x: f64) -> Fresnel {
    let phase = FRAC_PI_2 * x * x;
    // term = x phase^n / n!; the even ones make C, the odd ones S.
    let (mut term, mut n) = (x, 0.0);
    let (mut sine, mut cosine) = (0.0, 0.0);
    loop {
        let next_sine = term * phase / (n + 1.0);
        cosine += term / (2.0 * n + 1.0);
        sine += next_sine / (2.0 * n + 3.0);
        n += 2.0;
        term = -next_sine * phase / n;
        if term.abs() <= f64::EPSILON * 1e-2 * cosine.abs() || n > 100.0 {
            return Fresnel { sine, cosine };
        }
    }
}

/// `g + i f = x / (1 - i pi x² - 1·2/(5 - i pi x² - 3·4/(9 - i pi x² - ...)))`, by the method of Lentz.
fn continued_fraction(x: f64) -> FresnelAuxiliary {
    let mut b = Complex64::new(1.0, -PI * x * x);
    let mut d = b.inv();
    // The first ratio of numerators is infinite; its inverse is what the recurrence needs.
    let mut inverse_c = Complex64::ZERO;
    let mut value = d;
    let mut n = 1.0;
    for _ in 0..MAX_STEPS {
        let a = -n * (n + 1.0);
        n += 2.0;
        b += 4.0;
        d = (d * a + b).inv();
        let c = b + inverse_c * a;
        inverse_c = c.inv();
        let change = c * d;
        value *= change;
        if (change - 1.0).l1_norm() < 0.5 * f64::EPSILON {
            break;
        }
    }
    FresnelAuxiliary { f: x * value.im, g: x * value.re }
}
