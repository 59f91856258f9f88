//! The mean of the targets: what is left of a regression that learns nothing.

use linfa::traits::{Fit, PredictInplace};
use ndarray::{Array1, ArrayBase, ArrayView1, ArrayView2, Data, Ix2};
use serde::{Deserialize, Serialize};

use super::samples::{self, Samples};
use crate::{Error, Result};

/// Settings: there are none.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct MeanOnly;

/// The mean of the targets of the training.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Mean {
    mean: f64,
    columns: usize,
}

impl Mean {
    /// Columns of an observation.
    pub fn columns(&self) -> usize {
        self.columns
    }
}

impl<'a> Fit<ArrayView2<'a, f64>, ArrayView1<'a, f64>, Error> for MeanOnly {
    type Object = Mean;

    fn fit(&self, samples: &Samples<'a>) -> Result<Mean> {
        samples::check(samples)?;
        let targets = samples.targets();
        Ok(Mean { mean: targets.sum() / targets.len() as f64, columns: samples.records().ncols() })
    }
}

impl<D: Data<Elem = f64>> PredictInplace<ArrayBase<D, Ix2>, Array1<f64>> for Mean {
    fn predict_inplace(&self, _: &ArrayBase<D, Ix2>, out: &mut Array1<f64>) {
        out.fill(self.mean);
    }

    fn default_target(&self, inputs: &ArrayBase<D, Ix2>) -> Array1<f64> {
        Array1::zeros(inputs.nrows())
    }
}
