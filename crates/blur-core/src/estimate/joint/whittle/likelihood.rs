//! The likelihood of a spectrum in cells, with its derivatives.

use nalgebra::{SMatrix, SVector};

use super::cells::{Cells, PATCHES, octave_of};
use super::point::{ANGLE, Kernel, LENGTH, NOISE, PARAMETERS, Point, RATIO2, SCENE, SHARE, SHARE_MEAN, SHARE_STD};
use super::response::Response;
use super::scene::{self, TERMS};
use crate::products::{Columns, GROUP, LANES, Products, TILE, WIDTH};
use crate::spectrum::{exp, ln};

pub(super) type Matrix = SMatrix<f64, PARAMETERS, PARAMETERS>;
pub(super) type Vector = SVector<f64, PARAMETERS>;

/// Sums that run side by side.
const SUMS: usize = 8;
/// Shape of the compound distribution of the powers: the level of a cell scatters by `1 / sqrt(SHAPE)` beyond what the
/// exponential distribution of the powers explains. It bounds the pull of any one cell.
const SHAPE: f32 = 30.0;
/// Patches that are summed in single precision.
const BLOCK: usize = 8;
/// Least power transfer: below it the noise or rounding rules.
pub(super) const LEAST_POWER: f32 = 1e-8;
/// Prior standard deviation of the logarithm of the noise power about its first guess.
const NOISE_STD: f64 = 1.0;

/// Negative log-likelihood with its gradient and expected information at one point.
#[derive(Debug)]
pub(super) struct Score {
    pub(super) loss: f64,
    pub(super) gradient: Vector,
    pub(super) information: Matrix,
    /// Cross information of each patch with the parameters, its own information and gradient.
    pub(super) patch_cross: Vec<[f32; PARAMETERS]>,
    pub(super) patch_information: Vec<f64>,
    pub(super) patch_gradient: Vec<f64>,
    /// Sum of the weights of all cells: the effective number of independent powers.
    pub(super) weight: f64,
    /// Part of the weight that is signal and not noise.
    pub(super) signal: f64,
    /// Sum of squared standardised residuals.
    pub(super) squares: f64,
    products: Products<COLUMNS>,
}

impl Score {
    pub(super) fn new() -> Self {
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
            products: Products::new(),
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
            self.products.clear();
        }
    }

    /// Adds the information of a group of cells.
    fn add_information(
        &mut self,
        patches: &[u16],
        gradients: &Columns<COLUMNS>,
        pull: &[f32; WIDTH],
        info: &[f32; WIDTH],
        signal_share: &[f32; WIDTH],
    ) {
        let mut weighted = [[0.0_f32; WIDTH]; COLUMNS];
        self.weight += f64::from(sum(info));
        self.squares += f64::from(dot(pull, pull));
        for (weighted, gradient) in weighted.iter_mut().zip(gradients) {
            for ((out, &value), &info) in weighted.iter_mut().zip(gradient).zip(info) {
                *out = value * info;
            }
        }
        self.products.add(&weighted, gradients);
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
    pub(super) fn follow(&mut self, other: &Self) {
        self.loss = other.loss;
        self.gradient = other.gradient;
        self.patch_gradient.copy_from_slice(&other.patch_gradient);
    }

    /// Gradient of the parameters with the patches profiled out.
    pub(super) fn reduced_gradient(&self) -> Vector {
        self.reduced_gradient_of(self)
    }

    /// That of `other`, with the information from here.
    pub(super) fn reduced_gradient_of(&self, other: &Self) -> Vector {
        let mut gradient = other.gradient;
        let patches = self.patch_cross.chunks(BLOCK).zip(self.patch_information.chunks(BLOCK));
        for ((crosses, owns), pulls) in patches.zip(other.patch_gradient.chunks(BLOCK)) {
            let mut sums = [0.0_f32; PARAMETERS];
            for ((cross, &own), &pull) in crosses.iter().zip(owns).zip(pulls) {
                let pull = (pull / own) as f32;
                sums.iter_mut().zip(cross).for_each(|(sum, cross)| *sum += cross * pull);
            }
            gradient.iter_mut().zip(sums).for_each(|(out, sum)| *out -= f64::from(sum));
        }
        gradient
    }

    /// By how much each patch moves back with a `step` of the parameters.
    pub(super) fn patch_steps(&self, step: &Vector) -> impl Iterator<Item = f64> {
        let step: [f32; PARAMETERS] = std::array::from_fn(|i| step[i] as f32);
        let patches = self.patch_cross.iter().zip(&self.patch_information).zip(&self.patch_gradient);
        patches.map(move |((cross, own), pull)| {
            let mut followed = [0.0_f32; LANES];
            for (i, (cross, step)) in cross.iter().zip(&step).enumerate() {
                followed[i % LANES] += cross * step;
            }
            (pull - f64::from(followed.iter().sum::<f32>())) / own
        })
    }

    /// Information of the parameters with the patches profiled out.
    pub(super) fn reduced_information(&mut self) -> Matrix {
        let mut information = self.information;
        self.products.clear();
        let mut rows = [[0.0_f32; WIDTH]; COLUMNS];
        for (crosses, owns) in self.patch_cross.chunks(WIDTH).zip(self.patch_information.chunks(WIDTH)) {
            for (lane, (cross, &own)) in crosses.iter().zip(owns).enumerate() {
                let root = (1.0 / own).sqrt() as f32;
                for (row, &cross) in rows.iter_mut().zip(cross) {
                    row[lane] = cross * root;
                }
            }
            for row in &mut rows {
                row[crosses.len()..].fill(0.0);
            }
            self.products.add(&rows, &rows);
        }
        add_upper(&mut information, -1.0, self.products.totals());
        information.fill_lower_triangle_with_upper_triangle();
        information
    }
}

/// Parameters, filled up to whole tiles of products.
const COLUMNS: usize = PARAMETERS.next_multiple_of(TILE);

/// Adds `factor` times the sums of the parameters to the upper triangle of `matrix`.
fn add_upper(matrix: &mut Matrix, factor: f64, sums: &[[f64; COLUMNS]; COLUMNS]) {
    for (i, sums) in sums[..PARAMETERS].iter().enumerate() {
        for (j, &sum) in sums[..PARAMETERS].iter().enumerate().skip(i) {
            matrix[(i, j)] += factor * sum;
        }
    }
}

/// From the frame of the cells to that of the motion.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rotation {
    sin: f32,
    cos: f32,
}

impl Rotation {
    pub(super) fn between(cells: f64, motion: f64) -> Self {
        let turn = motion - cells;
        Self { sin: turn.sin() as f32, cos: turn.cos() as f32 }
    }

    pub(super) fn turn(self, s: f32, t: f32) -> (f32, f32) {
        (s * self.cos - t * self.sin, s * self.sin + t * self.cos)
    }
}

impl Response {
    pub(super) fn tabulate(&mut self, kernel: Kernel, point: &Point) {
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
    pub(super) fn score(&self, cells: &Cells, kernel: Kernel, point: &Point, with_information: bool, out: &mut Score) {
        out.clear(with_information);
        let rotation = Rotation::between(cells.angle, point.angle);
        let noise = exp(point.log_noise as f32);
        let share = if kernel == Kernel::None { 0.0 } else { exp(point.log_share as f32) };
        let amplitudes = point.scene.map(|c| c as f32);
        let falls = scene::falls(&point.scene).map(|c| c as f32);
        let mut gradients = [[0.0_f32; WIDTH]; COLUMNS];
        let mut pull = [0.0_f32; WIDTH];
        let mut info = [0.0_f32; WIDTH];
        let mut signal_share = [0.0_f32; WIDTH];
        let lattice = self.lattice();
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
                let (mut along, mut across) = ([0.0_f32; WIDTH], [0.0_f32; WIDTH]);
                let (mut places, mut beta) = ([(0_u32, 0.0_f32); WIDTH], [0.0_f32; WIDTH]);
                for (lane, (&s, &t)) in cells.s[range.clone()].iter().zip(&cells.t[range.clone()]).enumerate() {
                    let (s, t) = rotation.turn(s, t);
                    let square = s * s + t * t;
                    let x = terms[lane / LANES * LANES * TERMS + scene::LOG_RADIUS * LANES + lane % LANES];
                    let fall = falls[0] - x * (falls[1] + x * falls[2]);
                    along[lane] = if kernel == Kernel::Disk { square.sqrt() } else { s };
                    across[lane] = if kernel == Kernel::Disk { 0.0 } else { t };
                    // The table is of frequencies above 0, and even.
                    beta[lane] = fall * along[lane].abs() / square;
                    places[lane] = lattice.place(along[lane].abs());
                }
                for lane in 0..WIDTH {
                    let value = self.at_place(places[lane], beta[lane]);
                    transfer[lane] = value.power.max(LEAST_POWER);
                    d_length[lane] = value.per_log_length;
                    d_ratio2[lane] = value.per_ratio2;
                    d_angle[lane] = -across[lane] * 1.0_f32.copysign(along[lane]) * value.per_s;
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
        if with_information {
            add_upper(&mut out.information, 1.0, out.products.totals());
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
        out.information[(ANGLE, ANGLE)] += point.angle_precision;
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
    let mut sums = [0.0_f32; SUMS];
    for (a, b) in a.chunks_exact(SUMS).zip(b.chunks_exact(SUMS)) {
        for ((sum, &a), &b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    total(&sums)
}

fn sum(values: &[f32; WIDTH]) -> f32 {
    let mut sums = [0.0_f32; SUMS];
    for values in values.chunks_exact(SUMS) {
        for (sum, &value) in sums.iter_mut().zip(values) {
            *sum += value;
        }
    }
    total(&sums)
}

fn total(lanes: &[f32; SUMS]) -> f32 {
    ((lanes[0] + lanes[4]) + (lanes[1] + lanes[5])) + ((lanes[2] + lanes[6]) + (lanes[3] + lanes[7]))
}
