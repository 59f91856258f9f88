//! Type B evaluation: standard uncertainty from what is known otherwise (limits, certificates, data sheets).
//!
//! Every function returns a standard uncertainty (k = 1) in the unit of its argument unless it says otherwise.

use crate::coverage::normal_coverage_factor;
use crate::error::check;
use crate::{Distribution, Error};

fn from_half_width(distribution: Distribution, half_width: f64) -> Result<f64, Error> {
    check(half_width.is_finite() && half_width >= 0.0, "half-width", half_width, "finite and at least 0")?;
    Ok(half_width / distribution.checked()?.half_width_per_std())
}

/// Limits `+-a`, all values between equally probable: `a / sqrt(3)` (GUM 4.3.7 eq. 7).
///
/// ```
/// assert!((metrology::type_b::rectangular_std(3.0)? - 3.0_f64.sqrt()).abs() < 1e-15);
/// # Ok::<(), metrology::Error>(())
/// ```
pub fn rectangular_std(half_width: f64) -> Result<f64, Error> {
    from_half_width(Distribution::Rectangular, half_width)
}

/// Limits `+-a`, values near the middle more probable: `a / sqrt(6)` (GUM 4.3.9 eq. 9b).
pub fn triangular_std(half_width: f64) -> Result<f64, Error> {
    from_half_width(Distribution::Triangular, half_width)
}

/// A sinusoid of amplitude `a` and unknown phase: `a / sqrt(2)` (GUM H.1.3.4; JCGM 101 6.4.6).
pub fn arcsine_std(half_width: f64) -> Result<f64, Error> {
    from_half_width(Distribution::Arcsine, half_width)
}

/// A trapezoid with base `2 a` and top `2 a beta`, `beta` in 0..=1: `a sqrt((1 + beta^2) / 6)` (GUM 4.3.9 eq. 9a).
pub fn trapezoidal_std(half_width: f64, beta: f64) -> Result<f64, Error> {
    from_half_width(Distribution::Trapezoidal { beta }, half_width)
}

/// An expanded uncertainty `U` of a certificate that states its coverage factor `k`: `U / k` (GUM 4.3.3).
pub fn normal_std(expanded: f64, coverage_k: f64) -> Result<f64, Error> {
    check(expanded.is_finite() && expanded >= 0.0, "expanded uncertainty", expanded, "finite and at least 0")?;
    check(coverage_k.is_finite() && coverage_k > 0.0, "coverage factor", coverage_k, "finite and greater than 0")?;
    Ok(expanded / coverage_k)
}

/// An interval `+-a` that contains the value with a probability in (0, 1), normal distribution (GUM 4.3.4).
///
/// ```
/// // GUM 4.3.4: 10.000742 ohm +- 129 uohm at 99 %.
/// assert!((metrology::type_b::normal_std_from_interval(129.0, 0.99)? - 50.0).abs() < 0.1);
/// # Ok::<(), metrology::Error>(())
/// ```
pub fn normal_std_from_interval(half_width: f64, probability: f64) -> Result<f64, Error> {
    normal_std(half_width, normal_coverage_factor(probability)?)
}

/// Accuracy class (per cent of the reading) of an instrument: `|class / 100 * reading| / (2 sqrt(3))`.
///
/// As the thesis writes it the class is the full width of a rectangular distribution. A data sheet that promises
/// `+-class` means [`rectangular_std`] of `class / 100 * reading`, which is twice as much.
///
/// # Reference
///
/// Thesis eq. 8.3.
pub fn accuracy_class_std(class_percent: f64, reading: f64) -> Result<f64, Error> {
    rectangular_std((class_percent / 100.0 * reading).abs() / 2.0)
}

/// Resolution of a display, the width of one step: `resolution / (2 sqrt(3))` (GUM F.2.2.1; thesis eq. 8.4).
///
/// ```
/// // GUM F.2.2.1: 0.29 of the step.
/// assert!((metrology::type_b::resolution_std(0.01)? - 0.0029).abs() < 2e-5);
/// # Ok::<(), metrology::Error>(())
/// ```
pub fn resolution_std(resolution: f64) -> Result<f64, Error> {
    rectangular_std(resolution / 2.0)
}

/// Accuracy class in per cent of an instrument that reads `reading` where a standard instrument reads `standard` (not
/// 0): `100 (reading - standard) / standard`, with its sign.
///
/// # Reference
///
/// Thesis eq. 8.7.
pub fn accuracy_class_percent(reading: f64, standard: f64) -> Result<f64, Error> {
    check(reading.is_finite(), "reading", reading, "finite")?;
    check(standard.is_finite() && standard != 0.0, "reading of the standard", standard, "finite and not 0")?;
    Ok(100.0 * (reading - standard) / standard)
}

/// Degrees of freedom of a standard uncertainty that is itself known to a relative uncertainty in (0, 1], say 0.25 for
/// 25 per cent: `1 / (2 relative^2)`. One that is known exactly has infinitely many (`f64::INFINITY`).
///
/// ```
/// // GUM G.4.2: 25 % is 8 degrees of freedom.
/// assert_eq!(metrology::type_b::dof_from_relative_uncertainty(0.25)?, 8.0);
/// # Ok::<(), metrology::Error>(())
/// ```
///
/// # Reference
///
/// GUM G.4.2 eq. G.3.
pub fn dof_from_relative_uncertainty(relative: f64) -> Result<f64, Error> {
    check(relative > 0.0 && relative <= 1.0, "relative uncertainty of the uncertainty", relative, "in (0, 1]")?;
    Ok(0.5 / (relative * relative))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standard_uncertainties_of_the_limits_of_gum_4_3() {
        assert!((triangular_std(6.0).unwrap() - 6.0_f64.sqrt()).abs() < 1e-15);
        assert!((arcsine_std(0.5).unwrap() - 0.35).abs() < 0.004); // GUM H.1.3.4
        // A trapezoid without a top is a triangle, with a full one a rectangle.
        assert_eq!(trapezoidal_std(1.0, 0.0), triangular_std(1.0));
        assert!((trapezoidal_std(1.0, 1.0).unwrap() - rectangular_std(1.0).unwrap()).abs() < 1e-15);
        assert!(trapezoidal_std(1.0, 1.1).is_err());
        assert!(rectangular_std(-1.0).is_err());
    }

    #[test]
    fn caliper_and_timer_of_the_thesis() {
        // 0.05 % of 25.2 mm, 0.01 mm steps: by hand 0.0126 / 3.4641 and 0.01 / 3.4641.
        assert!((accuracy_class_std(0.05, 25.2).unwrap() - 0.003_637_307).abs() < 1e-9);
        assert!((resolution_std(0.01).unwrap() - 0.002_886_751).abs() < 1e-9);
        assert!((accuracy_class_percent(101.0, 100.0).unwrap() - 1.0).abs() < 1e-15);
        assert_eq!(accuracy_class_std(-0.05, 25.2), accuracy_class_std(0.05, 25.2));
        assert!(accuracy_class_percent(1.0, 0.0).is_err());
    }
}
