//! Figures of merit.

use ndarray::ArrayView1;
use serde::{Deserialize, Serialize};

use crate::{Error, Result};

/// How far predictions are from their targets: the columns of thesis table 6.2.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Metrics {
    /// Root of the mean squared error, in units of the targets.
    pub rmse: f64,
    /// Coefficient of determination: the share of the variance of the targets that is explained; below 0 when the mean
    /// of the targets would have been the better prediction.
    pub r_squared: f64,
    /// Mean squared error, in squared units of the targets.
    pub mse: f64,
    /// Mean magnitude of the error, in units of the targets.
    pub mae: f64,
}

impl Metrics {
    /// # Errors
    /// [`Error::Size`] when there is not one prediction for each target, [`Error::TooFew`] without two of them,
    /// [`Error::NotFinite`], and [`Error::Parameter`] when all targets are the same: nothing of nothing is no share.
    pub fn of(predictions: ArrayView1<'_, f64>, targets: ArrayView1<'_, f64>) -> Result<Self> {
        check("predictions", predictions, targets)?;
        let count = targets.len() as f64;
        let mean = targets.sum() / count;
        let variance = targets.iter().map(|target| (target - mean).powi(2)).sum::<f64>() / count;
        if variance == 0.0 {
            return Err(Error::Parameter { name: "variance of the targets", value: 0.0, expected: "above 0" });
        }
        let errors = || predictions.iter().zip(targets).map(|(prediction, target)| prediction - target);
        let mse = errors().map(|error| error * error).sum::<f64>() / count;
        let mae = errors().map(f64::abs).sum::<f64>() / count;
        Ok(Self { rmse: mse.sqrt(), r_squared: 1.0 - mse / variance, mse, mae })
    }
}

/// Share of the targets that lie within `coverage_k` standard deviations of their prediction; for Gaussian errors 95.4 %
/// at 2.
///
/// # Errors
/// Those of [`Metrics::of`] but the last.
pub fn coverage(
    predictions: ArrayView1<'_, f64>,
    std: ArrayView1<'_, f64>,
    targets: ArrayView1<'_, f64>,
    coverage_k: f64,
) -> Result<f64> {
    check("predictions", predictions, targets)?;
    check("standard deviations", std, targets)?;
    let covered = predictions
        .iter()
        .zip(std)
        .zip(targets)
        .filter(|((prediction, std), target)| (**prediction - **target).abs() <= coverage_k * **std);
    Ok(covered.count() as f64 / targets.len() as f64)
}

fn check(what: &'static str, values: ArrayView1<'_, f64>, targets: ArrayView1<'_, f64>) -> Result<()> {
    if values.len() != targets.len() {
        return Err(Error::Size { what, found: values.len(), expected: targets.len() });
    }
    if targets.len() < 2 {
        return Err(Error::TooFew { found: targets.len(), needed: 2, purpose: "for figures of merit" });
    }
    finite(what, values)?;
    finite("the target", targets)
}

fn finite(what: &'static str, values: ArrayView1<'_, f64>) -> Result<()> {
    match values.iter().enumerate().find(|(_, value)| !value.is_finite()) {
        Some((row, &value)) => Err(Error::NotFinite { what, row, column: 0, value }),
        None => Ok(()),
    }
}
