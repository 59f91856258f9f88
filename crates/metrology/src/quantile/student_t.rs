use super::beta::beta_fraction;
use super::{normal, solve_positive};
use crate::Error;
use crate::error;

/// From here on the expansion about the normal distribution is exact to rounding.
const MANY_DOF: f64 = 1e5;

/// The number that a variable of Student's t distribution with `dof` degrees of freedom (real, greater than 0, perhaps
/// infinite) does not exceed with a probability in (0, 1).
///
/// Relative error below 1e-12 for probabilities of 1e-12 to 1 - 1e-12.
///
/// ```
/// // GUM table G.2: t_95 for 10 degrees of freedom is 2.23 (two-sided).
/// assert!((metrology::student_t_quantile(0.975, 10.0)? - 2.228_138_851_986_274).abs() < 1e-12);
/// # Ok::<(), metrology::Error>(())
/// ```
///
/// # Reference
///
/// The distribution function is an incomplete beta function, Abramowitz and Stegun 26.7.1 and 26.5.27; for many degrees
/// of freedom 26.7.5.
pub fn student_t_quantile(probability: f64, dof: f64) -> Result<f64, Error> {
    let tail = error::probability(probability)?.min(1.0 - probability);
    error::degrees_of_freedom(dof)?;
    let magnitude = if tail == 0.5 { 0.0 } else { upper(tail, dof)? };
    Ok(if probability < 0.5 { -magnitude } else { magnitude })
}

/// The `t` that is exceeded with a probability below one half.
fn upper(tail: f64, dof: f64) -> Result<f64, Error> {
    let z = -normal::normal_quantile(tail)?;
    if dof >= MANY_DOF {
        let squared = z * z;
        let first = z * (squared + 1.0) / 4.0;
        let second = z * ((5.0 * squared + 16.0) * squared + 3.0) / 96.0;
        let third = z * (((3.0 * squared + 19.0) * squared + 17.0) * squared - 15.0) / 384.0;
        return Ok(z + (first + (second + third / dof) / dof) / dof);
    }
    let ln_beta = ln_beta_half(dof / 2.0);
    // Whichever of the two is small keeps its relative accuracy.
    let outside = tail < 0.25;
    let target = if outside { 2.0 * tail } else { 1.0 - 2.0 * tail };
    let slope_sign = if outside { -1.0 } else { 1.0 };
    let log_slope = |t: f64| {
        let (within, beyond) = two_sided(t, dof, ln_beta);
        let value = if outside { beyond } else { within };
        // Twice the density times t: the derivative by ln t.
        let ratio = t * t / dof;
        let derivative = 2.0 * (0.5 * ratio.ln() - ln_beta - 0.5 * (dof + 1.0) * ratio.ln_1p()).exp();
        (value, slope_sign * derivative / value)
    };
    solve_positive(log_slope, target, z, !outside).ok_or(Error::QuantileOutOfReach { probability: tail, dof })
}

/// Probabilities of `|T| <= t` and of `|T| > t`.
fn two_sided(t: f64, dof: f64, ln_beta: f64) -> (f64, f64) {
    let ratio = t * t / dof;
    let (x, y) = (1.0 / (1.0 + ratio), ratio / (1.0 + ratio));
    let a = dof / 2.0;
    // x^a y^(1/2) / B(a, 1/2), with ln(x) = -ln(1 + t^2 / dof).
    let front = (-a * ratio.ln_1p() + 0.5 * y.ln() - ln_beta).exp();
    if x < (a + 1.0) / (a + 2.5) {
        let beyond = front * beta_fraction(a, 0.5, x) / a;
        (1.0 - beyond, beyond)
    } else {
        let within = front * beta_fraction(0.5, a, y) / 0.5;
        (within, 1.0 - within)
    }
}

/// `ln B(a, 1/2)`.
fn ln_beta_half(a: f64) -> f64 {
    let ln_sqrt_pi = 0.5 * std::f64::consts::PI.ln();
    if a < 20.0 {
        return ln_sqrt_pi + libm::lgamma(a) - libm::lgamma(a + 0.5);
    }
    // ln of the ratio of the gamma functions, where their difference would cancel (Abramowitz and Stegun 6.1.47).
    let b = 1.0 / (a * a);
    let series = (1.0 / 8.0 - b * (1.0 / 192.0 - b * (1.0 / 640.0 - b * (17.0 / 14336.0 - b * (31.0 / 18432.0))))) / a;
    ln_sqrt_pi - 0.5 * a.ln() + series
}
