//! The likelihood of a blur given a spectrum, and its maximum.

use nalgebra::{Cholesky, Const, SMatrix, SVector};

use super::periodogram::CellSums;
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
const LANES: usize = 16;
/// Shape of the compound distribution of the powers: the level of a cell scatters by `1 / sqrt(SHAPE)` beyond what the
/// exponential distribution of the powers explains. It bounds the pull of any one cell.
const SHAPE: f32 = 30.0;
/// Least power transfer: below it the noise or rounding rules.
const LEAST_POWER: f32 = 1e-8;
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
const ROUGHNESS_COUNTS: f64 = 3.0;
const LEAST_ROUGHNESS: f64 = 0.02;

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
        (self.log_share, self.ratio2) = (other.log_share, other.ratio2);
        (self.scene, self.roughness) = (other.scene, other.roughness);
        self.patches.copy_from_slice(&other.patches);
    }
}

/// Cells in columns, padded to whole [`LANES`] with cells that weigh nothing.
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
    patch: Vec<u16>,
    peaks: f64,
}

impl Cells {
    /// How peaked the powers within the cells are, 1 for a smooth spectrum.
    pub(super) fn peaks(&self) -> f64 {
        self.peaks
    }

    pub(super) fn new(capacity: usize) -> Self {
        let padded = capacity.next_multiple_of(LANES);
        let column = || Vec::with_capacity(padded);
        Self {
            angle: 0.0,
            count: column(),
            power: column(),
            weight: column(),
            s: column(),
            t: column(),
            terms: Vec::with_capacity(padded * TERMS),
            patch: Vec::with_capacity(padded),
            peaks: 1.0,
        }
    }

    /// Takes the cells of `sums`, of which a bin counts for `independence` independent ones, under the noise power
    /// `noise`.
    pub(super) fn set(&mut self, sums: &CellSums, independence: f64, noise: f32) {
        self.angle = sums.angle;
        for column in [&mut self.count, &mut self.power, &mut self.weight, &mut self.s, &mut self.t] {
            column.clear();
        }
        self.patch.clear();
        for cell in sums.filled() {
            let one = 1.0 / cell.count;
            self.count.push(cell.count * independence as f32);
            self.power.push(cell.power * one);
            self.weight.push(cell.weight * one);
            self.s.push(cell.s * one);
            self.t.push(cell.t * one);
        }
        while !self.count.len().is_multiple_of(LANES) {
            self.count.push(0.0);
            for column in [&mut self.power, &mut self.weight, &mut self.s, &mut self.t] {
                column.push(0.1);
            }
        }
        self.peaks = peaks(sums, noise);
        self.terms.clear();
        self.terms.resize(self.count.len() * TERMS, 0.0);
        let (sin, cos) = sums.angle.sin_cos();
        for (i, (&s, &t)) in self.s.iter().zip(&self.t).enumerate() {
            let (s, t) = (f64::from(s), f64::from(t));
            let (u, v) = (s * cos + t * sin, t * cos - s * sin);
            let block = i / LANES * LANES * TERMS + i % LANES;
            for (k, term) in scene::terms(u, v).into_iter().enumerate() {
                self.terms[block + k * LANES] = term as f32;
            }
            self.patch.push(patch_of(u, v));
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

fn patch_of(u: f64, v: f64) -> u16 {
    let half_octave = (2.0 * (super::periodogram::MOST_FREQUENCY / u.hypot(v)).log2()) as usize;
    let turn = (v.atan2(u) / std::f64::consts::PI + 0.5).rem_euclid(1.0);
    let sector = ((turn * PATCHES_PER_RING as f64) as usize).min(PATCHES_PER_RING - 1);
    (half_octave.min(2 * OCTAVES - 1) * PATCHES_PER_RING + sector) as u16
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

    fn clear(&mut self) {
        (self.loss, self.weight, self.signal, self.squares) = (0.0, 0.0, 0.0, 0.0);
        self.gradient.fill(0.0);
        self.information.fill(0.0);
        self.patch_cross.fill([0.0; PARAMETERS]);
        self.patch_information.fill(0.0);
        self.patch_gradient.fill(0.0);
    }

    /// Gradient and information of the parameters with the patches profiled out.
    fn reduced(&self) -> (Vector, Matrix) {
        let (mut gradient, mut information) = (self.gradient, self.information);
        for ((cross, &own), &pull) in self.patch_cross.iter().zip(&self.patch_information).zip(&self.patch_gradient) {
            if cross[NOISE] == 0.0 && cross[SCENE] == 0.0 {
                continue;
            }
            for (i, &a) in cross.iter().enumerate().filter(|(_, a)| **a != 0.0) {
                let a = f64::from(a) / own;
                gradient[i] -= a * pull;
                for (j, &b) in cross[..=i].iter().enumerate() {
                    information[(i, j)] -= a * f64::from(b);
                }
            }
        }
        information.fill_upper_triangle_with_lower_triangle();
        (gradient, information)
    }
}

/// The end of a search for the maximum.
#[derive(Debug, Clone, Copy)]
pub(super) struct Maximum {
    /// Negative log-likelihood.
    pub(super) loss: f64,
    /// Effective number of independent powers.
    pub(super) weight: f64,
    /// Part of it that is signal and not noise.
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

    /// The window's lobe is that of `periodogram` along `angle` (radians) from here on.
    pub(super) fn set_direction(&mut self, periodogram: &super::periodogram::Periodogram, angle: f64) {
        self.response.set_direction(periodogram, angle);
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

    /// Fisher scoring with Levenberg's and Marquardt's damping from `point` to the maximum, at most `steps` steps.
    pub(super) fn maximise(&mut self, cells: &Cells, kernel: Kernel, point: &mut Point, steps: usize) -> Maximum {
        self.tabulate(kernel, point);
        self.response.score(cells, kernel, point, &mut self.score);
        let mut damping = 1e-3;
        for _ in 0..steps {
            let (gradient, information) = self.score.reduced();
            let mut gained = None;
            for _ in 0..5 {
                let mut damped = information;
                for i in 0..PARAMETERS {
                    damped[(i, i)] *= 1.0 + damping;
                }
                if let Some(factor) = Cholesky::new(damped) {
                    let step = factor.solve(&gradient);
                    self.candidate.copy(point);
                    advance(&mut self.candidate, &step, &self.score);
                    self.response.tabulate(kernel, &self.candidate);
                    self.response.score(cells, kernel, &self.candidate, &mut self.trial);
                    if self.trial.loss < self.score.loss {
                        gained = Some(self.score.loss - self.trial.loss);
                        point.copy(&self.candidate);
                        std::mem::swap(&mut self.score, &mut self.trial);
                        damping = (damping / 5.0_f64).max(1e-6);
                        break;
                    }
                }
                damping *= 6.0;
            }
            if gained.is_none_or(|gained| gained < LEAST_GAIN) {
                break;
            }
        }
        self.maximum()
    }

    /// The last maximum.
    pub(super) fn maximum(&self) -> Maximum {
        let Score { loss, weight, signal, squares, .. } = self.score;
        Maximum { loss, weight, signal, misfit: squares / weight.max(1.0) }
    }

    /// Estimates the scatter of the patches of each octave from the last maximum: one step of expectation and
    /// maximisation.
    pub(super) fn learn_roughness(&self, point: &mut Point) {
        let mut sums = [(ROUGHNESS_COUNTS * ROUGHNESS * ROUGHNESS, ROUGHNESS_COUNTS); OCTAVES];
        for (patch, (&deviation, &information)) in point.patches.iter().zip(&self.score.patch_information).enumerate() {
            let octave = octave_of(patch);
            let variance = 1.0 / information;
            // A patch that the picture says nothing about says nothing about the scatter.
            if variance < 0.99 * point.roughness[octave].powi(2) {
                sums[octave].0 += deviation * deviation + variance;
                sums[octave].1 += 1.0;
            }
        }
        for (roughness, (squares, count)) in point.roughness.iter_mut().zip(sums) {
            *roughness = (squares / count).sqrt().max(LEAST_ROUGHNESS);
        }
    }

    /// Covariance at the last maximum, everything else profiled out; `None` when the likelihood is flat.
    pub(super) fn covariance(&self) -> Option<Covariance> {
        let (_, information) = self.score.reduced();
        let factor: Cholesky<f64, Const<PARAMETERS>> = Cholesky::new(information)?;
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

/// A step that gains less ends the search.
const LEAST_GAIN: f64 = 0.01;

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
    fn score(&self, cells: &Cells, kernel: Kernel, point: &Point, out: &mut Score) {
        out.clear();
        let rotation = Rotation::between(cells.angle, point.angle);
        let noise = exp(point.log_noise as f32);
        let share = if kernel == Kernel::None { 0.0 } else { exp(point.log_share as f32) };
        let amplitudes = point.scene.map(|c| c as f32);
        let mut lower = [[0.0_f32; LANES]; PARAMETERS];
        let mut gradients = [[0.0_f32; LANES]; PARAMETERS];
        let mut triangle = [0.0_f64; PARAMETERS * (PARAMETERS + 1) / 2];
        for block in 0..cells.count.len() / LANES {
            let range = block * LANES..(block + 1) * LANES;
            let terms = &cells.terms[range.start * TERMS..range.end * TERMS];
            let mut level = [0.0_f32; LANES];
            let mut transfer = [0.0_f32; LANES];
            let (mut d_length, mut d_angle, mut d_ratio2) = ([0.0_f32; LANES], [0.0_f32; LANES], [0.0_f32; LANES]);
            for (lane, i) in range.clone().enumerate() {
                level[lane] = point.patches[usize::from(cells.patch[i])] as f32;
                let (s, t) = rotation.turn(cells.s[i], cells.t[i]);
                if kernel == Kernel::None {
                    transfer[lane] = 1.0;
                    continue;
                }
                let square = s * s + t * t;
                let fall = scene::fall(&point.scene, 0.5 * f64::from(ln(100.0 * square))) as f32;
                let along = if kernel == Kernel::Disk { square.sqrt() } else { s };
                let value = self.at(along, fall * along / square);
                transfer[lane] = value.power.max(LEAST_POWER);
                d_length[lane] = value.per_log_length;
                d_ratio2[lane] = value.per_ratio2;
                d_angle[lane] = if kernel == Kernel::Disk { 0.0 } else { -t * value.per_s };
            }
            for (k, &amplitude) in amplitudes.iter().enumerate() {
                let column = &terms[k * LANES..(k + 1) * LANES];
                for (level, &term) in level.iter_mut().zip(column) {
                    *level += amplitude * term;
                }
            }
            let (count, power) = (&cells.count[range.clone()], &cells.power[range.clone()]);
            let weight = &cells.weight[range.clone()];
            let (mut loss, mut info_sum, mut signal_sum, mut squares) = (0.0_f32, 0.0_f32, 0.0_f32, 0.0_f32);
            let (mut pull, mut info, mut signal_share) = ([0.0_f32; LANES], [0.0_f32; LANES], [0.0_f32; LANES]);
            for lane in 0..LANES {
                let n = count[lane];
                let scene = exp(level[lane]);
                let signal = scene * (transfer[lane] + share);
                let background = noise * weight[lane];
                let expected = signal + background;
                let inverse = 1.0 / expected;
                let x = power[lane] * inverse;
                loss += n * ln(expected) + (SHAPE + n) * ln((SHAPE + n * x) / (SHAPE + n));
                pull[lane] = n * SHAPE * (1.0 - x) / (SHAPE + n * x);
                info[lane] = n * SHAPE / (SHAPE + n + 1.0);
                signal_share[lane] = signal * inverse;
                info_sum += info[lane];
                signal_sum += info[lane] * signal_share[lane] * signal_share[lane];
                squares += pull[lane] * pull[lane];
                let scene = scene * inverse;
                gradients[LENGTH][lane] = scene * d_length[lane];
                gradients[ANGLE][lane] = scene * d_angle[lane];
                gradients[NOISE][lane] = background * inverse;
                gradients[SHARE][lane] = scene * share;
                gradients[RATIO2][lane] = scene * d_ratio2[lane];
            }
            out.loss += f64::from(loss);
            out.weight += f64::from(info_sum);
            out.signal += f64::from(signal_sum);
            out.squares += f64::from(squares);
            for (k, gradient) in gradients[SCENE..].iter_mut().enumerate() {
                let column = &terms[k * LANES..(k + 1) * LANES];
                for ((out, &term), &share) in gradient.iter_mut().zip(column).zip(&signal_share) {
                    *out = term * share;
                }
            }
            for (weighted, gradient) in lower.iter_mut().zip(&gradients) {
                for ((out, &value), &info) in weighted.iter_mut().zip(gradient).zip(&info) {
                    *out = value * info;
                }
            }
            let mut place = 0;
            for (i, weighted) in lower.iter().enumerate() {
                out.gradient[i] += f64::from(dot(&gradients[i], &pull));
                for other in &gradients[..=i] {
                    triangle[place] += f64::from(dot(weighted, other));
                    place += 1;
                }
            }
            for (lane, i) in range.enumerate() {
                let patch = usize::from(cells.patch[i]);
                let share = signal_share[lane];
                out.patch_gradient[patch] += f64::from(pull[lane] * share);
                out.patch_information[patch] += f64::from(info[lane] * share * share);
                for (cross, weighted) in out.patch_cross[patch].iter_mut().zip(&lower) {
                    *cross += weighted[lane] * share;
                }
            }
        }
        let mut place = 0;
        for i in 0..PARAMETERS {
            for j in 0..=i {
                out.information[(i, j)] = triangle[place];
                place += 1;
            }
        }
        add_prior(kernel, point, out);
    }
}

fn add_prior(kernel: Kernel, point: &Point, out: &mut Score) {
    let mut normal = |index: usize, deviation: f64, std: f64| {
        out.loss += 0.5 * (deviation / std).powi(2);
        out.gradient[index] += deviation / (std * std);
        out.information[(index, index)] += 1.0 / (std * std);
    };
    for (k, ((&value, &mean), &std)) in point.scene.iter().zip(&scene::MEAN).zip(&scene::STD).enumerate() {
        normal(SCENE + k, value - mean, std);
    }
    let fixed: &[usize] = match kernel {
        Kernel::None => &[LENGTH, ANGLE, SHARE, RATIO2],
        Kernel::Line => &[RATIO2],
        Kernel::AcceleratedLine => &[],
        Kernel::Disk => &[ANGLE, RATIO2],
    };
    if kernel != Kernel::None {
        normal(SHARE, point.log_share - SHARE_MEAN, SHARE_STD);
    }
    for &index in fixed {
        // Its gradient is 0, so any positive information keeps it where it is.
        out.information[(index, index)] += 1.0;
    }
    for (patch, &deviation) in point.patches.iter().enumerate() {
        let precision = 1.0 / point.roughness[octave_of(patch)].powi(2);
        out.loss += 0.5 * deviation * deviation * precision;
        out.patch_gradient[patch] += deviation * precision;
        out.patch_information[patch] += precision;
    }
}

fn dot(a: &[f32; LANES], b: &[f32; LANES]) -> f32 {
    let mut sums = [0.0_f32; 4];
    for (a, b) in a.chunks_exact(4).zip(b.chunks_exact(4)) {
        for ((sum, &a), &b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}
