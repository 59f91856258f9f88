//! Numbers as the unevaluated sum of two doubles: about 32 decimal digits.
//!
//! # Reference
//!
//! T. J. Dekker, "A floating-point technique for extending the available precision", Numer. Math. 18 (1971) 224-242;
//! `TwoSum` is Knuth's, `TwoProd` uses a fused multiply-add (Ogita, Rump, Oishi, SIAM J. Sci. Comput. 26 (2005), alg. 3.5).

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// `high + low`, where `low` is at most half a unit in the last place of `high`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct DoubleDouble {
    pub(super) high: f64,
    pub(super) low: f64,
}

impl DoubleDouble {
    /// The sum of two doubles without error.
    fn two_sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let b_part = high - a;
        Self { high, low: (a - (high - b_part)) + (b - b_part) }
    }

    /// The same where `|a| >= |b|`.
    fn quick_two_sum(a: f64, b: f64) -> Self {
        let high = a + b;
        Self { high, low: b - (high - a) }
    }

    /// The product of two doubles without error.
    pub(super) fn product(a: f64, b: f64) -> Self {
        let high = a * b;
        Self { high, low: a.mul_add(b, -high) }
    }

    /// The nearest double.
    pub(super) fn rounded(self) -> f64 {
        self.high + self.low
    }
}

impl From<f64> for DoubleDouble {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Add for DoubleDouble {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let sum = Self::two_sum(self.high, other.high);
        let low = Self::two_sum(self.low, other.low);
        let sum = Self::quick_two_sum(sum.high, sum.low + low.high);
        Self::quick_two_sum(sum.high, sum.low + low.low)
    }
}

impl AddAssign for DoubleDouble {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Neg for DoubleDouble {
    type Output = Self;

    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let product = Self::product(self.high, other.high);
        Self::quick_two_sum(product.high, product.low + (self.high * other.low + self.low * other.high))
    }
}

impl Div<f64> for DoubleDouble {
    type Output = Self;

    fn div(self, divisor: f64) -> Self {
        let high = self.high / divisor;
        let rest = self - Self::product(high, divisor);
        Self::quick_two_sum(high, rest.rounded() / divisor)
    }
}

#[cfg(test)]
mod tests {
    use super::DoubleDouble;

    #[test]
    fn a_sum_keeps_what_a_double_drops() {
        let tiny = 2f64.powi(-40);
        let sum = DoubleDouble::from(1e16) + DoubleDouble::from(1.0) + DoubleDouble::from(tiny);
        assert_eq!((sum - DoubleDouble::from(1e16)).rounded(), 1.0 + tiny);
        assert_eq!((sum - DoubleDouble::from(1e16) - DoubleDouble::from(1.0)).rounded(), tiny);
    }

    #[test]
    fn a_product_is_exact() {
        // (2^53 - 1)^2 = 2^106 - 2^54 + 1
        let n = 9_007_199_254_740_991.0_f64;
        let rest = DoubleDouble::product(n, n) - DoubleDouble::from(2f64.powi(106)) + DoubleDouble::from(2f64.powi(54));
        assert_eq!(rest.rounded(), 1.0);
    }

    #[test]
    fn a_quotient_times_its_divisor_is_the_dividend() {
        let third = DoubleDouble::from(1.0) / 3.0;
        let rest = third * DoubleDouble::from(3.0) - DoubleDouble::from(1.0);
        assert!(rest.rounded().abs() < 2f64.powi(-100), "{rest:?}");
    }
}
