use super::{Sample, numerical_tolerance, run, sampler::Sampler};
use crate::{Correlation, Error, Input, TypeA, error};

/// What the adaptive procedure is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Probability of the coverage interval, in (0, 1).
    pub probability: f64,
    /// Significant digits of the standard uncertainty that shall be stable, 1 to 15; each costs a hundred times more
    /// trials.
    pub digits: usize,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Give up before more trials than these (8 bytes each).
    pub max_trials: usize,
}

/// 95 %, two digits, at most 1e7 trials.
impl Default for Settings {
    fn default() -> Self {
        Self { probability: 0.95, digits: 2, seed: 0, max_trials: 10_000_000 }
    }
}

/// Why the adaptive procedure ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Termination {
    /// Mean, standard deviation and both ends of the interval are stable.
    Stable,
    /// Another block of trials would have been too many.
    TooManyTrials,
}

/// What the adaptive procedure found.
#[derive(Debug, Clone, PartialEq)]
pub struct Adaptive {
    /// All trials.
    pub sample: Sample,
    /// Numerical tolerance that the four numbers were held to.
    pub tolerance: f64,
    /// Twice the standard deviations of the averages over the blocks: mean, standard deviation, lower and upper end.
    pub scatter: [f64; 4],
    /// Why it ended.
    pub termination: Termination,
}

/// Propagates distributions by blocks of trials until the result is stable.
///
/// The interval in question is the probabilistically symmetric one.
///
/// # Reference
///
/// JCGM 101 7.9.4.
pub fn adaptive(
    inputs: &[Input],
    correlation: &Correlation,
    model: impl Fn(&[f64]) -> f64,
    settings: Settings,
) -> Result<Adaptive, Error> {
    let probability = error::probability(settings.probability)?;
    // Smallest integer not below 100 / (1 - p), but for rounding.
    let block = ((100.0 / (1.0 - probability) - 1e-6).ceil() as usize).max(10_000);
    if settings.max_trials < block.saturating_mul(2) {
        return Err(Error::TooFew {
            what: "trials allowed",
            count: settings.max_trials,
            least: block.saturating_mul(2),
        });
    }
    let mut sampler = Sampler::new(inputs, correlation, settings.seed)?;
    let mut all = Vec::new();
    let mut estimates: [Vec<f64>; 4] = Default::default();
    loop {
        let values = run(&mut sampler, &model, block)?;
        all.extend_from_slice(&values);
        let sample = Sample::new(values)?;
        let (low, high) = sample.symmetric_interval(probability)?;
        for (list, estimate) in estimates.iter_mut().zip([sample.mean(), sample.std(), low, high]) {
            list.push(estimate);
        }
        if estimates[0].len() < 2 {
            continue;
        }
        let mut scatter = [0.0; 4];
        for (scatter, list) in scatter.iter_mut().zip(&estimates) {
            *scatter = 2.0 * TypeA::of(list)?.std();
        }
        let tolerance = numerical_tolerance(pooled(&estimates[0], &estimates[1], block)?, settings.digits)?;
        let stable = scatter.iter().all(|&s| s <= tolerance);
        if stable || all.len() + block > settings.max_trials {
            let termination = if stable { Termination::Stable } else { Termination::TooManyTrials };
            return Ok(Adaptive { sample: Sample::new(all)?, tolerance, scatter, termination });
        }
    }
}

/// Standard deviation of all trials from the means and standard deviations of their blocks of equal size.
fn pooled(means: &[f64], stds: &[f64], block: usize) -> Result<f64, Error> {
    let (blocks, size) = (means.len() as f64, block as f64);
    let between = TypeA::of(means)?.sample_std().powi(2) * (blocks - 1.0) * size;
    let within: f64 = stds.iter().map(|s| s * s * (size - 1.0)).sum();
    Ok(((between + within) / (blocks * size - 1.0)).sqrt())
}
