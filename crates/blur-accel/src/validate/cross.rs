//! Predictions of observations by what has not seen them.

use std::time::{Duration, Instant};

use ndarray::{Array1, ArrayView1, ArrayView2, Axis};

use super::{Folds, Metrics};
use crate::pipeline::Pipeline;
use crate::reduce::Components;
use crate::regression::Preset;
use crate::{Error, Result};

/// What is fitted to each training: components, scales and regression, all from its observations alone.
#[derive(Clone, Copy)]
pub struct Recipe {
    /// Principal components kept.
    pub components: Components,
    /// The regression.
    pub preset: &'static Preset,
}

/// How a regression did on observations that it had not seen.
#[derive(Debug, Clone, PartialEq)]
pub struct Validation {
    /// Prediction of each observation, in the order of the inputs.
    pub predictions: Array1<f64>,
    /// Its standard deviation, where the regression has one.
    pub std: Option<Array1<f64>>,
    /// Over all observations.
    pub metrics: Metrics,
    /// Time of all trainings together.
    pub training_s: f64,
    /// Observations predicted in a second, without their standard deviations.
    pub predictions_per_s: f64,
}

/// Predicts every observation, one a row of `inputs`, by the recipe fitted to the folds without it. What is drawn is drawn
/// with `seed`.
///
/// # Errors
/// [`Error::Size`] when targets or folds are not of as many observations as the inputs, [`Error::NotFinite`], and those
/// of [`Pipeline::fit`] and [`Metrics::of`].
pub fn cross_validate(
    recipe: Recipe,
    inputs: ArrayView2<'_, f64>,
    targets: ArrayView1<'_, f64>,
    folds: &Folds,
    seed: u64,
) -> Result<Validation> {
    validate(inputs, targets, folds, |inputs, targets| {
        Pipeline::fit(inputs, targets, recipe.components, recipe.preset, seed)
    })
}

/// Predicts every observation by what `fit` makes of the folds without it.
pub(super) fn validate(
    inputs: ArrayView2<'_, f64>,
    targets: ArrayView1<'_, f64>,
    folds: &Folds,
    fit: impl Fn(ArrayView2<'_, f64>, ArrayView1<'_, f64>) -> Result<Pipeline>,
) -> Result<Validation> {
    let rows = inputs.nrows();
    for (what, found) in [("targets", targets.len()), ("observations in the folds", folds.observations())] {
        if found != rows {
            return Err(Error::Size { what, found, expected: rows });
        }
    }
    // Before the folds pick them: the numbers of an error are those of the whole.
    if let Some((row, &value)) = targets.iter().enumerate().find(|(_, value)| !value.is_finite()) {
        return Err(Error::NotFinite { what: "the target", row, column: 0, value });
    }
    if let Some(((row, column), &value)) = inputs.indexed_iter().find(|(_, value)| !value.is_finite()) {
        return Err(Error::NotFinite { what: "the input", row, column, value });
    }
    let mut predictions = Array1::zeros(rows);
    let mut std = Some(Array1::zeros(rows));
    let (mut training_time, mut prediction_time) = (Duration::ZERO, Duration::ZERO);
    for (training, test) in folds.splits() {
        let (known, known_targets) = (inputs.select(Axis(0), &training), targets.select(Axis(0), &training));
        let start = Instant::now();
        let pipeline = fit(known.view(), known_targets.view())?;
        training_time += start.elapsed();
        let unseen = inputs.select(Axis(0), test);
        let start = Instant::now();
        let found = pipeline.predict(unseen.view())?;
        prediction_time += start.elapsed();
        test.iter().zip(&found).for_each(|(&row, &value)| predictions[row] = value);
        match (pipeline.predict_std(unseen.view())?, &mut std) {
            (Some(found), Some(std)) => test.iter().zip(&found).for_each(|(&row, &value)| std[row] = value),
            _ => std = None,
        }
    }
    Ok(Validation {
        metrics: Metrics::of(predictions.view(), targets)?,
        predictions,
        std,
        training_s: training_time.as_secs_f64(),
        predictions_per_s: rows as f64 / prediction_time.as_secs_f64().max(f64::MIN_POSITIVE),
    })
}
