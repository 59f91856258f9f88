use super::solve_positive;
use crate::Error;
use crate::error;

/// The number that the sum of squares of `dof` standard normal variables does not exceed with a probability in (0, 1);
/// `dof` is real and between 0 (excluded) and 1e6.
///
/// ```
/// // Two degrees of freedom: -2 ln(1 - p).
/// assert!((metrology::chi_squared_quantile(0.95, 2.0)? + 2.0 * 0.05_f64.ln()).abs() < 1e-12);
/// # Ok::<(), metrology::Error>(())
/// ```
///
/// # Reference
///
/// Abramowitz and Stegun 26.4.19 (incomplete gamma function) and 26.4.17 (starting value).
pub fn chi_squared_quantile(probability: f64, dof: f64) -> Result<f64, Error> {
    error::probability(probability)?;
    error::check(dof > 0.0 && dof <= 1e6, "degrees of freedom", dof, "between 0 (excluded) and 1e6")?;
    let a = dof / 2.0;
    let ln_gamma = libm::lgamma(a);
    let upper = probability > 0.5;
    let target = if upper { 1.0 - probability } else { probability };
    let sign = if upper { -1.0 } else { 1.0 };
    let f = |x: f64| {
        let half = x / 2.0;
        let front = (a * half.ln() - half - ln_gamma).exp();
        let (below, above) = incomplete_gamma(a, half, front);
        let value = if upper { above } else { below };
        (value, sign * front / value)
    };
    let z = super::normal_quantile(probability)?;
    let cube = 1.0 - 2.0 / (9.0 * dof) + z * (2.0 / (9.0 * dof)).sqrt();
    let guess = (dof * cube.powi(3)).max(1e-3 * dof);
    solve_positive(f, target, guess, !upper).ok_or(Error::QuantileOutOfReach { probability, dof })
}

/// Regularised incomplete gamma functions `P(a, x)` and `Q(a, x)`; `front` is `x^a e^-x / Gamma(a)`.
fn incomplete_gamma(a: f64, x: f64, front: f64) -> (f64, f64) {
    if x < a + 1.0 {
        // Series, Abramowitz and Stegun 6.5.29.
        let (mut term, mut sum, mut n) = (1.0 / a, 1.0 / a, a);
        while term > 1e-17 * sum {
            n += 1.0;
            term *= x / n;
            sum += term;
        }
        (front * sum, 1.0 - front * sum)
    } else {
        // Continued fraction, Abramowitz and Stegun 6.5.31, by Lentz's method.
        let mut b = x + 1.0 - a;
        let mut c = f64::MAX;
        let mut d = 1.0 / b;
        let mut fraction = d;
        for i in 1..100_000 {
            let i = f64::from(i);
            let numerator = -i * (i - a);
            b += 2.0;
            d = 1.0 / (numerator * d + b);
            c = b + numerator / c;
            fraction *= c * d;
            if (c * d - 1.0).abs() <= f64::EPSILON {
                break;
            }
        }
        (1.0 - front * fraction, front * fraction)
    }
}
