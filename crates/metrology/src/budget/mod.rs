//! The table of a measurement: what each input contributes.

mod table;

use crate::{Combined, Coverage, Distribution, Error, Input, coverage};

/// One input of a budget.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Row {
    /// Label of the input.
    pub label: String,
    /// Its estimate.
    pub value: f64,
    /// Unit of estimate and standard uncertainty.
    pub unit: String,
    /// Standard uncertainty.
    pub std: f64,
    /// Shape.
    pub distribution: Distribution,
    /// Degrees of freedom, perhaps infinite (`null` in JSON).
    pub dof: f64,
    /// Sensitivity coefficient, unit of the output per unit of the input.
    pub sensitivity: f64,
    /// Contribution `|c_i| u(x_i)` in the unit of the output (GUM eq. 11b).
    pub contribution: f64,
    /// Fraction of the variance of the output ([`Combined::shares`]).
    pub share: f64,
}

/// An uncertainty budget with its expanded uncertainty. It serialises as it is; [`Budget::to_text`] and
/// [`Budget::to_markdown`] round.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Budget {
    /// Name of the output quantity.
    pub measurand: String,
    /// Unit of the output.
    pub unit: String,
    /// Estimate of the output.
    pub value: f64,
    /// Combined standard uncertainty.
    pub std: f64,
    /// Effective degrees of freedom, perhaps infinite (`null` in JSON).
    pub dof: f64,
    /// Coverage factor.
    pub coverage_k: f64,
    /// Coverage probability, where the factor was chosen by one.
    pub probability: Option<f64>,
    /// Why this factor, in words.
    pub coverage: String,
    /// Expanded uncertainty.
    pub expanded: f64,
    /// The inputs in their order.
    pub rows: Vec<Row>,
}

impl Budget {
    /// The budget of `combined`, which `inputs` were combined into.
    pub fn new(
        measurand: impl Into<String>,
        unit: impl Into<String>,
        inputs: &[Input],
        combined: &Combined,
        coverage: Coverage,
    ) -> Result<Self, Error> {
        let expected = combined.sensitivities().len();
        if inputs.len() != expected {
            return Err(Error::Count { what: "inputs of the budget", expected, found: inputs.len() });
        }
        let coverage_k = coverage.factor(inputs, combined)?;
        let rows = inputs.iter().enumerate().map(|(i, x)| Row {
            label: x.label().to_owned(),
            value: x.value(),
            unit: x.unit().to_owned(),
            std: x.std(),
            distribution: x.distribution(),
            dof: x.dof(),
            sensitivity: combined.sensitivities()[i],
            contribution: combined.contributions()[i].abs(),
            share: combined.shares()[i],
        });
        let (probability, why) = match coverage {
            Coverage::Probability(p) if combined.dof().is_finite() => {
                (Some(p), format!("{} %, Student's t", percent(p)))
            }
            Coverage::Probability(p) => (Some(p), format!("{} %, normal", percent(p))),
            Coverage::Factor(_) => (None, String::from("given")),
            Coverage::Dominant if coverage_k == coverage::RECTANGULAR_K => {
                (None, String::from("about 95 %, a rectangular distribution dominates"))
            }
            Coverage::Dominant => (None, String::from("about 95 %, no rectangular distribution dominates")),
        };
        Ok(Self {
            measurand: measurand.into(),
            unit: unit.into(),
            value: combined.value(),
            std: combined.std(),
            dof: combined.dof(),
            coverage_k,
            probability,
            coverage: why,
            expanded: combined.expanded(coverage_k),
            rows: rows.collect(),
        })
    }
}

/// Per cent without the digits that the product makes up: 99.73 of 0.9973.
fn percent(probability: f64) -> f64 {
    (probability * 1e10).round() / 1e8
}
