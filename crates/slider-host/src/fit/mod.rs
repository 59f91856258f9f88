//! Fits x(t) and says how well it is known.
//!
//! [`fit`] fits one run with the full covariance of its points, [`pool`] puts runs together.
//!
//! # The model
//!
//! Positions of the sheet's edges are sums of its widths, so their errors are correlated, and those of the times count as
//! `v u_t`, with v the speed at each edge:
//!
//! ```text
//! C = C_widths + diag(v_i^2 (u_tick^2 + u_jitter^2) + u_edge^2)
//! ```
//!
//! v comes from a first fit and is iterated. What scales all positions (the caliper) or all times (the timer's clock)
//! alike is not seen in residuals and is added to the covariance of the coefficients afterwards.
//!
//! # References
//!
//! JCGM 102:2011, section 6; thesis chapter 8, where times are taken as exact and edges as independent.

mod motion;
mod outlier;
mod pool;
mod system;

use metrology::least_squares::Fit;
use metrology::{chi_squared_quantile, coverage_factor, welch_satterthwaite};
use nalgebra::DMatrix;

pub use motion::Decision;
pub use outlier::Outlier;
pub use pool::{Pooled, pool};

use crate::Error;
use crate::outcome::{Kind, Outcome, Value};
use crate::points::{Points, Positions};
use system::System;

/// The probability of chi-squared above which the given uncertainties are not believed.
const PLAUSIBLE: f64 = 0.99;

/// Whether the place within the sensor's window where it switches is a coefficient, too.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EdgeShift {
    /// First and last edges of a tooth switch it at the same place.
    #[default]
    None,
    /// Teeth look narrower by a constant that is fitted; the window of the sensor is 1.8 mm wide.
    Fitted,
}

/// What to fit, and what is known besides the points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// 1 for the speed, 2 for the acceleration.
    pub degree: u8,
    /// Whether a shift of first against last edges is fitted; of no effect on points without a sheet.
    pub edge_shift: EdgeShift,
    /// Standard uncertainty of each time besides its resolution, s: jitter of the sensor.
    pub jitter_std_s: f64,
    /// Standard uncertainty of the place where each edge switches the sensor, m.
    pub edge_std_m: f64,
    /// Relative standard uncertainty of the timer's clock.
    pub clock_std: f64,
    /// Probability of the expanded uncertainties.
    pub coverage: f64,
    /// Probability of calling a uniform motion something else, and an accelerated one neither.
    pub significance: f64,
    /// Probability of finding an outlier in a run without any; 0 looks for none.
    pub outlier_significance: f64,
}

impl Options {
    /// Speed (1) or acceleration (2) to 95 %, with false alarms in 1 of 100 runs and outliers in 1 of 1000.
    pub fn of_degree(degree: u8) -> Self {
        Self {
            degree,
            edge_shift: EdgeShift::None,
            jitter_std_s: 0.0,
            edge_std_m: 0.0,
            clock_std: 0.0,
            coverage: 0.95,
            significance: 0.01,
            outlier_significance: 0.001,
        }
    }

    fn check(&self) -> Result<(), Error> {
        if !(1..=2).contains(&self.degree) {
            return Err(Error::Degree { degree: self.degree });
        }
        let fail = |name, value, expected| Err(Error::Option { name, value, expected });
        for (name, std) in
            [("jitter_std_s", self.jitter_std_s), ("edge_std_m", self.edge_std_m), ("clock_std", self.clock_std)]
        {
            if !(std.is_finite() && std >= 0.0) {
                return fail(name, std, "0 or more");
            }
        }
        let probabilities = [("coverage", self.coverage), ("significance", self.significance)];
        for (name, probability) in probabilities {
            if !(probability > 0.0 && probability < 1.0) {
                return fail(name, probability, "between 0 and 1");
            }
        }
        if !(0.0..1.0).contains(&self.outlier_significance) {
            return fail("outlier_significance", self.outlier_significance, "0 to below 1");
        }
        Ok(())
    }
}

/// The fit of one run: what a user gets, and what is needed to pool it with others.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// What a user gets.
    pub outcome: Outcome,
    /// Covariance of the coefficients of x(t), all contributions included.
    pub covariance: DMatrix<f64>,
    /// How much narrower teeth look than they are, m, if that was fitted.
    pub edge_shift_m: Option<Value>,
    /// Squared residuals in units of their covariance; of points without uncertainties, in m^2.
    pub chi2: f64,
    /// Degrees of freedom.
    pub dof: usize,
    /// `sqrt(chi2 / dof)`, by which the uncertainties were expanded if it is significantly above 1 (Birge ratio); `None` if
    /// the uncertainties come from the residuals.
    pub birge_ratio: Option<f64>,
    /// How the kind of motion was decided.
    pub decision: Decision,
    /// The points that were left out.
    pub outliers: Vec<Outlier>,
    /// Variance of speed or acceleration from what other runs do not share.
    own_variance: f64,
    /// Change of it with each width of the sheet, in the order of the sheet's description.
    width_sensitivities: Vec<f64>,
    /// Standard uncertainties of these widths, m, expanded as those of the residuals.
    width_stds: Vec<f64>,
    /// Relative standard uncertainty of what scales it in all runs: the sheet's and the clock's.
    scale_std: f64,
}

/// Fits the points of run `number`.
///
/// Uncertainties come from those of the points. If the residuals are larger than these allow (chi-squared above its 99 %
/// quantile), they are expanded by the Birge ratio, with the degrees of freedom of the residuals, and a warning says so. If
/// nothing is known of the points, they come from the residuals alone.
///
/// Outliers are looked for, and the kind of motion is decided, under a polynomial of degree 5, whatever degree is fitted.
pub fn fit(number: u16, points: &Points, options: &Options) -> Result<Fitted, Error> {
    options.check()?;
    let system = System::new(points, options)?;
    let (system, outliers) = outlier::left_out(system, options.outlier_significance)?;
    let decision = motion::decide(&system, options.significance)?;
    let fit = system.fit(usize::from(options.degree), options.edge_shift)?;
    let mut warnings = points.warnings.clone();
    for outlier in &outliers {
        warnings.push(format!("{} does not fit the others and is left out", points.positions.label(outlier.index)));
    }
    match (decision.kind, options.degree) {
        (Kind::Neither, _) => warnings.push(format!(
            "the motion was neither uniform nor uniformly accelerated (p = {:.1e}): the result is a mean over it",
            decision.higher_p
        )),
        (Kind::Accelerated, 1) => warnings.push(format!(
            "the motion was accelerated (p = {:.1e}): the speed is a mean over it; degree 2 fits it",
            decision.acceleration_p
        )),
        _ => {}
    }
    let expansion = expansion(&fit, &system, &mut warnings)?;

    let degree = usize::from(options.degree);
    let size = fit.coefficients.len();
    let b = &fit.coefficients;
    let from_residuals = &fit.covariance_prior * expansion.variance;
    let scale_std = points.positions.scale_std();
    // x -> (1 + d) x scales every coefficient, t -> (1 + d) t that of t^k by -k d.
    let scale = b * scale_std;
    let clock =
        nalgebra::DVector::from_fn(size, |k, _| if k <= degree { -(k as f64) * b[k] * options.clock_std } else { 0.0 });
    let covariance = &from_residuals + &scale * scale.transpose() + &clock * clock.transpose();
    let value = |index: usize, factor: f64| -> Result<Value, Error> {
        let parts = [
            (from_residuals[(index, index)].sqrt(), expansion.dof),
            (scale[index].abs(), f64::INFINITY),
            (clock[index].abs(), f64::INFINITY),
        ];
        value_of(factor * b[index], factor * covariance[(index, index)].sqrt(), effective_dof(&parts), options.coverage)
    };

    let (t_s, x_m) = (points.t_s.clone(), points.x_m.clone());
    let shift = (options.edge_shift == EdgeShift::Fitted && size > degree + 1).then_some(degree + 1);
    let residuals_m: Vec<f64> = system.residuals(&fit, degree);
    let is_kept = |index: &usize| !outliers.iter().any(|outlier| outlier.index == *index);
    let kept_squares: f64 = (0..t_s.len()).filter(is_kept).map(|index| residuals_m[index].powi(2)).sum();
    let factor = if degree == 2 { 2.0 } else { 1.0 };
    let widths = system.width_sensitivities(&fit, degree).into_iter().map(|s| factor * s).collect::<Vec<_>>();
    let width_stds: Vec<f64> = system.width_stds().into_iter().map(|std| std * expansion.variance.sqrt()).collect();
    let shared: f64 = widths.iter().zip(&width_stds).map(|(s, std)| (s * std).powi(2)).sum();
    let own_variance = (factor * factor * from_residuals[(degree, degree)] - shared).max(0.0);
    let outcome = Outcome {
        run: number,
        degree: options.degree,
        coefficients: b.iter().take(degree + 1).copied().collect(),
        std_errors: (0..=degree).map(|k| covariance[(k, k)].sqrt()).collect(),
        t_s,
        x_m,
        residuals_m,
        residual_stds_m: system.residual_stds(&fit, degree),
        residual_std: if fit.dof > 0 { (kept_squares / fit.dof as f64).sqrt() } else { 0.0 },
        r_squared: fit.r_squared,
        speed_m_s: if degree == 1 { Some(value(1, 1.0)?) } else { None },
        v0_m_s: if degree == 2 { Some(value(1, 1.0)?) } else { None },
        accel_m_s2: if degree == 2 { Some(value(2, 2.0)?) } else { None },
        kind: decision.kind,
        outliers: outliers.iter().map(|outlier| outlier.index).collect(),
        warnings,
    };
    Ok(Fitted {
        covariance: covariance.view((0, 0), (degree + 1, degree + 1)).into_owned(),
        edge_shift_m: shift.map(|index| value(index, 1.0)).transpose()?,
        chi2: fit.chi2,
        dof: fit.dof,
        birge_ratio: system.is_known().then(|| fit.residual_std()),
        decision,
        outliers,
        own_variance,
        width_sensitivities: widths,
        width_stds,
        // The acceleration goes with 1 / t^2.
        scale_std: scale_std.hypot(degree as f64 * options.clock_std),
        outcome,
    })
}

/// By what the variances of the coefficients are multiplied, and their degrees of freedom then.
struct Expansion {
    variance: f64,
    dof: f64,
}

fn expansion(fit: &Fit, system: &System<'_>, warnings: &mut Vec<String>) -> Result<Expansion, Error> {
    let dof = fit.dof as f64;
    if !system.is_known() {
        if fit.dof == 0 {
            warnings.push("as many coefficients as points: there is nothing to tell the uncertainty from".to_owned());
            return Ok(Expansion { variance: f64::NAN, dof });
        }
        return Ok(Expansion { variance: fit.chi2 / dof, dof });
    }
    if fit.dof > 0 && fit.chi2 > chi_squared_quantile(PLAUSIBLE, dof)? {
        let ratio = fit.residual_std();
        warnings.push(format!(
            "residuals are {ratio:.1} times as large as the uncertainties of the points allow: these are expanded by it"
        ));
        return Ok(Expansion { variance: ratio * ratio, dof });
    }
    Ok(Expansion { variance: 1.0, dof: f64::INFINITY })
}

/// Degrees of freedom of the combination of independent parts; parts of nothing do not count.
fn effective_dof(parts: &[(f64, f64)]) -> f64 {
    let parts: Vec<_> = parts.iter().copied().filter(|part| part.0 > 0.0).collect();
    if parts.is_empty() { f64::INFINITY } else { welch_satterthwaite(&parts) }
}

fn value_of(value: f64, std: f64, dof: f64, coverage: f64) -> Result<Value, Error> {
    // Without degrees of freedom any value is possible.
    let coverage_k = if dof > 0.0 { coverage_factor(coverage, dof)? } else { f64::INFINITY };
    Ok(Value { value, std, dof, expanded: coverage_k * std, coverage_k })
}

/// Whether positions are edges of a sheet, and so have a shift.
fn has_edges(points: &Points) -> bool {
    matches!(points.positions, Positions::Edges { .. })
}
