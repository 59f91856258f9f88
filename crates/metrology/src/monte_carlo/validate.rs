use crate::error::check;
use crate::{Combined, Error};

/// Half of the last significant digit of a standard uncertainty rounded to `digits` digits (1 to 15): the numerical
/// tolerance `delta`. 0 for an uncertainty of 0.
///
/// ```
/// // JCGM 101 7.9.2, example 1: 0.00035 g to two digits.
/// assert_eq!(metrology::monte_carlo::numerical_tolerance(0.00035, 2)?, 0.5e-5);
/// # Ok::<(), metrology::Error>(())
/// ```
///
/// # Reference
///
/// JCGM 101 7.9.2.
pub fn numerical_tolerance(std: f64, digits: usize) -> Result<f64, Error> {
    if !(std.is_finite() && std >= 0.0) {
        return Err(Error::InvalidUncertainty { std });
    }
    check((1..=15).contains(&digits), "number of significant digits", digits as f64, "in 1..=15")?;
    if std == 0.0 {
        return Ok(0.0);
    }
    let text = format!("{std:.*e}", digits - 1);
    let exponent: i32 = text.split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0);
    Ok(format!("0.5e{}", exponent - (digits as i32 - 1)).parse().unwrap_or(0.0))
}

/// How far the interval of the GUM is from that of the Monte Carlo method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Validation {
    /// Distance of the lower ends.
    pub low: f64,
    /// Distance of the upper ends.
    pub high: f64,
    /// Numerical tolerance.
    pub tolerance: f64,
}

impl Validation {
    /// Whether neither distance exceeds the tolerance: first-order propagation is good enough here.
    pub fn agrees(&self) -> bool {
        self.low <= self.tolerance && self.high <= self.tolerance
    }
}

/// Compares `y - k u .. y + k u` with the ends of a Monte Carlo interval of the same probability, to `digits` significant
/// digits of `u` (1 to 15).
///
/// The interval should come from [`adaptive`](super::adaptive()) with a tolerance of one fifth (JCGM 101 8.2), that is one
/// digit more, or from 1e6 trials.
///
/// # Reference
///
/// JCGM 101 8.1.3 eq. 21 and 22.
pub fn validate(
    combined: &Combined,
    coverage_k: f64,
    interval: (f64, f64),
    digits: usize,
) -> Result<Validation, Error> {
    let expanded = combined.expanded(coverage_k);
    Ok(Validation {
        low: (combined.value() - expanded - interval.0).abs(),
        high: (combined.value() + expanded - interval.1).abs(),
        tolerance: numerical_tolerance(combined.std(), digits)?,
    })
}
