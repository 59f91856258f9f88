//! The uncertainty of a direction.

use std::f64::consts::FRAC_PI_2;

use super::structure::Structure;
use crate::spectrum::SpectrumBins;

/// The sandwich formula for the uncertainty of a direction.
///
/// The score (derivative of the log likelihood by the angle) is summed over blocks of bins, whose sums are taken as
/// independent; their scatter over the information is the uncertainty. Correlation inside a block, from the window and
/// the picture's own structure, is counted in; structure that reaches over the whole spectrum is added from its spread
/// among sharp pictures ([`Structure`]).
///
/// Reference: H. White, "Maximum likelihood estimation of misspecified models", Econometrica 50, 1982.
#[derive(Debug)]
pub(super) struct Sandwich {
    structure: Structure,
    /// The large block that each small block is part of.
    large_of_small: Vec<usize>,
    scores: Vec<f64>,
    by_angle: Vec<f64>,
    large_scores: Vec<f64>,
    information: f64,
}

/// Bins along each side of the blocks whose scores are taken as independent: well beyond the window's correlation.
const LARGE_BLOCK: usize = 16;
/// Bins along each side of the blocks on which structure is tabulated; a divisor of [`LARGE_BLOCK`].
pub(super) const SMALL_BLOCK: usize = 4;

impl Sandwich {
    /// For spectra with the layout of `bins`.
    pub(super) fn new(bins: &SpectrumBins) -> Self {
        let (small, large) = (bins.blocks_of(SMALL_BLOCK), bins.blocks_of(LARGE_BLOCK));
        let mut centres = vec![(0.0, 0.0, 0.0_f64); small];
        bins.for_each_in_block(SMALL_BLOCK, |block, u, v, _| {
            let centre = &mut centres[block];
            *centre = (centre.0 + f64::from(u), centre.1 + f64::from(v), centre.2 + 1.0);
        });
        let mut small_blocks = Vec::new();
        bins.for_each_in_block(SMALL_BLOCK, |block, _, _, _| small_blocks.push(block));
        let mut large_of_small = vec![0; small];
        let mut each = small_blocks.iter();
        bins.for_each_in_block(LARGE_BLOCK, |block, _, _, _| {
            if let Some(&small) = each.next() {
                large_of_small[small] = block;
            }
        });
        Self {
            structure: Structure::new(centres.iter().map(|&(u, v, n)| (u / n.max(1.0), v / n.max(1.0)))),
            large_of_small,
            scores: vec![0.0; small],
            by_angle: vec![0.0; small],
            large_scores: vec![0.0; large],
            information: 0.0,
        }
    }

    /// Forgets what was added.
    pub(super) fn clear(&mut self) {
        self.scores.fill(0.0);
        self.by_angle.fill(0.0);
        self.large_scores.fill(0.0);
        self.information = 0.0;
    }

    /// Adds a bin: what the fit leaves of it, and the derivative of the fit by the angle.
    pub(super) fn add(&mut self, small_block: usize, residual: f64, by_angle: f64) {
        self.scores[small_block] += residual * by_angle;
        self.by_angle[small_block] += by_angle;
        self.information += by_angle * by_angle;
    }

    /// Standard uncertainty in radians; structure counts in levelled values, `scale` of them a unit of log power.
    pub(super) fn std_rad(&mut self, scale: f64) -> f64 {
        for (&large, score) in self.large_of_small.iter().zip(&self.scores) {
            self.large_scores[large] += score;
        }
        let scatter: f64 = self.large_scores.iter().map(|score| score * score).sum();
        let structure = self.structure.variance(&self.by_angle) * scale * scale;
        if self.information > 0.0 { (scatter + structure).sqrt() / self.information } else { FRAC_PI_2 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::Levelled;

    #[test]
    fn independent_unit_residuals_give_the_root_of_the_information() {
        // Residuals of +-1 scattered over the bins, derivatives of 2: information 4 n, so the uncertainty is
        // 1 / (2 sqrt n) up to the scatter of the block sums.
        let levelled = Levelled::for_dft(256, 256);
        let mut sandwich = Sandwich::new(levelled.bins());
        sandwich.clear();
        let mut state = 1_u64;
        levelled.bins().for_each_in_block(SMALL_BLOCK, |block, _, _, _| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            sandwich.add(block, if state >> 63 == 0 { 1.0 } else { -1.0 }, 2.0);
        });
        let expected = 0.5 / (levelled.bins().len() as f64).sqrt();
        let found = sandwich.std_rad(0.0);
        assert!((found / expected - 1.0).abs() < 0.25, "{found} {expected}");
        // Structure that the derivatives do not see through makes it larger.
        sandwich.large_scores.fill(0.0);
        assert!(sandwich.std_rad(1.0) > 1.5 * found);
    }

    #[test]
    fn without_information_nothing_is_known() {
        let levelled = Levelled::for_dft(64, 64);
        assert_eq!(Sandwich::new(levelled.bins()).std_rad(1.0), FRAC_PI_2);
    }
}
