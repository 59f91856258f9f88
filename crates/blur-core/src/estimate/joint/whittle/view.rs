//! The measurement of one part of a picture under one window.

mod survey;

use std::f64::consts::{FRAC_PI_2, PI};

use ndarray::ArrayView2;

use super::Stage;
use super::cells::Cells;
use super::fit::{Covariance, Effort, Fit, Maximum};
use super::periodogram::{CellSums, MOST_FREQUENCY, Periodogram};
use super::point::{Kernel, Point};
use super::search::{self, Band, Candidate};
use super::verdict;
use crate::each::each;
use crate::estimate::LengthRange;
use crate::image::Window;

/// The widest band searched, in cycles per pixel; each further one is half as wide ...
const WIDEST_BAND: f64 = 0.45;
/// ... as long as its radius has this many bins.
const LEAST_BAND_BINS: f64 = 25.0;
/// Modes that are fitted, at most.
const MODES: usize = 5;
/// A mode with fewer votes, relative to the first, is not fitted.
const LEAST_VOTES: f64 = 0.4;
/// When this many bands agree upon a mode, and it turns out coherent with this much evidence for a bin, only modes with
/// nearly as many votes are fitted besides.
const AGREED: f64 = 1.9;
const CLEAR: f64 = 0.05;
const CLOSE_VOTES: f64 = 0.7;
/// A band has found a length when it knows `ln L` to this standard deviation.
const SHARP: f64 = 0.1;
/// Two candidates are one mode within this angle (radians) and ratio of lengths (logarithm).
const SAME_ANGLE: f64 = 0.105;
pub(super) const SAME_LOG_LENGTH: f64 = 0.13;
/// Cells from one dark line to the next that a first fit needs.
const CELLS_PER_LINE: f64 = 14.0;
/// Dark lines that a first fit sees.
const FIRST_LINES: f64 = 5.0;
/// A first fit, the fit without blur and those with a disk that it is held against, and the fit that is reported.
const FIRST: Effort = Effort { steps: 8, least_gain: 0.5, informs: true };
const ALTERNATIVE: Effort = Effort { steps: 4, least_gain: 0.5, informs: false };
const DISK: Effort = Effort { steps: 10, least_gain: 0.5, informs: false };
const FINAL: Effort = Effort { steps: 20, least_gain: 1e-3, informs: true };
/// Diameters of a disk to start from, relative to the line's length.
const DISKS: [f64; 3] = [0.6, 0.87, 1.08];
/// Evidence is a gain per bin of signal; this many more count, so that few bins do not decide by chance.
const SPARE_BINS: f64 = 200.0;
/// A wider band, or a larger part of the picture, agrees when it moves the result by less than this many standard
/// deviations; the band besides when it ...
const AGREEMENT: f64 = 5.0;
/// ... makes the length at most this much less certain in variance ...
const MOST_LOSS: f64 = 1.2;
/// ... and lets the logarithm of the incoherent share grow by at most this, or to no more than the second.
const SHARE_GROWTH: f64 = 0.7;
const COHERENT: f64 = -4.0;
/// Precision of an angle that is known: a millionth of a radian.
const KNOWN: f64 = 1e12;
/// Lead in log-likelihood over any other length that leaves no rival.
const CLEAR_LEAD: f64 = 18.0;
/// Logarithmic step of the lengths from which fits along a known angle start.
const LENGTH_STEP: f64 = 0.06;

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
    /// The band, by index, that found the mode.
    pub(super) start: usize,
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

/// What the likelihood says of a part of a picture when the motion may accelerate.
#[derive(Debug, Clone, Copy)]
pub(super) struct Accelerated {
    /// Pixels.
    pub(super) length: f64,
    /// Radians.
    pub(super) angle: f64,
    /// The squared ratio, 0 to 1.
    pub(super) ratio2: f64,
    /// Covariance of `ln L`, the angle and `r^2`, the roughness of the scene counted in.
    pub(super) covariance: Covariance,
    /// Standard deviation of `r^2` if the motion were uniform.
    pub(super) uniform_std: f64,
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
        Self::of(Periodogram::new(rows, columns, window), range)
    }

    /// For pictures that such a `periodogram` is made of; blurs are searched in `range`.
    pub(super) fn of(periodogram: Periodogram, range: LengthRange) -> Self {
        let (rows, columns) = periodogram.dim();
        let side = rows.min(columns) as f64;
        let halves = || std::iter::successors(Some(WIDEST_BAND), |most_frequency| Some(0.5 * most_frequency));
        let has_room = |most_frequency: &f64| most_frequency * side > LEAST_BAND_BINS;
        let band = |&most_frequency: &f64| Band::new(&periodogram, most_frequency, range);
        let mut bands: Vec<Band> =
            each(&halves().take_while(has_room).collect::<Vec<_>>(), band).into_iter().flatten().collect();
        if bands.is_empty() {
            // Long blurs of a small picture are seen below that only.
            let narrow = halves().skip_while(has_room).take_while(|most_frequency| most_frequency * side >= 1.0);
            bands.extend(narrow.map(|most_frequency| band(&most_frequency)).find_map(|band| band));
        }
        Self { modes: Vec::with_capacity(bands.len() * search::CANDIDATES), bands, ..Self::fit_only(periodogram) }
    }

    /// Without the bands of a search: for motions along a known angle.
    pub(super) fn fit_only(periodogram: Periodogram) -> Self {
        let (rows, columns) = periodogram.dim();
        let sums = CellSums::new(rows.max(columns));
        Self {
            cells: Cells::new(sums.capacity()),
            fit: Fit::new(&periodogram),
            powers: vec![0.0; periodogram.len()],
            logs: vec![0.0; periodogram.len()],
            modes: Vec::new(),
            points: std::array::from_fn(|_| Point::new()),
            noise: 0.0,
            sums,
            bands: Vec::new(),
            periodogram,
        }
    }

    /// The picture to measure, of the view's size.
    pub(super) fn set(&mut self, image: ArrayView2<'_, f32>) {
        self.periodogram.set(image);
        self.noise = self.periodogram.noise();
    }

    /// The picture to measure under weights of its size, for views of weighted pictures.
    pub(super) fn set_weighted(&mut self, image: ArrayView2<'_, f32>, weights: ArrayView2<'_, f32>) {
        self.periodogram.set_weighted(image, weights);
        self.noise = self.periodogram.noise();
    }

    /// Searches everywhere and fits; `None` when no band sees a pattern. `done` is told of every stage that ends.
    pub(super) fn measure(&mut self, done: &mut dyn FnMut(Stage)) -> Option<Outcome> {
        self.search();
        done(Stage::Search);
        let mut outcome = self.choose()?;
        done(Stage::Choice);
        self.settle_at(&mut outcome)?;
        self.compare_disk(&mut outcome);
        done(Stage::Defocus);
        // What is no blur is not looked at more closely.
        if !verdict::is_denied(&outcome) {
            self.widen(&mut outcome);
        }
        done(Stage::Fit);
        Some(outcome)
    }

    /// As [`measure`](Self::measure) from the outcome of the frame before, without search and disks, whose shares of the
    /// evidence it keeps; `None` when the blur has left that mode.
    pub(super) fn follow(&mut self, last: &Outcome) -> Option<Outcome> {
        let at = last.candidate();
        let found = self.first_fit(at, last.start, last.start).filter(|found| same(&at, &found.candidate()))?;
        self.points.swap(0, 1);
        let mut outcome = Outcome { rival: last.rival, over_disk: last.over_disk, ..found };
        self.settle_at(&mut outcome)?;
        self.widen(&mut outcome);
        Some(outcome)
    }

    /// Fits from a result that another view has found; `None` when the likelihood is flat there.
    pub(super) fn refine(&mut self, from: &Outcome) -> Option<Outcome> {
        self.start_fit(Candidate { angle: from.angle, length: from.length, gain: 0.0 }, MOST_FREQUENCY);
        self.points.swap(0, 1);
        self.settle();
        let mut outcome = *from;
        self.record(&mut outcome, MOST_FREQUENCY)?;
        Some(outcome)
    }

    /// The fit of the accelerated blur, from the result of a view of the same part of the picture; `None` when the
    /// likelihood is flat there.
    pub(super) fn acceleration(&mut self, from: &Outcome) -> Option<Accelerated> {
        self.start_fit(Candidate { angle: from.angle, length: from.length, gain: 0.0 }, from.band);
        self.points.swap(0, 1);
        self.settle();
        let [best, trial, _] = &mut self.points;
        trial.copy(best);
        let scale = widening(trial, from.band);
        self.fit.maximise(&self.cells, Kernel::AcceleratedLine, trial, Effort { steps: 0, ..FINAL });
        let uniform_std = scale * self.fit.covariance()?[2][2].sqrt();
        self.fit.maximise(&self.cells, Kernel::AcceleratedLine, trial, FINAL);
        let covariance = self.fit.covariance()?.map(|row| row.map(|value| value * scale * scale));
        Some(Accelerated { length: trial.length, angle: trial.angle, ratio2: trial.ratio2, covariance, uniform_std })
    }

    /// As [`measure`](Self::measure) along a known angle (radians), and exhaustively: fits from every length of `range`, in
    /// a few dark lines first and then in the whole spectrum. The most likely one wins.
    pub(super) fn measure_along(&mut self, angle: f64, range: LengthRange) -> Option<Outcome> {
        for point in &mut self.points {
            point.angle_precision = KNOWN;
        }
        let (mut best, mut rival) = (None::<(Candidate, Maximum)>, f64::INFINITY);
        let steps = ((range.max_px() / range.min_px()).ln() / LENGTH_STEP).ceil() as usize;
        for step in 0..=steps {
            let length = (range.min_px() * (LENGTH_STEP * step as f64).exp()).min(range.max_px());
            self.start_fit(Candidate { angle, length, gain: 0.0 }, (FIRST_LINES / length).min(MOST_FREQUENCY));
            self.gather(angle, 1, MOST_FREQUENCY);
            let line = self.fit.maximise(&self.cells, Kernel::Line, &mut self.points[1], FIRST);
            let found = Candidate { angle, length: self.points[1].length, gain: -line.loss };
            match &best {
                Some((other, _)) if other.gain >= found.gain => {
                    if !same(other, &found) {
                        rival = rival.min(line.loss);
                    }
                }
                _ => {
                    if let Some((_, maximum)) = best.filter(|(other, _)| !same(other, &found)) {
                        rival = rival.min(maximum.loss);
                    }
                    best = Some((found, line));
                    self.points.swap(0, 1);
                }
            }
        }
        let (found, line) = best?;
        self.gather(angle, 1, MOST_FREQUENCY);
        let [first, _, other] = &mut self.points;
        other.copy(first);
        self.fit.start_scene(&self.cells, Kernel::None, other);
        let none = self.fit.maximise(&self.cells, Kernel::None, other, ALTERNATIVE);
        let gain = none.loss - line.loss;
        let mut outcome = Outcome {
            length: found.length,
            angle,
            covariance: Covariance::default(),
            band: MOST_FREQUENCY,
            start: 0,
            gain,
            density: gain / (line.signal + SPARE_BINS),
            // In the whole spectrum even a sixth of the dark lines gains much: what counts is the lead.
            rival: if rival - line.loss < CLEAR_LEAD { ((none.loss - rival) / gain).max(0.0) } else { 0.0 },
            over_disk: f64::INFINITY,
            log_share: 0.0,
            peaks: 1.0,
            misfit: line.misfit,
        };
        self.settle();
        self.compare_disk(&mut outcome);
        self.settle();
        self.record(&mut outcome, MOST_FREQUENCY)?;
        Some(outcome)
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
    /// signal. The winner's point is the first one.
    fn choose(&mut self) -> Option<Outcome> {
        let mut winner: Option<Outcome> = None;
        let mut rival = 0.0_f64;
        for i in 0..self.modes.len() {
            let Mode { at, votes, lowest, widest } = self.modes[i];
            let settled = winner.as_ref().is_some_and(|best| self.modes[0].votes > AGREED && best.is_coherent());
            if settled && votes < CLOSE_VOTES * self.modes[0].votes {
                break;
            }
            let Some(outcome) = self.first_fit(at, lowest, widest) else { continue };
            match &winner {
                Some(best) if best.density >= outcome.density => {
                    if !same(&best.candidate(), &outcome.candidate()) {
                        rival = rival.max(outcome.density);
                    }
                }
                _ => {
                    if let Some(best) = winner.filter(|best| !same(&best.candidate(), &outcome.candidate())) {
                        rival = rival.max(best.density);
                    }
                    winner = Some(outcome);
                    self.points.swap(0, 1);
                }
            }
        }
        let outcome = winner?;
        Some(Outcome { rival: rival / outcome.density.max(f64::MIN_POSITIVE), ..outcome })
    }

    /// Fits the second point to a mode in the lowest band, from `lowest` to `widest`, that knows its length; `None`
    /// when no band does.
    fn first_fit(&mut self, at: Candidate, lowest: usize, widest: usize) -> Option<Outcome> {
        let mut band = lowest;
        let (line, covariance, used) = loop {
            let used = self.first_band(band, at.length);
            let line = self.start_fit(at, used);
            let covariance = self.fit.covariance().filter(|covariance| covariance[0][0] < SHARP * SHARP);
            match covariance {
                Some(covariance) if self.bands[band].covers(self.points[1].length) => break (line, covariance, used),
                _ if band == widest => return None,
                _ => band -= 1,
            }
        };
        let [_, found, other] = &mut self.points;
        other.copy(found);
        self.fit.start_scene(&self.cells, Kernel::None, other);
        let none = self.fit.maximise(&self.cells, Kernel::None, other, ALTERNATIVE);
        let gain = none.loss - line.loss;
        Some(Outcome {
            length: found.length,
            angle: found.angle,
            covariance,
            band: used,
            start: band,
            gain,
            density: gain / (line.signal + SPARE_BINS),
            rival: 0.0,
            over_disk: f64::INFINITY,
            log_share: found.log_share,
            peaks: 1.0,
            misfit: line.misfit,
        })
    }

    /// Fits the mode chosen to the end in its own band.
    fn settle_at(&mut self, outcome: &mut Outcome) -> Option<()> {
        self.gather(outcome.angle, self.width_for(outcome.length), outcome.band);
        self.settle();
        self.record(outcome, outcome.band)
    }

    /// Holds the line against disks in the band where it was settled last, until one explains it as well.
    fn compare_disk(&mut self, outcome: &mut Outcome) {
        let line = self.fit.maximum().loss;
        for diameter in DISKS {
            let [best, trial, _] = &mut self.points;
            trial.copy(best);
            trial.length *= diameter;
            self.fit.start_scene(&self.cells, Kernel::Disk, trial);
            let disk = self.fit.maximise(&self.cells, Kernel::Disk, trial, DISK);
            outcome.over_disk = outcome.over_disk.min(disk.loss - line);
            if verdict::is_denied(outcome) {
                break;
            }
        }
    }

    /// Takes the whole spectrum in if it agrees with the band where the blur was found; if not, wider and wider bands as
    /// long as they do.
    fn widen(&mut self, outcome: &mut Outcome) {
        if self.widen_to(outcome, MOST_FREQUENCY) {
            return;
        }
        for band in (1..=outcome.start).rev() {
            let most_frequency = self.bands[band].most_frequency;
            if most_frequency > outcome.band && !self.widen_to(outcome, most_frequency) {
                break;
            }
        }
    }

    /// Follows `outcome` into the band up to `most_frequency`; `false`, and nothing changed, when that disagrees.
    fn widen_to(&mut self, outcome: &mut Outcome, most_frequency: f64) -> bool {
        let width = self.width_for(outcome.length);
        self.gather(self.points[0].angle, width, most_frequency);
        let [best, trial, _] = &mut self.points;
        trial.copy(best);
        self.fit.maximise(&self.cells, Kernel::Line, trial, FIRST);
        self.fit.learn_roughness(trial);
        // Cells are as wide as they are only along the motion: once more along the better direction.
        let angle = trial.angle;
        self.gather(angle, width, most_frequency);
        self.fit.maximise(&self.cells, Kernel::Line, &mut self.points[1], FINAL);
        let mut wide = *outcome;
        self.points.swap(0, 1);
        if self.record(&mut wide, most_frequency).is_some() && agrees(outcome, &wide) {
            *outcome = wide;
            return true;
        }
        self.points.swap(0, 1);
        false
    }

    /// Bins across a cell that a first fit of `length` needs: a dark line must not be lost in one.
    fn width_for(&self, length: f64) -> usize {
        let (rows, columns) = self.periodogram.dim();
        (rows.max(columns) as f64 / (CELLS_PER_LINE * length)) as usize
    }

    /// The frequencies of a first fit of `length` in a band: a few dark lines are enough to tell modes apart.
    fn first_band(&self, band: usize, length: f64) -> f64 {
        self.bands[band].most_frequency.min(FIRST_LINES / length)
    }

    /// Gathers cells of `width` bins along `angle` up to `most_frequency`.
    fn gather(&mut self, angle: f64, width: usize, most_frequency: f64) {
        self.periodogram.gather(angle, width, most_frequency, &mut self.sums);
        self.cells.set(&self.sums, self.periodogram.independence(), self.noise as f32);
        self.fit.set_direction(&self.periodogram, &self.sums, most_frequency);
    }

    /// A first fit of the second point.
    fn start_fit(&mut self, at: Candidate, most_frequency: f64) -> Maximum {
        self.gather(at.angle, self.width_for(at.length), most_frequency);
        let point = &mut self.points[1];
        point.start(at.length, at.angle, self.noise);
        self.fit.start_scene(&self.cells, Kernel::Line, point);
        self.fit.maximise(&self.cells, Kernel::Line, point, FIRST)
    }

    /// Follows the best point up to where the roughness of the scene is learnt.
    fn settle(&mut self) {
        let point = &mut self.points[0];
        self.fit.maximise(&self.cells, Kernel::Line, point, FIRST);
        self.fit.learn_roughness(point);
        self.fit.maximise(&self.cells, Kernel::Line, point, FINAL);
    }

    /// Writes the last fit, that of the first point, into `outcome`.
    fn record(&mut self, outcome: &mut Outcome, band: f64) -> Option<()> {
        let point = &self.points[0];
        let scale = widening(point, band).powi(2);
        outcome.covariance = self.fit.covariance()?.map(|row| row.map(|value| value * scale));
        (outcome.length, outcome.angle, outcome.band) = (point.length, point.angle, band);
        outcome.log_share = point.log_share;
        outcome.peaks = outcome.peaks.max(self.cells.peaks());
        outcome.misfit = self.fit.maximum().misfit;
        Some(())
    }
}

impl Outcome {
    /// Whether the two differ by no more than [`AGREEMENT`] allows.
    pub(super) fn is_near(&self, other: &Self) -> bool {
        let within = |shift: f64, i: usize| {
            shift * shift <= AGREEMENT * AGREEMENT * (self.covariance[i][i] + other.covariance[i][i])
        };
        within((other.length / self.length).ln(), 0) && within(other.angle - self.angle, 1)
    }

    fn is_coherent(&self) -> bool {
        self.log_share < COHERENT && self.density > CLEAR
    }

    fn candidate(&self) -> Candidate {
        Candidate { angle: self.angle, length: self.length, gain: self.density }
    }
}

/// Factor on standard deviations, 1 plus the roughness of the scene in log power: what is seen from patch to patch is there
/// within the patches too. That this is enough the attained coverage shows.
fn widening(point: &Point, band: f64) -> f64 {
    1.0 + point.roughness_within(band)
}

/// Whether the result of a wider band goes with that of a narrower one.
fn agrees(narrow: &Outcome, wide: &Outcome) -> bool {
    narrow.is_near(wide)
        && wide.log_share <= (narrow.log_share + SHARE_GROWTH).max(COHERENT)
        && wide.covariance[0][0] <= MOST_LOSS * narrow.covariance[0][0]
}

/// Whether two candidates are one mode of the likelihood.
fn same(a: &Candidate, b: &Candidate) -> bool {
    let turn = (a.angle - b.angle + FRAC_PI_2).rem_euclid(PI) - FRAC_PI_2;
    turn.abs() < SAME_ANGLE && (a.length / b.length).ln().abs() < SAME_LOG_LENGTH
}
