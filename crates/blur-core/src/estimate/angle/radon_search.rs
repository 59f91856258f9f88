//! Search for the direction in which the Radon transform of a spectrum matches a bank of patterns best.

use super::peak::Peak;
use crate::projection::{Blocks, PatternBank, Profile, project};
use crate::spectrum::{Levelled, SpectrumBins};

/// Coarse search on blocks of bins, then refinement on all bins.
#[derive(Debug)]
pub(super) struct RadonSearch {
    blocks: Blocks,
    profile: Profile,
    bank: PatternBank,
    responses: Vec<f64>,
    variance_factor: f64,
}

const COARSE_STEP_DEG: f64 = 1.5;
/// Offsets tried on all bins around the coarse peak.
const OFFSETS_DEG: [f64; 6] = [-1.2, -0.8, -0.4, 0.4, 0.8, 1.2];
/// Half width of the final parabola.
const PARABOLA_DEG: f64 = 0.3;

/// A peak with the curvature of the log likelihood at it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RadonPeak {
    pub(super) peak: Peak,
    /// Standard uncertainty in degrees when the bins have unit variance and the window's correlation.
    pub(super) std_deg: f64,
}

impl RadonSearch {
    /// A search in spectra with the layout of `levelled`, of pictures of `rows` x `columns` pixels, for the patterns
    /// that `bank` makes for a profile. The window raises the variance of spectral estimates by `variance_factor`.
    pub(super) fn new(
        levelled: &Levelled,
        (rows, columns): (usize, usize),
        variance_factor: f64,
        bank: impl FnOnce(&Profile) -> PatternBank,
    ) -> Self {
        let profile = Profile::fitting(levelled.bins(), rows, columns);
        Self {
            blocks: Blocks::new(levelled.bins()),
            bank: bank(&profile),
            profile,
            responses: Vec::new(),
            variance_factor,
        }
    }

    /// The direction in `[0, span_deg)` of the best match; `None` when nothing matches anywhere.
    pub(super) fn find(&mut self, bins: &SpectrumBins, span_deg: f64) -> Option<RadonPeak> {
        self.blocks.set(bins);
        self.responses.clear();
        for i in 0..(span_deg / COARSE_STEP_DEG).ceil() as usize {
            self.blocks.project((i as f64 * COARSE_STEP_DEG).to_radians(), &mut self.profile);
            self.responses.push(self.bank.best_match(&self.profile).gain);
        }
        let mut peak = Peak::of(&self.responses, COARSE_STEP_DEG)?;
        let coarse = peak.deg;
        peak.height = self.gain_at(bins, coarse);
        for offset in OFFSETS_DEG {
            let gain = self.gain_at(bins, coarse + offset);
            if gain > peak.height {
                (peak.deg, peak.height) = (coarse + offset, gain);
            }
        }
        let (before, after) =
            (self.gain_at(bins, peak.deg - PARABOLA_DEG), self.gain_at(bins, peak.deg + PARABOLA_DEG));
        let curvature = (before - 2.0 * peak.height + after) / (PARABOLA_DEG * PARABOLA_DEG);
        let slope = (after - before) / (2.0 * PARABOLA_DEG);
        let std_deg = if curvature < 0.0 { (-self.variance_factor / curvature).sqrt() } else { COARSE_STEP_DEG };
        if curvature < 0.0 {
            peak.deg += (-slope / curvature).clamp(-PARABOLA_DEG, PARABOLA_DEG);
        }
        Some(RadonPeak { peak, std_deg })
    }

    /// The gain in log likelihood of the best pattern at one direction, on all bins.
    pub(super) fn gain_at(&mut self, bins: &SpectrumBins, deg: f64) -> f64 {
        project(bins, deg.to_radians(), &mut self.profile);
        self.bank.best_match(&self.profile).gain
    }
}
