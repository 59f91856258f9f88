//! Correlation of the values of a process at two places.

use serde::{Deserialize, Serialize};

/// Correlation as a function of `q = |x - z|² / length_scale²`.
///
/// *Reference*: Rasmussen & Williams 2006, section 4.2.1: equations 4.9, 4.18 (exponential: Matérn 1/2), 4.17 and 4.19.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kernel {
    /// `exp(-√q)`.
    Exponential,
    /// `(1 + √(5q) + 5q/3) exp(-√(5q))`.
    Matern52,
    /// `(1 + q / 2a)^-a` of exponent a, which may grow beyond all bounds where the squared exponential fits better.
    RationalQuadratic,
    /// `exp(-q/2)`.
    SquaredExponential,
}

impl Kernel {
    /// The correlation.
    pub(super) fn value(self, q: f64, exponent: f64) -> f64 {
        match self {
            Self::Exponential => (-q.sqrt()).exp(),
            Self::Matern52 => {
                let s = (5.0 * q).sqrt();
                (1.0 + s + s * s / 3.0) * (-s).exp()
            }
            Self::RationalQuadratic => (-exponent * (q / (2.0 * exponent)).ln_1p()).exp(),
            Self::SquaredExponential => (-q / 2.0).exp(),
        }
    }

    /// The correlation and its derivatives by the logarithms of the length scale and the exponent.
    pub(super) fn with_derivatives(self, q: f64, exponent: f64) -> [f64; 3] {
        let value = self.value(q, exponent);
        match self {
            Self::Exponential => [value, q.sqrt() * value, 0.0],
            Self::Matern52 => {
                let s = (5.0 * q).sqrt();
                [value, s * s / 3.0 * (1.0 + s) * (-s).exp(), 0.0]
            }
            Self::RationalQuadratic => {
                let u = q / (2.0 * exponent);
                [value, q * value / (1.0 + u), exponent * (u / (1.0 + u) - u.ln_1p()) * value]
            }
            Self::SquaredExponential => [value, q * value, 0.0],
        }
    }

    /// Whether the exponent is one of its parameters.
    pub(super) fn has_exponent(self) -> bool {
        self == Self::RationalQuadratic
    }
}
