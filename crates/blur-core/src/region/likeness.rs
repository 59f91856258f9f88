//! How much a point looks as if it moved.

use ndarray::Array2;

use super::candidates::Candidate;
use super::texture::{CORRELATED, SCALES, STEP_PX, Texture, WINDOWS};

/// Logistic regression of "this point moves so" on the texture: weights of the log energies along and across the motion
/// and, at the scales that have one, of the correlation of the blur's ends; by scale, then by window. Blur takes the fine
/// scales along the motion away, leaves those across it, and makes the ends correlate negatively.
///
/// Learnt from twelve streets (`blur_sim::street`, noise of 40 dB) made of odd kodak pictures, their objects and their
/// backgrounds weighted alike.
const WEIGHTS: [&[f32]; SCALES * WINDOWS] = [
    &[-1.73, -0.04],
    &[0.56, 0.92],
    &[-0.04, 0.16, -0.01],
    &[-1.10, -0.80, -8.78],
    &[0.89, 0.11, 0.10],
    &[-3.21, 1.01, 3.64],
    &[-0.78, 0.06],
    &[4.42, -0.66],
];
const INTERCEPT: f32 = 3.25;
/// Beyond this, evidence counts no more: the model is not as sure as it sounds.
const LIMIT: f32 = 8.0;

/// Scale and window by which a point has texture or not, and the energy relative to noise at which evidence counts by half.
const TELLING: (usize, usize) = (1, 1);
const HALF_BELIEVED: f32 = 3.0;

/// Logarithm of the odds that each point of the grid moves as `candidate`, within plus and minus 8, or minus infinity where
/// it cannot.
pub(super) fn log_odds(texture: &Texture, candidate: &Candidate) -> Array2<f32> {
    let (sin, cos) = candidate.angle.rad().sin_cos();
    // Rows count downwards.
    let direction = (cos as f32, -sin as f32);
    let correlations: Vec<Vec<Array2<f32>>> =
        (0..CORRELATED.len()).map(|index| texture.end_correlations(index, candidate.length_px, direction)).collect();
    Array2::from_shape_fn(texture.dim(), |at| {
        if !candidate.reaches((at.1 * STEP_PX) as f64, (at.0 * STEP_PX) as f64) {
            return f32::NEG_INFINITY;
        }
        let mut sum = INTERCEPT;
        for (number, weights) in WEIGHTS.iter().enumerate() {
            let (scale, window) = (number / WINDOWS, number % WINDOWS);
            for (weight, energy) in weights.iter().zip(texture.log_energies((scale, window), at, direction)) {
                sum += weight * energy;
            }
            let index = CORRELATED.iter().position(|&correlated| correlated == scale);
            if let (Some(index), Some(weight)) = (index, weights.get(2)) {
                sum += weight * correlations[index][window][at];
            }
        }
        // Noise tells nothing, whatever the logarithms say of it.
        let texture = texture.energy_to_noise(TELLING, at);
        sum.clamp(-LIMIT, LIMIT) * texture / (texture + HALF_BELIEVED)
    })
}
