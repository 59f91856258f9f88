use crate::error::{check, degrees_of_freedom};
use crate::{Distribution, Error, Measurement, TypeA, type_b, welch_satterthwaite};

/// An input quantity of a model: estimate, standard uncertainty, degrees of freedom, distribution, label and unit.
///
/// ```
/// use metrology::Input;
///
/// let length = Input::new("L", 23.40, 0.20)?.with_unit("px").with_dof(9.0)?;
/// let limits = Input::rectangular("t", 20.0, 0.5)?.with_unit("degC");
/// assert_eq!(length.dof(), 9.0);
/// assert_eq!(limits.std(), 0.5 / 3.0_f64.sqrt());
/// # Ok::<(), metrology::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Input {
    label: String,
    unit: String,
    #[cfg_attr(feature = "serde", serde(flatten))]
    estimate: Measurement,
    dof: f64,
    distribution: Distribution,
}

impl Input {
    /// An estimate with its standard uncertainty (k = 1): normal, with infinitely many degrees of freedom and no unit.
    pub fn new(label: impl Into<String>, value: f64, std: f64) -> Result<Self, Error> {
        Ok(Self::from(Measurement::new(value, std)?).with_label(label))
    }

    /// A value taken as exact.
    pub fn exact(label: impl Into<String>, value: f64) -> Result<Self, Error> {
        Self::new(label, value, 0.0)
    }

    /// Type A: the mean of at least two observations with `n - 1` degrees of freedom, Student's t (GUM 4.2).
    pub fn from_observations(label: impl Into<String>, observations: &[f64]) -> Result<Self, Error> {
        let a = TypeA::of(observations)?;
        Self::new(label, a.mean(), a.std())?.with_dof(a.dof())?.with_distribution(Distribution::StudentT)
    }

    /// An expanded uncertainty with its coverage factor, normal (GUM 4.3.3).
    pub fn from_expanded(label: impl Into<String>, value: f64, expanded: f64, coverage_k: f64) -> Result<Self, Error> {
        Self::new(label, value, type_b::normal_std(expanded, coverage_k)?)
    }

    /// Limits `value +- half_width` of a bounded distribution (for the curvilinear trapezoid the best estimates of the
    /// limits).
    pub fn within(
        label: impl Into<String>,
        value: f64,
        half_width: f64,
        distribution: Distribution,
    ) -> Result<Self, Error> {
        let bounded = !matches!(distribution, Distribution::Normal | Distribution::StudentT);
        check(bounded, "half-width of an unbounded distribution", half_width, "a bounded distribution")?;
        check(half_width.is_finite() && half_width >= 0.0, "half-width", half_width, "finite and at least 0")?;
        let std = half_width / distribution.checked()?.half_width_per_std();
        Self::new(label, value, std)?.with_distribution(distribution)
    }

    /// Limits `value +- half_width`, all values between equally probable (GUM 4.3.7).
    pub fn rectangular(label: impl Into<String>, value: f64, half_width: f64) -> Result<Self, Error> {
        Self::within(label, value, half_width, Distribution::Rectangular)
    }

    /// The same quantity under another label.
    #[must_use]
    pub fn with_label(self, label: impl Into<String>) -> Self {
        Self { label: label.into(), ..self }
    }

    /// The same quantity with a unit, which is only printed.
    #[must_use]
    pub fn with_unit(self, unit: impl Into<String>) -> Self {
        Self { unit: unit.into(), ..self }
    }

    /// The same quantity with degrees of freedom, greater than 0, `f64::INFINITY` included.
    pub fn with_dof(self, dof: f64) -> Result<Self, Error> {
        Ok(Self { dof: degrees_of_freedom(dof)?, ..self })
    }

    /// The same quantity, value and standard uncertainty with another shape.
    pub fn with_distribution(self, distribution: Distribution) -> Result<Self, Error> {
        Ok(Self { distribution: distribution.checked()?, ..self })
    }

    /// The same quantity with one more independent component of uncertainty, say the resolution of the instrument
    /// beside the scatter of its readings: standard uncertainties add as a root sum of squares, degrees of freedom by
    /// [`welch_satterthwaite`](crate::welch_satterthwaite). The shape of the sum is taken as Student's t, or as normal if
    /// the degrees of freedom are infinite.
    ///
    /// ```
    /// use metrology::{Input, type_b};
    ///
    /// // A tooth of the slider's sheet, mm: readings, accuracy class 0.05 % and resolution of the caliper.
    /// let tooth = Input::from_observations("x", &[3.17, 3.18, 3.16, 3.19])?
    ///     .with_component(type_b::accuracy_class_std(0.05, 3.175)?, f64::INFINITY)?
    ///     .with_component(type_b::resolution_std(0.01)?, f64::INFINITY)?;
    /// assert!((tooth.std() - 0.0071).abs() < 5e-5);
    /// # Ok::<(), metrology::Error>(())
    /// ```
    ///
    /// # Reference
    ///
    /// Thesis eq. 8.5; GUM 5.1.2 and G.4.1.
    pub fn with_component(self, std: f64, dof: f64) -> Result<Self, Error> {
        let component = Measurement::new(0.0, std)?.std();
        let dof = welch_satterthwaite(&[(self.std(), self.dof), (component, degrees_of_freedom(dof)?)]);
        let distribution = if dof.is_finite() { Distribution::StudentT } else { Distribution::Normal };
        let estimate = Measurement::new(self.value(), self.std().hypot(component))?;
        Ok(Self { estimate, dof, distribution, ..self })
    }

    /// Label.
    pub fn label(&self) -> &str {
        &self.label
    }

    /// Unit of value and standard uncertainty, empty if none was given.
    pub fn unit(&self) -> &str {
        &self.unit
    }

    /// Estimate.
    pub fn value(&self) -> f64 {
        self.estimate.value()
    }

    /// Standard uncertainty.
    pub fn std(&self) -> f64 {
        self.estimate.std()
    }

    /// Degrees of freedom, `f64::INFINITY` if the standard uncertainty is known exactly.
    pub fn dof(&self) -> f64 {
        self.dof
    }

    /// Shape.
    pub fn distribution(&self) -> Distribution {
        self.distribution
    }

    /// Estimate and standard uncertainty alone.
    pub fn measurement(&self) -> Measurement {
        self.estimate
    }
}

/// A measurement without label, normal, with infinitely many degrees of freedom.
impl From<Measurement> for Input {
    fn from(estimate: Measurement) -> Self {
        Self {
            label: String::new(),
            unit: String::new(),
            estimate,
            dof: f64::INFINITY,
            distribution: Distribution::Normal,
        }
    }
}

/// The estimate and standard uncertainty alone.
impl From<&Input> for Measurement {
    fn from(input: &Input) -> Self {
        input.estimate
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn components_of_one_input_add_as_squares_with_their_degrees_of_freedom() {
        let x = Input::new("x", 5.0, 3.0).unwrap().with_dof(9.0).unwrap().with_unit("mm");
        let x = x.with_component(4.0, f64::INFINITY).unwrap();
        // 5^4 / (3^4 / 9)
        assert_eq!((x.value(), x.std(), x.unit()), (5.0, 5.0, "mm"));
        assert!((x.dof() - 625.0 / 9.0).abs() < 1e-9);
        assert_eq!(x.distribution(), Distribution::StudentT);
        assert!(x.clone().with_component(-1.0, 3.0).is_err() && x.with_component(1.0, 0.0).is_err());
    }

    #[test]
    fn limits_need_a_bounded_shape() {
        assert!(Input::within("x", 0.0, 1.0, Distribution::Normal).is_err());
        assert!(Input::within("x", 0.0, -1.0, Distribution::Triangular).is_err());
        let narrow = Input::within("x", 0.0, 1.0, Distribution::Trapezoidal { beta: 2.0 });
        assert!(narrow.is_err());
    }
}
