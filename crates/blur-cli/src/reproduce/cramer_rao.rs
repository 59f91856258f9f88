//! The Cramér-Rao bound of angle and length: how well they can be known from one picture.
//!
//! The bins of the Fourier transform of a Gaussian random field are independent, and each periodogram value is
//! exponentially distributed about `E(u, v) = A f^-b T(u, v) + s2`: a power law, the squared transfer function of the
//! blur, white noise. The log-likelihood is Whittle's, `-sum [log E + P / E]` over half of the plane, and its expected
//! information is `sum grad log E (grad log E)^T`. The parameters are the length, the angle, `log A`, `b` and `log s2`;
//! the bound of the first two is the inverse of what is left of the information when the other three are profiled out.
//!
//! A window correlates neighbouring bins. The variance of whatever is estimated from them rises by
//! [`Window::variance_factor`] in each direction, and the dark lines of the blur fill up: `T` is no longer `sinc²(L s)`
//! but its convolution with the spectrum of the window, which is taken into account along the motion, for a scene whose
//! power hardly changes over the width of that spectrum.
//!
//! # Reference
//! Whittle, *Estimation and information in stationary time series*, Arkiv för Matematik 2 (1953) 423; Dahlhaus, *Small
//! sample effects in time series analysis*, Annals of Statistics 16 (1988) 808, for tapers.

use blur_core::estimate::AxialAngle;
use blur_core::image::Window;
use blur_core::psf::sinc;

/// A random field with noise: `amplitude f^-exponent + noise_variance` at `f` cycles per pixel, as the mean of
/// `|FFT|² / pixels`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerLaw {
    /// Power at one cycle per pixel.
    pub amplitude: f64,
    /// Exponent `b`.
    pub exponent: f64,
    /// Variance of the white noise.
    pub noise_variance: f64,
}

/// The least standard uncertainties of an unbiased estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// Of the angle in degrees.
    pub angle_std_deg: f64,
    /// Of the length in pixels.
    pub length_std_px: f64,
    /// Correlation coefficient of both.
    pub correlation: f64,
}

/// The bound for a picture of `rows` x `cols` pixels of the field `scene`, blurred by a uniform motion of `length_px`
/// pixels along `angle`; `window` is laid over the picture before the transform, and with `None` every bin counts fully
/// and the dark lines stay dark. `None` where the picture does not determine the parameters.
pub fn cramer_rao(
    (rows, cols): (usize, usize),
    scene: &PowerLaw,
    angle: AxialAngle,
    length_px: f64,
    window: Option<Window>,
) -> Option<Bound> {
    let transfer = |length_px: f64, rad: f64| Transfer::new((rows, cols), length_px, rad, window);
    let (rad, step_px, step_rad) = (angle.rad(), RELATIVE_STEP * length_px, RELATIVE_STEP);
    let here = transfer(length_px, rad);
    let (longer, shorter) = (transfer(length_px + step_px, rad), transfer(length_px - step_px, rad));
    let (left, right) = (transfer(length_px, rad + step_rad), transfer(length_px, rad - step_rad));
    let mut information = [[0.0; PARAMETERS]; PARAMETERS];
    for row in 0..rows {
        let v = frequency(row, rows);
        for col in 0..cols {
            let u = frequency(col, cols);
            if row == 0 && col == 0 {
                continue;
            }
            let log_f = u.hypot(v).ln();
            let power = scene.amplitude * (-scene.exponent * log_f).exp();
            let signal = power * here.at(u, v);
            let expected = signal + scene.noise_variance;
            let slope = |above: &Transfer, below: &Transfer, step: f64| {
                power * (above.at(u, v) - below.at(u, v)) / (2.0 * step) / expected
            };
            let gradient = [
                signal / expected,
                -log_f * signal / expected,
                scene.noise_variance / expected,
                slope(&longer, &shorter, step_px),
                slope(&left, &right, step_rad),
            ];
            for (i, line) in information.iter_mut().enumerate() {
                for (j, sum) in line.iter_mut().enumerate() {
                    // Every bin has its conjugate twin in the other half of the plane.
                    *sum += 0.5 * gradient[i] * gradient[j];
                }
            }
        }
    }
    let variance_factor = window.map_or(1.0, |window| window.variance_factor(rows) * window.variance_factor(cols));
    bound_from(&information, variance_factor)
}

/// Amplitude, exponent, noise; then length and angle.
const PARAMETERS: usize = 5;
const NUISANCES: usize = 3;

/// Step of the derivatives, as a share of the length and in radians: in `sinc²` at most 60 cycles per path it errs by
/// `(2 pi 60 1e-4)² / 6 = 2e-4` of the derivative.
const RELATIVE_STEP: f64 = 1e-4;

fn frequency(index: usize, n: usize) -> f64 {
    let signed = if 2 * index > n { index as f64 - n as f64 } else { index as f64 };
    signed / n as f64
}

/// The nuisances stand first in the triangular factor, so its last block alone is the factor of their Schur complement.
fn bound_from(information: &[[f64; PARAMETERS]; PARAMETERS], variance_factor: f64) -> Option<Bound> {
    let factor = cholesky(information)?;
    let (a, b, c) =
        (factor[NUISANCES][NUISANCES], factor[NUISANCES + 1][NUISANCES], factor[NUISANCES + 1][NUISANCES + 1]);
    // The inverse of [[a², ab], [ab, b² + c²]], whose determinant is a² c².
    let (length, angle, both) = ((b * b + c * c) / (a * a * c * c), 1.0 / (c * c), -b / (a * c * c));
    Some(Bound {
        angle_std_deg: (variance_factor * angle).sqrt().to_degrees(),
        length_std_px: (variance_factor * length).sqrt(),
        correlation: both / (length * angle).sqrt(),
    })
}

/// The lower triangular factor; `None` for a matrix that is not positive definite.
fn cholesky(matrix: &[[f64; PARAMETERS]; PARAMETERS]) -> Option<[[f64; PARAMETERS]; PARAMETERS]> {
    let mut factor = [[0.0; PARAMETERS]; PARAMETERS];
    for i in 0..PARAMETERS {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
            let rest = matrix[i][j] - known;
            if i == j {
                // Relative to the element itself, what is left of a singular matrix is rounding.
                if rest.is_nan() || rest <= 1e-12 * matrix[i][i] {
                    return None;
                }
                factor[i][i] = rest.sqrt();
            } else {
                factor[i][j] = rest / factor[j][j];
            }
        }
    }
    Some(factor)
}

/// The expected squared transfer function of one blur in one picture.
struct Transfer {
    length_px: f64,
    direction: (f64, f64),
    /// What the window takes from `sinc²(z)` at `z = 0, 1/64, ...` cycles per path; empty without a window.
    loss: Vec<f64>,
}

impl Transfer {
    const NODES_PER_CYCLE: f64 = 64.0;
    const QUADRATURE: usize = 512;

    fn new((rows, cols): (usize, usize), length_px: f64, rad: f64, window: Option<Window>) -> Self {
        let (sin, cos) = rad.sin_cos();
        let direction = (cos, -sin);
        let Some(window) = window else { return Self { length_px, direction, loss: Vec::new() } };
        let (across, down) =
            (Overlap::new(window, cols, length_px * cos.abs()), Overlap::new(window, rows, length_px * sin.abs()));
        // Expectation of the windowed periodogram along the motion: the transform of the autocorrelation of the path,
        // (1 - q) for a shift by the share q of it, times that of the window, of which 1 is left for sinc².
        let missing: Vec<f64> = (0..=Self::QUADRATURE)
            .map(|i| {
                let shift_px = length_px * i as f64 / Self::QUADRATURE as f64;
                let q = i as f64 / Self::QUADRATURE as f64;
                (1.0 - q) * (1.0 - across.at(shift_px * cos.abs()) * down.at(shift_px * sin.abs()))
            })
            .collect();
        let last = 0.5 * (cos.abs() + sin.abs()) * length_px * Self::NODES_PER_CYCLE;
        let nodes = 0..last.ceil() as usize + 3;
        let loss = nodes.map(|node| cosine_integral(&missing, node as f64 / Self::NODES_PER_CYCLE)).collect();
        Self { length_px, direction, loss }
    }

    fn at(&self, u: f64, v: f64) -> f64 {
        let z = (self.length_px * (u * self.direction.0 + v * self.direction.1)).abs();
        let sharp = sinc(z).powi(2);
        // What is left of cancellation is not negative.
        if self.loss.is_empty() { sharp } else { (sharp - self.loss_at(z * Self::NODES_PER_CYCLE)).max(0.0) }
    }

    /// Cubic interpolation; the loss is even about 0.
    fn loss_at(&self, node: f64) -> f64 {
        let first = node.floor();
        let (i, t) = (first as usize, node - first);
        let value = |i: usize| self.loss.get(i).copied().unwrap_or(0.0);
        let [a, b, c, d] = [value(if i == 0 { 1 } else { i - 1 }), value(i), value(i + 1), value(i + 2)];
        let (s, w, r) = (t + 1.0, t - 1.0, t - 2.0);
        -a * t * w * r / 6.0 + b * s * w * r / 2.0 - c * s * t * r / 2.0 + d * s * t * w / 6.0
    }
}

/// `2 ∫ f(q) cos(2 pi z q) dq` over `q` from 0 to 1 by the trapezoidal rule, for an `f` that is 0 at both ends.
fn cosine_integral(f: &[f64], z: f64) -> f64 {
    let n = (f.len() - 1) as f64;
    // cos((k + 1) x) = 2 cos(x) cos(k x) - cos((k - 1) x)
    let step = (2.0 * std::f64::consts::PI * z / n).cos();
    let (mut before, mut now, mut sum) = (step, 1.0, 0.0);
    for value in f {
        sum += value * now;
        (before, now) = (now, 2.0 * step * now - before);
    }
    2.0 * sum / n
}

/// The autocorrelation of a window of `n` samples, 1 at no shift.
struct Overlap(Vec<f64>);

impl Overlap {
    /// For shifts up to `longest_px`.
    fn new(window: Window, n: usize, longest_px: f64) -> Self {
        let weights: Vec<f64> = (0..n).map(|i| window.weight(i, n)).collect();
        let at = |shift: usize| weights.iter().zip(weights.iter().skip(shift)).map(|(a, b)| a * b).sum::<f64>();
        let whole = at(0);
        Self((0..longest_px.ceil() as usize + 2).map(|shift| at(shift) / whole).collect())
    }

    fn at(&self, shift_px: f64) -> f64 {
        let (i, t) = (shift_px.floor() as usize, shift_px.fract());
        let value = |i: usize| self.0.get(i).copied().unwrap_or(0.0);
        value(i) + t * (value(i + 1) - value(i))
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    const SCENE: PowerLaw = PowerLaw { amplitude: 7.0, exponent: 2.4, noise_variance: 6.5 };
    const TUKEY: Option<Window> = Some(Window::Tukey { taper: 0.25 });

    fn bound(size: (usize, usize), scene: &PowerLaw, deg: f64, length_px: f64, window: Option<Window>) -> Bound {
        cramer_rao(size, scene, AxialAngle::from_deg(deg), length_px, window).unwrap()
    }

    fn assert_close(found: f64, expected: f64, share: f64) {
        assert!((found / expected - 1.0).abs() < share, "{found} for {expected}");
    }

    /// Whittle's expected log-likelihood ratio between two blurs of the scene, `sum [E0/E - 1 - log(E0/E)]` over half
    /// of the plane, without windows.
    fn divergence(size: (usize, usize), scene: &PowerLaw, truth: (f64, f64), other: (f64, f64)) -> f64 {
        let expected = |(length_px, rad): (f64, f64), u: f64, v: f64| {
            let z = PI * length_px * (u * rad.cos() - v * rad.sin());
            let sinc = if z == 0.0 { 1.0 } else { z.sin() / z };
            scene.amplitude * u.hypot(v).powf(-scene.exponent) * sinc * sinc + scene.noise_variance
        };
        let mut sum = 0.0;
        for bin in 1..size.0 * size.1 {
            let (u, v) = (frequency(bin % size.1, size.1), frequency(bin / size.1, size.0));
            let ratio = expected(truth, u, v) / expected(other, u, v);
            sum += 0.5 * (ratio - 1.0 - ratio.ln());
        }
        sum
    }

    #[test]
    fn the_information_is_the_curvature_of_the_likelihood() {
        // With a scene that is known but for angle and length.
        let (size, length_px, rad) = ((96, 128), 20.0, 0.5);
        let information = |dl: f64, da: f64| {
            let plus = divergence(size, &SCENE, (length_px, rad), (length_px + dl, rad + da));
            let minus = divergence(size, &SCENE, (length_px, rad), (length_px - dl, rad - da));
            // Half of the quadratic form, from both sides: odd orders cancel.
            plus + minus
        };
        let (dl, da) = (1e-3, 1e-4);
        let (ll, aa) = (information(dl, 0.0) / (dl * dl), information(0.0, da) / (da * da));
        let la = (information(dl, da) - information(dl, -da)) / (4.0 * dl * da);
        let found = information_of(size, &SCENE, length_px, rad);
        assert_close(found[3][3], ll, 1e-3);
        assert_close(found[4][4], aa, 1e-3);
        assert!((found[3][4] - la).abs() < 1e-3 * (ll * aa).sqrt(), "{} for {la}", found[3][4]);
    }

    /// The information without a window from the derivatives on paper.
    fn information_of(
        (rows, cols): (usize, usize),
        scene: &PowerLaw,
        length_px: f64,
        rad: f64,
    ) -> [[f64; PARAMETERS]; PARAMETERS] {
        let mut information = [[0.0; PARAMETERS]; PARAMETERS];
        for bin in 1..rows * cols {
            let (u, v) = (frequency(bin % cols, cols), frequency(bin / cols, rows));
            let (s, across) = (u * rad.cos() - v * rad.sin(), -u * rad.sin() - v * rad.cos());
            let z = PI * length_px * s;
            // d sinc²(z) / dz = 2 sinc (cos z - sinc) / z
            let (sinc, slope) = if z.abs() < 1e-9 {
                (1.0, 0.0)
            } else {
                (z.sin() / z, 2.0 * z.sin() / z * (z.cos() - z.sin() / z) / z)
            };
            let power = scene.amplitude * u.hypot(v).powf(-scene.exponent);
            let expected = power * sinc * sinc + scene.noise_variance;
            let signal = power * sinc * sinc / expected;
            let gradient = [
                signal,
                -u.hypot(v).ln() * signal,
                scene.noise_variance / expected,
                power * slope * PI * s / expected,
                power * slope * PI * length_px * across / expected,
            ];
            for i in 0..PARAMETERS {
                for j in 0..PARAMETERS {
                    information[i][j] += 0.5 * gradient[i] * gradient[j];
                }
            }
        }
        information
    }

    #[test]
    fn the_bound_is_that_of_the_derivatives_on_paper() {
        for (deg, length_px) in [(0.0, 20.0), (30.0, 20.0), (101.0, 55.5), (45.0, 6.0)] {
            let size = (120, 150);
            let rad = f64::to_radians(deg);
            let expected = bound_from(&information_of(size, &SCENE, length_px, rad), 1.0).unwrap();
            let found = bound(size, &SCENE, deg, length_px, None);
            assert_close(found.length_std_px, expected.length_std_px, 1e-3);
            assert_close(found.angle_std_deg, expected.angle_std_deg, 1e-3);
            assert!((found.correlation - expected.correlation).abs() < 1e-3);
        }
    }

    #[test]
    fn profiling_is_inverting_the_whole_information() {
        // A matrix with a known inverse: tridiagonal 2, -1 of order 5 has (inverse)_ij = min (6 - max) / 6.
        let matrix = std::array::from_fn(|i| {
            std::array::from_fn(|j: usize| match i.abs_diff(j) {
                0 => 2.0,
                1 => -1.0,
                _ => 0.0,
            })
        });
        let found = bound_from(&matrix, 2.0).unwrap();
        assert_close(found.length_std_px.powi(2), 2.0 * 8.0 / 6.0, 1e-12);
        assert_close(found.angle_std_deg.to_radians().powi(2), 2.0 * 5.0 / 6.0, 1e-12);
        assert_close(found.correlation, 4.0 / 40.0_f64.sqrt(), 1e-12);
    }

    #[test]
    fn more_noise_can_only_harm() {
        for window in [None, TUKEY] {
            let of = |noise_variance| bound((128, 128), &PowerLaw { noise_variance, ..SCENE }, 20.0, 15.0, window);
            let bounds: Vec<Bound> = [0.1, 1.0, 10.0, 100.0, 1e3].into_iter().map(of).collect();
            for pair in bounds.windows(2) {
                assert!(pair[0].length_std_px < pair[1].length_std_px, "{pair:?}");
                assert!(pair[0].angle_std_deg < pair[1].angle_std_deg, "{pair:?}");
            }
        }
    }

    #[test]
    fn in_strong_noise_the_bound_grows_with_its_variance() {
        // Where S << s2, grad log E is grad S / s2 for the length and the angle.
        let of = |noise_variance| bound((128, 128), &PowerLaw { noise_variance, ..SCENE }, 20.0, 15.0, TUKEY);
        let (loud, louder) = (of(1e9), of(1e10));
        assert_close(louder.length_std_px / loud.length_std_px, 10.0, 1e-2);
        assert_close(louder.angle_std_deg / loud.angle_std_deg, 10.0, 1e-2);
    }

    #[test]
    fn the_scale_of_the_grey_values_does_not_matter() {
        let scaled = PowerLaw { amplitude: 9.0 * SCENE.amplitude, noise_variance: 9.0 * SCENE.noise_variance, ..SCENE };
        let (a, b) = (bound((96, 96), &SCENE, 60.0, 12.0, TUKEY), bound((96, 96), &scaled, 60.0, 12.0, TUKEY));
        assert_close(a.length_std_px, b.length_std_px, 1e-9);
        assert_close(a.angle_std_deg, b.angle_std_deg, 1e-9);
    }

    #[test]
    fn turning_the_picture_turns_the_bound() {
        for window in [None, TUKEY] {
            let (lying, standing) =
                (bound((96, 140), &SCENE, 0.0, 20.0, window), bound((140, 96), &SCENE, 90.0, 20.0, window));
            assert_close(lying.length_std_px, standing.length_std_px, 1e-6);
            assert_close(lying.angle_std_deg, standing.angle_std_deg, 1e-6);
            // Above and below the axis is the same: nothing correlates.
            assert!(lying.correlation.abs() < 1e-6, "{}", lying.correlation);
        }
    }

    #[test]
    fn a_window_costs_its_variance_and_the_depth_of_the_dark_lines() {
        let cost = |scene: &PowerLaw, length_px: f64| {
            let of = |window| bound((256, 256), scene, 30.0, length_px, window).length_std_px;
            of(TUKEY) / of(None)
        };
        // 1.32 in two dimensions, as the documentation of `Window` says; where noise hides the lines, hardly more.
        let noisy = cost(&PowerLaw { noise_variance: 1e6, ..SCENE }, 8.0);
        assert!((noisy / 1.32_f64.sqrt() - 1.0).abs() < 0.03, "{noisy}");
        let clear = cost(&SCENE, 20.0);
        assert!(clear > 1.1 * noisy && clear < 2.0, "{clear}, {noisy}");
    }

    #[test]
    fn the_expected_periodogram_is_that_of_windowed_white_noise() {
        // White noise blurred along the rows by a box of 24 px, its periodogram under a window: the expected value by
        // the autocorrelation of the discrete kernel, a triangle of integer lags.
        let (n, length) = (64, 24_u8);
        let window = Window::Hann;
        let weights: Vec<f64> = (0..n).map(|i| window.weight(i, n)).collect();
        let square: f64 = weights.iter().map(|w| w * w).sum();
        let box_px = f64::from(length);
        let transfer = Transfer::new((n, n), box_px, 0.0, Some(window));
        for bin in 0..24 {
            let u = f64::from(bin) / (2.0 * n as f64);
            let mut expected = 0.0;
            for lag in 0..length {
                let triangle = (box_px - f64::from(lag)) / (box_px * box_px);
                let overlap: f64 = weights.iter().zip(&weights[lag.into()..]).map(|(a, b)| a * b).sum::<f64>() / square;
                let both_signs = if lag == 0 { 1.0 } else { 2.0 };
                expected += both_signs * triangle * overlap * (2.0 * PI * u * f64::from(lag)).cos();
            }
            // The integer lags add the aliases of the continuous triangle, at low frequencies at most the sum of
            // 2 / (24 pi k)² over k, which is 1 / (3 24²).
            let found = transfer.at(u, 0.0);
            assert!((found - expected).abs() < 7e-4, "{u}: {found} for {expected}");
        }
        // The window fills the first dark line.
        assert!(transfer.at(1.0 / box_px, 0.0) > 0.02);
    }

    #[test]
    fn what_cannot_be_determined_has_no_bound() {
        // Without noise the variance of the noise is not a parameter.
        assert_eq!(
            cramer_rao((64, 64), &PowerLaw { noise_variance: 0.0, ..SCENE }, AxialAngle::from_deg(3.0), 9.0, None),
            None
        );
    }
}
