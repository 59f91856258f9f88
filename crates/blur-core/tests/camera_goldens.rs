//! Calibration against `OpenCV` and, with skew, scipy: `fixtures/camera/make_opencv.py`.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a golden that cannot be read or fitted fails the test")]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use blur_core::camera::{Board, Calibration, Lens, Model, PARAMETER_NAMES, Pattern, View, calibrate};

/// The rows of a golden, without its header.
fn rows(name: &str) -> Vec<Vec<String>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/camera").join(name);
    let text = fs::read_to_string(path).unwrap();
    text.lines().skip(1).map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

fn views() -> Vec<View> {
    let board = Board::new(Pattern::Checkerboard { square: 1.0 }, 9, 6).unwrap().points();
    let mut views = BTreeMap::<usize, Vec<[f64; 2]>>::new();
    for row in rows("corners.csv") {
        views.entry(row[0].parse().unwrap()).or_default().push([row[1].parse().unwrap(), row[2].parse().unwrap()]);
    }
    views.into_values().map(|image_px| View { board: board.clone(), image_px }).collect()
}

fn fitted(skew: bool, lens: Lens) -> Calibration {
    calibrate(&views(), 640, 480, Model { skew, lens }).unwrap()
}

/// Values within 1e-4 of their uncertainty and uncertainties within 1e-4: both programs stop that near to the minimum.
fn assert_golden(case: &str, found: &Calibration) {
    let (values, stds) = (found.intrinsics.parameters(), found.intrinsics.stds());
    let mut compared = 0;
    for row in rows("calibrations.csv").iter().filter(|row| row[0] == case) {
        let value: f64 = row[2].parse().unwrap();
        if row[1] == "rms_px" {
            assert!((found.rms_px - value).abs() < 1e-8, "{case} rms {} {value}", found.rms_px);
            continue;
        }
        let std: f64 = row[3].parse().unwrap();
        let index = PARAMETER_NAMES.iter().position(|&name| name == row[1]).unwrap();
        assert!((values[index] - value).abs() < 1e-4 * std, "{case} {}: {} {value}", row[1], values[index]);
        assert!((stds[index] / std - 1.0).abs() < 1e-4, "{case} u({}): {} {std}", row[1], stds[index]);
        compared += 1;
    }
    assert_eq!(compared, found.model.fitted().iter().filter(|&&fit| fit).count());
}

#[test]
fn cameras_and_their_uncertainties_are_those_of_opencv() {
    for (case, lens) in [("two", Lens::Two), ("four", Lens::Four), ("five", Lens::Five)] {
        assert_golden(case, &fitted(false, lens));
    }
}

#[test]
fn a_camera_with_skew_is_that_of_scipy() {
    assert_golden("skew", &fitted(true, Lens::Two));
}

/// `left_intrinsics.yml` of `OpenCV`'s samples: one focal length of 535.916 px, mean error 0.393 px.
#[test]
fn the_corners_of_the_sample_give_the_published_camera() {
    let found = fitted(false, Lens::Five);
    for focal in &found.intrinsics.parameters()[..2] {
        assert!((focal - 535.916).abs() < 1.0, "{focal}");
    }
    assert!(found.rms_px < 0.45, "{}", found.rms_px);
}

#[test]
fn points_are_projected_and_found_again_as_by_opencv() {
    let camera = fitted(false, Lens::Five).intrinsics;
    for row in rows("projections.csv") {
        let number = |i: usize| row[i].parse::<f64>().unwrap();
        let (x, y) = (number(0), number(1));
        let [u, v] = camera.project([2.0 * x, 2.0 * y, 2.0]).unwrap();
        // The camera itself agrees to 1e-4 of its uncertainty, 1e-4 px and less.
        assert!((u - number(2)).abs() < 1e-3 && (v - number(3)).abs() < 1e-3, "{x} {y}: {u} {v}");
        let [back_x, back_y] = camera.unproject([u, v]).unwrap();
        assert!((back_x - x).abs() < 1e-12 && (back_y - y).abs() < 1e-12, "{x} {y}: {back_x} {back_y}");
    }
}
