//! Search for the direction in which the Radon transform of a spectrum matches a bank of patterns best.

use super::peak::Peak;
use super::sandwich::{SMALL_BLOCK, Sandwich};
use crate::projection::{BlockLines, Blocks, PatternBank, Profile, project};
use crate::spectrum::Levelled;

/// Coarse search on blocks of bins, then refinement on all bins.
#[derive(Debug)]
pub(super) struct RadonSearch {
    blocks: Blocks,
    /// Lines of the blocks at each coarse direction.
    lines: Vec<BlockLines>,
    coarse_profile: Profile,
    coarse_bank: PatternBank,
    profile: Profile,
    bank: PatternBank,
    responses: Vec<f64>,
    sandwich: Sandwich,
}

const COARSE_STEP_DEG: f64 = 1.5;
/// Last direction of a search over all directions: the next one is 0 again.
pub(super) const DIRECTIONS_DEG: f64 = 180.0 - COARSE_STEP_DEG;
/// Last direction of a search in the quadrant of a DCT.
pub(super) const QUADRANT_DEG: f64 = 90.0;
/// Half widths of the parabolas that refine the coarse peak, one after the other.
const PARABOLAS_DEG: [f64; 2] = [0.75, 0.25];

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
    /// that `bank` makes for a profile, over the directions in `[0, last_deg]`.
    pub(super) fn new(
        levelled: &Levelled,
        (rows, columns): (usize, usize),
        last_deg: f64,
        bank: impl Fn(&Profile) -> PatternBank,
    ) -> Self {
        let bins = levelled.bins();
        let profile = Profile::fitting(bins, rows, columns);
        let blocks = Blocks::new(bins);
        let coarse_profile = blocks.profile(bins, rows, columns);
        let lines = (0..=(last_deg / COARSE_STEP_DEG) as usize)
            .map(|i| blocks.lines((i as f64 * COARSE_STEP_DEG).to_radians(), &coarse_profile))
            .collect();
        Self {
            lines,
            coarse_bank: bank(&coarse_profile),
            coarse_profile,
            blocks,
            bank: bank(&profile),
            profile,
            responses: Vec::new(),
            sandwich: Sandwich::new(bins),
        }
    }

    /// The direction of the best match; `None` when nothing matches anywhere.
    pub(super) fn find(&mut self, levelled: &Levelled) -> Option<RadonPeak> {
        self.blocks.set(levelled.bins());
        self.responses.clear();
        for lines in &self.lines {
            self.blocks.project(lines, &mut self.coarse_profile);
            self.responses.push(self.coarse_bank.best_match(&self.coarse_profile).gain);
        }
        let mut peak = Peak::of(&self.responses, COARSE_STEP_DEG)?;
        for half_width in PARABOLAS_DEG {
            peak.deg = self.highest_near(levelled, peak.deg, half_width);
        }
        let std_deg = self.std_deg_at(levelled, peak.deg);
        Some(RadonPeak { peak, std_deg })
    }

    /// The place of the maximum within `half_width` of `deg` by the parabola through three directions on all bins; an end
    /// when the matches rise towards it.
    fn highest_near(&mut self, levelled: &Levelled, deg: f64, half_width: f64) -> f64 {
        let [before, at, after] = [-half_width, 0.0, half_width].map(|offset| self.gain_at(levelled, deg + offset));
        let curvature = before - 2.0 * at + after;
        if curvature < 0.0 {
            deg + half_width * (0.5 * (before - after) / curvature).clamp(-1.0, 1.0)
        } else if after > before {
            deg + half_width
        } else {
            deg - half_width
        }
    }

    /// Standard uncertainty of the direction, see [`Sandwich`].
    fn std_deg_at(&mut self, levelled: &Levelled, deg: f64) -> f64 {
        project(levelled.bins(), deg.to_radians(), &mut self.profile);
        let best = self.bank.best_match(&self.profile);
        let pattern = self.bank.pattern(best.length_px);
        let (sin, cos) = deg.to_radians().sin_cos();
        let per_step = 1.0 / self.profile.step();
        let fit = LineFit::of(pattern, &self.profile);
        self.sandwich.clear();
        let last = pattern.len().saturating_sub(1);
        levelled.bins().for_each_in_block(SMALL_BLOCK, |block, u, v, value| {
            let (u, v) = (f64::from(u), f64::from(v));
            let s = u * cos - v * sin;
            let line = ((s.abs() * per_step) as usize).min(last);
            let (left, right) = (line.saturating_sub(1), (line + 1).min(last));
            let slope = f64::from(pattern[right] - pattern[left]) * per_step / (right - left).max(1) as f64;
            let by_angle = fit.amplitude * slope * s.signum() * (-u * sin - v * cos);
            let residual = f64::from(value) - fit.offset - fit.amplitude * f64::from(pattern[line]);
            self.sandwich.add(block, residual, by_angle);
        });
        self.sandwich.std_rad(levelled.scale()).to_degrees()
    }

    /// The gain in log likelihood of the best pattern at one direction, on all bins.
    pub(super) fn gain_at(&mut self, levelled: &Levelled, deg: f64) -> f64 {
        project(levelled.bins(), deg.to_radians(), &mut self.profile);
        self.bank.best_match(&self.profile).gain
    }
}
