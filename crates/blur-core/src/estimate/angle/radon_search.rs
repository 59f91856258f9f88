//! Search for the direction in which the Radon transform of a spectrum matches a bank of patterns best.

use super::peak::Peak;
use super::structure::Structure;
use crate::projection::{Blocks, PatternBank, Profile, project};
use crate::spectrum::Levelled;

/// Coarse search on blocks of bins, then refinement on all bins.
#[derive(Debug)]
pub(super) struct RadonSearch {
    blocks: Blocks,
    profile: Profile,
    bank: PatternBank,
    responses: Vec<f64>,
    scores: Vec<f64>,
}

const COARSE_STEP_DEG: f64 = 1.5;
/// Last direction of a search over all directions: the next one is 0 again.
pub(super) const DIRECTIONS_DEG: f64 = 180.0 - COARSE_STEP_DEG;
/// Last direction of a search in the quadrant of a DCT.
pub(super) const QUADRANT_DEG: f64 = 90.0;
/// Offsets tried on all bins around the coarse peak.
const OFFSETS_DEG: [f64; 6] = [-1.2, -0.8, -0.4, 0.4, 0.8, 1.2];
/// Half width of the final parabola.
const PARABOLA_DEG: f64 = 0.3;

/// Bins along each side of the blocks that scores are summed over.
const SCORE_BLOCK: usize = 16;

/// Least-squares offset and amplitude of a pattern in a profile.
#[derive(Debug, Clone, Copy)]
struct LineFit {
    offset: f64,
    amplitude: f64,
}

impl LineFit {
    fn of(pattern: &[f32], profile: &Profile) -> Self {
        let (mut w, mut wt, mut wtt, mut y, mut yt) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for ((&t, &weight), &sum) in pattern.iter().zip(&profile.weight).zip(&profile.sum) {
            let (t, weight, sum) = (f64::from(t), f64::from(weight), f64::from(sum));
            w += weight;
            wt += weight * t;
            wtt += weight * t * t;
            y += sum;
            yt += sum * t;
        }
        let variance = w * wtt - wt * wt;
        let amplitude = if variance > 0.0 { (w * yt - y * wt) / variance } else { 0.0 };
        Self { offset: (y - amplitude * wt) / w.max(1.0), amplitude }
    }
}

/// A peak with its standard uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RadonPeak {
    pub(super) peak: Peak,
    /// Standard uncertainty in degrees.
    pub(super) std_deg: f64,
}

impl RadonSearch {
    /// A search in spectra with the layout of `levelled`, of pictures of `rows` x `columns` pixels, for the patterns
    /// that `bank` makes for a profile.
    pub(super) fn new(
        levelled: &Levelled,
        (rows, columns): (usize, usize),
        bank: impl FnOnce(&Profile) -> PatternBank,
    ) -> Self {
        let bins = levelled.bins();
        let profile = Profile::fitting(bins, rows, columns);
        Self {
            blocks: Blocks::new(bins),
            bank: bank(&profile),
            profile,
            responses: Vec::new(),
            scores: vec![0.0; bins.blocks_of(SCORE_BLOCK)],
        }
    }

    /// The direction in `[0, last_deg]` of the best match; `None` when nothing matches anywhere.
    pub(super) fn find(&mut self, levelled: &Levelled, last_deg: f64) -> Option<RadonPeak> {
        self.blocks.set(levelled.bins());
        self.responses.clear();
        for i in 0..=(last_deg / COARSE_STEP_DEG) as usize {
            self.blocks.project((i as f64 * COARSE_STEP_DEG).to_radians(), &mut self.profile);
            self.responses.push(self.bank.best_match(&self.profile).gain);
        }
        let mut peak = Peak::of(&self.responses, COARSE_STEP_DEG)?;
        let coarse = peak.deg;
        peak.height = self.gain_at(levelled, coarse);
        for offset in OFFSETS_DEG {
            let gain = self.gain_at(levelled, coarse + offset);
            if gain > peak.height {
                (peak.deg, peak.height) = (coarse + offset, gain);
            }
        }
        let (before, after) =
            (self.gain_at(levelled, peak.deg - PARABOLA_DEG), self.gain_at(levelled, peak.deg + PARABOLA_DEG));
        let curvature = (before - 2.0 * peak.height + after) / (PARABOLA_DEG * PARABOLA_DEG);
        let slope = (after - before) / (2.0 * PARABOLA_DEG);
        if curvature < 0.0 {
            peak.deg += (-slope / curvature).clamp(-PARABOLA_DEG, PARABOLA_DEG);
        }
        let std_deg = self.std_deg_at(levelled, peak.deg);
        Some(RadonPeak { peak, std_deg })
    }

    /// Standard uncertainty of the direction by the sandwich formula: the score (derivative of the log likelihood by the
    /// angle) is summed over blocks of bins, whose sums are taken as independent; their scatter over the information
    /// is the uncertainty. Correlation inside a block, from the window and the picture's own structure, is counted in;
    /// structure that reaches over the whole spectrum is added from its spread among sharp pictures ([`Structure`]).
    ///
    /// Reference: H. White, "Maximum likelihood estimation of misspecified models", Econometrica 50, 1982.
    fn std_deg_at(&mut self, levelled: &Levelled, deg: f64) -> f64 {
        project(levelled.bins(), deg.to_radians(), &mut self.profile);
        let best = self.bank.best_match(&self.profile);
        let pattern = self.bank.pattern(best.length_px);
        let (sin, cos) = deg.to_radians().sin_cos();
        let per_step = 1.0 / self.profile.step();
        let fit = LineFit::of(pattern, &self.profile);
        self.scores.fill(0.0);
        let mut information = 0.0;
        let mut structure = Structure::default();
        levelled.bins().for_each_in_block(SCORE_BLOCK, |block, u, v, value| {
            let (u, v) = (f64::from(u), f64::from(v));
            let s = u * cos - v * sin;
            let line = ((s.abs() * per_step) as usize).min(pattern.len().saturating_sub(1));
            let (left, right) = (line.saturating_sub(1), (line + 1).min(pattern.len().saturating_sub(1)));
            let slope = f64::from(pattern[right] - pattern[left]) * per_step / (right - left).max(1) as f64;
            let by_angle = fit.amplitude * slope * s.signum() * (-u * sin - v * cos);
            let residual = f64::from(value) - fit.offset - fit.amplitude * f64::from(pattern[line]);
            self.scores[block] += residual * by_angle;
            information += by_angle * by_angle;
            structure.add(u, v, by_angle);
        });
        let scatter = self.scores.iter().map(|score| score * score).sum::<f64>();
        let structure = structure.variance() * levelled.scale() * levelled.scale();
        if information > 0.0 { ((scatter + structure).sqrt() / information).to_degrees() } else { 90.0 }
    }

    /// The gain in log likelihood of the best pattern at one direction, on all bins.
    pub(super) fn gain_at(&mut self, levelled: &Levelled, deg: f64) -> f64 {
        project(levelled.bins(), deg.to_radians(), &mut self.profile);
        self.bank.best_match(&self.profile).gain
    }
}
