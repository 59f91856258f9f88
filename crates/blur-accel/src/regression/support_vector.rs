//! Support vector machines.

use linfa::DatasetBase;
use linfa::ParamGuard;
use linfa::traits::{Fit, PredictInplace};
use linfa_svm::Svm;
use ndarray::{Array1, Array2, ArrayBase, ArrayView1, ArrayView2, Axis, Data, Ix2};
use serde::{Deserialize, Serialize};

use super::distance::squared_distances;
use super::samples::{self, Samples};
use crate::{Error, Result, check_size};

/// Interquartile range of a standard normal number.
const NORMAL_IQR: f64 = 1.349;
/// Accuracy of the solver as a share of the interquartile range of the targets.
const ACCURACY: f64 = 1e-7;
/// What the optimality conditions may be missed by, as a share of the same; rounding stays far below.
const OPTIMAL: f64 = 1e-4;
/// Observations predicted at a time, so that their kernels stay in the cache.
const BLOCK: usize = 256;

/// How alike two observations x and z of P columns are.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kernel {
    /// `(1 + x·z / P)^degree`; 1 is the linear machine.
    Polynomial {
        /// The degree, at least 1.
        degree: i32,
    },
    /// `exp(-|x - z|² / (scale² P))`.
    Gaussian {
        /// The scale in units of √P.
        scale: f64,
    },
}

impl Kernel {
    /// Each row of `a` with each row of `b`.
    fn matrix(self, a: ArrayView2<'_, f64>, b: ArrayView2<'_, f64>) -> Array2<f64> {
        let columns = a.ncols() as f64;
        match self {
            Self::Polynomial { degree } => {
                let mut products = a.dot(&b.t());
                products.mapv_inplace(|product| (1.0 + product / columns).powi(degree));
                products
            }
            Self::Gaussian { scale } => {
                let mut distances = squared_distances(a, b);
                distances.mapv_inplace(|squared| (-squared / (scale * scale * columns)).exp());
                distances
            }
        }
    }

    fn check(self) -> Result<()> {
        match self {
            Self::Polynomial { degree } if degree < 1 => {
                Err(Error::Parameter { name: "degree of the kernel", value: f64::from(degree), expected: "at least 1" })
            }
            Self::Gaussian { scale } if !(scale > 0.0 && scale.is_finite()) => {
                Err(Error::Parameter { name: "scale of the kernel", value: scale, expected: "above 0" })
            }
            _ => Ok(()),
        }
    }
}

/// Settings of a support vector machine: errors below a tenth of the standard deviation cost nothing, and no
/// observation weighs more than one standard deviation, the latter being the interquartile range of the targets over
/// 1.349, as MATLAB's Regression Learner has it.
///
/// *Reference*: Smola & Schölkopf, Statistics and Computing 14 (2004) 199. The solver is [`linfa_svm`]'s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SupportVectorMachine {
    /// How alike two observations are.
    pub kernel: Kernel,
}

/// A fitted support vector machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SupportVectors {
    kernel: Kernel,
    bias: f64,
    weights: Array1<f64>,
    /// One a row.
    vectors: Array2<f64>,
}

impl SupportVectors {
    /// Whether its parts belong together, which they may not when it was read from a file.
    pub(super) fn check(&self) -> Result<()> {
        check_size("weights of support vectors", self.weights.len(), self.vectors.nrows())
    }

    /// Columns of an observation.
    pub fn columns(&self) -> usize {
        self.vectors.ncols()
    }

    /// Weight of each support vector: its multiplier, negative for a target below the prediction.
    pub fn weights(&self) -> &Array1<f64> {
        &self.weights
    }
}

impl<'a> Fit<ArrayView2<'a, f64>, ArrayView1<'a, f64>, Error> for SupportVectorMachine {
    type Object = SupportVectors;

    fn fit(&self, samples: &Samples<'a>) -> Result<SupportVectors> {
        self.kernel.check()?;
        samples::check(samples)?;
        let (inputs, targets) = (samples.records(), samples.targets());
        let iqr = interquartile_range(targets.view());
        let scale = if iqr > 0.0 { iqr } else { 1.0 };
        let (cost, tolerance) = (scale / NORMAL_IQR, scale / (10.0 * NORMAL_IQR));
        let columns = inputs.ncols() as f64;
        let settings = Svm::<f64, f64>::params().c_svr(cost, Some(tolerance)).eps(ACCURACY * scale);
        let (settings, records) = match self.kernel {
            Kernel::Polynomial { degree } => {
                (settings.polynomial_kernel(1.0, f64::from(degree)), inputs / columns.sqrt())
            }
            Kernel::Gaussian { scale } => (settings.gaussian_kernel(scale * scale * columns), inputs.to_owned()),
        };
        // The solver needs its targets one after the other in memory.
        let dataset = DatasetBase::new(records, targets.iter().copied().collect::<Array1<f64>>());
        let svm = settings.check()?.fit(&dataset)?;
        let support: Vec<usize> = (0..svm.alpha.len()).filter(|&row| svm.alpha[row] != 0.0).collect();
        let fitted = SupportVectors {
            kernel: self.kernel,
            bias: -svm.rho,
            weights: support.iter().map(|&row| svm.alpha[row]).collect(),
            vectors: inputs.select(Axis(0), &support),
        };
        let errors = targets - &linfa::traits::Predict::predict(&fitted, inputs);
        let missed = svm.alpha.iter().zip(&errors).map(|(&weight, &error)| violation(weight, error, cost, tolerance));
        if missed.fold(0.0, f64::max) > OPTIMAL * scale {
            return Err(Error::Convergence {
                what: "the support vector machine",
                rows: inputs.nrows(),
                columns: inputs.ncols(),
            });
        }
        Ok(fitted)
    }
}

/// By how much an observation of this weight and error misses the conditions of Karush, Kuhn and Tucker.
fn violation(weight: f64, error: f64, cost: f64, tolerance: f64) -> f64 {
    // A weight is on a bound that it comes this near to.
    let bound = 1e-10 * cost;
    let beyond = error * weight.signum() - tolerance;
    if weight.abs() <= bound {
        error.abs() - tolerance
    } else if weight.abs() >= cost - bound {
        -beyond
    } else {
        beyond.abs()
    }
}

/// Distance of the quartiles, which lie between observations as those of MATLAB's `quantile` do (Hyndman & Fan 1996,
/// definition 5).
fn interquartile_range(targets: ArrayView1<'_, f64>) -> f64 {
    let mut sorted = targets.to_vec();
    sorted.sort_by(f64::total_cmp);
    let quantile = |p: f64| {
        let at = (p * sorted.len() as f64 - 0.5).clamp(0.0, (sorted.len() - 1) as f64);
        let below = at.floor() as usize;
        let above = (below + 1).min(sorted.len() - 1);
        sorted[below] + (at - below as f64) * (sorted[above] - sorted[below])
    };
    quantile(0.75) - quantile(0.25)
}

impl<D: Data<Elem = f64>> PredictInplace<ArrayBase<D, Ix2>, Array1<f64>> for SupportVectors {
    fn predict_inplace(&self, inputs: &ArrayBase<D, Ix2>, out: &mut Array1<f64>) {
        let blocks = inputs.axis_chunks_iter(Axis(0), BLOCK).zip(out.axis_chunks_iter_mut(Axis(0), BLOCK));
        for (block, mut to) in blocks {
            to.assign(&(self.kernel.matrix(block, self.vectors.view()).dot(&self.weights) + self.bias));
        }
    }

    fn default_target(&self, inputs: &ArrayBase<D, Ix2>) -> Array1<f64> {
        Array1::zeros(inputs.nrows())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn quartiles_are_those_of_matlab() {
        // MATLAB: iqr([1 2 3 4]) = 2, quartiles 1.5 and 3.5; iqr([1 2 4 8 16]) = 10 - 1.75.
        assert_eq!(interquartile_range(array![3.0, 1.0, 4.0, 2.0].view()), 2.0);
        assert_eq!(interquartile_range(array![1.0, 2.0, 4.0, 8.0, 16.0].view()), 8.25);
    }
}
