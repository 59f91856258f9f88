//! How much better the spectrum around a point is explained by a moving scene than by one that stands still.

use std::f64::consts::PI;

use nalgebra::{Cholesky, Const, SMatrix, SVector};
use ndarray::{Array2, ArrayView2};

use crate::estimate::AxialAngle;
use crate::image::{Region, Window};
use crate::products::{Columns, LANES, Products, TILE, WIDTH};
use crate::spectrum::{Dft2, exp, ln};

/// Frequencies used: from this many bins to this many cycles per pixel.
const LEAST_BINS: f64 = 1.6;
const MOST_FREQUENCY: f64 = 0.48;
/// Bins of the spectrum are averaged over cells: steps, in bins, of the frequency along the motion by the side of the window ...
const WIDEST_STEP_BINS: f64 = 2.0;
const SIDE_OF_WIDEST: f64 = 48.0;
const STEP_BINS: f64 = 1.5;
/// ... and borders, in bins, of the one across it.
const ACROSS_BINS: [f64; 4] = [1.5, 4.0, 8.0, 14.0];

/// Power that no blur takes away, relative to the scene's: what compression and a motion that is not quite uniform leave.
const INCOHERENT: f64 = 0.03;
/// Least variance of the noise, in squared grey levels of eight bits: that of the rounding is less than what demosaicing and
/// compression leave in textured parts, where a calm corner of the picture does not show it.
const LEAST_NOISE: f64 = 2.0;

/// Terms of the logarithm of a scene's power.
const TERMS: usize = 13;
/// The same, filled up to whole tiles of products.
const COLUMNS: usize = TERMS.next_multiple_of(TILE);
/// Largest logarithm of a scene's power that counts.
const MOST_LOG: f32 = 50.0;
/// Means and standard deviations of the terms before anything is seen; the level is free. With `l = ln 8 f` they are 1, `-l`,
/// then cosine and sine of twice and of four times the direction, `l^2`, `l` times those of twice, of six times the direction,
/// `l` times those of four times. A scene may be quite anisotropic before the evidence is that it moves.
const MEAN: [f64; TERMS] = [0.0, 2.4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
const STD: [f64; TERMS] = [100.0, 0.6, 0.5, 0.5, 0.4, 0.4, 0.3, 0.3, 0.3, 0.3, 0.3, 0.2, 0.2];

/// Steps of a fit at most, the longest step of a term, and the gain of the likelihood's logarithm that is not worth a step.
const STEPS: usize = 8;
const LONGEST_STEP: f64 = 1.5;
const LEAST_GAIN: f64 = 0.05;
/// A step that gains less is taken with the curvature of another point, or of the one next to it.
const SMALL_GAIN: f64 = 5.0;

/// Cells of the spectrum of a small window for one motion.
#[derive(Debug)]
pub(super) struct Cells {
    side: usize,
    /// What the logarithm of the likelihood of a bin counts: neighbouring bins are not independent.
    tempering: f64,
    window: Vec<f32>,
    /// Bins of the half spectrum that are used, each with its cell.
    bins: Vec<(usize, usize)>,
    groups: Vec<Group>,
}

/// Cells side by side; the last group is filled up with some that hold no bins.
#[derive(Debug, Clone)]
struct Group {
    /// Column by column.
    terms: Columns<COLUMNS>,
    /// Power transfer of the motion, seen through the window.
    transfer: [f32; WIDTH],
    bins: [f32; WIDTH],
}

/// What a thread needs to look at one point after the other.
#[derive(Debug)]
pub(super) struct Workspace {
    dft: Dft2,
    /// Of each cell, as many as the groups hold.
    powers: Vec<f32>,
    products: Products<COLUMNS>,
    /// The last point's scene if it stood still, and if it moved: a neighbour is much like it.
    last: [Start; 2],
}

/// Where a fit starts from, and where it ends.
#[derive(Debug)]
struct Start {
    /// Amplitudes of the scene.
    terms: [f64; TERMS],
    /// Curvature there or nearby.
    curvature: Option<Cholesky<f64, Const<TERMS>>>,
}

impl Cells {
    /// For a Hann window of `side` pixels and a motion of `length_px` along `angle`.
    pub(super) fn new(side: usize, tempering: f64, length_px: f64, angle: AxialAngle) -> Self {
        let (sin, cos) = angle.rad().sin_cos();
        let n = side as f64;
        let along_step = if n > SIDE_OF_WIDEST { WIDEST_STEP_BINS } else { STEP_BINS };
        let mut keys: Vec<(i64, i64)> = Vec::new();
        let mut sums: Vec<([f64; TERMS], f64, f64, f64)> = Vec::new();
        let mut bins = Vec::new();
        for row in 0..side {
            for column in 0..=side / 2 {
                // Every frequency once: of those on the axis of the columns, half are conjugates of the others.
                if column == 0 && row > side / 2 {
                    continue;
                }
                let down = if row > side / 2 { row as f64 - n } else { row as f64 } / n;
                let (fx, fy) = (column as f64 / n, -down);
                let frequency = fx.hypot(fy);
                if frequency * n < LEAST_BINS || frequency > MOST_FREQUENCY {
                    continue;
                }
                let (along, across) = (fx * cos + fy * sin, fy * cos - fx * sin);
                let across = if along < 0.0 { -across } else { across };
                let border = ACROSS_BINS.iter().filter(|&&border| across.abs() * n >= border).count() as i64 + 1;
                let key = ((along.abs() * n / along_step) as i64, if across < 0.0 { -border } else { border });
                let cell = keys.iter().position(|&other| other == key).unwrap_or_else(|| {
                    keys.push(key);
                    sums.push(([0.0; TERMS], 0.0, 0.0, 0.0));
                    keys.len() - 1
                });
                bins.push((row * (side / 2 + 1) + column, cell));
                let terms = terms(frequency, fy.atan2(fx));
                let sum = &mut sums[cell];
                sum.0.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
                let power = frequency.powf(-MEAN[1]);
                sum.1 += power * seen_through(along.abs(), length_px, (cos.abs() / n, sin.abs() / n));
                sum.2 += power;
                sum.3 += 1.0;
            }
        }
        let empty = Group { terms: [[0.0; WIDTH]; COLUMNS], transfer: [1.0; WIDTH], bins: [0.0; WIDTH] };
        let mut groups = vec![empty; sums.len().div_ceil(WIDTH)];
        for (cell, (terms, transfer, power, bins)) in sums.into_iter().enumerate() {
            let (group, lane) = (&mut groups[cell / WIDTH], cell % WIDTH);
            for (column, term) in group.terms.iter_mut().zip(terms) {
                column[lane] = (term / bins) as f32;
            }
            group.transfer[lane] = (((transfer / power).max(0.0) + INCOHERENT) / (1.0 + INCOHERENT)) as f32;
            group.bins[lane] = bins as f32;
        }
        Self { side, tempering, window: Window::Hann.weights(side), bins, groups }
    }

    pub(super) fn workspace(&self) -> Workspace {
        let dft = Dft2::new(self.side, self.side);
        Workspace {
            dft,
            powers: vec![0.0; WIDTH * self.groups.len()],
            products: Products::new(),
            last: [Start::new(), Start::new()],
        }
    }

    /// Logarithm of the ratio of the likelihoods with the motion and without, around the pixel `(row, column)`, or as near to it
    /// as the window fits into the picture; 0 for a picture that it does not fit into.
    pub(super) fn evidence(
        &self,
        workspace: &mut Workspace,
        image: ArrayView2<'_, f32>,
        noise_variance: f64,
        (row, column): (usize, usize),
    ) -> f32 {
        let near = |at: usize, pixels: usize| at.saturating_sub(self.side / 2).min(pixels.saturating_sub(self.side));
        let (rows, columns) = image.dim();
        let around = Region { x: near(column, columns), y: near(row, rows), width: self.side, height: self.side };
        let Ok(view) = around.of(image) else {
            return 0.0;
        };
        self.measure(workspace, view, noise_variance.max(LEAST_NOISE));
        let Workspace { powers, products, last: [last_still, last_moving], .. } = workspace;
        let still = self.fit(products, powers, |_| &[1.0; WIDTH], last_still);
        let moving = self.fit(products, powers, |group| &group.transfer, last_moving);
        (moving - still) as f32
    }

    /// Mean power of each cell relative to that of the noise.
    fn measure(&self, workspace: &mut Workspace, view: ArrayView2<'_, f32>, noise_variance: f64) {
        let input: &mut Array2<f32> = workspace.dft.input();
        let mut mean = 0.0;
        for ((from, mut to), &down) in view.rows().into_iter().zip(input.rows_mut()).zip(&self.window) {
            let mut sums = [0.0; LANES];
            for (i, ((to, &from), &across)) in to.iter_mut().zip(from).zip(&self.window).enumerate() {
                *to = from;
                sums[i % LANES] += across * from;
            }
            mean += down * sums.iter().sum::<f32>();
        }
        let sum: f32 = self.window.iter().sum();
        let squares: f32 = self.window.iter().map(|weight| weight * weight).sum();
        mean /= sum * sum;
        for (mut row, &down) in input.rows_mut().into_iter().zip(&self.window) {
            row.iter_mut().zip(&self.window).for_each(|(value, &across)| *value = (*value - mean) * down * across);
        }
        let scale = 1.0 / (noise_variance as f32 * squares * squares);
        workspace.powers.fill(0.0);
        let spectrum = workspace.dft.transform();
        if let Some(spectrum) = spectrum.as_slice() {
            for &(bin, cell) in &self.bins {
                workspace.powers[cell] += scale * spectrum[bin].norm_sqr();
            }
        }
        let bins = self.groups.iter().flat_map(|group| &group.bins);
        workspace.powers.iter_mut().zip(bins).for_each(|(power, bins)| *power /= bins.max(1.0));
    }

    /// Logarithm of the largest posterior density of a scene whose power is `transfer` times a log-linear model, over noise of
    /// power 1. Starts from `at`, but for the level, and leaves there what was found.
    fn fit(
        &self,
        products: &mut Products<COLUMNS>,
        powers: &[f32],
        transfer: impl Fn(&Group) -> &[f32; WIDTH],
        at: &mut Start,
    ) -> f64 {
        at.terms[0] = 0.0;
        at.terms[0] = self.level(powers, &transfer, &at.terms);
        let (mut best, mut last) = (f64::NEG_INFINITY, SVector::zeros());
        for _ in 0..STEPS {
            let (posterior, slope) = self.slope(&at.terms, powers, &transfer);
            if posterior < best {
                // Too far.
                last *= 0.5;
                at.terms.iter_mut().zip(&last).for_each(|(term, step)| *term -= step);
                continue;
            }
            // Where there is no scene above the noise its level falls without end.
            if posterior - best < LEAST_GAIN {
                return posterior;
            }
            best = posterior;
            let mut step = at.curvature.as_ref().map(|root| root.solve(&slope));
            if step.is_none_or(|step| 0.5 * slope.dot(&step) > SMALL_GAIN) {
                at.curvature = self.curvature(products, &at.terms, powers, &transfer).cholesky();
                step = at.curvature.as_ref().map(|root| root.solve(&slope));
            }
            let Some(step) = step else { break };
            let gain = 0.5 * slope.dot(&step);
            if gain < LEAST_GAIN {
                return posterior + gain;
            }
            last = step * (LONGEST_STEP / step.amax()).min(1.0);
            at.terms.iter_mut().zip(&last).for_each(|(term, step)| *term += step);
        }
        // Nowhere to start from.
        *at = Start::new();
        best
    }

    /// The level at which a scene of this shape has the power that was measured above the noise, or somewhat more: from below,
    /// steps would be long ones.
    fn level(&self, powers: &[f32], transfer: impl Fn(&Group) -> &[f32; WIDTH], shape: &[f64; TERMS]) -> f64 {
        let (mut measured, mut expected, mut bins) = (0.0, 0.0, 0.0);
        for (group, powers) in self.groups.iter().zip(powers.as_chunks::<WIDTH>().0) {
            let scene = group.scene(shape, transfer(group));
            for lane in 0..WIDTH {
                let count = group.bins[lane];
                measured += f64::from(count * (powers[lane] - 1.0).max(0.0));
                expected += f64::from(count * scene[lane]);
                bins += f64::from(count);
            }
        }
        (measured.max(1e-3 * bins) / expected).ln()
    }

    /// Logarithm of the posterior density of exponentially distributed powers, and its slope.
    fn slope(
        &self,
        terms: &[f64; TERMS],
        powers: &[f32],
        transfer: impl Fn(&Group) -> &[f32; WIDTH],
    ) -> (f64, SVector<f64, TERMS>) {
        let mut likelihood = 0.0;
        let mut slope = [0.0; TERMS];
        for (group, powers) in self.groups.iter().zip(powers.as_chunks::<WIDTH>().0) {
            let scene = group.scene(terms, transfer(group));
            let (mut pull, mut losses) = ([0.0_f32; WIDTH], [0.0_f32; WIDTH]);
            for lane in 0..WIDTH {
                let (scene, bins) = (scene[lane], group.bins[lane]);
                let inverse = 1.0 / (scene + 1.0);
                let ratio = powers[lane] * inverse;
                losses[lane] = bins * (ln(scene + 1.0) + ratio);
                pull[lane] = bins * scene * inverse * (ratio - 1.0);
            }
            likelihood -= f64::from(losses.iter().sum::<f32>());
            for (slope, terms) in slope.iter_mut().zip(&group.terms) {
                *slope += f64::from(dot(&pull, terms));
            }
        }
        let mut posterior = self.tempering * likelihood;
        for (term, slope) in slope.iter_mut().enumerate() {
            let (off, weight) = (terms[term] - MEAN[term], 1.0 / (STD[term] * STD[term]));
            posterior -= 0.5 * weight * off * off;
            *slope = self.tempering * *slope - weight * off;
        }
        (posterior, slope.into())
    }

    /// The curvature of that density: that expected, and more in cells that have more power than expected, where a step would
    /// lead too far.
    fn curvature(
        &self,
        products: &mut Products<COLUMNS>,
        terms: &[f64; TERMS],
        powers: &[f32],
        transfer: impl Fn(&Group) -> &[f32; WIDTH],
    ) -> SMatrix<f64, TERMS, TERMS> {
        products.clear();
        let mut weighted = [[0.0_f32; WIDTH]; COLUMNS];
        for (group, powers) in self.groups.iter().zip(powers.as_chunks::<WIDTH>().0) {
            let scene = group.scene(terms, transfer(group));
            let mut weights = [0.0_f32; WIDTH];
            for lane in 0..WIDTH {
                let inverse = 1.0 / (scene[lane] + 1.0);
                let share = scene[lane] * inverse;
                weights[lane] = group.bins[lane] * share * share * (powers[lane] * inverse).max(1.0);
            }
            for (weighted, terms) in weighted.iter_mut().zip(&group.terms) {
                for ((out, term), weight) in weighted.iter_mut().zip(terms).zip(&weights) {
                    *out = term * weight;
                }
            }
            products.add(&weighted, &group.terms);
        }
        let sums = products.totals();
        SMatrix::from_fn(|i, j| {
            let prior = if i == j { 1.0 / (STD[i] * STD[i]) } else { 0.0 };
            self.tempering * sums[i.min(j)][i.max(j)] + prior
        })
    }
}

impl Start {
    /// What is expected before anything is seen.
    fn new() -> Self {
        Self { terms: MEAN, curvature: None }
    }
}

impl Group {
    /// Power of a scene with these amplitudes, as `transfer` lets it through.
    fn scene(&self, amplitudes: &[f64; TERMS], transfer: &[f32; WIDTH]) -> [f32; WIDTH] {
        let mut sums = [0.0; WIDTH];
        for (column, &amplitude) in self.terms.iter().zip(amplitudes) {
            let amplitude = amplitude as f32;
            for (sum, &term) in sums.iter_mut().zip(column) {
                *sum += amplitude * term;
            }
        }
        for (sum, transfer) in sums.iter_mut().zip(transfer) {
            *sum = exp(sum.min(MOST_LOG)) * transfer;
        }
        sums
    }
}

/// Sum of products.
fn dot(a: &[f32; WIDTH], b: &[f32; WIDTH]) -> f32 {
    let mut sums = [0.0_f32; LANES];
    for (a, b) in a.as_chunks::<LANES>().0.iter().zip(b.as_chunks::<LANES>().0) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3])
}

/// The terms at a frequency in cycles per pixel and a direction in radians.
fn terms(frequency: f64, direction: f64) -> [f64; TERMS] {
    let l = (8.0 * frequency).ln();
    let wave = |times: f64| (times * direction).sin_cos();
    let ((s2, c2), (s4, c4), (s6, c6)) = (wave(2.0), wave(4.0), wave(6.0));
    [1.0, -l, c2, s2, c4, s4, l * l, l * c2, l * s2, c6, s6, l * c4, l * s4]
}

/// Power transfer of a blur of `length_px` at the frequency `along` it, seen through a Hann window that is `(1/a, 1/b)` times
/// as wide and high as a step of one pixel along the motion: the autocorrelation of the blur, a triangle along the motion,
/// times that of the window, transformed.
fn seen_through(along: f64, length_px: f64, (a, b): (f64, f64)) -> f64 {
    const INTERVALS: usize = 64;
    let at = |lag_px: f64| {
        (1.0 - lag_px / length_px)
            * hann_autocorrelation(lag_px * a)
            * hann_autocorrelation(lag_px * b)
            * (2.0 * PI * along * lag_px).cos()
    };
    // Simpson's rule; the autocorrelation is even.
    let step = length_px / INTERVALS as f64;
    let sum: f64 = (0..=INTERVALS)
        .map(|i| {
            let weight = if i == 0 || i == INTERVALS { 1.0 } else { 2.0 + 2.0 * (i % 2) as f64 };
            weight * at(i as f64 * step)
        })
        .sum();
    2.0 / length_px * sum * step / 3.0
}

/// Autocorrelation of a Hann window at a lag relative to its length, 1 at lag 0.
fn hann_autocorrelation(lag: f64) -> f64 {
    if lag >= 1.0 {
        return 0.0;
    }
    let (sin, cos) = (2.0 * PI * lag).sin_cos();
    (1.0 - lag) * (2.0 + cos) / 3.0 + sin / (2.0 * PI)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: usize = 64;

    /// Grey values drawn independently, each the mean of those `length` to its right.
    fn picture(length: usize) -> Array2<f32> {
        let mut state = 7_u64;
        let scene = Array2::from_shape_simple_fn((SIDE, SIDE + length), || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            100.0 * (state >> 40) as f32 / (1_u64 << 24) as f32
        });
        Array2::from_shape_fn((SIDE, SIDE), |(row, column)| {
            (0..length).map(|i| scene[(row, column + i)]).sum::<f32>() / length as f32
        })
    }

    fn evidence(picture: &Array2<f32>, length_px: f64, deg: f64) -> f32 {
        let cells = Cells::new(SIDE, 0.25, length_px, AxialAngle::from_deg(deg));
        cells.evidence(&mut cells.workspace(), picture.view(), 1.0, (SIDE / 2, SIDE / 2))
    }

    #[test]
    fn a_blurred_scene_is_told_from_a_sharp_one_and_its_motion_from_others() {
        let (blurred, sharp) = (picture(12), picture(1));
        let right = evidence(&blurred, 12.0, 0.0);
        assert!(right > 20.0, "{right}");
        for (length_px, deg) in [(12.0, 90.0), (12.0, 30.0), (12.0, 150.0), (6.0, 0.0), (24.0, 0.0)] {
            let wrong = evidence(&blurred, length_px, deg);
            assert!(right > wrong + 10.0, "{length_px} px, {deg} deg: {wrong}, {right}");
        }
        for deg in [0.0, 45.0, 90.0] {
            let wrong = evidence(&sharp, 12.0, deg);
            assert!(wrong < -20.0, "{deg} deg: {wrong}");
        }
    }

    #[test]
    fn the_evidence_is_the_same_wherever_its_fits_start() {
        let cells = Cells::new(SIDE, 0.25, 12.0, AxialAngle::from_deg(0.0));
        // From far above the noise to hardly above it.
        for contrast in [1.0_f32, 0.2, 0.1, 0.05] {
            let [blurred, sharp] = [picture(12), picture(1)].map(|picture| picture * contrast);
            let look = |workspace: &mut Workspace, picture: &Array2<f32>| {
                cells.evidence(workspace, picture.view(), LEAST_NOISE, (SIDE / 2, SIDE / 2))
            };
            let mut workspace = cells.workspace();
            let cold = look(&mut workspace, &blurred);
            let other = look(&mut workspace, &sharp);
            let warm = look(&mut workspace, &blurred);
            // The fit of either hypothesis ends within a few times the gain that is not worth a step.
            assert!((warm - cold).abs() < 0.4, "{contrast}: {cold} {warm}, {other} between");
        }
    }

    #[test]
    fn noise_alone_tells_nothing() {
        let calm = Array2::from_elem((SIDE, SIDE), 40.0);
        assert!(evidence(&calm, 12.0, 20.0).abs() < 0.5);
        // A window that does not fit into the picture sees nothing.
        let cells = Cells::new(SIDE, 0.25, 12.0, AxialAngle::from_deg(0.0));
        let small = Array2::from_elem((SIDE - 1, SIDE), 1.0);
        assert_eq!(cells.evidence(&mut cells.workspace(), small.view(), 1.0, (10, 10)), 0.0);
    }

    #[test]
    fn the_transfer_through_a_wide_window_is_that_of_the_blur() {
        for along in [0.003, 0.02, 0.05, 0.11] {
            let phase = PI * along * 20.0;
            let expected = (phase.sin() / phase).powi(2);
            let seen = seen_through(along, 20.0, (0.0, 0.0));
            assert!((seen - expected).abs() < 1e-4, "{along}: {seen} {expected}");
        }
    }

    #[test]
    fn the_autocorrelation_of_the_window_is_the_sum_of_its_products() {
        let n = 512;
        let weights = Window::Hann.weights(n);
        let sum = |lag: usize| weights.iter().zip(&weights[lag..]).map(|(a, b)| f64::from(a * b)).sum::<f64>();
        for lag in [0, 40, 200, 400, 511] {
            let expected = sum(lag) / sum(0);
            assert!((hann_autocorrelation(lag as f64 / n as f64) - expected).abs() < 2e-3, "{lag}");
        }
    }
}
