//! Exact Gaussian processes with a constant mean.

mod bfgs;
mod kernel;
mod likelihood;

use linfa::traits::{Fit, PredictInplace};
use nalgebra::DMatrix;
use ndarray::{Array1, Array2, ArrayBase, ArrayView1, ArrayView2, Axis, Data, Ix2};
use serde::{Deserialize, Serialize};

use super::distance::squared_distances;
use super::samples::{self, Samples};
use crate::{Error, Result};
pub use kernel::Kernel;
use likelihood::{Conditioned, Likelihood};

/// The least noise, as a share of the standard deviation of the targets: MATLAB's `SigmaLowerBound`.
const LEAST_NOISE: f64 = 0.01;
/// Observations predicted at a time, so that their kernels stay in the cache.
const BLOCK: usize = 256;

/// Settings of a Gaussian process: covariance `signal_std² k(|x - z| / length_scale) + noise_std² [x is z]`, a constant
/// mean estimated by generalised least squares, and the parameters of largest likelihood that a quasi-Newton search
/// finds from two starting points: MATLAB's, whose length scale is the mean standard deviation of the columns, and the
/// same with √P times the length for P columns. In many dimensions observations lie so far apart that at the first
/// nothing is correlated with anything and the likelihood is flat. As in MATLAB's `fitrgp` the noise stays above 1 % of the standard deviation of the
/// targets. The time grows with the cube of the number of observations: some hundreds of them are meant.
///
/// *Reference*: Rasmussen & Williams, *Gaussian Processes for Machine Learning*, 2006: equations 2.23 and 2.24
/// (prediction), 2.41 and 2.42 (the constant), 5.9 (gradient).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GaussianProcessRegression {
    /// How alike two observations are.
    pub kernel: Kernel,
}

/// Parameters of the covariance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Hyperparameters {
    /// In units of the inputs.
    pub length_scale: f64,
    /// In units of the targets.
    pub signal_std: f64,
    /// In units of the targets.
    pub noise_std: f64,
    /// Exponent of the rational quadratic kernel; the others do not read it.
    pub exponent: f64,
}

/// A fitted Gaussian process. What is stored of it are the observations and the hyperparameters, the rest follows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Stored", into = "Stored")]
pub struct GaussianProcess {
    stored: Stored,
    constant: f64,
    log_likelihood: f64,
    /// `K⁻¹ (y - constant)`.
    weights: Array1<f64>,
    /// Transpose of the inverse of the Cholesky factor of K.
    whitening: Array2<f64>,
    /// `K⁻¹ 1`.
    inverse_ones: Array1<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Stored {
    kernel: Kernel,
    hyperparameters: Hyperparameters,
    inputs: Array2<f64>,
    targets: Vec<f64>,
}

impl TryFrom<Stored> for GaussianProcess {
    type Error = Error;

    fn try_from(stored: Stored) -> Result<Self> {
        samples::check(&Samples::new(stored.inputs.view(), ArrayView1::from(&stored.targets)))?;
        let distances = training_distances(stored.inputs.view());
        let conditioned = Conditioned::on(stored.kernel, &stored.hyperparameters, &distances, &stored.targets)
            .ok_or_else(|| not_definite(stored.inputs.view()))?;
        let whitening = conditioned.whitening().ok_or_else(|| not_definite(stored.inputs.view()))?;
        Ok(Self {
            constant: conditioned.constant,
            log_likelihood: conditioned.log_likelihood,
            weights: conditioned.weights.iter().copied().collect(),
            whitening: Array2::from_shape_fn(whitening.shape(), |(row, column)| whitening[(column, row)]),
            inverse_ones: conditioned.inverse_ones.iter().copied().collect(),
            stored,
        })
    }
}

impl From<GaussianProcess> for Stored {
    fn from(process: GaussianProcess) -> Self {
        process.stored
    }
}

fn not_definite(inputs: ArrayView2<'_, f64>) -> Error {
    Error::Convergence { what: "the covariance of the Gaussian process", rows: inputs.nrows(), columns: inputs.ncols() }
}

fn training_distances(inputs: ArrayView2<'_, f64>) -> DMatrix<f64> {
    let distances = squared_distances(inputs, inputs);
    DMatrix::from_fn(inputs.nrows(), inputs.nrows(), |row, column| distances[[row, column]])
}

impl GaussianProcess {
    /// Conditions a process of known hyperparameters on observations, one a row.
    ///
    /// # Errors
    /// For samples that no regression can be fitted to, and [`Error::Convergence`] where the covariance of the
    /// observations is not positive definite.
    pub fn condition(kernel: Kernel, hyperparameters: Hyperparameters, samples: &Samples<'_>) -> Result<Self> {
        let targets = samples.targets().to_vec();
        Stored { kernel, hyperparameters, inputs: samples.records().to_owned(), targets }.try_into()
    }

    /// Columns of an observation.
    pub fn columns(&self) -> usize {
        self.stored.inputs.ncols()
    }

    /// Parameters of the covariance.
    pub fn hyperparameters(&self) -> Hyperparameters {
        self.stored.hyperparameters
    }

    /// The constant mean, in units of the targets.
    pub fn constant(&self) -> f64 {
        self.constant
    }

    /// Natural logarithm of the likelihood of the targets.
    pub fn log_likelihood(&self) -> f64 {
        self.log_likelihood
    }

    /// Covariance of observations, one a row, with those of the training.
    fn covariance(&self, inputs: ArrayView2<'_, f64>) -> Array2<f64> {
        let Hyperparameters { length_scale, signal_std, exponent, .. } = self.stored.hyperparameters;
        let mut covariance = squared_distances(inputs, self.stored.inputs.view());
        let (scale, variance) = (1.0 / (length_scale * length_scale), signal_std * signal_std);
        let kernel = self.stored.kernel;
        covariance.mapv_inplace(|squared| variance * kernel.value(squared * scale, exponent));
        covariance
    }

    /// Standard deviation of each prediction for a new observation: what the training leaves open, the uncertainty of
    /// the constant, and the noise. The hyperparameters count as known.
    pub fn predict_std(&self, inputs: ArrayView2<'_, f64>) -> Array1<f64> {
        let Hyperparameters { signal_std, noise_std, .. } = self.stored.hyperparameters;
        let (signal, noise) = (signal_std * signal_std, noise_std * noise_std);
        let precision = self.inverse_ones.sum();
        let mut std = Array1::zeros(inputs.nrows());
        for (block, mut to) in inputs.axis_chunks_iter(Axis(0), BLOCK).zip(std.axis_chunks_iter_mut(Axis(0), BLOCK)) {
            let covariance = self.covariance(block);
            let explained = covariance.dot(&self.whitening);
            let constant = covariance.dot(&self.inverse_ones);
            for ((to, explained), constant) in to.iter_mut().zip(explained.rows()).zip(&constant) {
                // Rounding must not leave less than nothing open.
                let open = (signal - explained.dot(&explained)).max(0.0);
                *to = (open + (1.0 - constant).powi(2) / precision + noise).sqrt();
            }
        }
        std
    }
}

impl<'a> Fit<ArrayView2<'a, f64>, ArrayView1<'a, f64>, Error> for GaussianProcessRegression {
    type Object = GaussianProcess;

    fn fit(&self, samples: &Samples<'a>) -> Result<GaussianProcess> {
        samples::check(samples)?;
        let inputs = samples.records().view();
        let target_std = std_or_1(samples.targets().view());
        let length_scale =
            inputs.columns().into_iter().map(|column| column.std(1.0)).sum::<f64>() / inputs.ncols() as f64;
        let likelihood = Likelihood {
            kernel: self.kernel,
            distances: training_distances(inputs),
            targets: samples.targets().to_vec(),
            least_noise: LEAST_NOISE * target_std,
        };
        let length_scale = if length_scale > 0.0 { length_scale } else { 1.0 };
        let part = target_std / 2.0_f64.sqrt();
        let optimum = [length_scale, length_scale * (inputs.ncols() as f64).sqrt()]
            .into_iter()
            .filter_map(|length_scale| {
                let start = Hyperparameters { length_scale, signal_std: part, noise_std: part, exponent: 1.0 };
                bfgs::minimise(&likelihood.coordinates(&start), |at| {
                    likelihood.evaluate(at).map(|(value, gradient)| (-value, -gradient))
                })
            })
            .min_by(|a, b| a.value.total_cmp(&b.value))
            .ok_or(Error::Convergence {
                what: "the likelihood of the Gaussian process",
                rows: inputs.nrows(),
                columns: inputs.ncols(),
            })?;
        GaussianProcess::condition(self.kernel, likelihood.hyperparameters(&optimum.at), samples)
    }
}

/// Standard deviation of the targets; 1 where they have none.
fn std_or_1(targets: ArrayView1<'_, f64>) -> f64 {
    let std = targets.std(1.0);
    if std > 0.0 { std } else { 1.0 }
}

impl<D: Data<Elem = f64>> PredictInplace<ArrayBase<D, Ix2>, Array1<f64>> for GaussianProcess {
    fn predict_inplace(&self, inputs: &ArrayBase<D, Ix2>, out: &mut Array1<f64>) {
        let blocks = inputs.axis_chunks_iter(Axis(0), BLOCK).zip(out.axis_chunks_iter_mut(Axis(0), BLOCK));
        for (block, mut to) in blocks {
            to.assign(&(self.covariance(block).dot(&self.weights) + self.constant));
        }
    }

    fn default_target(&self, inputs: &ArrayBase<D, Ix2>) -> Array1<f64> {
        Array1::zeros(inputs.nrows())
    }
}
