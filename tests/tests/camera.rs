//! Cameras: boards rendered and photographed, honest uncertainties, the calibrations of Zhang and of `OpenCV`'s samples, and
//! the angular rate of a telephone against its gyroscope.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a picture or a camera that cannot be made fails the test")]

use std::path::{Path, PathBuf};

use blur_cli::camera::views;
use blur_cli::picture::{self, Linearize};
use blur_core::Error;
use blur_core::camera::{Board, Calibration, Intrinsics, Lens, LocalBlur, Model, PARAMETERS, Pattern, View, calibrate};
use blur_core::estimate::joint::Whittle;
use blur_core::estimate::{JointEstimator, Settings, Status};
use blur_core::image::centre_square;
use blur_sim::rng::Rng;
use e2e_tests::data;
use nalgebra::{Matrix3, Rotation3, Vector3};
use ndarray::Array2;
use rayon::prelude::*;

const CHECKERBOARD: Pattern = Pattern::Checkerboard { square: 1.0 };
/// Zhang's: squares of half an inch, 0.888889 inches apart.
const SQUARES: Pattern = Pattern::Squares { square: 0.5, pitch: 0.888_889 };

/// The homography from a board to a picture of `width` by `height` pixels whose focal length is its width, with the middle
/// `(x, y)` of the board in the middle of the picture at a distance of `distance`, turned by `turn` in radians.
fn homography((width, height): (usize, usize), middle: [f64; 2], distance: f64, turn: [f64; 3]) -> Matrix3<f64> {
    let (w, h) = (width as f64, height as f64);
    let camera = Matrix3::new(w, 0.0, 0.5 * w - 0.3, 0.0, w, 0.5 * h + 0.2, 0.0, 0.0, 1.0);
    let rotation = *Rotation3::from_scaled_axis(Vector3::from(turn)).matrix();
    let shift = Vector3::new(0.0, 0.0, distance) - rotation * Vector3::new(middle[0], middle[1], 0.0);
    camera * Matrix3::from_columns(&[rotation.column(0), rotation.column(1), shift.column(0)])
}

/// Whether a place of the plane is dark: a checkerboard of `columns` by `rows` inner corners with a white margin.
fn checkerboard_is_dark(x: f64, y: f64, columns: usize, rows: usize) -> bool {
    let (i, j) = (x.floor(), y.floor());
    let is_inside = (-1.0..columns as f64).contains(&i) && (-1.0..rows as f64).contains(&j);
    is_inside && (i + j).rem_euclid(2.0) < 1.0
}

fn squares_are_dark(x: f64, y: f64, columns: usize, rows: usize) -> bool {
    let (i, j) = ((x / 0.888_889).floor(), (y / 0.888_889).floor());
    let is_inside = (0.0..columns as f64).contains(&i) && (0.0..rows as f64).contains(&j);
    is_inside && x - 0.888_889 * i < 0.5 && y - 0.888_889 * j < 0.5
}

/// A picture with 8 by 8 samples a pixel, unevenly lit, with Gaussian noise of `noise` grey values of 255.
fn rendered(
    (width, height): (usize, usize),
    homography: &Matrix3<f64>,
    noise: f64,
    seed: u64,
    is_dark: impl Fn(f64, f64) -> bool + Sync,
) -> Array2<f32> {
    const SAMPLES: usize = 8;
    let to_board = homography.try_inverse().unwrap();
    let sample = |i: usize| (i as f64 + 0.5) / SAMPLES as f64 - 0.5;
    let rows: Vec<Vec<f64>> = (0..height)
        .into_par_iter()
        .map(|v| {
            (0..width)
                .map(|u| {
                    let dark = (0..SAMPLES * SAMPLES)
                        .filter(|k| {
                            let (du, dv) = (sample(k % SAMPLES), sample(k / SAMPLES));
                            let p = to_board * Vector3::new(u as f64 + du, v as f64 + dv, 1.0);
                            is_dark(p.x / p.z, p.y / p.z)
                        })
                        .count() as f64
                        / (SAMPLES * SAMPLES) as f64;
                    (220.0 - 180.0 * dark) * (1.0 - 0.3 * u as f64 / width as f64)
                })
                .collect()
        })
        .collect();
    let mut rng = Rng::new(seed, 0);
    Array2::from_shape_fn((height, width), |(v, u)| (rows[v][u] + noise * rng.gaussian()) as f32)
}

fn project(homography: &Matrix3<f64>, [x, y]: [f64; 2]) -> [f64; 2] {
    let p = homography * Vector3::new(x, y, 1.0);
    [p.x / p.z, p.y / p.z]
}

/// Root mean square distance of found points from where a board's points are, whichever way the board was read.
fn rms_px(found: &[[f64; 2]], board: &Board, homography: &Matrix3<f64>) -> f64 {
    let truth: Vec<[f64; 2]> = board.points().into_iter().map(|p| project(homography, p)).collect();
    assert_eq!(found.len(), truth.len());
    let squared = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2);
    let nearest = |p: &[f64; 2]| found.iter().map(|f| squared(f, p)).fold(f64::INFINITY, f64::min);
    (truth.iter().map(nearest).sum::<f64>() / truth.len() as f64).sqrt()
}

// The first is nearly along the pixels; exactly so, the samples of a pixel would all see an edge at once.
const TURNS: [[f64; 3]; 5] =
    [[0.0, 0.0, 0.01], [0.6, 0.1, 0.3], [-0.3, 0.7, -1.2], [0.2, -0.8, 2.5], [-0.7, -0.3, 0.8]];

#[test]
fn corners_of_a_checkerboard_are_found_to_a_few_hundredths_of_a_pixel() {
    let board = Board::new(CHECKERBOARD, 9, 6).unwrap();
    // From squares of 11 pixels to those of 120; noise of 2 and of 8 grey values of 180 between dark and bright.
    for (size, distance, noise, most_px) in [
        ((640, 480), 18.0, 0.0, 0.03),
        ((640, 480), 18.0, 2.0, 0.05),
        ((640, 480), 18.0, 8.0, 0.15),
        ((640, 480), 45.0, 2.0, 0.15),
        ((1600, 1200), 14.0, 2.0, 0.05),
    ] {
        for (seed, turn) in TURNS.into_iter().enumerate() {
            let homography = homography(size, [4.0, 2.5], distance, turn);
            let picture = rendered(size, &homography, noise, seed as u64, |x, y| checkerboard_is_dark(x, y, 9, 6));
            let found = board.find(picture.view()).unwrap_or_else(|e| panic!("{size:?} {distance} {turn:?}: {e}"));
            let rms = rms_px(&found, &board, &homography);
            println!("checkerboard {size:?} at {distance}, noise {noise}, turn {turn:?}: {rms:.4} px");
            assert!(rms < most_px, "{size:?} at {distance}, noise {noise}, turn {turn:?}: {rms} px");
        }
    }
}

#[test]
fn corners_of_separate_squares_are_found_to_a_few_hundredths_of_a_pixel() {
    let board = Board::new(SQUARES, 8, 8).unwrap();
    let size = (640, 480);
    for (noise, most_px) in [(0.0, 0.05), (2.0, 0.08), (8.0, 0.25)] {
        for (seed, turn) in TURNS.into_iter().enumerate() {
            let homography = homography(size, [3.4, 3.4], 16.0, turn);
            let picture = rendered(size, &homography, noise, seed as u64, |x, y| squares_are_dark(x, y, 8, 8));
            let found = board.find(picture.view()).unwrap_or_else(|e| panic!("{turn:?}: {e}"));
            let rms = rms_px(&found, &board, &homography);
            println!("squares, noise {noise}, turn {turn:?}: {rms:.4} px");
            assert!(rms < most_px, "noise {noise}, turn {turn:?}: {rms} px");
        }
    }
}

/// Points come in the order of the board: one homography takes all of them there, and it is no mirror.
#[test]
fn points_are_in_the_order_of_the_board() {
    let size = (640, 480);
    for (pattern, columns, rows) in [(CHECKERBOARD, 9, 6), (CHECKERBOARD, 5, 7), (SQUARES, 8, 8), (SQUARES, 5, 4)] {
        let board = Board::new(pattern, columns, rows).unwrap();
        let middle = [0.45 * columns as f64, 0.45 * rows as f64];
        for turn in TURNS {
            let homography = homography(size, middle, 18.0, turn);
            let picture = rendered(size, &homography, 1.0, 1, |x, y| match pattern {
                Pattern::Checkerboard { .. } => checkerboard_is_dark(x, y, columns, rows),
                Pattern::Squares { .. } => squares_are_dark(x, y, columns, rows),
            });
            let found = board.find(picture.view()).unwrap();
            let points = board.points();
            let at = |x: f64, y: f64| {
                let is_it = |p: &[f64; 2]| (p[0] - x).abs() + (p[1] - y).abs() < 1e-9;
                found[points.iter().position(is_it).unwrap()]
            };
            let [right, down] =
                [points.iter().map(|p| p[0]).fold(0.0, f64::max), points.iter().map(|p| p[1]).fold(0.0, f64::max)];
            let (o, a, b) = (at(0.0, 0.0), at(right, 0.0), at(0.0, down));
            let turn_of = (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
            assert!(turn_of > 0.0, "{pattern:?} {turn:?} is mirrored");
            // The neighbours on the board are the neighbours in the picture: a row is the straight line that it was.
            for (p, q) in points.iter().zip(&found) {
                // Either way round: all four readings of a rectangle are homographies of the true one.
                let readings = [[p[0], p[1]], [right - p[0], down - p[1]], [p[1], right - p[0]], [down - p[1], p[0]]];
                let is_there = readings.iter().any(|&reading| {
                    let [u, v] = project(&homography, reading);
                    (u - q[0]).hypot(v - q[1]) < 0.5
                });
                assert!(is_there, "{pattern:?} {turn:?}: point {p:?} at {q:?}");
            }
        }
    }
}

#[test]
fn a_board_that_is_not_there_is_not_found() {
    let size = (640, 480);
    let homography = homography(size, [4.0, 2.5], 18.0, [0.3, 0.2, 0.1]);
    let picture = rendered(size, &homography, 2.0, 3, |x, y| checkerboard_is_dark(x, y, 9, 6));
    let find = |pattern, columns, rows| Board::new(pattern, columns, rows).unwrap().find(picture.view());
    assert!(find(CHECKERBOARD, 9, 6).is_ok());
    assert!(find(CHECKERBOARD, 6, 9).is_ok());
    assert!(matches!(find(CHECKERBOARD, 8, 6), Err(Error::BoardLarger { columns: 8, rows: 6 })));
    match find(CHECKERBOARD, 10, 7) {
        Err(Error::BoardNotFound { found, needed: 70, .. }) => assert!((54..70).contains(&found), "{found}"),
        other => panic!("{other:?}"),
    }
    assert!(matches!(find(SQUARES, 8, 8), Err(Error::BoardNotFound { .. })));
    let mut rng = Rng::new(5, 0);
    let noise = Array2::from_shape_simple_fn((480, 640), || rng.gaussian() as f32);
    for pattern in [CHECKERBOARD, SQUARES] {
        let board = Board::new(pattern, 9, 6).unwrap();
        assert!(matches!(board.find(noise.view()), Err(Error::BoardNotFound { .. })));
    }
}

/// A known camera, points with Gaussian noise of known size: the truth lies within two standard uncertainties in 95 % of
/// all trials. In 800 trials chance alone moves that by 0.7 %.
#[test]
fn two_standard_uncertainties_cover_the_true_camera() {
    const TRIALS: u64 = 800;
    let truth = [530.0, 525.0, 322.0, 236.0, 0.4, -0.25, 0.08, 1e-3, -5e-4, -0.02];
    let camera = Intrinsics::new(truth, [[0.0; PARAMETERS]; PARAMETERS], 640, 480).unwrap();
    let board: Vec<[f64; 2]> = (0..54).map(|i| [f64::from(i % 9), f64::from(i / 9)]).collect();
    let model = Model { skew: true, lens: Lens::Five };
    let inside: Vec<[usize; PARAMETERS]> = (0..TRIALS)
        .into_par_iter()
        .map(|trial| {
            let mut rng = Rng::new(trial, 1);
            let views: Vec<View> = (0..8)
                .map(|_| {
                    let turn = Vector3::from_fn(|_, _| rng.uniform_in(-0.6, 0.6));
                    let rotation = Rotation3::from_scaled_axis(turn);
                    let place =
                        Vector3::new(rng.uniform_in(-1.0, 1.0), rng.uniform_in(-1.0, 1.0), rng.uniform_in(10.0, 14.0));
                    let image_px = board
                        .iter()
                        .map(|[x, y]| {
                            let p = rotation * Vector3::new(x - 4.0, y - 2.5, 0.0) + place;
                            let [u, v] = camera.project(p.into()).unwrap();
                            [u + 0.2 * rng.gaussian(), v + 0.2 * rng.gaussian()]
                        })
                        .collect();
                    View { board: board.clone(), image_px }
                })
                .collect();
            let found = calibrate(&views, 640, 480, model).unwrap().intrinsics;
            let (values, stds) = (*found.parameters(), found.stds());
            std::array::from_fn(|i| usize::from((values[i] - truth[i]).abs() <= 2.0 * stds[i]))
        })
        .collect();
    for parameter in 0..PARAMETERS {
        let share = inside.iter().map(|trial| trial[parameter]).sum::<usize>() as f64 / TRIALS as f64;
        println!("parameter {parameter}: {share:.3}");
        assert!((0.90..=0.98).contains(&share), "parameter {parameter}: {share}");
    }
}

fn zhang(folder: &Path) -> Vec<View> {
    let folder = folder.join("calib_zhang");
    let board = views::points(&folder.join("Model.txt")).unwrap();
    (1..=5).map(|i| views::from_points(&folder.join(format!("data{i}.txt")), &board).unwrap()).collect()
}

/// Zhang's result on his points: alpha, beta, u0, v0 and k1, k2 (`calibration-result-zhang-withdistortion.txt`).
#[test]
fn zhangs_points_give_zhangs_camera() {
    let Some(folder) = data::folder() else { return };
    let found = calibrate(&zhang(&folder), 640, 480, Model { skew: true, lens: Lens::Two }).unwrap();
    println!("{found:?}");
    let published = [832.5, 832.53, 303.959, 206.585, 0.204_494, -0.228_601, 0.190_353];
    for (index, expected) in published.into_iter().enumerate() {
        let within = if index < 4 { 0.5 } else { 0.005 };
        let value = found.intrinsics.parameters()[index];
        assert!((value - expected).abs() < within, "parameter {index}: {value} {expected}");
    }
    assert!(found.rms_px <= 0.45, "{}", found.rms_px);
}

fn from_pictures(paths: &[PathBuf], board: &Board, model: Model) -> Calibration {
    let views: Vec<View> = paths
        .par_iter()
        .map(|path| views::from_picture(path, board).unwrap_or_else(|e| panic!("{}: {e}", path.display())).view)
        .collect();
    calibrate(&views, 640, 480, model).unwrap()
}

#[test]
fn zhangs_pictures_give_zhangs_camera() {
    let Some(folder) = data::folder() else { return };
    let paths: Vec<PathBuf> = (1..=5).map(|i| folder.join(format!("calib_zhang/CalibIm{i}.png"))).collect();
    let board = Board::new(SQUARES, 8, 8).unwrap();
    let found = from_pictures(&paths, &board, Model { skew: true, lens: Lens::Two });
    println!("{found:?}");
    for (value, expected) in found.intrinsics.parameters().iter().zip([832.5, 832.53]) {
        assert!((value - expected).abs() < 1.0, "{value} {expected}");
    }
    assert!(found.rms_px <= 0.45, "{}", found.rms_px);
}

fn sample_pictures(folder: &Path, side: &str) -> Vec<PathBuf> {
    let numbers = [1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 13, 14];
    numbers.map(|i| folder.join(format!("calib_opencv/{side}{i:02}.jpg"))).to_vec()
}

/// All pictures of both cameras are used. `OpenCV` 5.0 finds fx = 532.83 and fy = 532.95 px with standard uncertainties of
/// 0.44 and 0.46 px from its corners with half windows of 5 px (rms 0.195 px), and 533.17, 533.25 px with 9 px.
///
/// Its published 535.916 px come from half windows of 11 px, see below.
#[test]
fn the_samples_of_opencv_are_calibrated_to_a_fifth_of_a_pixel() {
    let Some(folder) = data::folder() else { return };
    let board = Board::new(CHECKERBOARD, 9, 6).unwrap();
    let left = from_pictures(&sample_pictures(&folder, "left"), &board, Model::default());
    println!("left {left:?}");
    assert!(left.rms_px < 0.2, "{}", left.rms_px);
    let stds = left.intrinsics.stds();
    for (index, opencv) in [532.827, 532.946].into_iter().enumerate() {
        let value = left.intrinsics.parameters()[index];
        assert!((value - opencv).abs() < 2.0 * stds[index], "{index}: {value} {opencv}");
    }
    let right = from_pictures(&sample_pictures(&folder, "right"), &board, Model::default());
    println!("right {right:?}");
    assert!(right.rms_px < 0.2, "{}", right.rms_px);
    assert_eq!((left.view_rms_px.len(), right.view_rms_px.len()), (13, 13));
}

/// The camera that `OpenCV` publishes with its left pictures, `left_intrinsics.yml`: fx = fy = 535.916 px, mean error
/// 0.393 px. Its half windows of 11 px reach the next corners where the board is small or tilted, and the error is twice
/// that of windows that end before them.
#[test]
fn the_published_camera_of_the_sample_comes_from_wide_corner_windows() {
    let Some(folder) = data::folder() else { return };
    let board = Board::new(CHECKERBOARD, 9, 6).unwrap();
    let paths = sample_pictures(&folder, "left");
    let own = from_pictures(&paths, &board, Model::default());
    let wide = from_pictures(&paths, &board.with_corner_window(11).unwrap(), Model::default());
    println!("own window {:.3?} rms {:.3}", &own.intrinsics.parameters()[..2], own.rms_px);
    println!("half window 11 px {:.3?} rms {:.3}", &wide.intrinsics.parameters()[..2], wide.rms_px);
    for focal_px in &wide.intrinsics.parameters()[..2] {
        assert!((focal_px - 535.916).abs() <= 1.0, "{focal_px}");
    }
    assert!(wide.rms_px <= 0.45, "{}", wide.rms_px);
    assert!(own.rms_px < 0.5 * wide.rms_px, "{} {}", own.rms_px, wide.rms_px);
    let squares = Board::new(SQUARES, 8, 8).unwrap();
    assert!(squares.with_corner_window(11).is_err() && board.with_corner_window(0).is_err());
}

/// One frame of the telephone.
struct Frame {
    path: PathBuf,
    camera: Intrinsics,
    exposure_s: f64,
    /// Angular rate about axes across the view, from the gyroscope.
    gyro_rad_s: f64,
    /// Share of the blur that the rotation explains: the camera also moved.
    rotation_share: f64,
}

fn frames(folder: &Path, sequence: &str) -> Vec<Frame> {
    let folder = folder.join("real_phone");
    let table = std::fs::read_to_string(folder.join("truth_selected.csv")).unwrap();
    let header: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let column = |name: &str| header.iter().position(|&column| column == name).unwrap();
    table
        .lines()
        .skip(1)
        .map(|line| line.split(',').collect::<Vec<_>>())
        .filter(|cells| cells[column("seq")] == sequence)
        .map(|cells| {
            let number = |name: &str| cells[column(name)].parse::<f64>().unwrap();
            let mut parameters = [0.0; PARAMETERS];
            (parameters[0], parameters[1]) = (number("fx_px"), number("fx_px"));
            (parameters[2], parameters[3]) = (number("cx_px"), number("cy_px"));
            Frame {
                path: folder.join(cells[0]),
                camera: Intrinsics::new(parameters, [[0.0; PARAMETERS]; PARAMETERS], 1920, 1440).unwrap(),
                exposure_s: number("exposure_s"),
                gyro_rad_s: number("omega_cam_x").hypot(number("omega_cam_y")),
                rotation_share: number("blur_len_rotonly_px") / number("blur_len_px"),
            }
        })
        .collect()
}

/// Ratios of the angular rate from the blur to that of the gyroscope, of the frames that the method is sure of and whose
/// camera hardly moved otherwise, in rising order.
fn rate_ratios(folder: &Path, sequence: &str) -> Vec<f64> {
    let mut ratios: Vec<f64> = frames(folder, sequence)
        .into_par_iter()
        .filter_map(|frame| {
            let picture = picture::read(&frame.path, Linearize::Auto).unwrap();
            let (rows, columns) = picture.luma.dim();
            let blur = Whittle::new(&Settings::default()).estimate(centre_square(picture.luma.view(), 640)).unwrap();
            let centre_px = [0.5 * (columns as f64 - 1.0), 0.5 * (rows as f64 - 1.0)];
            let turn = frame.camera.ideal_blur(LocalBlur {
                centre_px,
                angle: blur.angle,
                angle_std_deg: 0.0,
                length_px: blur.length_px,
                length_std_px: blur.length_std_px.unwrap(),
                correlation: 0.0,
            });
            let rate = turn.unwrap().turn_rad().unwrap().value() / frame.exposure_s;
            println!(
                "{}: {rate:.3} rad/s, gyroscope {:.3}, rotation {:.2} of the blur, {}",
                frame.path.display(),
                frame.gyro_rad_s,
                frame.rotation_share,
                blur.status.name()
            );
            let is_turning = (frame.rotation_share - 1.0).abs() < 0.1;
            (blur.status == Status::Ok && is_turning).then_some(rate / frame.gyro_rad_s)
        })
        .collect();
    ratios.sort_by(f64::total_cmp);
    ratios
}

#[test]
fn a_turning_telephone_agrees_with_its_gyroscope() {
    let Some(folder) = data::folder() else { return };
    for sequence in ["billiards", "commonroom"] {
        let ratios = rate_ratios(&folder, sequence);
        println!("{sequence}: {ratios:.3?}");
        assert!(ratios.len() >= 3, "{ratios:?}");
        // Up to 10 % of the blur is the camera's own way, and the gyroscope is read once in an exposure: some % more.
        let median = ratios[ratios.len() / 2];
        assert!((median - 1.0).abs() < 0.15, "{sequence}: {median}");
    }
}
