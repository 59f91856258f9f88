//! What a fit leaves: noise, and what it does not explain.

use super::fit::Fit;
use super::model::{Model, Noise, Unknown, of_path};

/// Most contrast that may stay unexplained by a picture that shows the scene.
pub(super) const MOST_UNEXPLAINED: f64 = 0.05;
/// Above this radius in cycles per pixel next to nothing but noise is left in a residual, right or wrong.
const NOISE_RADIUS: f64 = 0.35;
/// Bins whose noise is the picture's own but for this share measure it.
const OWN_NOISE: f64 = 0.2;

/// Powers of a residual of the whole band over those expected.
#[derive(Debug, Clone, Copy)]
pub(super) struct Residual {
    /// Where the noise is the picture's own.
    pub(super) own: f64,
    /// Everywhere.
    pub(super) mean: f64,
    /// Share of the contrast that is neither explained nor noise.
    pub(super) unexplained: f64,
}

impl Residual {
    /// Of a fit of `unknowns` that `model` still holds the columns of, weighted by `noise`.
    pub(super) fn new(model: &Model, unknowns: &[Unknown], found: &Fit, noise: Noise) -> Self {
        let mut values = found.values;
        values[..of_path(unknowns)].fill(0.0);
        let grid = model.grid;
        let share = model.pixels() / (grid.padded.0 * grid.padded.1) as f64;
        let (mut own, mut high, mut all) = (Mean::default(), Mean::default(), Mean::default());
        model.residual(&values[..unknowns.len()], |bin, power| {
            let expected = grid.multiplicity(bin[1]) * share;
            all.add(power, expected);
            if model.noise_power(bin) < (1.0 + OWN_NOISE) * noise.picture {
                own.add(power, expected);
            }
            if grid.right(bin[1]).hypot(grid.down(bin[0])) > NOISE_RADIUS {
                high.add(power, expected);
            }
        });
        let excess = all.power - high.ratio() * all.expected;
        let contrast = found.normal.contrast(unknowns.iter().position(|unknown| *unknown == Unknown::Offset));
        Self {
            own: own.ratio(),
            mean: all.ratio(),
            unexplained: if contrast > 0.0 { (excess / contrast).max(0.0) } else { 1.0 },
        }
    }
}

/// A sum of powers and the sum expected.
#[derive(Default)]
struct Mean {
    power: f64,
    expected: f64,
}

impl Mean {
    fn add(&mut self, power: f64, expected: f64) {
        self.power += power;
        self.expected += expected;
    }

    fn ratio(&self) -> f64 {
        if self.expected > 0.0 { self.power / self.expected } else { 1.0 }
    }
}
