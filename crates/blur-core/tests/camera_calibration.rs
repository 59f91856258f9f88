//! Calibration from points: what is refused, derivatives, and what becomes of a blur.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a camera that cannot be made fails the test")]

use blur_core::Error;
use blur_core::camera::{Intrinsics, Lens, LocalBlur, Model, PARAMETERS, View, calibrate};
use blur_core::estimate::AxialAngle;
use metrology::Measurement;
use proptest::prelude::*;

const SIZE: (usize, usize) = (640, 480);
type Covariance = [[f64; PARAMETERS]; PARAMETERS];

const NONE: Covariance = [[0.0; PARAMETERS]; PARAMETERS];
const TRUTH: [f64; PARAMETERS] = [530.0, 525.0, 322.0, 236.0, 0.0, -0.25, 0.08, 1e-3, -5e-4, -0.02];

fn camera(parameters: [f64; PARAMETERS]) -> Intrinsics {
    Intrinsics::new(parameters, NONE, SIZE.0, SIZE.1).unwrap()
}

/// A board of 8 by 6 points, 1 apart, its middle 11 before the camera, turned by `a` about x and then `b` about y.
fn view(camera: &Intrinsics, a: f64, b: f64) -> View {
    let board: Vec<[f64; 2]> = (0..48).map(|i| [f64::from(i % 8), f64::from(i / 8)]).collect();
    let (sin_a, cos_a, sin_b, cos_b) = (a.sin(), a.cos(), b.sin(), b.cos());
    let image_px = board
        .iter()
        .map(|[x, y]| {
            let (x, y) = (x - 3.5, y - 2.5);
            let (y, z) = (y * cos_a, y * sin_a);
            camera.project([x * cos_b + z * sin_b, y, 11.0 - x * sin_b + z * cos_b]).unwrap()
        })
        .collect();
    View { board, image_px }
}

fn good_views(camera: &Intrinsics) -> Vec<View> {
    [(0.5, 0.1), (-0.4, 0.3), (0.1, -0.6), (0.3, 0.5), (0.0, 0.0)].map(|(a, b)| view(camera, a, b)).to_vec()
}

#[test]
fn exact_points_give_the_camera_back() {
    for (skew, lens, coefficients) in
        [(0.0, Lens::Five, 5), (0.7, Lens::Five, 5), (0.0, Lens::Four, 4), (0.0, Lens::Two, 2)]
    {
        let mut truth = TRUTH;
        truth[4] = skew;
        truth[5 + coefficients..].fill(0.0);
        let model = Model { skew: skew != 0.0, lens };
        let found = calibrate(&good_views(&camera(truth)), SIZE.0, SIZE.1, model).unwrap();
        for (found, truth) in found.intrinsics.parameters().iter().zip(truth) {
            assert!((found - truth).abs() < 1e-6 * truth.abs().max(0.1), "{found} {truth}");
        }
        assert!(found.rms_px < 1e-8);
        // The third board is turned by 0.1 and 0.6: the normal's z is cos 0.1 cos 0.6.
        let tilt = (0.1_f64.cos() * 0.6_f64.cos()).acos().to_degrees();
        assert!((found.view_tilt_deg[2] - tilt).abs() < 1e-6, "{}", found.view_tilt_deg[2]);
    }
}

#[test]
fn views_that_cannot_fix_a_camera_are_refused() {
    let seen = camera(TRUTH);
    let fit = |views: &[View], skew| calibrate(views, SIZE.0, SIZE.1, Model { skew, lens: Lens::Two });
    let good = good_views(&seen);
    assert_eq!(fit(&good[..1], false), Err(Error::TooFewViews { views: 1, needed: 2 }));
    assert_eq!(fit(&good[..2], true), Err(Error::TooFewViews { views: 2, needed: 3 }));
    // All parallel: moved, never tilted. Without distortion the homographies are exact.
    let ideal = camera([530.0, 525.0, 322.0, 236.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let parallel: Vec<View> = [10.0, 12.0, 15.0]
        .map(|distance| View {
            board: (0..48).map(|i| [f64::from(i % 8), f64::from(i / 8)]).collect(),
            image_px: (0..48)
                .map(|i| ideal.project([f64::from(i % 8) - 3.0, f64::from(i / 8) - 2.0, distance]).unwrap())
                .collect(),
        })
        .to_vec();
    assert!(matches!(fit(&parallel, false), Err(Error::ViewsTooAlike { .. })), "{:?}", fit(&parallel, false));
    // With noise of 0.1 px the equations have a solution, which is worth nothing.
    let noisy: Vec<View> = parallel
        .iter()
        .enumerate()
        .map(|(k, view)| View {
            board: view.board.clone(),
            image_px: view
                .image_px
                .iter()
                .enumerate()
                .map(|(i, [u, v])| {
                    let wave = |f: f64| 0.1 * (f * (i as f64 + 1.0) * (k as f64 + 1.7)).sin();
                    [u + wave(12.9898), v + wave(78.233)]
                })
                .collect(),
        })
        .collect();
    assert!(matches!(fit(&noisy, false), Err(Error::ViewsTooAlike { .. })), "{:?}", fit(&noisy, false));

    let with = |change: &dyn Fn(&mut View)| {
        let mut views = good.clone();
        change(&mut views[1]);
        fit(&views, false)
    };
    for (change, reason) in [
        (&(|view: &mut View| view.board.iter_mut().for_each(|p| p[1] = 2.0 * p[0])) as &dyn Fn(&mut View), "line"),
        (&|view| view.image_px.iter_mut().for_each(|p| *p = [100.0 + p[0], 100.0 + p[0]]), "line"),
        (&|view| view.image_px[3][0] = f64::NAN, "finite"),
        (&|view| view.board[3][0] = f64::INFINITY, "finite"),
        (&|view| (view.board, view.image_px) = (view.board[..3].to_vec(), view.image_px[..3].to_vec()), "4 points"),
        (&|view| view.image_px.truncate(47), "number of points"),
        // Three of four points on a line.
        (
            &|view| {
                view.board = vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.0, 1.0]];
                view.image_px = vec![[10.0, 10.0], [20.0, 10.0], [30.0, 10.0], [10.0, 20.0]];
            },
            "line",
        ),
    ] {
        match with(change) {
            Err(Error::View { number: 2, reason: found, .. }) => assert!(found.contains(reason), "{found}"),
            other => panic!("{reason}: {other:?}"),
        }
    }
}

#[test]
fn parameters_that_describe_no_camera_are_refused() {
    let refused = |change: &dyn Fn(&mut [f64; PARAMETERS], &mut Covariance)| {
        let (mut parameters, mut covariance) = (TRUTH, NONE);
        change(&mut parameters, &mut covariance);
        Intrinsics::new(parameters, covariance, SIZE.0, SIZE.1).unwrap_err().to_string()
    };
    assert!(refused(&|p, _| p[0] = -530.0).contains("fx_px = -530"));
    assert!(refused(&|p, _| p[1] = 0.0).contains("fy_px = 0"));
    assert!(refused(&|p, _| p[7] = f64::NAN).contains("p1 = NaN"));
    assert!(refused(&|_, c| c[2][2] = -1.0).contains("cx_px and cx_px is -1"));
    assert!(refused(&|_, c| c[0][0] = f64::INFINITY).contains("inf"));
    // A correlation beyond 1, and one that differs from its mirror.
    assert!(refused(&|_, c| (c[0][0], c[1][1], c[0][1], c[1][0]) = (1.0, 1.0, 1.1, 1.1)).contains("1.1"));
    assert!(refused(&|_, c| (c[0][0], c[1][1], c[1][0]) = (1.0, 1.0, 0.5)).contains("0.5"));
    assert!(Intrinsics::new(TRUTH, NONE, 0, 480).is_err());
}

#[test]
fn what_lies_beyond_the_lens_is_refused() {
    // r (1 - r^2 / 4) grows to r = sqrt(4/3), where it is sqrt(4/3) 2/3 = 0.7698.
    let mut parameters = [100.0, 100.0, 0.0, 0.0, 0.0, -0.25, 0.0, 0.0, 0.0, 0.0];
    let seen = camera(parameters);
    let [x, _] = seen.unproject([76.9, 0.0]).unwrap();
    assert!((x * (1.0 - 0.25 * x * x) - 0.769).abs() < 1e-12 && x < (4.0_f64 / 3.0).sqrt());
    match seen.unproject([0.0, 77.1]) {
        Err(Error::BeyondLens { radius, limit }) => {
            assert!((radius - 0.771).abs() < 1e-12 && (limit - 0.769_800).abs() < 1e-5, "{radius} {limit}");
        }
        other => panic!("{other:?}"),
    }
    assert!(seen.unproject([f64::NAN, 0.0]).is_err());
    parameters[5] = 0.0;
    let [x, y] = camera(parameters).unproject([250.0, -30.0]).unwrap();
    assert!((x - 2.5).abs() < 1e-15 && (y + 0.3).abs() < 1e-15);
}

proptest! {
    #[test]
    fn what_is_distorted_can_be_undone(
        u in 0.0..640.0_f64, v in 0.0..480.0_f64,
        k1 in -0.3..0.3_f64, k2 in -0.05..0.1_f64, k3 in -0.02..0.02_f64,
        p1 in -2e-3..2e-3_f64, p2 in -2e-3..2e-3_f64, skew in -2.0..2.0_f64,
    ) {
        let seen = camera([530.0, 525.0, 322.0, 236.0, skew, k1, k2, p1, p2, k3]);
        // The corner lies 0.76 focal lengths out, where k1 = -0.3 may fold: then it says so.
        match seen.unproject([u, v]) {
            Ok([x, y]) => {
                let [back_u, back_v] = seen.project([x, y, 1.0]).unwrap();
                prop_assert!((back_u - u).abs() < 1e-9 && (back_v - v).abs() < 1e-9, "{back_u} {back_v}");
            }
            Err(Error::BeyondLens { limit, .. }) => prop_assert!(limit < 0.8, "{limit}"),
            Err(other) => prop_assert!(false, "{other}"),
        }
    }

    /// The uncertainty of scale and turn is the root of squared sensitivities, here by finite differences.
    #[test]
    fn uncertainties_follow_from_the_derivatives(
        u in 60.0..580.0_f64, v in 60.0..420.0_f64, deg in 0.0..180.0_f64, length in 5.0..90.0_f64,
        which in 0..PARAMETERS,
    ) {
        let blur = LocalBlur {
            centre_px: [u, v], angle: AxialAngle::from_deg(deg), angle_std_deg: 0.0, length_px: length,
            length_std_px: 0.0, correlation: 0.0,
        };
        let exact = |x| Measurement::exact(x).unwrap();
        let outputs = |camera: &Intrinsics, blur: LocalBlur| {
            let seen = camera.ideal_blur(blur).unwrap();
            [seen.scale(exact(2.0)).unwrap().m_per_px(), seen.turn_rad().unwrap()]
        };
        let std = if which < 5 { 1.0 } else { 1e-3 };
        let mut covariance = NONE;
        covariance[which][which] = std * std;
        let uncertain = outputs(&Intrinsics::new(TRUTH, covariance, SIZE.0, SIZE.1).unwrap(), blur);
        let moved = |sign: f64| {
            let mut parameters = TRUTH;
            parameters[which] += sign * 1e-3 * std;
            outputs(&camera(parameters), blur)
        };
        let (up, down) = (moved(1.0), moved(-1.0));
        for i in 0..2 {
            let expected = (up[i].value() - down[i].value()).abs() / 2e-3;
            let relative = (uncertain[i].std() - expected).abs() / uncertain[i].value();
            prop_assert!(relative < 1e-8, "{i}: {} {expected}", uncertain[i].std());
        }
        // By angle and length together, fully correlated: the sum of both effects.
        let exactly = camera(TRUTH);
        let both = LocalBlur { angle_std_deg: 0.5, length_std_px: 0.4, correlation: 1.0, ..blur };
        let turned = |sign: f64| {
            let angle = AxialAngle::from_deg(deg + sign * 5e-4);
            outputs(&exactly, LocalBlur { angle, length_px: length + sign * 4e-4, ..blur })[1].value()
        };
        let expected = (turned(1.0) - turned(-1.0)).abs() / 2e-3;
        let found = outputs(&exactly, both)[1].std();
        prop_assert!((found - expected).abs() < 1e-6 * length / 530.0, "{found} {expected}");
    }
}

fn plain_blur(centre_px: [f64; 2], deg: f64, length_px: f64) -> LocalBlur {
    let angle = AxialAngle::from_deg(deg);
    LocalBlur { centre_px, angle, angle_std_deg: 0.0, length_px, length_std_px: 0.0, correlation: 0.0 }
}

#[test]
fn without_distortion_the_scale_is_distance_over_focal_length() {
    let mut covariance = NONE;
    covariance[0][0] = 4.0;
    covariance[1][1] = 9.0;
    let parameters = [500.0, 400.0, 320.0, 240.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let seen = Intrinsics::new(parameters, covariance, 640, 480).unwrap();
    let distance = Measurement::new(2.0, 0.01).unwrap();
    for centre in [[320.0, 240.0], [30.0, 400.0]] {
        for (deg, focal, focal_std) in [(0.0, 500.0_f64, 2.0_f64), (90.0, 400.0, 3.0)] {
            let blur = seen.ideal_blur(plain_blur(centre, deg, 40.0)).unwrap();
            let k = blur.scale(distance).unwrap().m_per_px();
            assert!((k.value() - 2.0 / focal).abs() < 1e-15);
            assert!((k.std() / k.value() - (focal_std / focal).hypot(0.01 / 2.0)).abs() < 1e-9, "{}", k.std());
            assert!(blur.angle().distance_deg(AxialAngle::from_deg(deg)) < 1e-9);
            assert!((blur.length_px() - 40.0 * 500.0 / focal).abs() < 1e-9);
        }
    }
    // 3 right and 4 up in the scene are 3 * 500 and 4 * 400 in pixels.
    let deg = 1600.0_f64.atan2(1500.0).to_degrees();
    let blur = seen.ideal_blur(plain_blur([100.0, 100.0], deg, 50.0)).unwrap();
    assert!((blur.angle().deg() - 4.0_f64.atan2(3.0).to_degrees()).abs() < 1e-9);
}

#[test]
fn a_motion_in_space_is_measured_anywhere_behind_a_lens() {
    let seen = camera(TRUTH);
    for (x, y) in [(0.0, 0.0), (0.9, 0.6), (-1.0, 0.7)] {
        for deg in [0.0_f64, 37.0, 90.0, 140.0] {
            // 20 cm at 2 m, parallel to the sensor.
            let (sin, cos) = deg.to_radians().sin_cos();
            let [a, b] = [-0.1, 0.1].map(|s: f64| seen.project([x + s * cos, y - s * sin, 2.0]).unwrap());
            let (du, dv) = (b[0] - a[0], b[1] - a[1]);
            let centre = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
            let blur = seen.ideal_blur(plain_blur(centre, (-dv).atan2(du).to_degrees(), du.hypot(dv))).unwrap();
            let metres = blur.scale(Measurement::exact(2.0).unwrap()).unwrap().m_per_px().value() * du.hypot(dv);
            assert!((metres - 0.2).abs() < 1e-12, "{metres}");
            assert!(blur.angle().distance_deg(AxialAngle::from_deg(deg)) < 1e-9);
        }
    }
}

#[test]
fn the_turn_of_a_camera_is_the_angle_between_rays() {
    let seen = camera(TRUTH);
    // Rays at a and b from the axis in one plane through it differ by b - a, on the axis and far from it.
    for (a, b) in [(-0.02_f64, 0.02_f64), (0.1, 0.15), (-0.4, -0.37)] {
        for plane in [0.0_f64, 0.6, 1.5] {
            let [p, q] =
                [a, b].map(|t: f64| seen.project([t.sin() * plane.cos(), t.sin() * plane.sin(), t.cos()]).unwrap());
            let (du, dv) = (q[0] - p[0], q[1] - p[1]);
            let centre = [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])];
            let blur = seen.ideal_blur(plain_blur(centre, (-dv).atan2(du).to_degrees(), du.hypot(dv))).unwrap();
            let turn = blur.turn_rad().unwrap().value();
            assert!((turn - (b - a)).abs() < 1e-9, "{turn} {}", b - a);
        }
    }
}

#[test]
fn a_smaller_picture_has_a_smaller_camera() {
    let mut covariance = NONE;
    covariance[0][0] = 4.0;
    covariance[5][5] = 1e-6;
    let whole = Intrinsics::new(TRUTH, covariance, 640, 480).unwrap();
    let half = whole.resized(320, 240).unwrap();
    // Two by two pixels become one: pixel x of the small picture covers 2 x and 2 x + 1.
    let point = [0.3, -0.2, 1.0];
    let ([u, v], [half_u, half_v]) = (whole.project(point).unwrap(), half.project(point).unwrap());
    assert!((2.0 * half_u + 0.5 - u).abs() < 1e-9 && (2.0 * half_v + 0.5 - v).abs() < 1e-9);
    assert!((half.stds()[0] - 1.0).abs() < 1e-12 && (half.stds()[5] - 1e-3).abs() < 1e-12);
    assert!(matches!(whole.resized(480, 640), Err(Error::OtherShape { width: 480, camera_width: 640, .. })));
    assert!(whole.resized(640, 400).is_err());
    // 999 columns of 4:3 are 749.25 rows, rounded to 749.
    assert!(whole.resized(1000, 750).is_ok() && whole.resized(999, 749).is_ok());
}
