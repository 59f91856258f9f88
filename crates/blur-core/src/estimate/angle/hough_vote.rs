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
    directions: Directions,
}

/// Which directions there are, and what lies beyond the first and the last one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Directions {
    /// All of `[0, 180)`: beyond the last is the first.
    All,
    /// `[0, 90]`, the quadrant of a DCT: the directions beyond are the mirror images of those before.
    Quadrant,
}

impl Directions {
    fn count(self) -> usize {
        match self {
            Self::All => 180,
            Self::Quadrant => 91,
        }
    }

    /// Index of the direction `index`, which may be one of those beyond.
    fn fold(self, index: isize) -> usize {
        match self {
            Self::All => index.rem_euclid(180) as usize,
            Self::Quadrant => (90 - (90 - index.abs()).abs()) as usize,
        }
    }
}

const STEP_DEG: f64 = 1.0;
/// Directions on both sides of the middle that the centroid is taken over.
const NEIGHBOURS: isize = 6;
/// Most moves of the window.
const MOVES: usize = 8;

impl HoughVote {
    /// A vote in spectra with the layout of `bins`, of pictures whose longer side is `side` pixels, over `directions`. Lines are four DFT bins wide: wide enough to hold the central ridge of usual blurs.
    pub(super) fn new(bins: &SpectrumBins, side: usize, directions: Directions) -> Self {
        let step = 4.0 / side as f64;
        let mut profile = Profile::new(step, bins.band.max);
        let all = (0..directions.count())
            .map(|i| {
                project(bins, (i as f64 * STEP_DEG).to_radians(), &mut profile);
                profile.weight.clone()
            })
            .collect();
        Self { hough: Hough::new(bins), all, votes: Votes::new(step, bins.band.max), responses: Vec::new(), directions }
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
        // Near the peak the votes are a plateau as wide as the ridge; its middle is found by moving a window of
        // directions to the centroid of what is in it until it stays.
        let mut middle = (peak.deg / STEP_DEG).round() as isize;
        for _ in 0..MOVES {
            let (mut moment, mut total) = (0.0, 0.0);
            for offset in -NEIGHBOURS..=NEIGHBOURS {
                let excess = (self.responses[self.directions.fold(middle + offset)] - 0.5 * peak.height).max(0.0);
                moment += excess * offset as f64;
                total += excess;
            }
            if total <= 0.0 {
                break;
            }
            let centroid = moment / total;
            peak.deg = STEP_DEG * (middle as f64 + centroid);
            if centroid.abs() <= 0.5 {
                break;
            }
            middle += centroid.round() as isize;
        }
        Some(peak)
    }

    /// The significance of the direction `deg`; lines hold as many bins as those of the nearest direction of the grid.
    pub(super) fn response_near(&mut self, bins: &SpectrumBins, deg: f64) -> f64 {
        self.hough.set(bins);
        let at = self.directions.fold((deg / STEP_DEG).round() as isize);
        self.votes.all.copy_from_slice(&self.all[at]);
        self.hough.vote(deg.to_radians(), &mut self.votes);
        self.hough.significance(&self.votes)
    }
}

#[cfg(test)]
mod tests {
    use super::Directions;

    #[test]
    fn directions_beyond_the_ends_are_folded_back() {
        assert_eq!([-3, 0, 90, 93].map(|i| Directions::Quadrant.fold(i)), [3, 0, 90, 87]);
        assert_eq!([-3, 0, 179, 183].map(|i| Directions::All.fold(i)), [177, 0, 179, 3]);
    }
}
