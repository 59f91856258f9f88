use std::f64::consts::{PI, SQRT_2};

use crate::Error;
use crate::error;

/// The number that a standard normal variable does not exceed with a probability in (0, 1).
///
/// Relative error below 1e-14.
///
/// ```
/// assert!((metrology::normal_quantile(0.975)? - 1.959_963_984_540_054).abs() < 1e-14);
/// # Ok::<(), metrology::Error>(())
/// ```
///
/// # Reference
///
/// Starting value: Abramowitz and Stegun 26.2.23.
pub fn normal_quantile(probability: f64) -> Result<f64, Error> {
    let tail = error::probability(probability)?.min(1.0 - probability);
    let magnitude = if tail < 0.25 { upper(tail) } else { central(0.5 - tail) };
    Ok(if probability < 0.5 { -magnitude } else { magnitude })
}

fn density(z: f64) -> f64 {
    (-0.5 * z * z).exp() / (2.0 * PI).sqrt()
}

/// The `z` that is exceeded with a small probability, from a guess good to 4.5e-4.
pub(crate) fn upper(tail: f64) -> f64 {
    let t = (-2.0 * tail.ln()).sqrt();
    let above = 2.515_517 + t * (0.802_853 + t * 0.010_328);
    let below = 1.0 + t * (1.432_788 + t * (0.189_269 + t * 0.001_308));
    let mut z = t - above / below;
    for _ in 0..3 {
        let newton = (0.5 * libm::erfc(z / SQRT_2) - tail) / density(z);
        // Halley's step; the second derivative of the tail is z times the density.
        z += newton / (1.0 + 0.5 * z * newton);
    }
    z
}

/// The `z` with the probability `excess` between 0 and it.
fn central(excess: f64) -> f64 {
    let mut z = excess * (2.0 * PI).sqrt();
    for _ in 0..5 {
        let newton = (excess - 0.5 * libm::erf(z / SQRT_2)) / density(z);
        z += newton / (1.0 - 0.5 * z * newton);
    }
    z
}
