//! The nineteen regressions of thesis table 6.2.
//!
//! One folder or file is one family: its settings implement [`linfa::traits::Fit`], what they fit to implements
//! [`PredictInplace`]. [`PRESETS`] lists the settings of the thesis's table, and [`Fitted`] is any of their results.
//!
//! Observations to predict have as many columns as those of the training ([`Fitted::columns`]); like the array
//! operations below it, a prediction panics on others.

mod distance;
pub mod gaussian_process;
pub mod linear;
mod mean;
mod preset;
mod samples;
pub mod support_vector;
pub mod tree;

use linfa::traits::PredictInplace;
use ndarray::{Array1, Array2, ArrayView2};
use serde::{Deserialize, Serialize};

use gaussian_process::GaussianProcess;
use linear::Linear;
pub use mean::{Mean, MeanOnly};
pub use preset::{PRESETS, Preset, ThesisRow};
pub use samples::Samples;
use support_vector::SupportVectors;
use tree::{Bagged, Boosted, Tree};

use crate::Result;

/// A fitted regression.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Fitted {
    /// The mean of the targets, which no regression should do worse than.
    Mean(Mean),
    /// A sum of products of columns.
    Linear(Linear),
    /// One regression tree.
    Tree(Tree),
    /// The mean of many trees.
    Bagged(Bagged),
    /// The sum of many small trees.
    Boosted(Boosted),
    /// A support vector machine.
    SupportVectors(SupportVectors),
    /// A Gaussian process.
    GaussianProcess(GaussianProcess),
}

impl Fitted {
    fn model<'a>(&self) -> &dyn PredictInplace<ArrayView2<'a, f64>, Array1<f64>> {
        match self {
            Self::Mean(model) => model,
            Self::Linear(model) => model,
            Self::Tree(model) => model,
            Self::Bagged(model) => model,
            Self::Boosted(model) => model,
            Self::SupportVectors(model) => model,
            Self::GaussianProcess(model) => model,
        }
    }

    /// Columns of an observation.
    pub fn columns(&self) -> usize {
        match self {
            Self::Mean(model) => model.columns(),
            Self::Linear(model) => model.columns(),
            Self::Tree(model) => model.columns(),
            Self::Bagged(model) => model.columns(),
            Self::Boosted(model) => model.columns(),
            Self::SupportVectors(model) => model.columns(),
            Self::GaussianProcess(model) => model.columns(),
        }
    }

    /// Whether its parts belong together, which they may not when it was read from a file.
    pub(crate) fn check(&self) -> Result<()> {
        match self {
            // The Gaussian process checks itself when it is read.
            Self::Mean(_) | Self::GaussianProcess(_) => Ok(()),
            Self::Linear(model) => model.check(),
            Self::Tree(model) => model.check(),
            Self::Bagged(model) => model.check(),
            Self::Boosted(model) => model.check(),
            Self::SupportVectors(model) => model.check(),
        }
    }

    /// Predictions for observations, one a row.
    pub fn predict(&self, inputs: ArrayView2<'_, f64>) -> Array1<f64> {
        let mut predictions = Array1::zeros(inputs.nrows());
        self.model().predict_inplace(&inputs, &mut predictions);
        predictions
    }

    /// Standard deviation of each prediction for a new observation, noise included; `None` where the regression has none.
    pub fn predict_std(&self, inputs: ArrayView2<'_, f64>) -> Option<Array1<f64>> {
        match self {
            Self::GaussianProcess(model) => Some(model.predict_std(inputs)),
            _ => None,
        }
    }
}

impl PredictInplace<Array2<f64>, Array1<f64>> for Fitted {
    fn predict_inplace(&self, inputs: &Array2<f64>, out: &mut Array1<f64>) {
        out.assign(&self.predict(inputs.view()));
    }

    fn default_target(&self, inputs: &Array2<f64>) -> Array1<f64> {
        Array1::zeros(inputs.nrows())
    }
}
