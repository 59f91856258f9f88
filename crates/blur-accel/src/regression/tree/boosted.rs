//! Many trees, each on what those before it leave.

use linfa::traits::{Fit, PredictInplace};
use ndarray::{Array1, ArrayBase, ArrayView1, ArrayView2, Data, Ix2};
use serde::{Deserialize, Serialize};

use super::{Cart, Tree};
use crate::regression::samples::{self, Samples};
use crate::{Error, Result, check_size};

/// Settings of boosted trees: from the mean on, each tree is fitted to the residuals and adds `rate` of its prediction.
///
/// *Reference*: Friedman, Annals of Statistics 29 (2001) 1189, algorithm 2 (`LS_Boost`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Boosting {
    /// Number of trees.
    pub trees: usize,
    /// Share of each tree that is added, above 0 and at most 1.
    pub rate: f64,
    /// Settings of each.
    pub tree: Cart,
}

/// A mean and trees that correct it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Boosted {
    columns: usize,
    mean: f64,
    rate: f64,
    trees: Vec<Tree>,
}

impl Boosted {
    /// Whether its parts belong together, which they may not when it was read from a file.
    pub(in crate::regression) fn check(&self) -> Result<()> {
        for tree in &self.trees {
            check_size("columns of a boosted tree", tree.columns(), self.columns)?;
            tree.check()?;
        }
        Ok(())
    }

    /// Columns of an observation.
    pub fn columns(&self) -> usize {
        self.columns
    }
}

impl<'a> Fit<ArrayView2<'a, f64>, ArrayView1<'a, f64>, Error> for Boosting {
    type Object = Boosted;

    fn fit(&self, samples: &Samples<'a>) -> Result<Boosted> {
        self.tree.check()?;
        samples::check(samples)?;
        if !(self.rate > 0.0 && self.rate <= 1.0) {
            return Err(Error::Parameter {
                name: "learning rate",
                value: self.rate,
                expected: "above 0 and at most 1",
            });
        }
        let (inputs, targets) = (samples.records().view(), samples.targets());
        let mean = targets.sum() / targets.len() as f64;
        let mut residuals = targets - mean;
        let mut trees = Vec::with_capacity(self.trees);
        for _ in 0..self.trees {
            let tree = self.tree.grow(inputs.view(), residuals.view(), (0..inputs.nrows()).collect());
            for (row, residual) in inputs.rows().into_iter().zip(&mut residuals) {
                *residual -= self.rate * tree.predict_row(row);
            }
            trees.push(tree);
        }
        Ok(Boosted { columns: inputs.ncols(), mean, rate: self.rate, trees })
    }
}

impl<D: Data<Elem = f64>> PredictInplace<ArrayBase<D, Ix2>, Array1<f64>> for Boosted {
    fn predict_inplace(&self, inputs: &ArrayBase<D, Ix2>, out: &mut Array1<f64>) {
        for (row, to) in inputs.rows().into_iter().zip(out) {
            *to = self.mean + self.rate * self.trees.iter().map(|tree| tree.predict_row(row)).sum::<f64>();
        }
    }

    fn default_target(&self, inputs: &ArrayBase<D, Ix2>) -> Array1<f64> {
        Array1::zeros(inputs.nrows())
    }
}
