//! The search for the maximum of the likelihood.

use nalgebra::{Cholesky, Const};

use super::cells::{Cells, OCTAVES, octave_of, patch_of};
use super::descent::Descent;
use super::likelihood::{LEAST_POWER, Matrix, Rotation, Score, Vector};
use super::periodogram::{CellSums, FALL, Periodogram};
use super::point::{
    ANGLE, Kernel, LEAST_ROUGHNESS, LEAST_TOLD, LENGTH, NOISE, PARAMETERS, Point, RATIO2, ROUGHNESS, ROUGHNESS_COUNTS,
    SCENE, SHARE,
};
use super::response::Response;
use super::scene::{self, TERMS};
use crate::products::LANES;
use crate::spectrum::{exp, ln};

/// A kernel, the cells it is held against and everything that the search for the maximum needs.
#[derive(Debug)]
pub(super) struct Fit {
    response: Response,
    score: Score,
    trial: Score,
    candidate: Point,
}

/// How far a search for the maximum goes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Effort {
    /// Most steps.
    pub(super) steps: usize,
    /// A step that gains less log-likelihood is the last.
    pub(super) least_gain: f64,
    /// Whether the information at the end counts, and not the likelihood alone.
    pub(super) informs: bool,
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
    /// For spectra such as those of `periodogram`.
    pub(super) fn new(periodogram: &Periodogram) -> Self {
        let (rows, columns) = periodogram.dim();
        let response = Response::new(rows.max(columns), periodogram.lobe_bins());
        Self { response, score: Score::new(), trial: Score::new(), candidate: Point::new() }
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
                Kernel::Disk => self.response.at((s * s + t * t).sqrt(), 0.0).power + share,
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

    /// From `point` to the maximum by Fisher scoring, with limited effort.
    ///
    /// The expected information is computed at the start, anew after long steps, and at the end if it counts. In between the
    /// gradients tell how the likelihood curves: where the model does not fit, it may curve more than expected.
    pub(super) fn maximise(&mut self, cells: &Cells, kernel: Kernel, point: &mut Point, effort: Effort) -> Maximum {
        self.climb(cells, kernel, point, effort, &[])
    }

    /// As [`maximise`](Self::maximise), at the length, the angle and the acceleration that `point` has.
    pub(super) fn profile(&mut self, cells: &Cells, kernel: Kernel, point: &mut Point, effort: Effort) -> Maximum {
        self.climb(cells, kernel, point, effort, &[LENGTH, ANGLE, RATIO2])
    }

    fn climb(&mut self, cells: &Cells, kernel: Kernel, point: &mut Point, effort: Effort, held: &[usize]) -> Maximum {
        let Effort { steps, least_gain, informs } = effort;
        self.tabulate(kernel, point);
        self.response.score(cells, kernel, point, true, &mut self.score);
        let mut descent = Descent::new(&self.score.reduced_information(), held);
        for _ in 0..steps {
            let gradient = descent.free(self.score.reduced_gradient());
            let Some(step) = descent.step(&gradient) else { break };
            let expected = 0.5 * step.dot(&gradient);
            self.candidate.copy(point);
            advance(&mut self.candidate, &step, &self.score, descent.share);
            self.response.tabulate(kernel, &self.candidate);
            self.response.score(cells, kernel, &self.candidate, false, &mut self.trial);
            let gained = self.score.loss - self.trial.loss;
            // Long steps lead from one curvature to another.
            let is_near = expected <= LARGE;
            if is_near {
                let change = descent.free(self.score.reduced_gradient_of(&self.trial)) - gradient;
                descent.learn(&descent.free(self.candidate.parameters() - point.parameters()), &change);
            }
            if gained > 0.0 {
                point.copy(&self.candidate);
                self.score.follow(&self.trial);
                descent.accept();
                if gained.max(expected) < least_gain {
                    break;
                }
                if !is_near {
                    self.response.score(cells, kernel, point, true, &mut self.score);
                    descent.renew(&self.score.reduced_information());
                }
            } else {
                if expected < least_gain || descent.is_lost() {
                    break;
                }
                if is_near {
                    descent.shorten(gained, 2.0 * expected);
                } else {
                    descent.damp();
                }
            }
        }
        if informs && !descent.is_fresh {
            self.tabulate(kernel, point);
            self.response.score(cells, kernel, point, true, &mut self.score);
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
    pub(super) fn covariance(&mut self) -> Option<Covariance> {
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

    /// What the model expects of a whitened power at the frequency `(u, v)` in cycles per pixel: that of the blurred
    /// scene, and that of the noise. [`tabulate`](Self::tabulate) comes first.
    pub(super) fn expected(&self, kernel: Kernel, point: &Point, u: f64, v: f64) -> (f64, f64) {
        let (sin, cos) = point.angle.sin_cos();
        let (s, square) = (u * cos - v * sin, u * u + v * v);
        let falls = scene::falls(&point.scene);
        let x = 0.5 * (100.0 * square).ln();
        let fall = falls[0] - x * (falls[1] + x * falls[2]);
        let along = if kernel == Kernel::Disk { square.sqrt() } else { s };
        let transfer = match kernel {
            Kernel::None => 1.0,
            _ => f64::from(self.response.at(along as f32, (fall * along / square) as f32).power.max(LEAST_POWER)),
        };
        let share = if kernel == Kernel::None { 0.0 } else { point.log_share.exp() };
        let smooth: f64 = scene::terms(u, v).iter().zip(&point.scene).map(|(term, c)| term * c).sum();
        let scene = (smooth + point.patches[patch_of(u, v)]).exp();
        let noise = point.log_noise.exp() * (10.0 * square.sqrt()).powf(FALL);
        (scene * (transfer + share), noise)
    }

    /// Fills the table of the kernel's response for `point`.
    pub(super) fn tabulate(&mut self, kernel: Kernel, point: &Point) {
        self.response.tabulate(kernel, point);
    }
}

/// A step that promises more than this is a long one: the information is computed anew after it.
const LARGE: f64 = 5.0;

/// Moves `point` against a `share` of `step`, and the patches with it, within limits that keep the quadratic model honest.
fn advance(point: &mut Point, step: &Vector, score: &Score, share: f64) {
    let within = |i: usize, limit: f64| (share * step[i]).clamp(-limit, limit);
    point.length *= (-within(LENGTH, 0.15)).exp();
    point.angle -= within(ANGLE, 0.08);
    point.log_noise -= within(NOISE, 1.0);
    point.log_share = (point.log_share - within(SHARE, 1.0)).clamp(-20.0, 3.0);
    point.ratio2 = (point.ratio2 - within(RATIO2, 0.2)).clamp(0.0, 1.0);
    for (k, amplitude) in point.scene.iter_mut().enumerate() {
        *amplitude -= share * step[SCENE + k];
    }
    for (deviation, own) in point.patches.iter_mut().zip(score.patch_steps(step)) {
        *deviation -= (share * own).clamp(-1.0, 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::super::periodogram::MOST_FREQUENCY;
    use super::super::testing::Random;
    use super::*;
    use crate::image::Window;

    const KERNELS: [Kernel; 4] = [Kernel::None, Kernel::Line, Kernel::AcceleratedLine, Kernel::Disk];
    const EFFORT: Effort = Effort { steps: 40, least_gain: 1e-3, informs: true };

    /// Everything that a fit to one spectrum needs.
    struct Bench {
        periodogram: Periodogram,
        sums: CellSums,
        cells: Cells,
        fit: Fit,
    }

    impl Bench {
        fn new(rows: usize, columns: usize) -> Self {
            let sums = CellSums::new(rows.max(columns));
            let periodogram = Periodogram::new(rows, columns, Window::Tukey { taper: 0.25 });
            Self { cells: Cells::new(sums.capacity()), fit: Fit::new(&periodogram), sums, periodogram }
        }

        fn gather(&mut self, angle: f64, noise: f64) {
            self.periodogram.gather(angle, 1, MOST_FREQUENCY, &mut self.sums);
            self.cells.set(&self.sums, self.periodogram.independence(), noise as f32);
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
            let mut score = bench.score(kernel, &point);
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
}
