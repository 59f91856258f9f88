//! The measurement of one part of a picture under one window.

use std::f64::consts::{FRAC_PI_2, PI};

use ndarray::ArrayView2;

use super::fit::{Cells, Covariance, Fit, Kernel, Point};
use super::periodogram::{CellSums, MOST_FREQUENCY, Periodogram};
use super::search::{self, Band, Candidate};
use crate::estimate::LengthRange;
use crate::image::Window;

/// The widest band searched, in cycles per pixel; each further one is half as wide ...
const WIDEST_BAND: f64 = 0.45;
/// ... as long as its radius has this many bins.
const LEAST_BAND_BINS: f64 = 25.0;
/// Modes that are fitted, at most.
const MODES: usize = 6;
/// A mode with fewer votes, relative to the first, is not fitted.
const LEAST_VOTES: f64 = 0.3;
/// A band has found a length when it knows `ln L` to this standard deviation.
const SHARP: f64 = 0.1;
/// Two candidates are one mode within this angle (radians) and ratio of lengths (logarithm).
const SAME_ANGLE: f64 = 0.105;
const SAME_LOG_LENGTH: f64 = 0.13;
/// Steps of a first fit, of the fit without blur, of a defocused one and of a fit that only follows up.
const FIRST_STEPS: usize = 10;
const SHARP_STEPS: usize = 6;
const DISK_STEPS: usize = 5;
const FOLLOW_STEPS: usize = 6;
/// Diameters of a disk to start from, relative to the line's length.
const DISKS: [f64; 3] = [0.8, 1.0, 1.2];
/// Evidence is a gain per bin of signal; this many more count, so that few bins do not decide by chance.
const SPARE_BINS: f64 = 200.0;
/// A wider band agrees when it moves the result by less than this many standard deviations ...
const AGREEMENT: f64 = 5.0;
/// ... makes the length at most this much less certain in variance ...
const MOST_LOSS: f64 = 1.2;
/// ... and lets the incoherent share grow by at most this in its logarithm, or to no more than this.
const SHARE_GROWTH: f64 = 0.7;
const COHERENT: f64 = -4.0;
/// How much the scatter of the scene's spectrum over patches widens the uncertainty: what is seen between patches is
/// there within them too. Learnt on design pictures; the coverage is tested on others.
const ROUGHNESS_WEIGHT: f64 = 2.0;

/// What the likelihood says of a part of a picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Outcome {
    /// Pixels.
    pub(super) length: f64,
    /// Radians.
    pub(super) angle: f64,
    /// Covariance of `ln L`, the angle and `r^2`, the roughness of the scene counted in.
    pub(super) covariance: Covariance,
    /// Highest frequency used, cycles per pixel.
    pub(super) band: f64,
    /// Gain in log-likelihood over no blur in the band where the mode was found.
    pub(super) gain: f64,
    /// That gain per bin of signal.
    pub(super) density: f64,
    /// The same of the best other mode, relative to it.
    pub(super) rival: f64,
    /// Gain over the best defocused disk.
    pub(super) over_disk: f64,
    /// Logarithm of the share of light that the kernel does not explain.
    pub(super) log_share: f64,
    /// Mean square over squared mean of the powers within a cell, relative to a smooth spectrum.
    pub(super) peaks: f64,
    /// Mean squared standardised residual.
    pub(super) misfit: f64,
}

/// Plans and buffers for pictures of one size under one window.
#[derive(Debug)]
pub(super) struct View {
    periodogram: Periodogram,
    sums: CellSums,
    cells: Cells,
    fit: Fit,
    bands: Vec<Band>,
    powers: Vec<f32>,
    logs: Vec<f32>,
    modes: Vec<Mode>,
    /// The best point, a trial and an alternative.
    points: [Point; 3],
    noise: f64,
}

/// A direction and length that bands agree upon.
#[derive(Debug, Clone, Copy)]
struct Mode {
    at: Candidate,
    /// Gains in all bands, each relative to the band's best.
    votes: f64,
    /// Lowest and widest band, by index, that found it.
    lowest: usize,
    widest: usize,
}

impl View {
    /// For pictures of this size; blurs are searched in `range`, those beyond are only refined.
    pub(super) fn new((rows, columns): (usize, usize), window: Window, range: LengthRange) -> Self {
        let periodogram = Periodogram::new(rows, columns, window);
        let mut bands = Vec::new();
        let mut most_frequency = WIDEST_BAND;
        while bands.is_empty() || most_frequency * rows.min(columns) as f64 > LEAST_BAND_BINS {
            match Band::new(&periodogram, most_frequency, range) {
                Some(band) => bands.push(band),
                None if most_frequency * (rows.min(columns) as f64) < 1.0 => break,
                None => {}
            }
            most_frequency *= 0.5;
        }
        let side = rows.max(columns);
        let sums = CellSums::new(side);
        Self {
            cells: Cells::new(sums.capacity()),
            fit: Fit::new(side),
            powers: vec![0.0; periodogram.len()],
            logs: vec![0.0; periodogram.len()],
            modes: Vec::with_capacity(bands.len() * search::CANDIDATES),
            points: std::array::from_fn(|_| Point::new()),
            noise: 0.0,
            sums,
            bands,
            periodogram,
        }
    }

    /// The picture to measure, of the view's size.
    pub(super) fn set(&mut self, image: ArrayView2<'_, f32>) {
        self.periodogram.set(image);
        self.noise = self.periodogram.noise();
    }

    /// Searches everywhere and fits; `None` when no band sees a pattern.
    pub(super) fn measure(&mut self) -> Option<Outcome> {
        self.search();
        let (mut outcome, start) = self.choose()?;
        self.compare_disk(&mut outcome, start);
        self.widen(&mut outcome, start)?;
        Some(outcome)
    }

    /// Fits from a result that another view has found; `None` when the likelihood is flat there.
    pub(super) fn refine(&mut self, from: &Outcome) -> Option<Outcome> {
        self.start_fit(Candidate { angle: from.angle, length: from.length, gain: 0.0 }, MOST_FREQUENCY);
        self.points.swap(0, 1);
        self.settle(0);
        let mut outcome = *from;
        self.record(&mut outcome, MOST_FREQUENCY)?;
        Some(outcome)
    }

    /// `|r|^2` and its standard deviation from the fit of the accelerated blur at the last result.
    pub(super) fn acceleration(&mut self, outcome: &Outcome) -> Option<(f64, f64)> {
        self.gather(self.points[0].angle, outcome.band);
        let [best, trial, _] = &mut self.points;
        trial.copy(best);
        self.fit.maximise(&self.cells, Kernel::AcceleratedLine, trial, FIRST_STEPS);
        let covariance = self.fit.covariance()?;
        Some((trial.ratio2, widening(trial, outcome.band) * covariance[2][2].sqrt()))
    }

    /// Lets every band search and joins what they find into modes, the one with most votes first.
    fn search(&mut self) {
        search::log_powers(&self.periodogram, self.noise as f32, &mut self.powers, &mut self.logs);
        for band in &mut self.bands {
            band.search(&self.powers, &self.logs, self.noise as f32);
        }
        self.modes.clear();
        for (pivot, band) in self.bands.iter().enumerate() {
            for &at in &band.found {
                let mut mode = Mode { at, votes: 0.0, lowest: pivot, widest: pivot };
                for (index, other) in self.bands.iter().enumerate().filter(|(_, other)| other.covers(at.length)) {
                    let member = other.found.iter().find(|candidate| same(candidate, &at));
                    if let (Some(member), Some(best)) = (member, other.found.first()) {
                        mode.votes += member.gain / best.gain;
                        mode.lowest = mode.lowest.max(index);
                        mode.widest = mode.widest.min(index);
                    }
                }
                self.modes.push(mode);
            }
        }
        self.modes.sort_unstable_by(|a, b| b.votes.total_cmp(&a.votes).then(b.at.gain.total_cmp(&a.at.gain)));
        let mut kept = 0;
        for i in 0..self.modes.len() {
            let mode = self.modes[i];
            let enough = mode.votes >= LEAST_VOTES * self.modes[0].votes;
            if kept < MODES && enough && !self.modes[..kept].iter().any(|other| same(&other.at, &mode.at)) {
                self.modes[kept] = mode;
                kept += 1;
            }
        }
        self.modes.truncate(kept);
    }

    /// Fits every mode in the lowest band that knows its length, and takes the one with most evidence for a bin of
    /// signal. The winner's point is the first one; its band is returned.
    fn choose(&mut self) -> Option<(Outcome, usize)> {
        let mut winner: Option<(Outcome, usize)> = None;
        let mut rival = 0.0_f64;
        for i in 0..self.modes.len() {
            let Mode { at, lowest, widest, .. } = self.modes[i];
            let mut band = lowest;
            let (line, covariance) = loop {
                let line = self.start_fit(at, self.bands[band].most_frequency);
                let covariance = self.fit.covariance().filter(|covariance| covariance[0][0] < SHARP * SHARP);
                if covariance.is_some() && self.bands[band].covers(self.points[1].length) {
                    break (line, covariance);
                }
                if band == widest {
                    break (line, None);
                }
                band -= 1;
            };
            let Some(covariance) = covariance else { continue };
            let [_, found, other] = &mut self.points;
            other.copy(found);
            self.fit.start_scene(&self.cells, Kernel::None, other);
            let none = self.fit.maximise(&self.cells, Kernel::None, other, SHARP_STEPS);
            let gain = none.loss - line.loss;
            let outcome = Outcome {
                length: found.length,
                angle: found.angle,
                covariance,
                band: self.bands[band].most_frequency,
                gain,
                density: gain / (line.signal + SPARE_BINS),
                rival: 0.0,
                over_disk: f64::INFINITY,
                log_share: found.log_share,
                peaks: 1.0,
                misfit: line.misfit,
            };
            match &winner {
                Some((best, _)) if best.density >= outcome.density => {
                    if !same(&best.candidate(), &outcome.candidate()) {
                        rival = rival.max(outcome.density);
                    }
                }
                _ => {
                    if let Some((best, _)) = winner.filter(|(best, _)| !same(&best.candidate(), &outcome.candidate())) {
                        rival = rival.max(best.density);
                    }
                    winner = Some((outcome, band));
                    self.points.swap(0, 1);
                }
            }
        }
        let (outcome, band) = winner?;
        Some((Outcome { rival: rival / outcome.density.max(f64::MIN_POSITIVE), ..outcome }, band))
    }

    /// Holds the line against disks in the band where it was found.
    fn compare_disk(&mut self, outcome: &mut Outcome, band: usize) {
        self.gather(outcome.angle, self.bands[band].most_frequency);
        let line = self.settle(0);
        for diameter in DISKS {
            let [best, trial, _] = &mut self.points;
            trial.copy(best);
            trial.length *= diameter;
            self.fit.start_scene(&self.cells, Kernel::Disk, trial);
            let disk = self.fit.maximise(&self.cells, Kernel::Disk, trial, DISK_STEPS);
            outcome.over_disk = outcome.over_disk.min(disk.loss - line);
        }
    }

    /// Takes wider and wider bands in, as long as they agree with the narrower one.
    fn widen(&mut self, outcome: &mut Outcome, start: usize) -> Option<()> {
        self.gather(self.points[0].angle, self.bands[start].most_frequency);
        self.settle(0);
        self.record(outcome, self.bands[start].most_frequency)?;
        let wider = (0..start).rev().map(|band| self.bands[band].most_frequency);
        // On the stack: the bands cannot be borrowed while the view works.
        let mut limits = [MOST_FREQUENCY; 16];
        let count = wider.zip(&mut limits).map(|(frequency, limit)| *limit = frequency).count() + 1;
        for &limit in &limits[..count] {
            let angle = self.points[0].angle;
            self.gather(angle, limit);
            let [best, trial, _] = &mut self.points;
            trial.copy(best);
            self.settle(1);
            let mut wide = *outcome;
            self.points.swap(0, 1);
            let agreed = self.record(&mut wide, limit).is_some() && agrees(outcome, &wide);
            if !agreed {
                self.points.swap(0, 1);
                break;
            }
            *outcome = wide;
        }
        Some(())
    }

    /// Gathers the cells along `angle` up to `most_frequency`.
    fn gather(&mut self, angle: f64, most_frequency: f64) {
        self.periodogram.gather(angle, most_frequency, &mut self.sums);
        self.cells.set(&self.sums, self.periodogram.independence, self.noise as f32);
        self.fit.set_direction(&self.periodogram, angle);
    }

    /// A first fit of the second point.
    fn start_fit(&mut self, at: Candidate, most_frequency: f64) -> super::fit::Maximum {
        self.gather(at.angle, most_frequency);
        let point = &mut self.points[1];
        point.start(at.length, at.angle, self.noise);
        self.fit.start_scene(&self.cells, Kernel::Line, point);
        self.fit.maximise(&self.cells, Kernel::Line, point, FIRST_STEPS)
    }

    /// Follows a fit up to where the roughness of the scene is learnt; returns the negative log-likelihood.
    fn settle(&mut self, which: usize) -> f64 {
        let point = &mut self.points[which];
        self.fit.maximise(&self.cells, Kernel::Line, point, FOLLOW_STEPS);
        self.fit.learn_roughness(point);
        self.fit.maximise(&self.cells, Kernel::Line, point, FOLLOW_STEPS).loss
    }

    /// Writes the last fit, that of the first point, into `outcome`.
    fn record(&self, outcome: &mut Outcome, band: f64) -> Option<()> {
        let point = &self.points[0];
        let scale = widening(point, band).powi(2);
        outcome.covariance = self.fit.covariance()?.map(|row| row.map(|value| value * scale));
        (outcome.length, outcome.angle, outcome.band) = (point.length, point.angle, band);
        (outcome.log_share, outcome.peaks) = (point.log_share, self.cells.peaks());
        outcome.misfit = self.fit.maximum().misfit;
        Some(())
    }
}

impl Outcome {
    fn candidate(&self) -> Candidate {
        Candidate { angle: self.angle, length: self.length, gain: self.density }
    }
}

/// Factor on standard deviations for the roughness of the scene.
fn widening(point: &Point, band: f64) -> f64 {
    1.0 + ROUGHNESS_WEIGHT * point.roughness_within(band)
}

/// Whether the result of a wider band goes with that of a narrower one.
fn agrees(narrow: &Outcome, wide: &Outcome) -> bool {
    let within = |shift: f64, i: usize| {
        shift * shift <= AGREEMENT * AGREEMENT * (narrow.covariance[i][i] + wide.covariance[i][i])
    };
    within((wide.length / narrow.length).ln(), 0)
        && within(wide.angle - narrow.angle, 1)
        && wide.log_share <= (narrow.log_share + SHARE_GROWTH).max(COHERENT)
        && wide.covariance[0][0] <= MOST_LOSS * narrow.covariance[0][0]
}

/// Whether two candidates are one mode of the likelihood.
fn same(a: &Candidate, b: &Candidate) -> bool {
    let turn = (a.angle - b.angle + FRAC_PI_2).rem_euclid(PI) - FRAC_PI_2;
    turn.abs() < SAME_ANGLE && (a.length / b.length).ln().abs() < SAME_LOG_LENGTH
}
