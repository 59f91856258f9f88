//! First-order propagation of uncertainties through a model.

use crate::error::check;
use crate::{Correlation, Dual, Error, Input, Measurement, dof};

/// Sensitivity coefficients of a model at a point by automatic differentiation: exact to rounding.
///
/// ```
/// // v = x / t
/// let c = metrology::sensitivities(|q| q[0] / q[1], &[0.1, 0.5]);
/// assert_eq!(c, [2.0, -0.4]);
/// ```
///
/// # Reference
///
/// GUM 5.1.3.
pub fn sensitivities(model: impl Fn(&[Dual]) -> Dual, at: &[f64]) -> Vec<f64> {
    let [row] = jacobian(|q| [model(q)], at);
    row
}

/// Rows of derivatives, one for each output.
pub(crate) fn jacobian<const M: usize>(model: impl Fn(&[Dual]) -> [Dual; M], at: &[f64]) -> [Vec<f64>; M] {
    let mut point: Vec<Dual> = at.iter().map(|&x| Dual::constant(x)).collect();
    let mut rows = std::array::from_fn(|_| Vec::<f64>::with_capacity(at.len()));
    for (i, &x) in at.iter().enumerate() {
        point[i] = Dual::variable(x);
        for (row, output) in rows.iter_mut().zip(model(&point)) {
            row.push(output.derivative());
        }
        point[i] = Dual::constant(x);
    }
    rows
}

/// Sensitivity coefficients of a model at a point by central differences over `steps` (not 0, one for each input), for a
/// model that is not written in [`Dual`].
///
/// # Reference
///
/// GUM 5.1.3, note 2, where the steps are the standard uncertainties.
pub fn sensitivities_numeric(model: impl Fn(&[f64]) -> f64, at: &[f64], steps: &[f64]) -> Result<Vec<f64>, Error> {
    if steps.len() != at.len() {
        return Err(Error::Count { what: "steps", expected: at.len(), found: steps.len() });
    }
    let mut point = at.to_vec();
    let mut slopes = Vec::with_capacity(at.len());
    for (i, (&x, &step)) in at.iter().zip(steps).enumerate() {
        let (low, high) = (x - step, x + step);
        check(high != low, "step of a difference", step, "finite and large enough to change the input")?;
        point[i] = high;
        let above = model(&point);
        point[i] = low;
        let below = model(&point);
        point[i] = x;
        // The step as it was rounded.
        slopes.push((above - below) / (high - low));
    }
    Ok(slopes)
}

/// The estimate of an output quantity with everything its budget says.
#[derive(Debug, Clone, PartialEq)]
pub struct Combined {
    value: f64,
    std: f64,
    dof: f64,
    sensitivities: Vec<f64>,
    contributions: Vec<f64>,
    shares: Vec<f64>,
}

impl Combined {
    /// Combines inputs by the value of a model and its sensitivity coefficients, one for each input.
    pub fn new(
        inputs: &[Input],
        correlation: &Correlation,
        value: f64,
        sensitivities: Vec<f64>,
    ) -> Result<Self, Error> {
        correlation.check_size(inputs.len())?;
        if sensitivities.len() != inputs.len() {
            return Err(Error::Count {
                what: "sensitivity coefficients",
                expected: inputs.len(),
                found: sensitivities.len(),
            });
        }
        if let Some(&value) = std::iter::once(&value).chain(&sensitivities).find(|x| !x.is_finite()) {
            return Err(Error::ModelNotFinite { value });
        }
        let contributions: Vec<f64> = sensitivities.iter().zip(inputs).map(|(c, x)| c * x.std()).collect();
        // GUM eq. 16, one row of the double sum after the other.
        let mut shares: Vec<f64> = (0..inputs.len())
            .map(|i| {
                contributions[i] * (0..inputs.len()).map(|j| correlation.get(i, j) * contributions[j]).sum::<f64>()
            })
            .collect();
        let variance = shares.iter().sum::<f64>().max(0.0);
        for share in &mut shares {
            *share = if variance > 0.0 { *share / variance } else { 0.0 };
        }
        let with_dof: Vec<_> = contributions.iter().copied().zip(inputs.iter().map(Input::dof)).collect();
        let dof = dof::effective(&with_dof, correlation);
        Ok(Self { value, std: variance.sqrt(), dof, sensitivities, contributions, shares })
    }

    /// Estimate of the output.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// Combined standard uncertainty (GUM eq. 10, 13 and 16).
    pub fn std(&self) -> f64 {
        self.std
    }

    /// Effective degrees of freedom, perhaps infinite (GUM eq. G.2b).
    ///
    /// Correlated inputs form groups; the groups are independent of each other and enter the formula with their whole
    /// variance. A group observed simultaneously keeps its degrees of freedom exactly (Willink, *Metrologia* 44 (2007)
    /// 340); where they differ inside a group, no formula holds and the smallest is taken.
    pub fn dof(&self) -> f64 {
        self.dof
    }

    /// Sensitivity coefficients, one for each input.
    pub fn sensitivities(&self) -> &[f64] {
        &self.sensitivities
    }

    /// Contributions `c_i u(x_i)` with their signs (GUM eq. 11b).
    pub fn contributions(&self) -> &[f64] {
        &self.contributions
    }

    /// Fractions of the variance, which add up to 1: `c_i u_i sum_j r_ij c_j u_j / u^2`. That of a correlated input may
    /// be negative; that of an independent one is its squared contribution over the variance.
    pub fn shares(&self) -> &[f64] {
        &self.shares
    }

    /// Expanded uncertainty `U = k u` (GUM 6.2.1).
    pub fn expanded(&self, coverage_k: f64) -> f64 {
        coverage_k * self.std
    }

    /// Value and standard uncertainty alone.
    pub fn measurement(&self) -> Result<Measurement, Error> {
        Measurement::new(self.value, self.std)
    }

    /// The output as an input of the next model: normal, or Student's t if its degrees of freedom are finite.
    pub fn into_input(self, label: impl Into<String>) -> Result<Input, Error> {
        let shape = if self.dof.is_finite() { crate::Distribution::StudentT } else { crate::Distribution::Normal };
        Input::new(label, self.value, self.std)?.with_dof(self.dof)?.with_distribution(shape)
    }
}

/// Propagates inputs through a model written in [`Dual`] numbers, first order.
///
/// `model` gets one number for each input, in their order.
///
/// ```
/// use metrology::{Correlation, Input, propagate};
///
/// let inputs = [
///     Input::new("L", 23.40, 0.20)?.with_unit("px").with_dof(9.0)?,
///     Input::new("s", 0.4120e-3, 0.0015e-3)?.with_unit("m/px"),
///     Input::new("T", 1.0 / 60.0, 2e-5)?.with_unit("s"),
/// ];
/// let v = propagate(&inputs, &Correlation::independent(3), |q| q[0] * q[1] / q[2])?;
/// assert!((v.value() - 0.578_448).abs() < 1e-12);
/// assert!((v.std() - 0.005_418_5).abs() < 5e-8);
/// # Ok::<(), metrology::Error>(())
/// ```
///
/// # Reference
///
/// GUM 5.1.2 eq. 10 and 5.2.2 eq. 13 and 16.
pub fn propagate(
    inputs: &[Input],
    correlation: &Correlation,
    model: impl Fn(&[Dual]) -> Dual,
) -> Result<Combined, Error> {
    let at: Vec<f64> = inputs.iter().map(Input::value).collect();
    let value = values_of(&model)(&at);
    Combined::new(inputs, correlation, value, sensitivities(model, &at))
}

/// Propagates inputs through a model of plain numbers, with numeric derivatives ([`sensitivities_numeric`]).
///
/// The step is a hundredth of the standard uncertainty, over which a model fit for first order is nearly straight, or
/// `eps^(1/3) = 6e-6` of the value where that is more, since rounding would spoil a smaller one.
pub fn propagate_numeric(
    inputs: &[Input],
    correlation: &Correlation,
    model: impl Fn(&[f64]) -> f64,
) -> Result<Combined, Error> {
    let at: Vec<f64> = inputs.iter().map(Input::value).collect();
    let smallest = f64::EPSILON.cbrt();
    let steps = inputs.iter().map(|x| (0.01 * x.std()).max(smallest * x.value().abs()));
    // An exact 0 has no scale; its derivative is only printed.
    let steps: Vec<f64> = steps.map(|step| if step > 0.0 { step } else { smallest }).collect();
    Combined::new(inputs, correlation, model(&at), sensitivities_numeric(&model, &at, &steps)?)
}

/// A model of plain numbers from one of dual numbers, as Monte Carlo wants it.
pub fn values_of(model: impl Fn(&[Dual]) -> Dual) -> impl Fn(&[f64]) -> f64 {
    move |at| {
        let point: Vec<Dual> = at.iter().map(|&x| Dual::constant(x)).collect();
        model(&point).value()
    }
}
