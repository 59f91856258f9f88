use std::iter::Sum;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number with the derivative of how it was computed: forward automatic differentiation.
///
/// A model written in dual numbers gives its sensitivity coefficients to rounding error, without a step to choose. Where
/// a derivative does not exist (the root of 0, the modulus of 0) it is what the formula gives: infinite, NaN, or 0 for
/// the modulus. Arguments outside the domain of a function give NaN, as those of `f64` do.
///
/// ```
/// use metrology::Dual;
///
/// let x = Dual::variable(2.0);
/// let y = (x * x + 1.0).sqrt();
/// assert_eq!(y.value(), 5.0_f64.sqrt());
/// assert_eq!(y.derivative(), 2.0 / 5.0_f64.sqrt());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual {
    value: f64,
    derivative: f64,
}

impl Dual {
    /// The variable that is differentiated by.
    pub fn variable(value: f64) -> Self {
        Self { value, derivative: 1.0 }
    }

    /// A constant.
    pub fn constant(value: f64) -> Self {
        Self { value, derivative: 0.0 }
    }

    /// The number.
    pub fn value(self) -> f64 {
        self.value
    }

    /// Its derivative by the variable.
    pub fn derivative(self) -> f64 {
        self.derivative
    }

    /// A function's value here, and its slope here, by the chain rule.
    fn chain(self, value: f64, slope: f64) -> Self {
        // A constant stays one where the slope is infinite.
        let derivative = if self.derivative == 0.0 { 0.0 } else { slope * self.derivative };
        Self { value, derivative }
    }

    /// Integer power.
    #[must_use]
    pub fn powi(self, exponent: i32) -> Self {
        let slope = if exponent == 0 { 0.0 } else { f64::from(exponent) * self.value.powi(exponent - 1) };
        self.chain(self.value.powi(exponent), slope)
    }

    /// Real power of a number >= 0.
    #[must_use]
    pub fn powf(self, exponent: f64) -> Self {
        let slope = if exponent == 0.0 { 0.0 } else { exponent * self.value.powf(exponent - 1.0) };
        self.chain(self.value.powf(exponent), slope)
    }

    /// Square root.
    #[must_use]
    pub fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, 0.5 / root)
    }

    /// Exponential function.
    #[must_use]
    pub fn exp(self) -> Self {
        let exp = self.value.exp();
        self.chain(exp, exp)
    }

    /// Natural logarithm.
    #[must_use]
    pub fn ln(self) -> Self {
        self.chain(self.value.ln(), self.value.recip())
    }

    /// Sine of an angle in radians.
    #[must_use]
    pub fn sin(self) -> Self {
        self.chain(self.value.sin(), self.value.cos())
    }

    /// Cosine of an angle in radians.
    #[must_use]
    pub fn cos(self) -> Self {
        self.chain(self.value.cos(), -self.value.sin())
    }

    /// Tangent of an angle in radians.
    #[must_use]
    pub fn tan(self) -> Self {
        let tan = self.value.tan();
        self.chain(tan, 1.0 + tan * tan)
    }

    /// Angle in radians, -pi..=pi, of the point with ordinate `self` and abscissa `x`.
    #[must_use]
    pub fn atan2(self, x: impl Into<Self>) -> Self {
        let (y, x) = (self, x.into());
        let squared = x.value * x.value + y.value * y.value;
        Self { value: y.value.atan2(x.value), derivative: (x.value * y.derivative - y.value * x.derivative) / squared }
    }

    /// Modulus.
    #[must_use]
    pub fn abs(self) -> Self {
        let slope = if self.value == 0.0 { 0.0 } else { self.value.signum() };
        self.chain(self.value.abs(), slope)
    }
}

/// A constant.
impl From<f64> for Dual {
    fn from(value: f64) -> Self {
        Self::constant(value)
    }
}

impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, derivative: -self.derivative }
    }
}

impl<T: Into<Self>> Add<T> for Dual {
    type Output = Self;
    fn add(self, other: T) -> Self {
        let other = other.into();
        Self { value: self.value + other.value, derivative: self.derivative + other.derivative }
    }
}

impl<T: Into<Self>> Sub<T> for Dual {
    type Output = Self;
    fn sub(self, other: T) -> Self {
        let other = other.into();
        Self { value: self.value - other.value, derivative: self.derivative - other.derivative }
    }
}

impl<T: Into<Self>> Mul<T> for Dual {
    type Output = Self;
    fn mul(self, other: T) -> Self {
        let other = other.into();
        Self {
            value: self.value * other.value,
            derivative: self.derivative * other.value + self.value * other.derivative,
        }
    }
}

impl<T: Into<Self>> Div<T> for Dual {
    type Output = Self;
    fn div(self, other: T) -> Self {
        let other = other.into();
        let value = self.value / other.value;
        Self { value, derivative: (self.derivative - value * other.derivative) / other.value }
    }
}

impl Add<Dual> for f64 {
    type Output = Dual;
    fn add(self, other: Dual) -> Dual {
        Dual::constant(self) + other
    }
}

impl Sub<Dual> for f64 {
    type Output = Dual;
    fn sub(self, other: Dual) -> Dual {
        Dual::constant(self) - other
    }
}

impl Mul<Dual> for f64 {
    type Output = Dual;
    fn mul(self, other: Dual) -> Dual {
        Dual::constant(self) * other
    }
}

impl Div<Dual> for f64 {
    type Output = Dual;
    fn div(self, other: Dual) -> Dual {
        Dual::constant(self) / other
    }
}

impl Sum for Dual {
    fn sum<I: Iterator<Item = Self>>(iter: I) -> Self {
        iter.fold(Self::constant(0.0), |sum, x| sum + x)
    }
}
