//! Hough transform of a binarised spectrum.

use crate::spectrum::SpectrumBins;

/// The brightest bins of a spectrum, ready to vote for lines.
#[derive(Debug, Clone)]
pub struct Hough {
    u: Vec<f32>,
    v: Vec<f32>,
    sorted: Vec<f32>,
    share: f64,
}

/// Votes for one direction.
#[derive(Debug, Clone)]
pub struct Votes {
    /// Bright bins on each line.
    pub bright: Vec<f32>,
    /// All bins on each line.
    pub all: Vec<f32>,
    step: f64,
}

impl Votes {
    /// No votes yet, for lines `step` cycles per pixel apart, up to the frequency `most`.
    pub fn new(step: f64, most: f64) -> Self {
        let lines = ((most / step).ceil() as usize).max(1) + 1;
        Self { bright: vec![0.0; lines], all: vec![0.0; lines], step }
    }
}

/// Share of the bins that are bright: the thesis binarises at 0.9.
const BRIGHT_SHARE: f64 = 0.1;

impl Hough {
    /// For spectra with as many bins as `bins`.
    pub fn new(bins: &SpectrumBins) -> Self {
        let capacity = bins.len();
        Self {
            u: Vec::with_capacity(capacity),
            v: Vec::with_capacity(capacity),
            sorted: Vec::with_capacity(capacity),
            share: 0.0,
        }
    }

    /// Binarises `bins`: bright are those above the 0.9 quantile of the values.
    pub fn set(&mut self, bins: &SpectrumBins) {
        self.u.clear();
        self.v.clear();
        self.sorted.clear();
        self.sorted.extend_from_slice(&bins.values);
        if self.sorted.is_empty() {
            return;
        }
        let at = ((self.sorted.len() - 1) as f64 * (1.0 - BRIGHT_SHARE)) as usize;
        let (_, &mut threshold, _) = self.sorted.select_nth_unstable_by(at, f32::total_cmp);
        bins.for_each(|u, v, value| {
            if value > threshold {
                self.u.push(u);
                self.v.push(v);
            }
        });
        self.share = self.u.len() as f64 / bins.len() as f64;
    }

    /// The bright bins on the lines `|u cos(angle) - v sin(angle)| = const`.
    pub fn vote(&self, angle_rad: f64, votes: &mut Votes) {
        votes.bright.fill(0.0);
        let (sin, cos) = ((angle_rad.sin() / votes.step) as f32, (angle_rad.cos() / votes.step) as f32);
        let last = votes.bright.len() - 1;
        for (u, v) in self.u.iter().zip(&self.v) {
            votes.bright[((u * cos - v * sin).abs() as usize).min(last)] += 1.0;
        }
    }

    /// How far the line with the most surprising number of votes stands above chance, in standard deviations of the
    /// binomial distribution. Unlike the bare count it does not favour directions in which lines are long.
    pub fn significance(&self, votes: &Votes) -> f64 {
        let p = self.share;
        (votes.bright.iter().zip(&votes.all))
            .map(|(&bright, &all)| {
                let (bright, all) = (f64::from(bright), f64::from(all));
                let variance = all * p * (1.0 - p);
                // Short lines at the rim hold a handful of bins, where the normal approximation fails.
                if variance > 1.0 { (bright - all * p) / variance.sqrt() } else { 0.0 }
            })
            .fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::projection::{Profile, project};
    use crate::spectrum::Levelled;

    #[test]
    fn a_bright_line_wins_the_vote_at_its_angle() {
        let mut bins = Levelled::for_dft(200, 160).bins().clone();
        let angle = 64.0_f64.to_radians();
        let (sin, cos) = (angle.sin() as f32, angle.cos() as f32);
        bins.update(|u, v, _| {
            let scramble = ((u * 9973.0 + v * 7919.0).sin() * 43_758.55).fract().abs();
            if (u * cos - v * sin).abs() < 0.02 { 2.0 + scramble } else { scramble }
        });
        let mut hough = Hough::new(&bins);
        hough.set(&bins);
        let mut votes = Votes::new(0.02, 0.4);
        let mut counts = Profile::new(0.02, 0.4);
        let mut significance = |deg: f64| {
            project(&bins, deg.to_radians(), &mut counts);
            votes.all.copy_from_slice(&counts.weight);
            hough.vote(deg.to_radians(), &mut votes);
            hough.significance(&votes)
        };
        let best = (0..180).max_by(|&a, &b| significance(f64::from(a)).total_cmp(&significance(f64::from(b))));
        assert_eq!(best, Some(64));
        assert!(significance(64.0) > 20.0 && significance(154.0) < 8.0);
    }

    #[test]
    fn a_tenth_of_the_bins_is_bright() {
        let mut bins = Levelled::for_dct(64, 64).bins().clone();
        let mut i = 0.0;
        bins.update(|_, _, _| {
            i += 1.0;
            i
        });
        let mut hough = Hough::new(&bins);
        hough.set(&bins);
        assert!((hough.share - 0.1).abs() < 0.002);
    }
}
