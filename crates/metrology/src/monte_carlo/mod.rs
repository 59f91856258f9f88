//! Propagation of distributions by random trials (JCGM 101).
//!
//! ```
//! use metrology::monte_carlo::monte_carlo;
//! use metrology::{Correlation, Input};
//!
//! // JCGM 101 9.2.3: the sum of four rectangular inputs with u = 1.
//! let x = Input::rectangular("x", 0.0, 3.0_f64.sqrt())?;
//! let inputs = [x.clone(), x.clone(), x.clone(), x];
//! let y = monte_carlo(&inputs, &Correlation::independent(4), |q| q.iter().sum(), 100_000, 1)?;
//! let (low, high) = y.symmetric_interval(0.95)?;
//! assert!((low + 3.88).abs() < 0.04 && (high - 3.88).abs() < 0.04);
//! # Ok::<(), metrology::Error>(())
//! ```

mod adaptive;
mod random;
mod sample;
mod sampler;
mod validate;

pub use adaptive::{Adaptive, Settings, Termination, adaptive};
pub use sample::Sample;
pub use validate::{Validation, numerical_tolerance, validate};

use crate::{Correlation, Error, Input};
use sampler::Sampler;

/// Propagates distributions through a model by a fixed number of trials, at least 2.
///
/// The same seed gives the same numbers on every machine, as far as the model does. Correlated inputs must be normal.
/// JCGM 101 7.2.1 recommends 1e6 trials for a 95 % interval with two digits; [`adaptive`](adaptive()) finds the number by
/// itself.
///
/// # Reference
///
/// JCGM 101 clause 7.
pub fn monte_carlo(
    inputs: &[Input],
    correlation: &Correlation,
    model: impl Fn(&[f64]) -> f64,
    trials: usize,
    seed: u64,
) -> Result<Sample, Error> {
    let mut sampler = Sampler::new(inputs, correlation, seed)?;
    Sample::new(run(&mut sampler, &model, trials)?)
}

fn run(sampler: &mut Sampler<'_>, model: &impl Fn(&[f64]) -> f64, trials: usize) -> Result<Vec<f64>, Error> {
    let mut outputs = Vec::with_capacity(trials);
    for _ in 0..trials {
        let value = model(sampler.draw());
        if !value.is_finite() {
            return Err(Error::ModelNotFinite { value });
        }
        outputs.push(value);
    }
    Ok(outputs)
}
