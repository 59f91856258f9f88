//! The likelihood around a result, and what the model expects of every bin: for looking at a fit, not for making it.

use super::{Candidate, Effort, FINAL, View};
use crate::estimate::joint::whittle::fit::Maximum;
use crate::estimate::joint::whittle::point::Kernel;
use crate::spectrum::{PowerBin, PowerSpectrum};

/// The parameters besides length and angle follow from a neighbour where they were best: a few steps are enough.
const FOLLOW: Effort = Effort { steps: 6, least_gain: 0.02, informs: true };

impl View {
    /// Fits everything anew from a length and an angle up to `most_frequency`; the best point is the first one.
    pub(in crate::estimate::joint::whittle) fn refit(
        &mut self,
        kernel: Kernel,
        (length, angle): (f64, f64),
        most_frequency: f64,
    ) -> Maximum {
        self.start_fit(Candidate { angle, length, gain: 0.0 }, most_frequency);
        self.points.swap(0, 1);
        self.settle();
        let point = &mut self.points[0];
        self.fit.learn_roughness(point);
        self.fit.maximise(&self.cells, kernel, point, FINAL)
    }

    /// Length in pixels and angle in radians of the best point.
    pub(in crate::estimate::joint::whittle) fn best(&self) -> (f64, f64) {
        (self.points[0].length, self.points[0].angle)
    }

    /// Factor of the stated standard deviations over those of the likelihood up to `most_frequency`.
    pub(in crate::estimate::joint::whittle) fn widening(&self, most_frequency: f64) -> f64 {
        super::widening(&self.points[0], most_frequency)
    }

    /// Negative log-likelihood at each length and angle, all other parameters but the acceleration at their best there:
    /// `angles.len()` rows. Both lists hold the result in their middle, from where the parameters are followed outwards.
    pub(in crate::estimate::joint::whittle) fn profile(
        &mut self,
        kernel: Kernel,
        lengths: &[f64],
        angles: &[f64],
    ) -> Vec<f64> {
        let mut losses = vec![f64::NAN; angles.len() * lengths.len()];
        let mut point = self.points[0].clone();
        // One length after the other: the response is tabulated once for each.
        for columns in both_ways(lengths.len()) {
            point.copy(&self.points[0]);
            for column in columns {
                let mut start = point.clone();
                for rows in both_ways(angles.len()) {
                    point.copy(&start);
                    for row in rows {
                        (point.length, point.angle) = (lengths[column], angles[row]);
                        losses[row * lengths.len() + column] =
                            self.fit.profile(&self.cells, kernel, &mut point, FOLLOW).loss;
                        if row == angles.len() / 2 {
                            start.copy(&point);
                        }
                    }
                }
                point.copy(&start);
            }
        }
        losses
    }

    /// Powers on the whole plane of frequencies that do not depend on each other.
    pub(in crate::estimate::joint::whittle) fn independent_powers(&self) -> f64 {
        let (rows, columns) = self.periodogram.dim();
        rows as f64 * columns as f64 * self.periodogram.independence()
    }

    /// The powers, and what the model at the best point expects of each: from the scene, and from the noise.
    pub(in crate::estimate::joint::whittle) fn expectation(
        &mut self,
        kernel: Kernel,
        most_frequency: f64,
    ) -> (PowerSpectrum, Vec<(f64, f64)>) {
        // The response of single bins, not of the cells that the fit was made with.
        self.gather(self.points[0].angle, 1, most_frequency);
        let point = &self.points[0];
        self.fit.tabulate(kernel, point);
        let frequencies = self.periodogram.u.iter().zip(&self.periodogram.v);
        let bins: Vec<PowerBin> =
            frequencies.zip(self.periodogram.powers()).map(|((&u, &v), power)| PowerBin { u, v, power }).collect();
        let expected = bins
            .iter()
            .map(|bin| {
                let (scene, noise) = self.fit.expected(kernel, point, f64::from(bin.u), f64::from(bin.v));
                let whitening = PowerSpectrum::whitening(bin.u, bin.v);
                (scene / whitening, noise / whitening)
            })
            .collect();
        (PowerSpectrum::from_bins(bins), expected)
    }
}

/// The indices of a list from its middle to its end, then from before its middle to its start.
fn both_ways(length: usize) -> [Vec<usize>; 2] {
    [(length / 2..length).collect(), (0..length / 2).rev().collect()]
}
