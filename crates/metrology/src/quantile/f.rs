//! The tail of the F distribution: p-values of tests.

use super::beta::beta_fraction;

/// Probability that F of `numerator` and `denominator` degrees of freedom exceeds `f`; an infinite denominator makes it
/// that of chi-squared over its degrees of freedom.
///
/// # Reference
///
/// Abramowitz and Stegun 26.6.2 (F by the incomplete beta function), 26.5.8 (its continued fraction), 26.4.4 and 26.4.5
/// (chi-squared of whole degrees of freedom).
#[must_use]
pub fn f_tail(f: f64, numerator: usize, denominator: f64) -> f64 {
    if f.is_nan() || f <= 0.0 {
        return 1.0;
    }
    let a = numerator as f64 / 2.0;
    if denominator.is_infinite() {
        return chi_squared_tail(f * numerator as f64, numerator);
    }
    let b = denominator / 2.0;
    // I_x(b, a) with x = d2 / (d2 + d1 F).
    let x = b / (b + a * f);
    if x < (b + 1.0) / (a + b + 2.0) { beta(b, a, x) } else { 1.0 - beta(a, b, 1.0 - x) }
}

/// Probability that chi-squared of `dof` degrees of freedom exceeds `x`, by the recurrence from one or two of them.
fn chi_squared_tail(x: f64, dof: usize) -> f64 {
    let half = x / 2.0;
    let (mut a, mut tail) = if dof.is_multiple_of(2) { (1.0, (-half).exp()) } else { (0.5, libm::erfc(half.sqrt())) };
    while a < dof as f64 / 2.0 {
        tail += (a * half.ln() - half - libm::lgamma(a + 1.0)).exp();
        a += 1.0;
    }
    tail.min(1.0)
}

/// The regularised incomplete beta function where its fraction converges quickly.
fn beta(a: f64, b: f64, x: f64) -> f64 {
    let front = a * x.ln() + b * (-x).ln_1p() + libm::lgamma(a + b) - libm::lgamma(a) - libm::lgamma(b);
    front.exp() * beta_fraction(a, b, x) / a
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_at_the_quantiles_are_their_probabilities() {
        for dof in [1.0, 2.0, 7.0, 23.0] {
            for probability in [0.6, 0.95, 0.9999] {
                let t = crate::student_t_quantile(probability, dof).unwrap();
                let tail = f_tail(t * t, 1, dof);
                assert!((tail - 2.0 * (1.0 - probability)).abs() < 1e-10, "t, {dof} {probability}: {tail}");
                let chi2 = crate::chi_squared_quantile(probability, dof).unwrap();
                let tail = f_tail(chi2 / dof, dof as usize, f64::INFINITY);
                assert!((tail - (1.0 - probability)).abs() < 1e-10, "chi2, {dof} {probability}: {tail}");
            }
        }
    }

    #[test]
    fn two_degrees_above_have_a_closed_form() {
        // With 2 in the numerator the tail is (1 + 2 F / d2)^(-d2 / 2).
        for (f, d2) in [(0.1, 5.0), (3.0, 20.0), (60.0, 9.0)] {
            let wanted = (1.0_f64 + 2.0 * f / d2).powf(-d2 / 2.0);
            assert!((f_tail(f, 2, d2) - wanted).abs() < 1e-12 * wanted.max(1e-3));
        }
    }
}
