//! Whether one regression does better than another on the same observations.

use metrology::student_t_quantile;
use ndarray::{Array1, ArrayView1};

use super::{Folds, Validation};
use crate::{Error, Result};

/// Probability that a model which is no better is still said to beat its baseline.
const SIGNIFICANCE: f64 = 0.05;

/// By how much the squared errors of a model are smaller than those of a baseline, observation by observation.
///
/// The observations are not so many independent witnesses: those of a fold are predicted by one training, those of a
/// group are alike, and the trainings share most of their data. So the folds are the sample. Each gives one mean difference
/// d of squared errors, and the standard error of the mean of k folds is `s √(1/k + n_test/n_train)` in place of `s √(1/k)`:
/// the second part makes up for the trainings that overlap. With k folds there are k - 1 degrees of freedom, and few
/// folds can show little. What is shown holds for new observations of the kind that the folds leave out: for new posters
/// only if the folds are of whole posters.
///
/// *Reference*: Nadeau & Bengio, Machine Learning 52 (2003) 239, section 4.2 (corrected resampled t-test).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comparison {
    /// Mean over the folds of the baseline's squared error less the model's, in squared units of the targets; above 0
    /// when the model is better.
    pub gain: f64,
    /// Standard error of the gain.
    pub gain_std: f64,
    /// Its degrees of freedom.
    pub dof: f64,
    /// What the gain exceeds with a probability of 95 %.
    pub least_gain: f64,
}

impl Comparison {
    /// Compares two validations with the same `folds` of the same `targets`.
    ///
    /// # Errors
    /// [`Error::Size`] when predictions, targets and folds are not of as many observations.
    pub fn of(model: &Validation, baseline: &Validation, targets: ArrayView1<'_, f64>, folds: &Folds) -> Result<Self> {
        let expected = folds.observations();
        for (what, found) in [
            ("targets", targets.len()),
            ("predictions of the model", model.predictions.len()),
            ("predictions of the baseline", baseline.predictions.len()),
        ] {
            if found != expected {
                return Err(Error::Size { what, found, expected });
            }
        }
        let squared = |predictions: &Array1<f64>| (predictions - &targets).mapv(|error| error * error);
        let difference = squared(&baseline.predictions) - squared(&model.predictions);
        let gains: Array1<f64> = folds
            .tests()
            .map(|test| test.iter().map(|&row| difference[row]).sum::<f64>() / test.len() as f64)
            .collect();
        let count = folds.count() as f64;
        // Folds of about the same size: one is tested and the others train.
        let overlap = 1.0 / (count - 1.0);
        let gain = gains.sum() / count;
        let gain_std = gains.std(1.0) * (1.0 / count + overlap).sqrt();
        let dof = count - 1.0;
        let least_gain = gain - student_t_quantile(1.0 - SIGNIFICANCE, dof)? * gain_std;
        Ok(Self { gain, gain_std, dof, least_gain })
    }

    /// Whether the model does better beyond what chance explains at the 5 % level.
    pub fn beats(&self) -> bool {
        self.least_gain > 0.0
    }
}
