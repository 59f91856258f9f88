//! Vote of the brightest bins for the direction of the lines they lie on.

use super::peak::Peak;
use crate::projection::{Hough, Profile, Votes, project};
use crate::spectrum::SpectrumBins;

/// Hough votes over all directions, with the number of bins on each line worked out beforehand.
#[derive(Debug)]
pub(super) struct HoughVote {
    hough: Hough,
    /// For each direction, the number of all bins on each line.
    all: Vec<Vec<f32>>,
    votes: Votes,
    responses: Vec<f64>,
}

const STEP_DEG: f64 = 1.0;
/// Directions on both sides of the peak that its centroid is taken over.
const NEIGHBOURS: isize = 4;

impl HoughVote {
    /// A vote in spectra with the layout of `bins`, of pictures whose longer side is `side` pixels, over directions in
    /// `[0, span_deg)`. Lines are four DFT bins wide: wide enough to hold the central ridge of usual blurs.
    pub(super) fn new(bins: &SpectrumBins, side: usize, span_deg: f64) -> Self {
        let step = 4.0 / side as f64;
        let mut profile = Profile::new(step, bins.band.max);
        let all = (0..(span_deg / STEP_DEG) as usize)
            .map(|i| {
                project(bins, (i as f64 * STEP_DEG).to_radians(), &mut profile);
                profile.weight.clone()
            })
            .collect();
        Self { hough: Hough::new(bins), all, votes: Votes::new(step, bins.band.max), responses: Vec::new() }
    }

    /// The direction with the most significant line, between the directions of the grid by the centroid of what
    /// stands above half of the peak.
    pub(super) fn find(&mut self, bins: &SpectrumBins) -> Option<Peak> {
        self.hough.set(bins);
        self.responses.clear();
        for (i, all) in self.all.iter().enumerate() {
            self.votes.all.copy_from_slice(all);
            self.hough.vote((i as f64 * STEP_DEG).to_radians(), &mut self.votes);
            self.responses.push(self.hough.significance(&self.votes));
        }
        let mut peak = Peak::of(&self.responses, STEP_DEG)?;
        let (mut moment, mut total) = (0.0, 0.0);
        let at = (peak.deg / STEP_DEG) as isize;
        for offset in -NEIGHBOURS..=NEIGHBOURS {
            let neighbour = (at + offset).rem_euclid(self.responses.len() as isize) as usize;
            let excess = (self.responses[neighbour] - 0.5 * peak.height).max(0.0);
            moment += excess * offset as f64;
            total += excess;
        }
        peak.deg += STEP_DEG * moment / total;
        Some(peak)
    }

    /// The significance of the direction of the grid nearest to `deg`.
    pub(super) fn response_near(&mut self, bins: &SpectrumBins, deg: f64) -> f64 {
        self.hough.set(bins);
        let at = (deg / STEP_DEG).round().rem_euclid(self.all.len() as f64) as usize;
        self.votes.all.copy_from_slice(&self.all[at]);
        self.hough.vote((at as f64 * STEP_DEG).to_radians(), &mut self.votes);
        self.hough.significance(&self.votes)
    }
}
