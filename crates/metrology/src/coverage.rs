//! Coverage factors.

use crate::error::{check, degrees_of_freedom, probability};
use crate::{Combined, Distribution, Error, Input, normal_quantile, student_t_quantile};

/// The thesis's coverage factor of a dominant rectangular distribution, for about 95 %: `sqrt(3) * 0.95 = 1.645`.
pub const RECTANGULAR_K: f64 = 1.65;
/// The usual coverage factor of a normal distribution, for about 95 % (GUM 6.3.3).
pub const NORMAL_K: f64 = 2.0;
/// Below this ratio of the other contributions to the largest one, that one gives the result its shape (thesis eq. 8.14).
pub const DOMINANT_RATIO: f64 = 0.3;

/// Coverage factor of an interval of a probability in (0, 1) for a result with `dof` degrees of freedom.
///
/// The degrees of freedom are taken as the real number they are. GUM G.4.1 allows that as well as rounding them down,
/// which is `dof.floor()` and gives a slightly larger factor.
///
/// ```
/// assert!((metrology::coverage_factor(0.95, 13.0)? - 2.160).abs() < 5e-4); // GUM table G.2: 2.16
/// # Ok::<(), metrology::Error>(())
/// ```
///
/// # Reference
///
/// GUM G.3.2 eq. G.1d.
pub fn coverage_factor(probability: f64, dof: f64) -> Result<f64, Error> {
    // Of the tail, which keeps its digits where the probability is near 1.
    degrees_of_freedom(dof)?;
    Ok(-student_t_quantile((1.0 - self::probability(probability)?) / 2.0, dof)?)
}

/// Coverage factor of a normal distribution.
pub fn normal_coverage_factor(probability: f64) -> Result<f64, Error> {
    Ok(-normal_quantile((1.0 - self::probability(probability)?) / 2.0)?)
}

/// Coverage factor of a rectangular distribution: `sqrt(3) p`, since its half-width is `sqrt(3) u` (GUM 4.3.7) and an
/// interval of the probability p is that part of it.
pub fn rectangular_coverage_factor(probability: f64) -> Result<f64, Error> {
    Ok(3.0_f64.sqrt() * self::probability(probability)?)
}

/// Which contribution is the largest, and whether it dominates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dominance {
    /// Index of the largest contribution.
    pub largest: usize,
    /// Root sum of squares of the others divided by the largest, `U_R / U_1` of the thesis.
    pub ratio: f64,
    /// Whether the ratio is below [`DOMINANT_RATIO`] and the largest contribution is rectangular.
    pub rectangular: bool,
}

impl Dominance {
    /// The thesis's coverage factor for about 95 %: [`RECTANGULAR_K`] or else [`NORMAL_K`].
    pub fn coverage_k(&self) -> f64 {
        if self.rectangular { RECTANGULAR_K } else { NORMAL_K }
    }
}

/// Finds the dominant contribution to a result of independent inputs; `None` if nothing contributes.
///
/// The thesis compares the contribution of the time with the rest; here it is the largest contribution, whichever that
/// is.
///
/// # Reference
///
/// Thesis eq. 8.12 to 8.14.
pub fn dominance(contributions: &[f64], distributions: &[Distribution]) -> Option<Dominance> {
    let (largest, top) = contributions
        .iter()
        .map(|u| u.abs())
        .enumerate()
        .fold((0, 0.0), |best, next| if next.1 > best.1 { next } else { best });
    if top == 0.0 {
        return None;
    }
    let rest: f64 = contributions.iter().enumerate().filter(|&(i, _)| i != largest).map(|(_, u)| u * u).sum();
    let ratio = rest.sqrt() / top;
    let rectangular = ratio < DOMINANT_RATIO && distributions.get(largest) == Some(&Distribution::Rectangular);
    Some(Dominance { largest, ratio, rectangular })
}

/// How an expanded uncertainty is chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Coverage {
    /// Interval of this probability in (0, 1), by Student's t with the effective degrees of freedom.
    Probability(f64),
    /// This coverage factor, greater than 0.
    Factor(f64),
    /// The thesis's rule of the dominant distribution: k = 1.65 or 2 ([`dominance`]).
    Dominant,
}

impl Coverage {
    /// The coverage factor for a result of these inputs.
    pub fn factor(self, inputs: &[Input], combined: &Combined) -> Result<f64, Error> {
        match self {
            Self::Probability(p) => coverage_factor(p, combined.dof()),
            Self::Factor(k) => check(k.is_finite() && k > 0.0, "coverage factor", k, "finite and greater than 0"),
            Self::Dominant => {
                let shapes: Vec<_> = inputs.iter().map(Input::distribution).collect();
                Ok(dominance(combined.contributions(), &shapes).map_or(NORMAL_K, |d| d.coverage_k()))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dominant_rectangle_has_its_own_factor() {
        use Distribution::{Normal, Rectangular};
        let d = dominance(&[-4.0, 1.0], &[Rectangular, Normal]).unwrap();
        assert_eq!((d.largest, d.ratio, d.coverage_k()), (0, 0.25, 1.65));
        assert_eq!(dominance(&[4.0, 1.3], &[Rectangular, Normal]).unwrap().coverage_k(), 2.0);
        assert_eq!(dominance(&[4.0, 1.0], &[Normal, Rectangular]).unwrap().coverage_k(), 2.0);
        assert_eq!(dominance(&[0.0], &[Rectangular]), None);
    }

    #[test]
    fn the_thesis_rounds_the_factor_of_a_rectangle_up() {
        assert!((rectangular_coverage_factor(0.95).unwrap() - 1.645).abs() < 5e-4);
        assert!(rectangular_coverage_factor(1.0).is_err());
    }
}
