//! The look behind a result: what it shows must be what the result rests on.
#![allow(clippy::unwrap_used, reason = "a picture that cannot be made or measured fails the test")]

use blur_core::estimate::joint::{Diagnosis, Whittle};
use blur_core::estimate::{AxialAngle, JointEstimator, MotionBlur, Settings, Status};
use blur_core::image::{Region, Window};
use blur_sim::expose::{Blur, expose};
use blur_sim::motion::Motion;
use blur_sim::scene::{DeadLeaves, dead_leaves};
use blur_sim::sensor::{Sensor, f32_from_u8};
use ndarray::Array2;

/// Eight-bit picture of `dim` rows and columns with noise of 40 dB.
fn picture(seed: u64, (rows, columns): (usize, usize), blur: &impl Blur) -> Array2<f32> {
    let (lost_rows, lost_columns) = blur.extent_px();
    let scene = dead_leaves(seed, rows + lost_rows, columns + lost_columns, &DeadLeaves::default()).unwrap();
    let exposure = expose(scene.view(), blur).unwrap();
    let sensor = Sensor::ideal().with_psnr_db(40.0).unwrap();
    f32_from_u8(sensor.record(exposure.view(), seed).unwrap().view())
}

fn diagnosed(picture: &Array2<f32>, settings: &Settings) -> (MotionBlur, Diagnosis) {
    let blur = Whittle::new(settings).estimate(picture.view()).unwrap();
    assert_eq!(blur.status, Status::Ok);
    let diagnosis = Diagnosis::of(picture.view(), settings, &blur).unwrap().unwrap();
    (blur, diagnosis)
}

fn uniform(length_px: f64, deg: f64) -> Motion {
    Motion::uniform(length_px, AxialAngle::from_deg(deg)).unwrap()
}

/// Least-squares curvature `(ll, aa, la)` of `-2 log L` over all points above `-2`, in units of the stated standard
/// uncertainties about the maximum of the fit.
fn curvature(blur: &MotionBlur, diagnosis: &Diagnosis) -> [f64; 3] {
    let surface = &diagnosis.surface;
    let (mut normal, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
    for (row, angle_deg) in surface.angles_deg.iter().enumerate() {
        for (column, length_px) in surface.lengths_px.iter().enumerate() {
            let value = surface.log_likelihood[[row, column]];
            if value > -2.0 {
                let l = (length_px - diagnosis.length_px) / blur.length_std_px.unwrap();
                let a = AxialAngle::from_deg(*angle_deg).minus_deg(diagnosis.angle) / blur.angle_std_deg.unwrap();
                let terms = [l * l, a * a, 2.0 * l * a];
                for i in 0..3 {
                    for j in 0..3 {
                        normal[i][j] += terms[i] * terms[j];
                    }
                    right[i] -= 2.0 * value * terms[i];
                }
            }
        }
    }
    // Cramer's rule.
    let determinant = |m: [[f64; 3]; 3]| {
        let minor = |i: usize, j: usize| m[1][i] * m[2][j] - m[1][j] * m[2][i];
        m[0][0] * minor(1, 2) - m[0][1] * minor(0, 2) + m[0][2] * minor(0, 1)
    };
    std::array::from_fn(|column| {
        let mut replaced = normal;
        for (row, value) in replaced.iter_mut().zip(right) {
            row[column] = value;
        }
        determinant(replaced) / determinant(normal)
    })
}

#[test]
fn the_fit_made_anew_is_the_one_that_was_reported() {
    // Whole, in the middle under a Hann window, and in a large square.
    for (dim, length_px, deg) in [((300, 420), 17.3, 28.0), ((900, 800), 30.0, 120.0), ((1300, 1200), 40.0, 3.0)] {
        let picture = picture(5, dim, &uniform(length_px, deg));
        let (blur, diagnosis) = diagnosed(&picture, &Settings::default());
        let off_px = (diagnosis.length_px - blur.length_px).abs();
        let off_deg = diagnosis.angle.distance_deg(blur.angle);
        assert!(off_px < 0.3 * blur.length_std_px.unwrap(), "{dim:?}: {off_px} px of {blur:?}");
        assert!(off_deg < 0.3 * blur.angle_std_deg.unwrap(), "{dim:?}: {off_deg} deg of {blur:?}");
    }
}

#[test]
fn the_curvature_of_the_surface_is_the_inverse_of_the_stated_covariance_before_it_was_widened() {
    for (seed, length_px, deg) in [(1, 14.0, 35.0), (2, 25.0, 0.0), (3, 9.0, 152.0)] {
        let picture = picture(seed, (384, 512), &uniform(length_px, deg));
        let (blur, diagnosis) = diagnosed(&picture, &Settings::default());
        let rho = blur.correlation.unwrap();
        let inverse = 1.0 / (1.0 - rho * rho);
        let [ll, aa, la] = curvature(&blur, &diagnosis).map(|c| c / diagnosis.widening.powi(2));
        // The covariance is that of the expected information, the surface shows the observed one.
        assert!((ll / inverse - 1.0).abs() < 0.25, "{length_px} px: length {ll} instead of {inverse}");
        assert!((aa / inverse - 1.0).abs() < 0.25, "{length_px} px: angle {aa} instead of {inverse}");
        assert!((la + rho * inverse).abs() < 0.25, "{length_px} px: {la} instead of {}", -rho * inverse);
        assert!(diagnosis.widening >= 1.0);
    }
}

#[test]
fn the_surface_is_highest_at_the_fit_and_holds_the_result_in_its_middle() {
    let picture = picture(4, (300, 300), &uniform(12.0, 75.0));
    let (blur, diagnosis) = diagnosed(&picture, &Settings::default());
    let surface = &diagnosis.surface;
    let (rows, columns) = surface.log_likelihood.dim();
    assert_eq!((rows, columns), (surface.angles_deg.len(), surface.lengths_px.len()));
    assert!((surface.lengths_px[columns / 2] - blur.length_px).abs() < 1e-9);
    assert!((surface.angles_deg[rows / 2] - blur.angle.deg()).abs() < 1e-9);
    assert!(surface.log_likelihood.iter().all(|&value| value <= 0.0));
    let middle = surface.log_likelihood[[rows / 2, columns / 2]];
    assert!(middle > -0.1, "{middle}");
    for corner in [[0, 0], [0, columns - 1], [rows - 1, 0], [rows - 1, columns - 1]] {
        assert!(surface.log_likelihood[corner] < -4.0, "{corner:?}");
    }
}

#[test]
fn powers_over_their_expectation_are_exponential_variables_of_mean_1() {
    let picture = picture(6, (512, 512), &uniform(15.0, 20.0));
    let (_, diagnosis) = diagnosed(&picture, &Settings::default());
    let mut ratios: Vec<f64> = diagnosis
        .spectrum
        .bins()
        .iter()
        .zip(&diagnosis.expected)
        .map(|(bin, (scene, noise))| f64::from(bin.power) / (scene + noise))
        .collect();
    ratios.sort_by(f64::total_cmp);
    let n = ratios.len() as f64;
    // The largest distance of the distribution from 1 - exp(-x). Neighbours under a window depend on each other and the
    // scene is rough, so no table of Kolmogorov's holds; one per cent of all bins is a model that fits.
    let distance =
        ratios.iter().enumerate().map(|(i, x)| ((i as f64 + 0.5) / n - (1.0 - (-x).exp())).abs()).fold(0.0, f64::max);
    assert!(distance < 0.02, "{distance}");
}

#[test]
fn the_model_is_dark_where_the_transfer_function_has_its_zeros() {
    let (length_px, deg) = (20.0, 0.0);
    let picture = picture(7, (512, 512), &uniform(length_px, deg));
    let (_, diagnosis) = diagnosed(&picture, &Settings::default());
    let step = 0.002;
    let profile = diagnosis.spectrum.along(0.0, step, 0.4, |index, bin| {
        // Without the noise, which fills the lines farther out.
        let (scene, _) = diagnosis.expected[index];
        scene * blur_core::spectrum::PowerSpectrum::whitening(bin.u, bin.v)
    });
    for zero in 1..=4 {
        let at = |frequency: f64| profile[(frequency / step) as usize];
        let (dark, bright) = (at(f64::from(zero) / length_px), at((f64::from(zero) + 0.5) / length_px));
        assert!(dark < 0.3 * bright, "zero {zero}: {dark} {bright}");
    }
}

#[test]
fn an_accelerated_blur_is_looked_at_under_its_own_window_and_kernel() {
    let motion = Motion::new(30.0, AxialAngle::from_deg(40.0), 0.7).unwrap();
    let picture = picture(8, (512, 512), &motion);
    let mut settings = Settings::default();
    settings.acceleration = true;
    let (blur, diagnosis) = diagnosed(&picture, &settings);
    assert!(blur.acceleration.unwrap().is_detected());
    assert_eq!(diagnosis.window, Some(Window::Hann));
    assert!((diagnosis.length_px - blur.length_px).abs() < 0.3 * blur.length_std_px.unwrap());
}

#[test]
fn the_part_under_weights_is_looked_at_under_the_same_weights() {
    // A disk of its own blur in a picture that moved otherwise.
    let (inside, outside) =
        (picture(10, (400, 500), &uniform(12.0, 70.0)), picture(11, (400, 500), &uniform(20.0, 160.0)));
    let radius = |row: usize, column: usize| (row as f64 - 190.0).hypot(column as f64 - 290.0);
    let seen =
        Array2::from_shape_fn((400, 500), |at| if radius(at.0, at.1) < 170.0 { inside[at] } else { outside[at] });
    let weights = Array2::from_shape_fn((400, 500), |(row, column)| {
        let share = ((170.0 - radius(row, column)) / 40.0).clamp(0.0, 1.0);
        (0.5 - 0.5 * (std::f64::consts::PI * share).cos()) as f32
    });
    let settings = Settings::default();
    let blur = Whittle::new(&settings).estimate_weighted(seen.view(), weights.view()).unwrap();
    assert_eq!(blur.status, Status::Ok);
    let diagnosis = Diagnosis::of_weighted(seen.view(), weights.view(), &settings, &blur).unwrap().unwrap();
    // The fit is that of the disk, and its part the square about it.
    assert_eq!((diagnosis.window, diagnosis.part), (None, Region { x: 121, y: 21, width: 339, height: 339 }));
    assert!((diagnosis.length_px - blur.length_px).abs() < 0.3 * blur.length_std_px.unwrap(), "{diagnosis:.3?}");
    assert!((diagnosis.length_px - 12.0).abs() < 4.0 * blur.length_std_px.unwrap(), "{}", diagnosis.length_px);
    // Weights w leave (sum w^2)^2 / sum w^4 independent powers.
    let sum = |power: i32| weights.iter().map(|&weight| f64::from(weight).powi(power)).sum::<f64>();
    let expected = sum(2).powi(2) / sum(4);
    assert!((diagnosis.independent_powers / expected - 1.0).abs() < 1e-3, "{}", diagnosis.independent_powers);
    let ratios = diagnosis.spectrum.bins().iter().zip(&diagnosis.expected);
    let mean = ratios.map(|(bin, (scene, noise))| f64::from(bin.power) / (scene + noise)).sum::<f64>()
        / diagnosis.expected.len() as f64;
    assert!((mean - 1.0).abs() < 0.05, "{mean}");
}

#[test]
fn a_result_without_uncertainties_has_nothing_to_look_at() {
    let picture = picture(9, (128, 128), &uniform(10.0, 10.0));
    let mut blur = Whittle::new(&Settings::default()).estimate(picture.view()).unwrap();
    blur.evidence = None;
    assert_eq!(Diagnosis::of(picture.view(), &Settings::default(), &blur).unwrap(), None);
}
