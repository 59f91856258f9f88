//! `--reference`: a blurred picture against sharp ones.
#![allow(clippy::unwrap_used, reason = "a picture that cannot be written fails the test")]

mod common;

use std::path::{Path, PathBuf};

use blur_core::estimate::AxialAngle;
use blur_sim::motion::Motion;
use blur_sim::rig::{Rig, Setting, Studio};
use blur_sim::scene::{DeadLeaves, dead_leaves};
use common::*;
use ndarray::Array2;

const SIDE: usize = 160;

/// The truth about the blurred picture.
const LENGTH_PX: f64 = 24.0;
const RATIO: f64 = -0.4;
const DEG: f64 = 40.0;

fn save(folder: &Path, name: &str, picture: &Array2<u8>) -> PathBuf {
    let path = folder.join(name);
    let (rows, columns) = picture.dim();
    let pixels = picture.iter().copied().collect();
    image::GrayImage::from_raw(columns as u32, rows as u32, pixels).unwrap().save(&path).unwrap();
    path
}

/// Two stills in a folder of their own and a blurred picture.
fn pictures(name: &str) -> (PathBuf, PathBuf) {
    let folder = folder(name);
    let stills = folder.join("stills");
    std::fs::create_dir(&stills).unwrap();
    let mut studio = Studio::new(&Rig { side_px: SIDE, psnr_db: Some(40.0), ..Rig::default() }).unwrap();
    let scene = dead_leaves(5, SIDE + 120, SIDE + 120, &DeadLeaves::default()).unwrap();
    let setting = |noise_seed| Setting { right_px: 0.2, down_px: -0.3, gain: 0.9, kappa: 0.1, noise_seed };
    let still = Motion::uniform(0.0, AxialAngle::from_deg(0.0)).unwrap();
    for seed in [1, 2] {
        let picture = studio.photograph(scene.view(), &still, &setting(seed)).unwrap();
        save(&stills, &format!("{seed}.png"), &picture);
    }
    let motion = Motion::new(LENGTH_PX, AxialAngle::from_deg(DEG), RATIO).unwrap();
    let blurred = studio.photograph(scene.view(), &motion, &setting(3)).unwrap();
    (save(&folder, "blurred.png", &blurred), stills)
}

fn text(path: &Path) -> String {
    path.to_str().unwrap().to_owned()
}

#[test]
fn stills_give_the_direction_and_the_sign() {
    let (blurred, stills) = pictures("reference-sign");
    let pattern = text(&stills.join("*.png"));
    let two = [text(&stills.join("1.png")), text(&stills.join("2.png"))];
    let mut answers = Vec::new();
    for named in [vec![text(&stills)], vec![pattern], two.to_vec()] {
        let mut arguments = vec![text(&blurred), "--accel".to_owned(), "--reference".to_owned()];
        arguments.extend(named);
        let (status, objects) = run_json(arguments);
        assert_eq!((status, objects.len()), (0, 1));
        let found = &objects[0];
        assert_eq!(found["method"], "reference");
        assert_eq!(found["status"], "ok", "{found}");
        let number = |key: &str| found[key].as_f64().unwrap_or(f64::NAN);
        // Four standard uncertainties, themselves small: a wrong sign or end would be off by far more.
        for (value, std, truth) in [
            ("length_px", "length_std_px", LENGTH_PX),
            ("direction_deg", "angle_std_deg", DEG),
            ("angle_deg", "angle_std_deg", DEG),
            ("accel_ratio", "accel_ratio_std", RATIO),
        ] {
            let error = (number(value) - truth).abs();
            assert!(error < 4.0 * number(std), "{value}: {found}");
        }
        assert!(number("length_std_px") < 0.2 && number("accel_ratio_std") < 0.03, "{found}");
        answers.push(number("accel_ratio"));
    }
    assert!(answers.iter().all(|answer| *answer == answers[0]), "{answers:?}");
}

#[test]
fn the_ratio_is_there_only_when_asked_for_and_the_text_says_where_it_goes() {
    let (blurred, stills) = pictures("reference-text");
    let (_, objects) = run_json([text(&blurred), "--reference".to_owned(), text(&stills)]);
    assert!(objects[0].get("accel_ratio").is_none() && objects[0].get("direction_deg").is_some(), "{objects:?}");
    let output = run([text(&blurred), "--accel".to_owned(), "--reference".to_owned(), text(&stills)]);
    let shown = stdout(&output);
    assert!(shown.contains("direction 40") || shown.contains("direction 39.9"), "{shown}");
    assert!(shown.contains("(slowing down)"), "{shown}");
}

#[test]
fn a_region_is_cut_from_the_stills_too() {
    let (blurred, stills) = pictures("reference-region");
    let region = ["--roi", "20,10,120,130", "--reference"].map(str::to_owned);
    let mut arguments = vec![text(&blurred)];
    arguments.extend(region);
    arguments.push(text(&stills));
    let (status, objects) = run_json(arguments);
    assert_eq!(status, 0);
    let found = &objects[0];
    let error = (found["length_px"].as_f64().unwrap() - LENGTH_PX).abs();
    assert!(error < 4.0 * found["length_std_px"].as_f64().unwrap(), "{found}");
}

#[test]
fn mistakes_are_told_before_anything_is_measured() {
    let (blurred, stills) = pictures("reference-mistakes");
    let (blurred, still) = (text(&blurred), text(&stills.join("1.png")));
    for (arguments, message) in [
        (vec!["--method", "reference", &blurred], "--reference"),
        (vec!["--method", "whittle", &blurred, "--reference", &still], "does not compare"),
        (vec!["--known-angle", "0", &blurred, "--reference", &still], "--known-angle"),
        (vec!["--angle", "dct-radon", &blurred, "--reference", &still], "--angle"),
        (vec!["--length", "autocorrelation", &blurred, "--reference", &still], "--length"),
        (vec![&blurred, "--reference", "nowhere.png"], "nowhere.png"),
        (vec!["--reference", &still], "IMAGE"),
    ] {
        let output = run(arguments.clone());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {output:?}");
        assert!(stderr(&output).contains(message), "{arguments:?}: {output:?}");
        assert_eq!(stdout(&output), "");
    }
}

#[test]
fn a_picture_of_another_size_fails_alone() {
    let (blurred, stills) = pictures("reference-size");
    let folder = folder("reference-other-size");
    let other = save(&folder, "other.png", &Array2::from_shape_fn((100, 120), |(y, x)| ((y * 7 + x * 13) % 251) as u8));
    let (status, objects) = run_json([text(&other), text(&blurred), "--reference".to_owned(), text(&stills)]);
    assert_eq!(status, 1);
    assert!(objects[0]["error"].as_str().unwrap().contains("120x100"), "{objects:?}");
    assert_eq!(objects[1]["status"], "ok");
}

#[test]
fn lengths_beyond_the_picture_are_not_looked_for() {
    let (picture, stills) = pictures("reference-range");
    for range in ["4,1e300", "4,1e17", "4,1e6"] {
        let arguments = ["--range", range, picture.to_str().unwrap(), "--reference", stills.to_str().unwrap()];
        let (status, records) = run_json(arguments);
        assert_eq!(status, 0, "{range}");
        assert!((number(&records[0], "length_px") - LENGTH_PX).abs() < 0.5, "{range}: {}", records[0]);
    }
}
