//! The likelihood of a process and its gradient.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::{Hyperparameters, Kernel};

/// A process of known hyperparameters, conditioned on its observations.
pub(super) struct Conditioned {
    cholesky: Cholesky<f64, Dyn>,
    pub(super) constant: f64,
    pub(super) weights: DVector<f64>,
    pub(super) inverse_ones: DVector<f64>,
    pub(super) log_likelihood: f64,
}

impl Conditioned {
    /// `None` where the covariance is not positive definite. `distances` are squared.
    pub(super) fn on(
        kernel: Kernel,
        hyperparameters: &Hyperparameters,
        distances: &DMatrix<f64>,
        targets: &[f64],
    ) -> Option<Self> {
        let Hyperparameters { length_scale, signal_std, noise_std, exponent } = *hyperparameters;
        let scale = 1.0 / (length_scale * length_scale);
        let mut covariance = distances.map(|squared| signal_std * signal_std * kernel.value(squared * scale, exponent));
        for i in 0..targets.len() {
            covariance[(i, i)] += noise_std * noise_std;
        }
        let cholesky = Cholesky::new(covariance)?;
        let targets = DVector::from_column_slice(targets);
        let inverse_ones = cholesky.solve(&DVector::from_element(targets.len(), 1.0));
        let constant = inverse_ones.dot(&targets) / inverse_ones.sum();
        let residuals = targets.add_scalar(-constant);
        let weights = cholesky.solve(&residuals);
        let half_log_determinant: f64 = cholesky.l_dirty().diagonal().iter().map(|entry| entry.ln()).sum();
        let log_likelihood = -0.5 * residuals.dot(&weights)
            - half_log_determinant
            - 0.5 * targets.len() as f64 * std::f64::consts::TAU.ln();
        log_likelihood.is_finite().then_some(Self { cholesky, constant, weights, inverse_ones, log_likelihood })
    }

    /// The inverse of the Cholesky factor.
    pub(super) fn whitening(&self) -> Option<DMatrix<f64>> {
        let count = self.weights.len();
        self.cholesky.l().solve_lower_triangular(&DMatrix::identity(count, count))
    }
}

/// The likelihood as a function of the logarithms of length scale, signal, noise above the least, and exponent if the
/// kernel has one.
pub(super) struct Likelihood {
    pub(super) kernel: Kernel,
    /// Squared distances of the observations.
    pub(super) distances: DMatrix<f64>,
    pub(super) targets: Vec<f64>,
    pub(super) least_noise: f64,
}

impl Likelihood {
    pub(super) fn coordinates(&self, of: &Hyperparameters) -> DVector<f64> {
        let mut all = vec![of.length_scale.ln(), of.signal_std.ln(), (of.noise_std - self.least_noise).ln()];
        if self.kernel.has_exponent() {
            all.push(of.exponent.ln());
        }
        DVector::from_vec(all)
    }

    pub(super) fn hyperparameters(&self, at: &DVector<f64>) -> Hyperparameters {
        Hyperparameters {
            length_scale: at[0].exp(),
            signal_std: at[1].exp(),
            noise_std: self.least_noise + at[2].exp(),
            exponent: at.get(3).map_or(1.0, |log| log.exp()),
        }
    }

    /// Log-likelihood and its gradient; `None` where the covariance is not positive definite.
    ///
    /// *Reference*: Rasmussen & Williams 2006, equation 5.9. The constant follows the hyperparameters, but at its best
    /// value it has no part in the gradient.
    pub(super) fn evaluate(&self, at: &DVector<f64>) -> Option<(f64, DVector<f64>)> {
        let hyperparameters = self.hyperparameters(at);
        let Hyperparameters { length_scale, signal_std, noise_std, exponent } = hyperparameters;
        let conditioned = Conditioned::on(self.kernel, &hyperparameters, &self.distances, &self.targets)?;
        let inverse = conditioned.cholesky.inverse();
        let (scale, signal) = (1.0 / (length_scale * length_scale), signal_std * signal_std);
        let weights = &conditioned.weights;
        let mut gradient = DVector::zeros(at.len());
        for column in 0..self.targets.len() {
            // The matrices are symmetric: below the diagonal every entry counts twice.
            for row in column..self.targets.len() {
                let share = (weights[row] * weights[column] - inverse[(row, column)]) * signal;
                let share = if row == column { 0.5 * share } else { share };
                let [value, by_length, by_exponent] =
                    self.kernel.with_derivatives(self.distances[(row, column)] * scale, exponent);
                gradient[0] += share * by_length;
                gradient[1] += share * 2.0 * value;
                if self.kernel.has_exponent() {
                    gradient[3] += share * by_exponent;
                }
            }
        }
        let trace = weights.norm_squared() - inverse.trace();
        gradient[2] = trace * noise_std * at[2].exp();
        Some((conditioned.log_likelihood, gradient))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blur_sim::rng::Rng;

    #[test]
    fn gradient_is_that_of_finite_differences() {
        let (rows, columns) = (40, 5);
        let mut rng = Rng::new(3, 0);
        let inputs = ndarray::Array2::from_shape_simple_fn((rows, columns), || rng.gaussian());
        let targets: Vec<f64> =
            inputs.rows().into_iter().map(|row| (row[0] + 0.5 * row[1]).sin() + 0.2 * rng.gaussian()).collect();
        for kernel in [Kernel::Exponential, Kernel::Matern52, Kernel::RationalQuadratic, Kernel::SquaredExponential] {
            let likelihood = Likelihood {
                kernel,
                distances: super::super::training_distances(inputs.view()),
                targets: targets.clone(),
                least_noise: 0.01,
            };
            let full = [0.7, -0.2, -1.4, 0.3];
            let at = DVector::from_column_slice(&full[..if kernel.has_exponent() { 4 } else { 3 }]);
            let (_, gradient) = likelihood.evaluate(&at).unwrap();
            for parameter in 0..at.len() {
                // Fourth order: a step of 1e-3 leaves about 1e-12 of the fifth derivative, rounding some 1e-11.
                let step = 1e-3;
                let value = |steps: f64| {
                    let mut moved = at.clone();
                    moved[parameter] += steps * step;
                    likelihood.evaluate(&moved).unwrap().0
                };
                let difference = (8.0 * (value(1.0) - value(-1.0)) - (value(2.0) - value(-2.0))) / (12.0 * step);
                let error = (difference - gradient[parameter]).abs() / gradient.amax();
                assert!(error < 1e-9, "{kernel:?} {parameter}: {difference} {}", gradient[parameter]);
            }
        }
    }
}
