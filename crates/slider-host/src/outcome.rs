//! What a user gets of a run.

use serde::Serialize;

/// A value with its standard uncertainty and degrees of freedom, and the expanded one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Value {
    /// The estimate.
    pub value: f64,
    /// Standard uncertainty.
    pub std: f64,
    /// Effective degrees of freedom; infinite ones are `null` in JSON.
    pub dof: f64,
    /// Expanded uncertainty.
    pub expanded: f64,
    /// Its coverage factor.
    pub coverage_k: f64,
}

/// What kind of motion the run was.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Constant speed explains it.
    Uniform,
    /// Constant acceleration explains it, constant speed does not.
    Accelerated,
    /// Neither does.
    Neither,
}

/// The fit of one run. Position in m against time in s from the first edge.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outcome {
    /// Number of the run.
    pub run: u16,
    /// Degree of the polynomial: 1 speed, 2 acceleration.
    pub degree: u8,
    /// Coefficients of x(t), lowest power first.
    pub coefficients: Vec<f64>,
    /// Their standard uncertainties.
    pub std_errors: Vec<f64>,
    /// Times of the points, s.
    pub t_s: Vec<f64>,
    /// Positions of the points, m.
    pub x_m: Vec<f64>,
    /// Position less fit, m.
    pub residuals_m: Vec<f64>,
    /// Standard deviation that each residual should have by the uncertainties of the points, m; of points without any, by
    /// the scatter of all. NaN for one that was left out.
    pub residual_stds_m: Vec<f64>,
    /// Standard deviation of the residuals, m.
    pub residual_std: f64,
    /// Share of the variance of x that the fit explains.
    pub r_squared: f64,
    /// Degree 1: the speed, m/s.
    pub speed_m_s: Option<Value>,
    /// Degree 2: the speed at the first edge, m/s.
    pub v0_m_s: Option<Value>,
    /// Degree 2: the acceleration, m/s^2.
    pub accel_m_s2: Option<Value>,
    /// What kind of motion it was.
    pub kind: Kind,
    /// Indices of the points that do not fit the others and were left out.
    pub outliers: Vec<usize>,
    /// What the user should know: missing teeth, an incomplete run, late edges.
    pub warnings: Vec<String>,
}
