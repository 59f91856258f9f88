use crate::Error;

/// An estimate and its standard uncertainty, both in the same unit.
///
/// It is what crosses the border between crates; [`Input`](crate::Input) adds what a budget needs. Its text is the
/// concise notation with two digits of uncertainty ([`crate::concise`]), and it can be parsed from it.
///
/// ```
/// let tooth_mm: metrology::Measurement = "3.174(35)".parse()?;
/// assert_eq!((tooth_mm.value(), tooth_mm.std()), (3.174, 0.035));
/// assert_eq!(tooth_mm.to_string(), "3.174(35)");
/// # Ok::<(), metrology::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Measurement {
    value: f64,
    std: f64,
}

impl Measurement {
    /// A measured `value` with standard uncertainty `std` (k = 1, same unit).
    pub fn new(value: f64, std: f64) -> Result<Self, Error> {
        if !value.is_finite() {
            return Err(Error::ValueNotFinite { value });
        }
        if !(std.is_finite() && std >= 0.0) {
            return Err(Error::InvalidUncertainty { std });
        }
        Ok(Self { value, std })
    }

    /// A value taken as exact: its uncertainty is zero.
    pub fn exact(value: f64) -> Result<Self, Error> {
        Self::new(value, 0.0)
    }

    /// The estimate.
    pub fn value(self) -> f64 {
        self.value
    }

    /// The standard uncertainty (one standard deviation).
    pub fn std(self) -> f64 {
        self.std
    }

    /// The expanded uncertainty `U = k u` for a coverage factor `k` (GUM 6.2.1).
    pub fn expanded(self, coverage_k: f64) -> f64 {
        coverage_k * self.std
    }
}

/// Combined standard uncertainty of a function of independent inputs, first order: the root sum of squares of
/// `sensitivity * std` (GUM eq. 10 and 11a).
///
/// Each pair is a sensitivity coefficient (partial derivative) and the standard uncertainty of its input.
///
/// ```
/// // v = x / t with x = 0.1(0.001) m and t = 0.5(0.002) s
/// let (x, ux, t, ut) = (0.1_f64, 0.001, 0.5, 0.002);
/// let u = metrology::combined_std([(1.0 / t, ux), (-x / (t * t), ut)]);
/// assert!((u - 0.002_154_065_9).abs() < 1e-9);
/// ```
pub fn combined_std(contributions: impl IntoIterator<Item = (f64, f64)>) -> f64 {
    contributions.into_iter().map(|(sensitivity, std)| (sensitivity * std).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_uncertainty_is_finite_and_not_negative() {
        assert_eq!(Measurement::new(1.0, -0.1), Err(Error::InvalidUncertainty { std: -0.1 }));
        assert!(Measurement::new(1.0, f64::NAN).is_err());
        assert!(Measurement::new(f64::INFINITY, 0.0).is_err());
    }

    #[test]
    fn combined_uncertainty_of_the_gum_end_gauge_terms() {
        // GUM H.1, table H.1: standard uncertainties of the components (nm) combine to 32 nm.
        let u = combined_std([(1.0, 25.0), (1.0, 9.7), (0.0, 0.0), (0.0, 0.0), (1.0, 2.9), (1.0, 16.6)]);
        assert!((u - 31.7).abs() < 0.1, "{u}");
    }
}
