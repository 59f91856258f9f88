//! Promises of the exposure.
#![allow(clippy::unwrap_used)]

mod quadrature;

use blur_core::estimate::AxialAngle;
use blur_sim::Error;
use blur_sim::expose::{Exposer, expose, expose_padded};
use blur_sim::motion::Motion;
use blur_sim::scene::{DeadLeaves, PlaneWave, dead_leaves, gaussian_field, plane_waves};
use ndarray::{Array2, Zip};
use proptest::prelude::*;
use quadrature::gauss_legendre;

const ANGLES: [f64; 7] = [0.0, 10.0, 45.0, 89.7, 90.0, 137.3, 179.9];

fn motion(length_px: f64, deg: f64, accel_ratio: f64) -> Motion {
    Motion::new(length_px, AxialAngle::from_deg(deg), accel_ratio).unwrap()
}

fn greatest_difference(a: &Array2<f64>, b: &Array2<f64>) -> f64 {
    assert_eq!(a.dim(), b.dim());
    Zip::from(a).and(b).fold(0.0, |most, x, y| f64::max(most, (x - y).abs()))
}

/// A plane wave under a Gaussian bell.
struct Packet {
    wave: PlaneWave,
    col: f64,
    row: f64,
    sigma: f64,
}

impl Packet {
    fn at(&self, x: f64, y: f64) -> f64 {
        let (dx, dy) = (x - self.col, y - self.row);
        (-0.5 * (dx * dx + dy * dy) / (self.sigma * self.sigma)).exp() * self.wave.at(dx, dy)
    }
}

/// Wave packets in the middle of 237 x 251 pixels: nothing is left of them where the scene is continued, and their
/// spectra end 8 standard deviations before the Nyquist frequency, so their samples say all about them.
fn packets() -> [Packet; 3] {
    let packet = |amplitude, u, v, col, row, sigma| {
        let wave = PlaneWave { amplitude, u, v, phase_rad: amplitude };
        Packet { wave, col, row, sigma }
    };
    [
        packet(60.0, 0.11, 0.05, 121.0, 119.0, 6.0),
        packet(40.0, -0.21, 0.17, 127.5, 117.0, 6.5),
        packet(50.0, 0.02, -0.30, 125.0, 121.4, 7.0),
    ]
}

#[test]
fn exposure_is_the_time_average_of_the_shifted_scene() {
    let nodes = gauss_legendre(40);
    let packets = packets();
    let scene_at = |x, y| 100.0 + packets.iter().map(|packet| packet.at(x, y)).sum::<f64>();
    let mut exposer = Exposer::new();
    for (rows, cols) in [(237, 251), (238, 250)] {
        let scene = Array2::from_shape_fn((rows, cols), |(row, col)| scene_at(col as f64, row as f64));
        for deg in ANGLES {
            for (length, r) in [(13.37, 0.0), (9.2, 0.6), (8.0, -1.0)] {
                let blur = motion(length, deg, r);
                let (dx, dy) = blur.direction();
                let (lost_rows, lost_cols) = blur.extent_px();
                let picture = exposer.expose(scene.view(), &blur).unwrap();
                for ((row, col), value) in picture.indexed_iter().step_by(7) {
                    let (x, y) = ((col + lost_cols / 2) as f64, (row + lost_rows / 2) as f64);
                    let moved = |t| blur.centred_displacement_px(t);
                    let mean: f64 =
                        nodes.iter().map(|&(t, w)| w * scene_at(x - moved(t) * dx, y - moved(t) * dy)).sum();
                    assert!((value - mean).abs() < 1e-9, "{length} px at {deg} degrees, r {r}: {value} for {mean}");
                }
            }
        }
    }
}

#[test]
fn sinusoid_of_whole_periods_is_attenuated_by_sinc() {
    let mut exposer = Exposer::new();
    for (rows, cols) in [(64, 96), (45, 77), (50, 81), (37, 41)] {
        for deg in ANGLES {
            for length in [0.3, 7.5, 30.0] {
                let blur = motion(length, deg, 0.0);
                let (u, v) = (7.0 / cols as f64, -4.0 / rows as f64);
                let wave = PlaneWave { amplitude: 80.0, u, v, phase_rad: 0.4 };
                let scene = plane_waves(rows, cols, 100.0, &[wave]).unwrap();
                let picture = exposer.expose_periodic(scene.view(), &blur).unwrap();
                let x = length * std::f64::consts::PI * (u * deg.to_radians().cos() - v * deg.to_radians().sin());
                let sinc = if x.abs() < 1e-9 { 1.0 } else { x.sin() / x };
                let truth = plane_waves(rows, cols, 100.0, &[PlaneWave { amplitude: 80.0 * sinc, ..wave }]).unwrap();
                let error = greatest_difference(&picture, &truth);
                assert!(error < 1e-10, "{rows}x{cols}, {length} px at {deg} degrees: {error:e}");
            }
        }
    }
}

#[test]
fn accelerated_exposure_turns_and_attenuates_each_wave() {
    let waves = [
        PlaneWave { amplitude: 50.0, u: 3.0 / 60.0, v: 5.0 / 45.0, phase_rad: 0.1 },
        PlaneWave { amplitude: 20.0, u: -11.0 / 60.0, v: 17.0 / 45.0, phase_rad: -2.0 },
    ];
    let scene = plane_waves(45, 60, 90.0, &waves).unwrap();
    for deg in ANGLES {
        for r in [-0.8, 0.05, 1.0] {
            let blur = motion(17.3, deg, r);
            let picture = Exposer::new().expose_periodic(scene.view(), &blur).unwrap();
            let truth = plane_waves(45, 60, 90.0, &waves.map(|wave| wave.exposed(&blur))).unwrap();
            let error = greatest_difference(&picture, &truth);
            assert!(error < 1e-10, "{deg} degrees, r {r}: {error:e}");
        }
    }
}

#[test]
fn nyquist_pattern_is_split_between_both_signs() {
    // Rows alternate and columns alternate: all four corners of the spectrum share the pattern.
    let scene = Array2::from_shape_fn((32, 48), |(row, col)| if (row + col) % 2 == 0 { 60.0 } else { -60.0 });
    let blur = motion(5.0, 30.0, 0.4);
    let picture = Exposer::new().expose_periodic(scene.view(), &blur).unwrap();
    let gain =
        0.5 * (blur.transfer(blur.frequency_along(0.5, 0.5)) + blur.transfer(blur.frequency_along(0.5, -0.5))).re;
    assert!(greatest_difference(&picture, &scene.mapv(|x| gain * x)) < 1e-11);
}

#[test]
fn unknown_surroundings_stay_below_the_rounding_of_eight_bits() {
    // The same exposure with and without the 70 pixels around the scene.
    let surroundings = dead_leaves(1, 340, 340, &DeadLeaves::default()).unwrap();
    let scene = Array2::from_shape_fn((200, 200), |(row, col)| surroundings[[row + 70, col + 70]]);
    for deg in ANGLES {
        let blur = motion(20.3, deg, 0.0);
        let (lost_rows, lost_cols) = blur.extent_px();
        let truth = expose_padded(surroundings.view(), &blur).unwrap();
        let picture = expose(scene.view(), &blur).unwrap();
        let (rows, cols) = picture.dim();
        let rms_at_depth = |depth: usize| {
            let (mut sum, mut count) = (0.0, 0.0);
            for ((row, col), value) in picture.indexed_iter() {
                if row.min(col).min(rows - 1 - row).min(cols - 1 - col) == depth {
                    sum += (value - truth[[row + 70 + lost_rows / 2, col + 70 + lost_cols / 2]]).powi(2);
                    count += 1.0;
                }
            }
            f64::sqrt(sum / count)
        };
        // Rounding to integers has a standard deviation of 1/sqrt(12) = 0.29.
        assert!(rms_at_depth(0) < 0.25, "{deg} degrees: {}", rms_at_depth(0));
        assert!(rms_at_depth(16) < 0.1, "{deg} degrees: {}", rms_at_depth(16));
    }
}

#[test]
fn a_body_that_starts_from_rest_stays_longest_at_its_start() {
    // The mean of the centred path is -r L / 6: the centre of gravity of a bell moves by that along the motion.
    for (deg, r) in [(0.0, 1.0), (90.0, 1.0), (30.0, 0.5), (137.3, -0.7)] {
        let bell = |row: usize, col: usize| {
            let (x, y) = (col as f64 - 60.0, row as f64 - 50.0);
            200.0 * (-0.5 * (x * x + y * y) / 9.0).exp()
        };
        let scene = Array2::from_shape_fn((101, 121), |(row, col)| bell(row, col));
        let picture = expose_padded(scene.view(), &motion(12.0, deg, r)).unwrap();
        let total = picture.sum();
        let x = picture.indexed_iter().map(|((_, col), value)| value * col as f64).sum::<f64>() / total;
        let y = picture.indexed_iter().map(|((row, _), value)| value * row as f64).sum::<f64>() / total;
        let shift = -r * 12.0 / 6.0;
        assert!((x - 60.0 - shift * deg.to_radians().cos()).abs() < 1e-6, "{deg} degrees: x {x}");
        assert!((y - 50.0 + shift * deg.to_radians().sin()).abs() < 1e-6, "{deg} degrees: y {y}");
    }
}

#[test]
fn a_bright_body_out_of_reach_leaves_no_trace() {
    // A bell of 3 px is band-limited to 1e-19, and about the border, where the reflection takes place, it is even.
    let body = |cx: f64, cy: f64| {
        Array2::from_shape_fn((160, 200), |(row, col)| {
            let (x, y) = (col as f64 - cx, row as f64 - cy);
            50.0 + 1e4 * (-0.5 * (x * x + y * y) / 9.0).exp()
        })
    };
    for (deg, cx, cy) in [(0.0, -0.5, 80.0), (0.0, 199.5, 80.0), (90.0, 100.0, -0.5), (45.0, -0.5, 159.5)] {
        let blur = motion(30.0, deg, 0.0);
        let (lost_rows, lost_cols) = blur.extent_px();
        let picture = expose(body(cx, cy).view(), &blur).unwrap();
        for ((row, col), value) in picture.indexed_iter() {
            let (x, y) = ((col + lost_cols / 2) as f64, (row + lost_rows / 2) as f64);
            // Half the path and eight standard deviations of the bell.
            if (x - cx).hypot(y - cy) > 15.0 + 24.0 {
                assert!((value - 50.0).abs() < 1e-8, "{deg} degrees, row {row}, column {col}: {value}");
            }
        }
    }
}

#[test]
fn padded_exposure_continues_the_valid_one() {
    let scene = gaussian_field(1, 90, 111, 2.0).unwrap();
    for deg in ANGLES {
        let blur = motion(14.2, deg, 0.3);
        let (lost_rows, lost_cols) = blur.extent_px();
        let (valid, padded) = (expose(scene.view(), &blur).unwrap(), expose_padded(scene.view(), &blur).unwrap());
        assert_eq!(padded.dim(), scene.dim());
        let (top, left) = (lost_rows / 2, lost_cols / 2);
        let cut = Array2::from_shape_fn(valid.dim(), |(row, col)| padded[[row + top, col + left]]);
        assert_eq!(cut, valid);
    }
}

#[test]
fn an_exposer_answers_the_same_whatever_it_did_before() {
    let mut used = Exposer::new();
    for (rows, cols, length) in [(60, 80, 9.0), (61, 80, 21.0), (60, 80, 9.0), (60, 80, 9.1)] {
        let scene = gaussian_field(2, rows, cols, 2.0).unwrap();
        let blur = motion(length, 33.0, 0.0);
        assert_eq!(used.expose(scene.view(), &blur).unwrap(), expose(scene.view(), &blur).unwrap());
    }
}

#[test]
fn scenes_that_cannot_be_exposed_are_refused() {
    let blur = motion(20.0, 0.0, 0.0);
    let refused = expose(Array2::zeros((30, 20)).view(), &blur).unwrap_err();
    assert_eq!(refused, Error::BlurTooLong { blur_rows: 0, blur_cols: 20, rows: 30, cols: 20 });
    assert_eq!(expose(Array2::zeros((30, 21)).view(), &blur).unwrap().dim(), (30, 1));
    assert!(matches!(expose_padded(Array2::zeros((30, 19)).view(), &blur), Err(Error::BlurTooLong { .. })));
    assert!(matches!(expose(Array2::zeros((0, 50)).view(), &blur), Err(Error::Size { rows: 0, cols: 50, .. })));
    let mut scene = Array2::zeros((30, 40));
    scene[[3, 7]] = f64::NAN;
    assert!(matches!(expose(scene.view(), &blur), Err(Error::NotFinite { row: 3, col: 7, .. })));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn valid_region_is_the_scene_less_the_extent(
        rows in 1_usize..90, cols in 1_usize..90, length in 0.0..60.0, deg in 0.0..180.0, r in -1.0..=1.0,
    ) {
        let blur = motion(length, deg, r);
        let (sin, cos) = deg.to_radians().sin_cos();
        let lost = ((length * sin).abs().ceil() as usize, (length * cos).abs().ceil() as usize);
        match expose(Array2::from_elem((rows, cols), 70.0).view(), &blur) {
            Ok(picture) => {
                prop_assert_eq!(picture.dim(), (rows - lost.0, cols - lost.1));
                // The mean over time of a constant is the constant.
                prop_assert!(picture.iter().all(|value| (value - 70.0).abs() < 1e-10));
            }
            Err(refused) => {
                let too_long = matches!(refused, Error::BlurTooLong { .. });
                prop_assert!(too_long);
                prop_assert!(lost.0 >= rows || lost.1 >= cols);
            }
        }
    }

    #[test]
    fn no_motion_leaves_the_scene(seed: u64, rows in 2_usize..70, cols in 2_usize..70, deg in 0.0..180.0) {
        let scene = gaussian_field(seed, rows, cols, 1.0).unwrap();
        let picture = expose(scene.view(), &motion(0.0, deg, 0.0)).unwrap();
        prop_assert!(greatest_difference(&picture, &scene) < 1e-9);
    }

    #[test]
    fn exposure_is_linear_in_the_light(seed: u64, deg in 0.0..180.0, gain in -3.0..3.0) {
        let (a, b) = (gaussian_field(seed, 50, 47, 1.0).unwrap(), gaussian_field(!seed, 50, 47, 2.0).unwrap());
        let blur = motion(11.1, deg, 0.5);
        let of_sum = expose((&a + &(gain * &b)).view(), &blur).unwrap();
        let sum = expose(a.view(), &blur).unwrap() + gain * expose(b.view(), &blur).unwrap();
        prop_assert!(greatest_difference(&of_sum, &sum) < 1e-9);
    }

    #[test]
    fn turning_the_scene_half_way_round_reverses_the_acceleration(seed: u64, deg in 0.0..180.0, r in -1.0..=1.0) {
        let scene = gaussian_field(seed, 49, 52, 2.0).unwrap();
        let turned = Array2::from_shape_fn((49, 52), |(row, col)| scene[[48 - row, 51 - col]]);
        let picture = expose_padded(scene.view(), &motion(9.0, deg, r)).unwrap();
        let other = expose_padded(turned.view(), &motion(9.0, deg, -r)).unwrap();
        let back = Array2::from_shape_fn((49, 52), |(row, col)| other[[48 - row, 51 - col]]);
        prop_assert!(greatest_difference(&picture, &back) < 1e-9);
    }
}
