//! An outcome as text and as JSON.

use std::fmt::Write;

use metrology::Measurement;
use serde_json::{Map, Value as Json, json};
use slider_host::fit::Fitted;
use slider_host::outcome::{Kind, Outcome, Value};

/// The fields that `slider fit --json` and `slider listen --json` print: quantities flat, each with its standard and
/// expanded uncertainty, as `estimate --json` prints its speed.
pub(crate) fn fields(fitted: &Fitted) -> Map<String, Json> {
    let outcome = &fitted.outcome;
    let mut fields = Map::new();
    let kind = match outcome.kind {
        Kind::Uniform => "uniform",
        Kind::Accelerated => "accelerated",
        Kind::Neither => "neither",
    };
    fields.insert("kind".to_owned(), json!(kind));
    fields.insert("degree".to_owned(), json!(outcome.degree));
    fields.insert("coefficients".to_owned(), json!(outcome.coefficients));
    fields.insert("std_errors".to_owned(), json!(outcome.std_errors));
    fields.insert("residual_std".to_owned(), json!(outcome.residual_std));
    fields.insert("r_squared".to_owned(), json!(outcome.r_squared));
    for (name, unit, value) in quantities(outcome) {
        fields.insert(format!("{name}_{unit}"), json!(value.value));
        fields.insert(format!("{name}_std_{unit}"), json!(value.std));
        fields.insert(format!("{name}_expanded_{unit}"), json!(value.expanded));
        fields.insert(format!("{name}_dof"), if value.dof.is_finite() { json!(value.dof) } else { Json::Null });
        fields.insert("coverage_k".to_owned(), json!(value.coverage_k));
    }
    fields.insert("chi2".to_owned(), json!(fitted.chi2));
    fields.insert("dof".to_owned(), json!(fitted.dof));
    if let Some(shift) = &fitted.edge_shift_m {
        fields.insert("edge_shift_m".to_owned(), json!(shift.value));
        fields.insert("edge_shift_std_m".to_owned(), json!(shift.std));
    }
    fields.insert("points".to_owned(), json!(outcome.t_s.len()));
    fields.insert("t_s".to_owned(), json!(outcome.t_s));
    fields.insert("x_m".to_owned(), json!(outcome.x_m));
    fields.insert("residuals_m".to_owned(), json!(outcome.residuals_m));
    fields.insert("outliers".to_owned(), json!(outcome.outliers));
    fields.insert("warnings".to_owned(), json!(outcome.warnings));
    fields
}

/// The quantities that were fitted, with the units of their names.
fn quantities(outcome: &Outcome) -> impl Iterator<Item = (&'static str, &'static str, &Value)> {
    let Outcome { speed_m_s, v0_m_s, accel_m_s2, .. } = outcome;
    let all = [("speed", "m_s", speed_m_s), ("v0", "m_s", v0_m_s), ("accel", "m_s2", accel_m_s2)];
    all.into_iter().filter_map(|(name, unit, value)| value.as_ref().map(|value| (name, unit, value)))
}

/// The same for a reader.
pub(crate) fn text(fitted: &Fitted) -> String {
    let outcome = &fitted.outcome;
    let kind = match outcome.kind {
        Kind::Uniform => "uniform motion",
        Kind::Accelerated => "uniformly accelerated motion",
        Kind::Neither => "neither uniform nor uniformly accelerated motion",
    };
    let mut text = format!("  {kind}, {} points", outcome.t_s.len());
    // Writing to a String cannot fail.
    for (name, unit, value) in quantities(outcome) {
        let unit = if unit == "m_s" { "m/s" } else { "m/s²" };
        let shown = Measurement::new(value.value, value.std)
            .map_or_else(|_| value.value.to_string(), |measurement| measurement.to_string());
        let _ = write!(
            text,
            "\n  {name:<6} {shown} {unit}   U = {:.2e} {unit} (k = {:.2}, 95 %)",
            value.expanded, value.coverage_k
        );
    }
    let (residual, r) = (outcome.residual_std * 1e6, outcome.r_squared);
    let _ = write!(text, "\n  residuals {residual:.1} um, R² {r:.8}");
    for warning in &outcome.warnings {
        let _ = write!(text, "\n  warning: {warning}");
    }
    text
}
