//! Several runs of the same setting.

use metrology::coverage_factor;

use super::{Fitted, effective_dof, value_of};
use crate::Error;
use crate::outcome::Value;

/// Rounds that halve the interval of the between-run variance: to its last bit.
const HALVINGS: usize = 200;

/// What several runs say together of the speed (degree 1) or the acceleration (degree 2), in m/s or m/s^2.
#[derive(Debug, Clone, PartialEq)]
pub struct Pooled {
    /// The weighted mean. The runs share the sheet and the clock, so these uncertainties are in it undiminished.
    pub value: Value,
    /// Weights of the runs; their sum is 1.
    pub weights: Vec<f64>,
    /// Scatter of the runs, `sqrt(sum (v - mean)^2 / (m - 1))`: repeatability as VIM 2.21 has it.
    pub scatter_std: f64,
    /// Root mean square of the standard uncertainties that the runs do not share: what would scatter if nothing but the
    /// times did.
    pub within_std: f64,
    /// Standard deviation between runs that the own uncertainties do not explain: how well the slider repeats itself.
    pub between_std: f64,
    /// Standard uncertainty that the runs share.
    pub common_std: f64,
    /// Root of chi-squared of the runs about their mean over its degrees of freedom, by own uncertainties alone.
    pub birge_ratio: f64,
}

/// Pools runs that were fitted with the same degree and sheet.
///
/// A run is weighted by `1 / (u^2 + b^2)`, where u is what it does not share and b the standard deviation between runs that
/// makes chi-squared equal to its degrees of freedom, or 0 if it is below them already. With b = 0 the mean has
/// unlimited degrees of freedom, else m - 1.
///
/// # Reference
///
/// R. C. Paule, J. Mandel, J. Res. Natl. Bur. Stand. 87 (1982) 377-385; R. T. Birge, Phys. Rev. 40 (1932) 207-227.
pub fn pool(runs: &[Fitted], coverage: f64) -> Result<Pooled, Error> {
    let [first, _, ..] = runs else {
        return Err(Error::Runs(format!("{} given, at least 2 are needed to pool", runs.len())));
    };
    let degree = first.outcome.degree;
    let sections = first.width_sensitivities.len();
    if let Some(other) = runs.iter().find(|run| run.outcome.degree != degree) {
        return Err(Error::Runs(format!("fitted with degrees {degree} and {}", other.outcome.degree)));
    }
    if let Some(other) = runs.iter().find(|run| run.width_sensitivities.len() != sections) {
        let other = other.width_sensitivities.len();
        return Err(Error::Runs(format!("of different sheets, with {sections} and {other} sections")));
    }
    // Fail early: there is no mean of runs without a value.
    coverage_factor(coverage, f64::INFINITY)?;
    let values: Vec<f64> = runs.iter().map(quantity).collect();
    let own: Vec<f64> = runs.iter().map(|run| run.own_variance).collect();
    if !values.iter().chain(&own).all(|number| number.is_finite()) {
        return Err(Error::Runs("one has no uncertainty: its points are as many as its coefficients".to_owned()));
    }
    let m = values.len() as f64;
    let plain_mean = values.iter().sum::<f64>() / m;
    let scatter_var = values.iter().map(|v| (v - plain_mean).powi(2)).sum::<f64>() / (m - 1.0);
    let between_var = between(&values, &own, scatter_var * m);
    let weights = weights(&own, between_var);
    let mean = mean_of(&values, &weights);

    let random_var: f64 = weights.iter().zip(&own).map(|(w, own)| w * w * (own + between_var)).sum();
    let from_widths: f64 = (0..sections)
        .map(|section| {
            let moved: f64 = runs
                .iter()
                .zip(&weights)
                .map(|(run, w)| w * run.width_sensitivities[section] * run.width_stds[section])
                .sum();
            moved * moved
        })
        .sum();
    // Relative to the value, the same for all runs.
    let scale_std = runs.iter().map(|run| run.scale_std).fold(0.0, f64::max) * mean.abs();
    let common_std = from_widths.sqrt().hypot(scale_std);
    let random_dof = if between_var > 0.0 { m - 1.0 } else { f64::INFINITY };
    let dof = effective_dof(&[(random_var.sqrt(), random_dof), (common_std, f64::INFINITY)]);
    let own_chi2 = spread(&values, &own, 0.0);
    Ok(Pooled {
        value: value_of(mean, random_var.sqrt().hypot(common_std), dof, coverage)?,
        weights,
        scatter_std: scatter_var.sqrt(),
        within_std: (own.iter().sum::<f64>() / m).sqrt(),
        between_std: between_var.sqrt(),
        common_std,
        birge_ratio: (own_chi2 / (m - 1.0)).sqrt(),
    })
}

fn quantity(run: &Fitted) -> f64 {
    let value = run.outcome.speed_m_s.or(run.outcome.accel_m_s2);
    value.map_or(f64::NAN, |value| value.value)
}

fn weights(own: &[f64], between_var: f64) -> Vec<f64> {
    // A run that is known exactly would take all the weight and divide by zero; as good as the best of floats is enough.
    let inverse: Vec<f64> = own.iter().map(|own| 1.0 / (own + between_var).max(f64::MIN_POSITIVE)).collect();
    let sum: f64 = inverse.iter().sum();
    inverse.into_iter().map(|w| w / sum).collect()
}

fn mean_of(values: &[f64], weights: &[f64]) -> f64 {
    values.iter().zip(weights).map(|(v, w)| v * w).sum()
}

/// Chi-squared of the runs about their weighted mean.
fn spread(values: &[f64], own: &[f64], between_var: f64) -> f64 {
    let mean = mean_of(values, &weights(own, between_var));
    let square = |(v, own): (&f64, &f64)| (v - mean).powi(2) / (own + between_var).max(f64::MIN_POSITIVE);
    values.iter().zip(own).map(square).sum()
}

/// The between-run variance that makes chi-squared its degrees of freedom: chi-squared falls as it grows, and it is at most
/// the squared scatter.
fn between(values: &[f64], own: &[f64], most: f64) -> f64 {
    let dof = values.len() as f64 - 1.0;
    if spread(values, own, 0.0) <= dof {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, most);
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(low, high);
        if spread(values, own, middle) > dof { low = middle } else { high = middle }
    }
    f64::midpoint(low, high)
}
