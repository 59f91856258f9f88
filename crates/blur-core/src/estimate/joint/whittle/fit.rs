//! The likelihood of a blur given a spectrum, and its maximum.

use nalgebra::{Cholesky, Const, SMatrix, SVector};

use super::periodogram::{CellSum, CellSums, Periodogram};
use super::response::Response;
use super::scene::{self, TERMS};
use crate::spectrum::{exp, ln};

/// Parameters of the fit, in this order: `ln L`, the angle in radians, `ln` of the noise power, `ln` of the incoherent
/// share, `r^2`, then the amplitudes of the scene's spectrum.
pub(super) const PARAMETERS: usize = SCENE + TERMS;
const LENGTH: usize = 0;
const ANGLE: usize = 1;
const NOISE: usize = 2;
const SHARE: usize = 3;
const RATIO2: usize = 4;
const SCENE: usize = 5;

type Matrix = SMatrix<f64, PARAMETERS, PARAMETERS>;
type Vector = SVector<f64, PARAMETERS>;

/// Cells that are worked on side by side.
const LANES: usize = 8;
/// Blocks of lanes whose products are summed at once.
const GROUP: usize = 4;
const WIDTH: usize = GROUP * LANES;
/// Shape of the compound distribution of the powers: the level of a cell scatters by `1 / sqrt(SHAPE)` beyond what the
/// exponential distribution of the powers explains. It bounds the pull of any one cell.
const SHAPE: f32 = 30.0;
/// Least power transfer: below it the noise or rounding rules.
const LEAST_POWER: f32 = 1e-8;
/// Prior standard deviation of the logarithm of the noise power about its first guess.
const NOISE_STD: f64 = 1.0;
/// Prior of the logarithm of the incoherent share: anything from nothing to nearly everything.
const SHARE_MEAN: f64 = -6.0;
const SHARE_STD: f64 = 3.0;

/// Patches of the plane of frequencies in which the scene's spectrum may differ from its mean form: this many a half
/// turn, two an octave.
const PATCHES_PER_RING: usize = 36;
/// Octaves below the highest frequency, each with its own scatter of the patches.
pub(super) const OCTAVES: usize = 5;
const PATCHES: usize = 2 * OCTAVES * PATCHES_PER_RING;
/// Scatter of the patches in log power before the picture is seen, and the number of patches that this counts for.
const ROUGHNESS: f64 = 0.3;
const ROUGHNESS_COUNTS: f64 = 2.0;
const LEAST_ROUGHNESS: f64 = 0.02;
/// A patch is told of by the picture when that weighs this much against the first guess.
const LEAST_TOLD: f64 = 0.05;

/// Which kernel the spectrum is explained with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kernel {
    /// No blur.
    None,
    /// Uniform motion along a line.
    Line,
    /// Motion of constant acceleration along a line.
    AcceleratedLine,
    /// A lens out of focus; the length is the disk's diameter.
    Disk,
}

/// One point of the space of parameters.
#[derive(Debug, Clone)]
pub(super) struct Point {
    /// Length of the line or diameter of the disk in pixels.
    pub(super) length: f64,
    /// Radians.
    pub(super) angle: f64,
    pub(super) log_noise: f64,
    /// The first guess of it, from the highest frequencies: bands without noise cannot tell.
    guessed_log_noise: f64,
    /// Logarithm of the share of the light that the kernel does not explain.
    pub(super) log_share: f64,
    pub(super) ratio2: f64,
    pub(super) scene: [f64; TERMS],
    /// Deviation of each patch in log power.
    patches: Vec<f64>,
    /// Scatter of the patches of each octave.
    pub(super) roughness: [f64; OCTAVES],
}

impl Point {
    /// A point with room for everything that a fit will change.
    pub(super) fn new() -> Self {
        Self {
            length: 1.0,
            angle: 0.0,
            log_noise: 0.0,
            guessed_log_noise: 0.0,
            log_share: SHARE_MEAN,
            ratio2: 0.0,
            scene: scene::MEAN,
            patches: vec![0.0; PATCHES],
            roughness: [ROUGHNESS; OCTAVES],
        }
    }

    /// Starts from this length and angle, the noise power guessed and everything else unknown.
    pub(super) fn start(&mut self, length: f64, angle: f64, noise: f64) {
        (self.length, self.angle, self.log_noise) = (length, angle, noise.ln());
        self.guessed_log_noise = self.log_noise;
        (self.log_share, self.ratio2) = (SHARE_MEAN, 0.0);
        self.scene = scene::MEAN;
        self.patches.fill(0.0);
        self.roughness = [ROUGHNESS; OCTAVES];
    }

    /// Mean scatter of the patches in the octaves up to `most_frequency`.
    pub(super) fn roughness_within(&self, most_frequency: f64) -> f64 {
        let first = (super::periodogram::MOST_FREQUENCY / most_frequency).log2().round() as usize;
        let within = &self.roughness[first.min(OCTAVES - 1)..];
        within.iter().sum::<f64>() / within.len() as f64
    }

    /// Becomes `other` without allocating.
    pub(super) fn copy(&mut self, other: &Self) {
        (self.length, self.angle, self.log_noise) = (other.length, other.angle, other.log_noise);
        self.guessed_log_noise = other.guessed_log_noise;
        (self.log_share, self.ratio2) = (other.log_share, other.ratio2);
        (self.scene, self.roughness) = (other.scene, other.roughness);
        self.patches.copy_from_slice(&other.patches);
    }
}

/// Cells in columns, sorted by patch: each patch is padded to whole blocks of [`LANES`] with cells that weigh nothing.
#[derive(Debug)]
pub(super) struct Cells {
    angle: f64,
    /// Independent bins.
    count: Vec<f32>,
    power: Vec<f32>,
    weight: Vec<f32>,
    s: Vec<f32>,
    t: Vec<f32>,
    /// `TERMS` columns of lanes, block after block.
    terms: Vec<f32>,
    /// Patch of each block.
    patch: Vec<u16>,
    /// First cell of each patch, as long as they are sorted.
    first: Vec<u32>,
    peaks: f64,
}

impl Cells {
    /// How peaked the powers within the cells are, 1 for a smooth spectrum.
    pub(super) fn peaks(&self) -> f64 {
        self.peaks
    }

    pub(super) fn new(capacity: usize) -> Self {
        let padded = capacity + (PATCHES + GROUP) * LANES;
        let column = || Vec::with_capacity(padded);
        Self {
            angle: 0.0,
            count: column(),
            power: column(),
            weight: column(),
            s: column(),
            t: column(),
            terms: Vec::with_capacity(padded * TERMS),
            patch: Vec::with_capacity(padded / LANES),
            first: vec![0; PATCHES + 1],
            peaks: 1.0,
        }
    }

    /// Takes the cells of `sums`, of which a bin counts for `independence` independent ones, under the noise power
    /// `noise`.
    pub(super) fn set(&mut self, sums: &CellSums, independence: f64, noise: f32) {
        self.angle = sums.angle;
        self.peaks = peaks(sums, noise);
        let (sin, cos) = sums.angle.sin_cos();
        let place = |cell: &CellSum| {
            let (s, t) = (f64::from(cell.s / cell.count), f64::from(cell.t / cell.count));
            (s * cos + t * sin, t * cos - s * sin)
        };
        self.first.fill(0);
        for cell in sums.filled() {
            let (u, v) = place(cell);
            self.first[patch_of(u, v)] += 1;
        }
        self.patch.clear();
        let mut total = 0;
        for (patch, first) in self.first.iter_mut().enumerate() {
            let blocks = (*first as usize).div_ceil(LANES);
            *first = total as u32;
            total += blocks * LANES;
            self.patch.extend(std::iter::repeat_n(patch as u16, blocks));
        }
        while !self.patch.len().is_multiple_of(GROUP) {
            self.patch.push(0);
        }
        let total = self.patch.len() * LANES;
        self.count.clear();
        self.count.resize(total, 0.0);
        for column in [&mut self.power, &mut self.weight, &mut self.s, &mut self.t] {
            column.clear();
            column.resize(total, 0.1);
        }
        self.terms.clear();
        self.terms.resize(total * TERMS, 0.0);
        for cell in sums.filled() {
            let (u, v) = place(cell);
            let slot = &mut self.first[patch_of(u, v)];
            let i = *slot as usize;
            *slot += 1;
            let one = 1.0 / cell.count;
            self.count[i] = cell.count * independence as f32;
            self.power[i] = cell.power * one;
            self.weight[i] = cell.weight * one;
            self.s[i] = cell.s * one;
            self.t[i] = cell.t * one;
            let block = i / LANES * LANES * TERMS + i % LANES;
            for (k, term) in scene::terms(u, v).into_iter().enumerate() {
                self.terms[block + k * LANES] = term as f32;
            }
        }
    }
}

/// Bins that a cell must hold, and times that it must stand above the noise, to tell whether its powers are peaked.
const PEAK_BINS: f32 = 6.0;
const PEAK_CONTRAST: f32 = 3.0;

/// Mean over cells of the mean square power over twice the squared mean: 1 for a smooth spectrum, whose powers are
/// exponential variables, and more where a periodic texture puts its power into single bins.
fn peaks(sums: &CellSums, noise: f32) -> f64 {
    let (mut total, mut count) = (0.0_f32, 0.0_f32);
    for cell in sums.filled() {
        if cell.count >= PEAK_BINS && cell.power > PEAK_CONTRAST * noise * cell.weight {
            // n sum p^2 / (sum p)^2 has the mean 2 n / (n + 1).
            total += cell.square * (cell.count + 1.0) / (2.0 * cell.power * cell.power);
            count += 1.0;
        }
    }
    if count > 0.0 { f64::from(total / count) } else { 1.0 }
}

fn patch_of(u: f64, v: f64) -> usize {
    let half_octave = (2.0 * (super::periodogram::MOST_FREQUENCY / u.hypot(v)).log2()) as usize;
    let turn = (v.atan2(u) / std::f64::consts::PI + 0.5).rem_euclid(1.0);
    let sector = ((turn * PATCHES_PER_RING as f64) as usize).min(PATCHES_PER_RING - 1);
    half_octave.min(2 * OCTAVES - 1) * PATCHES_PER_RING + sector
}

fn octave_of(patch: usize) -> usize {
    patch / (2 * PATCHES_PER_RING)
}

/// A kernel, the cells it is held against and everything that the search for the maximum needs.
#[derive(Debug)]
pub(super) struct Fit {
    response: Response,
    score: Score,
    trial: Score,
    candidate: Point,
}

/// Negative log-likelihood with its gradient and expected information at one point.
#[derive(Debug)]
struct Score {
    loss: f64,
    gradient: Vector,
    information: Matrix,
    /// Cross information of each patch with the parameters, its own information and gradient.
    patch_cross: Vec<[f32; PARAMETERS]>,
    patch_information: Vec<f64>,
    patch_gradient: Vec<f64>,
    /// Sum of the weights of all cells: the effective number of independent powers.
    weight: f64,
    /// Part of the weight that is signal and not noise.
    signal: f64,
    /// Sum of squared standardised residuals.
    squares: f64,
}

impl Score {
    fn new() -> Self {
        Self {
            loss: 0.0,
            gradient: Vector::zeros(),
            information: Matrix::zeros(),
            patch_cross: vec![[0.0; PARAMETERS]; PATCHES],
            patch_information: vec![0.0; PATCHES],
            patch_gradient: vec![0.0; PATCHES],
            weight: 0.0,
            signal: 0.0,
            squares: 0.0,
        }
    }

    fn clear(&mut self, with_information: bool) {
        self.loss = 0.0;
        self.gradient.fill(0.0);
        self.patch_gradient.fill(0.0);
        if with_information {
            (self.weight, self.signal, self.squares) = (0.0, 0.0, 0.0);
            self.information.fill(0.0);
            self.patch_cross.fill([0.0; PARAMETERS]);
            self.patch_information.fill(0.0);
        }
    }

    /// Adds the information of a group of cells.
    fn add_information(
        &mut self,
        patches: &[u16],
        gradients: &[[f32; WIDTH]; PARAMETERS],
        pull: &[f32; WIDTH],
        info: &[f32; WIDTH],
        signal_share: &[f32; WIDTH],
    ) {
        let mut weighted = [[0.0_f32; WIDTH]; PARAMETERS];
        self.weight += f64::from(sum(info));
        self.squares += f64::from(dot(pull, pull));
        for (weighted, gradient) in weighted.iter_mut().zip(gradients) {
            for ((out, &value), &info) in weighted.iter_mut().zip(gradient).zip(info) {
                *out = value * info;
            }
        }
        for (i, weighted) in weighted.iter().enumerate() {
            for (j, other) in gradients[..=i].iter().enumerate() {
                self.information[(j, i)] += f64::from(dot(weighted, other));
            }
        }
        for (block, &patch) in patches.iter().enumerate() {
            let lanes = block * LANES..(block + 1) * LANES;
            let share = &signal_share[lanes.clone()];
            let patch = usize::from(patch);
            for (cross, weighted) in self.patch_cross[patch].iter_mut().zip(&weighted) {
                *cross += weighted[lanes.clone()].iter().zip(share).map(|(value, share)| value * share).sum::<f32>();
            }
            let own: f32 = info[lanes].iter().zip(share).map(|(info, share)| info * share * share).sum();
            self.patch_information[patch] += f64::from(own);
            self.signal += f64::from(own);
        }
    }

    /// Takes loss and gradients of `other` and keeps the information.
    fn follow(&mut self, other: &Self) {
        self.loss = other.loss;
        self.gradient = other.gradient;
        self.patch_gradient.copy_from_slice(&other.patch_gradient);
    }

    /// Gradient of the parameters with the patches profiled out.
    fn reduced_gradient(&self) -> Vector {
        let mut gradient = self.gradient;
        for ((cross, &own), &pull) in self.patch_cross.iter().zip(&self.patch_information).zip(&self.patch_gradient) {
            let pull = pull / own;
            for (out, &cross) in gradient.iter_mut().zip(cross) {
                *out -= f64::from(cross) * pull;
            }
        }
        gradient
    }

    /// Information of the parameters with the patches profiled out.
    fn reduced_information(&self) -> Matrix {
        let mut information = self.information;
        for (cross, &own) in self.patch_cross.iter().zip(&self.patch_information) {
            if cross[NOISE] == 0.0 && cross[SCENE] == 0.0 {
                continue;
            }
            let cross = cross.map(f64::from);
            for (i, &a) in cross.iter().enumerate() {
                let a = a / own;
                // One column of the upper triangle: its rows lie side by side.
                for (out, &b) in information.column_mut(i).iter_mut().zip(&cross[..=i]) {
                    *out -= a * b;
                }
            }
        }
        information.fill_lower_triangle_with_upper_triangle();
        information
    }
}

/// How far a search for the maximum goes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Effort {
    /// Most steps.
    pub(super) steps: usize,
    /// A step that gains less log-likelihood is the last.
    pub(super) least_gain: f64,
}

/// The end of a search for the maximum.
#[derive(Debug, Clone, Copy)]
pub(super) struct Maximum {
    /// Negative log-likelihood.
    pub(super) loss: f64,
    /// Effective number of independent powers that are signal and not noise.
    pub(super) signal: f64,
    /// Mean squared standardised residual of the cells, 1 for a model that is right.
    pub(super) misfit: f64,
}

/// Covariance of `ln L`, the angle (radians) and `r^2`.
pub(super) type Covariance = [[f64; 3]; 3];

impl Fit {
    /// For pictures whose longer side has `side` pixels.
    pub(super) fn new(side: usize) -> Self {
        Self { response: Response::new(side), score: Score::new(), trial: Score::new(), candidate: Point::new() }
    }

    /// The window's lobe is that of `periodogram` over `cells` from here on, the highest frequency `most_frequency`.
    pub(super) fn set_direction(&mut self, periodogram: &Periodogram, cells: &CellSums, most_frequency: f64) {
        self.response.set_direction(periodogram, cells, most_frequency);
    }

    /// First amplitudes of the scene: least squares of the log power where there is signal.
    pub(super) fn start_scene(&mut self, cells: &Cells, kernel: Kernel, point: &mut Point) {
        self.tabulate(kernel, point);
        let noise = exp(point.log_noise as f32);
        let share = exp(point.log_share as f32);
        let rotation = Rotation::between(cells.angle, point.angle);
        let (mut gradient, mut information) = (Vector::zeros(), Matrix::identity());
        for (i, &count) in cells.count.iter().enumerate() {
            let (s, t) = rotation.turn(cells.s[i], cells.t[i]);
            let transfer = match kernel {
                Kernel::None => 1.0,
                Kernel::Disk => self.response.at(s.hypot(t), 0.0).power + share,
                Kernel::Line | Kernel::AcceleratedLine => self.response.at(s, 0.0).power + share,
            };
            let signal = cells.power[i] - noise * cells.weight[i];
            if count == 0.0 || transfer < 0.05 || signal < noise * cells.weight[i] {
                continue;
            }
            let y = f64::from(ln(signal / transfer));
            let weight = 0.5 * f64::from(count.min(8.0));
            let block = i / LANES * LANES * TERMS + i % LANES;
            let mut terms = [0.0; TERMS];
            for (k, term) in terms.iter_mut().enumerate() {
                *term = f64::from(cells.terms[block + k * LANES]);
            }
            for (a, &term) in terms.iter().enumerate() {
                gradient[SCENE + a] += weight * y * term;
                for (b, &other) in terms[..=a].iter().enumerate() {
                    information[(SCENE + a, SCENE + b)] += weight * term * other;
                }
            }
        }
        for (k, (&mean, &std)) in scene::MEAN.iter().zip(&scene::STD).enumerate() {
            gradient[SCENE + k] += mean / (std * std);
            // The identity stays under the other parameters only.
            information[(SCENE + k, SCENE + k)] += 1.0 / (std * std) - 1.0;
        }
        information.fill_upper_triangle_with_lower_triangle();
        if let Some(factor) = Cholesky::new(information) {
            let solution = factor.solve(&gradient);
            for (k, amplitude) in point.scene.iter_mut().enumerate() {
                *amplitude = solution[SCENE + k];
            }
        }
    }

    /// Fisher scoring with Levenberg's and Marquardt's damping from `point` to the maximum, with limited effort.
    ///
    /// The expected information hardly changes on the way: it is computed at the start, anew when a step falls short,
    /// and at the end.
    pub(super) fn maximise(&mut self, cells: &Cells, kernel: Kernel, point: &mut Point, effort: Effort) -> Maximum {
        let Effort { steps, least_gain } = effort;
        self.tabulate(kernel, point);
        self.response.score(cells, kernel, point, true, &mut self.score);
        let mut damping = 1e-3;
        let mut fresh = true;
        let mut reduced = self.score.reduced_information();
        for _ in 0..steps {
            let gradient = self.score.reduced_gradient();
            let mut damped = reduced;
            for i in 0..PARAMETERS {
                damped[(i, i)] *= 1.0 + damping;
            }
            let Some(factor) = Cholesky::new(damped) else { break };
            let step = factor.solve(&gradient);
            let expected = 0.5 * step.dot(&gradient);
            self.candidate.copy(point);
            advance(&mut self.candidate, &step, &self.score);
            self.response.tabulate(kernel, &self.candidate);
            self.response.score(cells, kernel, &self.candidate, false, &mut self.trial);
            let gained = self.score.loss - self.trial.loss;
            if gained > 0.0 {
                point.copy(&self.candidate);
                self.score.follow(&self.trial);
                damping = (damping / 5.0_f64).max(1e-6);
                if gained < least_gain && fresh {
                    break;
                }
                // A step that falls far short of what was expected was taken with stale information.
                if gained < least_gain || gained < SHORT * expected || expected > LARGE {
                    self.response.score(cells, kernel, point, true, &mut self.score);
                    reduced = self.score.reduced_information();
                    fresh = true;
                } else {
                    fresh = false;
                }
            } else if fresh {
                damping *= 10.0;
                if damping > MOST_DAMPING || expected < least_gain {
                    break;
                }
            } else {
                self.tabulate(kernel, point);
                self.response.score(cells, kernel, point, true, &mut self.score);
                reduced = self.score.reduced_information();
                fresh = true;
            }
        }
        self.maximum()
    }

    /// The last maximum.
    pub(super) fn maximum(&self) -> Maximum {
        let Score { loss, weight, signal, squares, .. } = self.score;
        Maximum { loss, signal, misfit: squares / weight.max(1.0) }
    }

    /// Estimates the scatter of the patches of each octave at the last maximum, by the moments of what the picture alone
    /// says of them: mean of `deviation^2 - variance`, weighted by the inverse square of the variance plus the first guess
    /// of `scatter^2`.
    ///
    /// *Reference*: R. `DerSimonian` and N. Laird, *Meta-analysis in clinical trials*, Controlled Clinical Trials 7 (1986) 177.
    pub(super) fn learn_roughness(&self, point: &mut Point) {
        let misfit = self.maximum().misfit.min(1.0);
        let prior = ROUGHNESS * ROUGHNESS;
        let weight = ROUGHNESS_COUNTS / (2.0 * prior).powi(2);
        let mut sums = [(weight * prior, weight); OCTAVES];
        for (patch, (&deviation, &own)) in point.patches.iter().zip(&self.score.patch_information).enumerate() {
            let octave = octave_of(patch);
            let information = own - 1.0 / point.roughness[octave].powi(2);
            // A patch that the picture says nothing about says nothing about the scatter.
            if information * prior > LEAST_TOLD {
                // The shape of the cells makes the information too small by the misfit.
                let (free, variance) = (deviation * own / information, misfit / information);
                let weight = 1.0 / (variance + prior).powi(2);
                sums[octave].0 += weight * (free * free - variance);
                sums[octave].1 += weight;
            }
        }
        for (roughness, (sum, weight)) in point.roughness.iter_mut().zip(sums) {
            *roughness = (sum / weight).max(LEAST_ROUGHNESS * LEAST_ROUGHNESS).sqrt();
        }
    }

    /// Covariance at the last maximum, everything else profiled out; `None` when the likelihood is flat.
    pub(super) fn covariance(&self) -> Option<Covariance> {
        let factor: Cholesky<f64, Const<PARAMETERS>> = Cholesky::new(self.score.reduced_information())?;
        let mut covariance = [[0.0; 3]; 3];
        for (row, &i) in covariance.iter_mut().zip(&[LENGTH, ANGLE, RATIO2]) {
            let mut unit = Vector::zeros();
            unit[i] = 1.0;
            let column = factor.solve(&unit);
            for (cell, &j) in row.iter_mut().zip(&[LENGTH, ANGLE, RATIO2]) {
                *cell = column[j];
            }
        }
        Some(covariance)
    }

    fn tabulate(&mut self, kernel: Kernel, point: &Point) {
        self.response.tabulate(kernel, point);
    }
}

/// The information is stale after a step that gains less than this share of what was expected, or more than this.
const SHORT: f64 = 0.7;
const LARGE: f64 = 5.0;
/// No step is shorter than this damping makes it.
const MOST_DAMPING: f64 = 1e3;

/// Moves `point` against `step`, within limits that keep the quadratic model honest.
fn advance(point: &mut Point, step: &Vector, score: &Score) {
    point.length *= (-step[LENGTH].clamp(-0.15, 0.15)).exp();
    point.angle -= step[ANGLE].clamp(-0.08, 0.08);
    point.log_noise -= step[NOISE].clamp(-1.0, 1.0);
    point.log_share = (point.log_share - step[SHARE].clamp(-1.0, 1.0)).clamp(-20.0, 3.0);
    point.ratio2 = (point.ratio2 - step[RATIO2].clamp(-0.2, 0.2)).clamp(0.0, 1.0);
    for (k, amplitude) in point.scene.iter_mut().enumerate() {
        *amplitude -= step[SCENE + k];
    }
    for (patch, deviation) in point.patches.iter_mut().enumerate() {
        let followed: f64 = score.patch_cross[patch].iter().zip(step.iter()).map(|(&a, b)| f64::from(a) * b).sum();
        let own = (score.patch_gradient[patch] - followed) / score.patch_information[patch];
        *deviation -= own.clamp(-1.0, 1.0);
    }
}

/// From the frame of the cells to that of the motion.
#[derive(Debug, Clone, Copy)]
struct Rotation {
    sin: f32,
    cos: f32,
}

impl Rotation {
    fn between(cells: f64, motion: f64) -> Self {
        let turn = motion - cells;
        Self { sin: turn.sin() as f32, cos: turn.cos() as f32 }
    }

    fn turn(self, s: f32, t: f32) -> (f32, f32) {
        (s * self.cos - t * self.sin, s * self.sin + t * self.cos)
    }
}

impl Response {
    fn tabulate(&mut self, kernel: Kernel, point: &Point) {
        match kernel {
            Kernel::None => {}
            Kernel::Line => self.set_uniform(point.length),
            Kernel::AcceleratedLine => self.set_accelerated(point.length, point.ratio2),
            Kernel::Disk => self.set_disk(point.length),
        }
    }

    /// The negative log-likelihood of `point` with its derivatives.
    ///
    /// A cell of `n` independent bins with the mean power `P` and the expectation `E = S (T + share) + noise` weighs as a
    /// gamma variable of `n` whose scale scatters as an inverse gamma variable of [`SHAPE`] `a`: up to a constant
    /// `n ln E + (a + n) ln(1 + n (P/E - 1)/(a + n))`.
    fn score(&self, cells: &Cells, kernel: Kernel, point: &Point, with_information: bool, out: &mut Score) {
        out.clear(with_information);
        let rotation = Rotation::between(cells.angle, point.angle);
        let noise = exp(point.log_noise as f32);
        let share = if kernel == Kernel::None { 0.0 } else { exp(point.log_share as f32) };
        let amplitudes = point.scene.map(|c| c as f32);
        let falls = scene::falls(&point.scene).map(|c| c as f32);
        let mut gradients = [[0.0_f32; WIDTH]; PARAMETERS];
        let mut pull = [0.0_f32; WIDTH];
        let mut info = [0.0_f32; WIDTH];
        let mut signal_share = [0.0_f32; WIDTH];
        for (group, patches) in cells.patch.chunks_exact(GROUP).enumerate() {
            let range = group * WIDTH..(group + 1) * WIDTH;
            let terms = &cells.terms[range.start * TERMS..range.end * TERMS];
            let mut level = [0.0_f32; WIDTH];
            for ((level, terms), &patch) in
                level.chunks_exact_mut(LANES).zip(terms.chunks_exact(LANES * TERMS)).zip(patches)
            {
                level.fill(point.patches[usize::from(patch)] as f32);
                for (column, &amplitude) in terms.chunks_exact(LANES).zip(&amplitudes) {
                    for (level, &term) in level.iter_mut().zip(column) {
                        *level += amplitude * term;
                    }
                }
            }
            let mut transfer = [1.0_f32; WIDTH];
            let (mut d_length, mut d_angle, mut d_ratio2) = ([0.0_f32; WIDTH], [0.0_f32; WIDTH], [0.0_f32; WIDTH]);
            if kernel != Kernel::None {
                for (lane, (&s, &t)) in cells.s[range.clone()].iter().zip(&cells.t[range.clone()]).enumerate() {
                    let (s, t) = rotation.turn(s, t);
                    let square = s * s + t * t;
                    let x = 0.5 * ln(100.0 * square);
                    let fall = falls[0] - x * (falls[1] + x * falls[2]);
                    let along = if kernel == Kernel::Disk { square.sqrt() } else { s };
                    let value = self.at(along, fall * along / square);
                    transfer[lane] = value.power.max(LEAST_POWER);
                    d_length[lane] = value.per_log_length;
                    d_ratio2[lane] = value.per_ratio2;
                    d_angle[lane] = if kernel == Kernel::Disk { 0.0 } else { -t * value.per_s };
                }
            }
            let (count, power) = (&cells.count[range.clone()], &cells.power[range.clone()]);
            let weight = &cells.weight[range];
            let mut loss = [0.0_f32; WIDTH];
            for lane in 0..WIDTH {
                let n = count[lane];
                let scene = exp(level[lane]);
                let signal = scene * (transfer[lane] + share);
                let background = noise * weight[lane];
                let expected = signal + background;
                let inverse = 1.0 / expected;
                let x = power[lane] * inverse;
                loss[lane] = n * ln(expected) + (SHAPE + n) * ln((SHAPE + n * x) / (SHAPE + n));
                pull[lane] = n * SHAPE * (1.0 - x) / (SHAPE + n * x);
                info[lane] = n * SHAPE / (SHAPE + n + 1.0);
                signal_share[lane] = signal * inverse;
                let scene = scene * inverse;
                gradients[LENGTH][lane] = scene * d_length[lane];
                gradients[ANGLE][lane] = scene * d_angle[lane];
                gradients[NOISE][lane] = background * inverse;
                gradients[SHARE][lane] = scene * share;
                gradients[RATIO2][lane] = scene * d_ratio2[lane];
            }
            out.loss += f64::from(sum(&loss));
            for (block, terms) in terms.chunks_exact(LANES * TERMS).enumerate() {
                let lanes = block * LANES..(block + 1) * LANES;
                for (gradient, column) in gradients[SCENE..].iter_mut().zip(terms.chunks_exact(LANES)) {
                    for ((out, &term), &share) in
                        gradient[lanes.clone()].iter_mut().zip(column).zip(&signal_share[lanes.clone()])
                    {
                        *out = term * share;
                    }
                }
            }
            for (out, gradient) in out.gradient.iter_mut().zip(&gradients) {
                *out += f64::from(dot(gradient, &pull));
            }
            for (block, &patch) in patches.iter().enumerate() {
                let lanes = block * LANES..(block + 1) * LANES;
                let pulled: f32 =
                    pull[lanes.clone()].iter().zip(&signal_share[lanes]).map(|(pull, share)| pull * share).sum();
                out.patch_gradient[usize::from(patch)] += f64::from(pulled);
            }
            if !with_information {
                continue;
            }
            out.add_information(patches, &gradients, &pull, &info, &signal_share);
        }
        add_prior(kernel, point, with_information, out);
    }
}

fn add_prior(kernel: Kernel, point: &Point, with_information: bool, out: &mut Score) {
    let mut normal = |index: usize, deviation: f64, std: f64| {
        out.loss += 0.5 * (deviation / std).powi(2);
        out.gradient[index] += deviation / (std * std);
        if with_information {
            out.information[(index, index)] += 1.0 / (std * std);
        }
    };
    for (k, ((&value, &mean), &std)) in point.scene.iter().zip(&scene::MEAN).zip(&scene::STD).enumerate() {
        normal(SCENE + k, value - mean, std);
    }
    normal(NOISE, point.log_noise - point.guessed_log_noise, NOISE_STD);
    if kernel != Kernel::None {
        normal(SHARE, point.log_share - SHARE_MEAN, SHARE_STD);
    }
    for (patch, &deviation) in point.patches.iter().enumerate() {
        let precision = 1.0 / point.roughness[octave_of(patch)].powi(2);
        out.loss += 0.5 * deviation * deviation * precision;
        out.patch_gradient[patch] += deviation * precision;
        if with_information {
            out.patch_information[patch] += precision;
        }
    }
    if with_information {
        let fixed: &[usize] = match kernel {
            Kernel::None => &[LENGTH, ANGLE, SHARE, RATIO2],
            Kernel::Line => &[RATIO2],
            Kernel::AcceleratedLine => &[],
            Kernel::Disk => &[ANGLE, RATIO2],
        };
        for &index in fixed {
            // Its gradient is 0, so any positive information keeps it where it is.
            out.information[(index, index)] += 1.0;
        }
    }
}

/// Kept apart from its callers: there the compiler would rather vectorise across products than along them.
#[inline(never)]
fn dot(a: &[f32; WIDTH], b: &[f32; WIDTH]) -> f32 {
    let mut sums = [0.0_f32; LANES];
    for (a, b) in a.chunks_exact(LANES).zip(b.chunks_exact(LANES)) {
        for ((sum, &a), &b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    total(&sums)
}

fn sum(values: &[f32; WIDTH]) -> f32 {
    let mut sums = [0.0_f32; LANES];
    for values in values.chunks_exact(LANES) {
        for (sum, &value) in sums.iter_mut().zip(values) {
            *sum += value;
        }
    }
    total(&sums)
}

fn total(lanes: &[f32; LANES]) -> f32 {
    ((lanes[0] + lanes[4]) + (lanes[1] + lanes[5])) + ((lanes[2] + lanes[6]) + (lanes[3] + lanes[7]))
}

#[cfg(test)]
mod tests {
    use super::super::periodogram::MOST_FREQUENCY;
    use super::super::testing::Random;
    use super::*;
    use crate::image::Window;

    const KERNELS: [Kernel; 4] = [Kernel::None, Kernel::Line, Kernel::AcceleratedLine, Kernel::Disk];
    const EFFORT: Effort = Effort { steps: 40, least_gain: 1e-3 };

    /// Everything that a fit to one spectrum needs.
    struct Bench {
        periodogram: Periodogram,
        sums: CellSums,
        cells: Cells,
        fit: Fit,
    }

    impl Bench {
        fn new(rows: usize, columns: usize) -> Self {
            let side = rows.max(columns);
            let sums = CellSums::new(side);
            Self {
                periodogram: Periodogram::new(rows, columns, Window::Tukey { taper: 0.25 }),
                cells: Cells::new(sums.capacity()),
                fit: Fit::new(side),
                sums,
            }
        }

        fn gather(&mut self, angle: f64, noise: f64) {
            self.periodogram.gather(angle, 1, MOST_FREQUENCY, &mut self.sums);
            self.cells.set(&self.sums, self.periodogram.independence, noise as f32);
            self.fit.set_direction(&self.periodogram, &self.sums, MOST_FREQUENCY);
        }

        /// A spectrum drawn from the model at `truth`, gathered along `angle`.
        fn draw(&mut self, kernel: Kernel, truth: &Point, angle: f64, random: &mut Random) {
            // The window's lobe is that along the true direction.
            self.gather(truth.angle, truth.log_noise.exp());
            self.fit.tabulate(kernel, truth);
            let (sin, cos) = truth.angle.sin_cos();
            let falls = scene::falls(&truth.scene);
            let response = &self.fit.response;
            self.periodogram.set_powers(|u, v| {
                let (s, r2) = (u * cos - v * sin, u * u + v * v);
                let x = 0.5 * (100.0 * r2).ln();
                let fall = falls[0] - x * (falls[1] + x * falls[2]);
                let along = if kernel == Kernel::Disk { r2.sqrt() } else { s };
                let transfer = match kernel {
                    Kernel::None => 1.0,
                    _ => f64::from(response.at(along as f32, (fall * along / r2) as f32).power) + truth.log_share.exp(),
                };
                let terms = scene::terms(u, v);
                let level: f64 = terms.iter().zip(&truth.scene).map(|(term, c)| term * c).sum();
                let whitening = (r2.sqrt() / 0.1).powf(super::super::periodogram::FALL);
                let scene = (level + truth.patches[patch_of(u, v)]).exp() / whitening;
                (scene * transfer + truth.log_noise.exp()) * random.exponential()
            });
            self.gather(angle, truth.log_noise.exp());
        }

        fn score(&mut self, kernel: Kernel, point: &Point) -> Score {
            let mut score = Score::new();
            self.fit.tabulate(kernel, point);
            self.fit.response.score(&self.cells, kernel, point, true, &mut score);
            score
        }
    }

    /// A blur of `length` along `deg` over an ordinary scene with little noise.
    fn truth(length: f64, deg: f64) -> Point {
        let mut point = Point::new();
        point.start(length, deg.to_radians(), 1e-4);
        point.ratio2 = 0.36;
        point.scene[0] = 1.0;
        point
    }

    /// `point` with one parameter moved.
    fn moved(point: &Point, parameter: usize, by: f64) -> Point {
        let mut point = point.clone();
        match parameter {
            LENGTH => point.length *= by.exp(),
            ANGLE => point.angle += by,
            NOISE => point.log_noise += by,
            SHARE => point.log_share += by,
            RATIO2 => point.ratio2 += by,
            _ => point.scene[parameter - SCENE] += by,
        }
        point
    }

    #[test]
    fn the_gradient_is_the_limit_of_differences() {
        for (seed, kernel) in KERNELS.into_iter().enumerate() {
            let mut random = Random::new(seed as u64);
            let mut bench = Bench::new(96, 128);
            let mut point = truth(9.7, 33.0);
            bench.draw(kernel, &point, point.angle + 0.01, &mut random);
            // Not at the maximum.
            point.length *= 1.03;
            point.log_noise += 0.3;
            point.log_share += 0.5;
            for amplitude in &mut point.scene {
                *amplitude += 0.05 * random.normal();
            }
            for deviation in &mut point.patches {
                *deviation = 0.1 * random.normal();
            }
            let score = bench.score(kernel, &point);
            for parameter in 0..PARAMETERS {
                let std = score.information[(parameter, parameter)].sqrt().recip();
                // Half a standard deviation either way stands out from rounding; angles and lengths curve sooner.
                let h = (0.5 * std).min(if parameter < NOISE { 2e-3 } else { 0.05 });
                let loss = |by: f64, bench: &mut Bench| bench.score(kernel, &moved(&point, parameter, by)).loss;
                let change = loss(h, &mut bench) - loss(-h, &mut bench);
                if kernel == Kernel::Disk && parameter == ANGLE {
                    // A disk has no direction: what turning it changes is rounding.
                    assert!(score.gradient[ANGLE] == 0.0 && change.abs() < 1e-3, "{change}");
                    continue;
                }
                let difference = change / (2.0 * h);
                let miss = (score.gradient[parameter] - difference) * std;
                // The gradient leaves out that the leakage depends on the fall of the scene's spectrum, three of its
                // amplitudes, and a little on the angle.
                let most = if [1, 2, 7].map(|k| SCENE + k).contains(&parameter) { 0.15 } else { 0.03 };
                assert!(
                    miss.abs() < most,
                    "{kernel:?} {parameter}: {} not {difference}, {miss} standard deviations",
                    score.gradient[parameter]
                );
            }
            for patch in [0, 40, 100, 150] {
                let h = 0.1;
                let mut loss = |by: f64| {
                    let mut point = point.clone();
                    point.patches[patch] += by;
                    bench.score(kernel, &point).loss
                };
                let difference = (loss(h) - loss(-h)) / (2.0 * h);
                let miss = (score.patch_gradient[patch] - difference) / score.patch_information[patch].sqrt();
                assert!(miss.abs() < 0.03, "{kernel:?} patch {patch}: {miss} standard deviations");
            }
        }
    }

    #[test]
    fn the_expected_information_is_positive_definite() {
        for (seed, kernel) in KERNELS.into_iter().enumerate() {
            let mut bench = Bench::new(96, 128);
            let point = truth(9.7, 112.0);
            bench.draw(kernel, &point, point.angle, &mut Random::new(seed as u64));
            let score = bench.score(kernel, &point);
            let reduced: Option<Cholesky<f64, Const<PARAMETERS>>> = Cholesky::new(score.reduced_information());
            assert!(reduced.is_some(), "{kernel:?}");
            let mut whole = score.information;
            whole.fill_lower_triangle_with_upper_triangle();
            assert!(Cholesky::<f64, Const<PARAMETERS>>::new(whole).is_some(), "{kernel:?}");
            assert!(score.patch_information.iter().all(|&own| own > 0.0), "{kernel:?}");
        }
    }

    #[test]
    fn the_maximum_of_a_drawn_spectrum_is_the_truth_within_its_uncertainty() {
        let mut squares = [0.0; 2];
        let mut count = 0.0;
        for (seed, deg) in [0.0_f64, 21.0, 45.0, 90.0, 133.0, 178.5].into_iter().enumerate() {
            for length in [8.3, 21.7] {
                let mut bench = Bench::new(160, 128);
                let truth = truth(length, deg);
                bench.draw(Kernel::Line, &truth, truth.angle, &mut Random::new(seed as u64));
                let mut point = Point::new();
                point.start(1.04 * length, truth.angle + 0.02, 1e-4);
                bench.fit.start_scene(&bench.cells, Kernel::Line, &mut point);
                bench.fit.maximise(&bench.cells, Kernel::Line, &mut point, EFFORT);
                let covariance = bench.fit.covariance().unwrap();
                let z = [
                    (point.length / length).ln() / covariance[0][0].sqrt(),
                    (point.angle - truth.angle) / covariance[1][1].sqrt(),
                ];
                assert!(z.iter().all(|z| z.abs() < 4.0), "{deg} deg {length} px: {z:?}");
                for (sum, z) in squares.iter_mut().zip(z) {
                    *sum += z * z;
                }
                count += 1.0;
            }
        }
        let rms = squares.map(|sum| (sum / count).sqrt());
        // The root mean square of twelve standard normal deviations is outside of this once in a hundred cases.
        assert!(rms.iter().all(|rms| (0.5..1.5).contains(rms)), "{rms:?}");
    }

    #[test]
    fn an_acceleration_is_found_within_its_uncertainty() {
        let mut squares = 0.0;
        for seed in 0..6 {
            let mut bench = Bench::new(160, 160);
            let truth = truth(14.0, 21.0);
            bench.draw(Kernel::AcceleratedLine, &truth, truth.angle, &mut Random::new(seed));
            let mut point = truth.clone();
            point.start(14.0, truth.angle, 1e-4);
            point.ratio2 = 0.1;
            bench.fit.start_scene(&bench.cells, Kernel::AcceleratedLine, &mut point);
            bench.fit.maximise(&bench.cells, Kernel::AcceleratedLine, &mut point, EFFORT);
            let std = bench.fit.covariance().unwrap()[2][2].sqrt();
            let z = (point.ratio2 - truth.ratio2) / std;
            assert!(z.abs() < 4.0, "{seed}: {z}");
            squares += z * z;
        }
        assert!(squares / 6.0 < 2.5, "{squares}");
    }

    #[test]
    fn the_scatter_of_the_patches_is_learnt() {
        // A small scatter drowns in that of the powers: it is known to be small, not how small.
        for (planted, most, least) in [(0.1, 0.16, 0.03), (0.5, 0.8, 0.31)] {
            let mut random = Random::new(7);
            let mut bench = Bench::new(256, 256);
            let mut truth = truth(12.0, 33.0);
            for deviation in &mut truth.patches {
                *deviation = planted * random.normal();
            }
            bench.draw(Kernel::Line, &truth, truth.angle, &mut random);
            let mut point = Point::new();
            point.start(12.0, truth.angle, 1e-4);
            bench.fit.start_scene(&bench.cells, Kernel::Line, &mut point);
            for _ in 0..6 {
                bench.fit.maximise(&bench.cells, Kernel::Line, &mut point, EFFORT);
                bench.fit.learn_roughness(&mut point);
            }
            // The upper octaves have patches of many bins, the others cling to the first guess.
            for &learnt in &point.roughness[..2] {
                assert!((least..most).contains(&learnt), "{planted}: {:?}", point.roughness);
            }
        }
    }

    #[test]
    fn patches_are_halves_of_octaves() {
        assert_eq!(octave_of(patch_of(0.3, 0.0)), 0);
        assert_eq!(octave_of(patch_of(0.0, 0.2)), 1);
        // Below the last octave they stay in it.
        assert_eq!(octave_of(patch_of(0.001, 0.001)), OCTAVES - 1);
        assert!(patch_of(0.49, -1e-12) < PATCHES && patch_of(1e-12, 0.49) < PATCHES);
    }
}
