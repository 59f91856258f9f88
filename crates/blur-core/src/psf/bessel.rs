//! Spherical Bessel functions of the first kind.

/// Sums over all even and over all odd orders of the spherical Bessel functions of one argument.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BesselSums {
    /// `j_0(x) + j_2(x) + j_4(x) + ...`
    pub even: f64,
    /// `j_1(x) + j_3(x) + j_5(x) + ...`
    pub odd: f64,
}

/// The spherical Bessel function `j_n(x)` of any order and any real argument.
///
/// The relative error is a few units in the last place, except that near a zero in `x` the absolute error is of that
/// size compared with the neighbouring orders. The time grows with `n`.
///
/// The recurrence `j_{n+1} = (2n+1)/x j_n - j_{n-1}` is stable upwards while `n < x` and downwards beyond: the power
/// series serves `x² <= 2n + 3`, the upward recurrence `x > n`, and Miller's downward recurrence, scaled by `j_0` or
/// `j_1`, the rest.
///
/// # Reference
/// Abramowitz and Stegun, 10.1.2 (series), 10.1.11 (`j_0`, `j_1`), 10.1.19 (recurrence) and 10.5 (Miller).
pub fn spherical_bessel(n: u32, x: f64) -> f64 {
    if x.is_infinite() {
        return 0.0;
    }
    let positive = x.abs();
    let value = if positive * positive <= 2.0 * f64::from(n) + 3.0 {
        series(n, positive)
    } else if positive > f64::from(n) {
        upward(n, positive)
    } else {
        downward(n, positive)
    };
    if x < 0.0 && n % 2 == 1 { -value } else { value }
}

/// The sums of `j_n(x)` over the even and over the odd orders, from order 0 on, for `x >= 0`; NaN for negative or
/// infinite `x`. The time grows with `x`.
///
/// They are the integral of thesis eq. 3.21-3.22, `∫ e^{-i k} k^{-1/2} dk` from 0 to `x`, which is
/// `2 sqrt(x) (even - i odd)`. The thesis starts its sums at `n = 1` and so loses `j_0` and `j_1`, the only terms that
/// are left at small `x`; it also loses the factor `u^{-1/2}` in front of them.
///
/// # Reference
/// Abramowitz and Stegun, 10.1.19 downwards (Miller), and 11.1.2 for the integral.
pub fn spherical_bessel_sums(x: f64) -> BesselSums {
    if x.is_nan() || x.is_infinite() || x < 0.0 {
        return BesselSums { even: f64::NAN, odd: f64::NAN };
    }
    if x < 1e-8 {
        return BesselSums { even: 1.0, odd: x / 3.0 };
    }
    let miller = Miller::run(miller_start(x), x, |_| false);
    let scale = miller.scale(x);
    BesselSums { even: scale * miller.even, odd: scale * miller.odd }
}

/// `j_0(x)` and `j_1(x)` for `x > 1`, where `j_1` is free of cancellation.
fn first_two(x: f64) -> (f64, f64) {
    let (sin, cos) = x.sin_cos();
    let j0 = sin / x;
    (j0, (j0 - cos) / x)
}

fn series(n: u32, x: f64) -> f64 {
    let mut leading = 1.0;
    for k in 1..=n {
        leading *= x / (2.0 * f64::from(k) + 1.0);
        if leading == 0.0 {
            return 0.0;
        }
    }
    let (mut term, mut sum, mut k) = (1.0_f64, 1.0, 1.0);
    while term.abs() > f64::EPSILON * 1e-2 && k < 100.0 {
        term *= -0.5 * x * x / (k * (2.0 * f64::from(n) + 2.0 * k + 1.0));
        sum += term;
        k += 1.0;
    }
    leading * sum
}

fn upward(n: u32, x: f64) -> f64 {
    let (mut current, mut next) = first_two(x);
    for k in 1..=n {
        (current, next) = (next, (2.0 * f64::from(k) + 1.0) / x * next - current);
    }
    current
}

fn downward(n: u32, x: f64) -> f64 {
    let n = u64::from(n);
    let miller = Miller::run(miller_start(n as f64), x, |order| order == n);
    miller.kept * miller.scale(x)
}

/// An order so high above `top` that a recurrence started there with anything has forgotten it at `top`.
///
/// Above the turning point `n = x` the wanted solution falls as `exp(-(2 sqrt 2 / 3) d^{3/2} / n^{1/2})` over `d`
/// orders while the unwanted one rises as fast, so `d = 10 n^{1/3}` suppresses it by `exp(-59)`.
fn miller_start(top: f64) -> u64 {
    (top + 20.0 + 10.0 * top.cbrt()) as u64
}

/// Unscaled values of a downward recurrence.
struct Miller {
    j0: f64,
    j1: f64,
    even: f64,
    odd: f64,
    kept: f64,
}

impl Miller {
    /// From order `start` down to 0 at `x > 0`; the value of the order for which `keep` holds is kept.
    fn run(start: u64, x: f64, keep: impl Fn(u64) -> bool) -> Self {
        const LARGE: f64 = 1e200;
        let (mut above, mut current) = (0.0, 1.0 / LARGE);
        let mut miller = Self { j0: 0.0, j1: 0.0, even: 0.0, odd: 0.0, kept: 0.0 };
        for order in (0..=start).rev() {
            if order % 2 == 0 {
                miller.even += current;
            } else {
                miller.odd += current;
            }
            if keep(order) {
                miller.kept = current;
            }
            if order == 0 {
                break;
            }
            let below = (2.0 * order as f64 + 1.0) / x * current - above;
            (above, current) = (current, below);
            if current.abs() > LARGE {
                let shrink = 1.0 / (LARGE * LARGE);
                above *= shrink;
                current *= shrink;
                miller.even *= shrink;
                miller.odd *= shrink;
                miller.kept *= shrink;
            }
        }
        miller.j0 = current;
        miller.j1 = above;
        miller
    }

    /// The factor that makes the values of the recurrence true ones.
    fn scale(&self, x: f64) -> f64 {
        if x <= 1.0 {
            return x.sin() / x / self.j0;
        }
        let (j0, j1) = first_two(x);
        // Both are never small together.
        if j0.abs() > j1.abs() { j0 / self.j0 } else { j1 / self.j1 }
    }
}
