//! Lengths in segments of few rows or columns: the method by itself, and the tables of the thesis's chapter 7.
//!
//! The tables need pictures that are not part of the project; without them their tests say that they skipped.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a picture or a program that fails fails the test")]

use std::process::Command;

use blur_core::estimate::{AxialAngle, Settings, Status, registry};
use blur_sim::defocus::Defocus;
use blur_sim::expose::expose;
use blur_sim::motion::Motion;
use blur_sim::scene::{DeadLeaves, dead_leaves};
use blur_sim::sensor::{Sensor, f32_from_u8};
use e2e_tests::{data, program};
use ndarray::Array2;
use serde_json::Value;

const HEIGHTS_PX: [usize; 4] = [32, 16, 8, 4];
const LENGTHS_PX: [f64; 3] = [9.3, 17.0, 30.0];

/// Dead leaves, `rows` x 256 pixels, moved along the rows, at 40 dB.
fn strip(seed: u64, rows: usize, length_px: f64) -> Array2<f32> {
    segment(seed, (rows, 256), length_px, Some(40.0))
}

/// Dead leaves of `dim` pixels, moved along the rows; without noise but that of 8 bit, or at so many decibels.
fn segment(seed: u64, dim: (usize, usize), length_px: f64, psnr_db: Option<f64>) -> Array2<f32> {
    let motion = Motion::uniform(length_px, AxialAngle::from_deg(0.0)).unwrap();
    let (lost_rows, lost_columns) = motion.extent_px();
    let scene = dead_leaves(seed, dim.0 + lost_rows, dim.1 + lost_columns, &DeadLeaves::default()).unwrap();
    let exposure = expose(scene.view(), &motion).unwrap();
    let sensor = psnr_db.map_or(Sensor::ideal(), |psnr_db| Sensor::ideal().with_psnr_db(psnr_db).unwrap());
    f32_from_u8(sensor.record(exposure.view(), seed).unwrap().view())
}

#[test]
fn two_standard_uncertainties_cover_the_errors_in_strips_of_few_rows() {
    let mut estimator = registry::length("whittle").unwrap().build(&Settings::default());
    let (mut ok, mut covered, mut cases) = (0, 0, 0);
    for rows in HEIGHTS_PX {
        for length_px in LENGTHS_PX {
            for _ in 0..6 {
                cases += 1;
                let image = strip(7000 + cases, rows, length_px);
                let found = estimator.estimate(image.view(), AxialAngle::from_deg(0.0)).unwrap();
                let std_px = found.std_px.unwrap();
                let error_px = found.length_px - length_px;
                if found.status == Status::Ok {
                    ok += 1;
                    covered += u64::from(error_px.abs() <= 2.0 * std_px);
                }
                println!("{rows} rows, {length_px} px: {error_px:+.3} of {std_px:.3} px, {:?}", found.status);
            }
        }
    }
    println!("{covered} of {ok} within two standard uncertainties, of {cases}");
    assert!(3 * ok >= 2 * cases, "{ok} of {cases} are ok");
    // Of 48 normal errors 95 % are covered, and less than 85 % once in 300 draws.
    assert!(100 * covered >= 85 * ok, "{covered} of {ok}");
}

#[test]
fn two_standard_uncertainties_cover_the_errors_in_segments_of_short_rows() {
    let mut estimator = registry::length("whittle").unwrap().build(&Settings::default());
    for psnr_db in [None, Some(40.0), Some(30.0)] {
        let (mut ok, mut covered, mut cases) = (0, 0, 0);
        for width in [20, 30, 40, 50, 60] {
            for share in [0.5, 0.41, 0.28] {
                for _ in 0..4 {
                    cases += 1;
                    let length_px = share * width as f64;
                    let image = segment(7400 + cases, (256, width), length_px, psnr_db);
                    let found = estimator.estimate(image.view(), AxialAngle::from_deg(0.0)).unwrap();
                    let std_px = found.std_px.unwrap();
                    let error_px = found.length_px - length_px;
                    if found.status == Status::Ok {
                        ok += 1;
                        covered += u64::from(error_px.abs() <= 2.0 * std_px);
                        // Who is called certain is not gross.
                        assert!(error_px.abs() < 0.25 * length_px, "{width} px, {length_px} px: {found:?}");
                    }
                    println!("{width} px, {length_px:.1} px: {error_px:+.3} of {std_px:.3} px, {:?}", found.status);
                }
            }
        }
        println!("{psnr_db:?}: {covered} of {ok} within two standard uncertainties, of {cases}");
        // Noise may hide the blur from many of them; without it nearly all tell.
        let (least_ok, of) = if psnr_db.is_none() { (9, 10) } else { (1, 5) };
        assert!(of * ok >= least_ok * cases, "{psnr_db:?}: {ok} of {cases} are ok");
        // Of 54 normal errors 95 % are covered, and less than 85 % once in 300 draws.
        assert!(100 * covered >= 85 * ok, "{psnr_db:?}: {covered} of {ok}");
    }
}

#[test]
fn a_strip_is_measured_along_its_columns_as_along_its_rows() {
    let mut estimator = registry::length("whittle").unwrap().build(&Settings::default());
    for (seed, rows) in (7200..).zip(HEIGHTS_PX) {
        let image = strip(seed, rows, 17.0);
        let flat = estimator.estimate(image.view(), AxialAngle::from_deg(0.0)).unwrap();
        let steep = estimator.estimate(image.t(), AxialAngle::from_deg(90.0)).unwrap();
        let (a, b) = (flat.std_px.unwrap(), steep.std_px.unwrap());
        // Sums in another order, in single precision, and a search that stops at a gain of 0.02 in log-likelihood.
        assert!((flat.length_px - steep.length_px).abs() < 0.1 * a, "{rows}: {flat:?} {steep:?}");
        assert!((a / b - 1.0).abs() < 0.05, "{rows}: {flat:?} {steep:?}");
    }
    // Short rows likewise, and here the arithmetic is the same.
    let image = segment(7210, (128, 40), 17.0, Some(40.0));
    let flat = estimator.estimate(image.view(), AxialAngle::from_deg(0.0)).unwrap();
    assert_eq!(flat.status, Status::Ok);
    assert_eq!(estimator.estimate(image.t(), AxialAngle::from_deg(90.0)).unwrap(), flat);
}

#[test]
fn what_did_not_move_is_denied_though_its_rows_are_asked() {
    let mut estimator = registry::length("whittle").unwrap().build(&Settings::default());
    let mut status = |scene: &Array2<f64>, seed| {
        let sensor = Sensor::ideal().with_psnr_db(40.0).unwrap();
        let picture = f32_from_u8(sensor.record(scene.view(), seed).unwrap().view());
        estimator.estimate(picture.view(), AxialAngle::from_deg(0.0)).unwrap().status
    };
    for seed in 7600..7606 {
        let sharp = dead_leaves(seed, 128, 200, &DeadLeaves::default()).unwrap();
        let found = status(&sharp, seed);
        assert!(matches!(found, Status::NoMotionBlur(_)), "{seed} sharp: {found:?}");
        let blur = Defocus::new(6.0).unwrap();
        let scene = dead_leaves(seed, 128 + 16, 200 + 16, &DeadLeaves::default()).unwrap();
        let found = status(&expose(scene.view(), &blur).unwrap(), seed);
        assert_ne!(found, Status::Ok, "{seed} out of focus: {found:?}");
    }
}

/// The rows of a table of one picture in 16; `None` where there is no data.
fn table(name: &str) -> Option<Vec<Value>> {
    let folder = data::folder()?;
    let mut command = Command::new(program::built("blur-cli", "reproduce"));
    let output = command.args([name, "--step", "16", "--json", "--images"]).arg(folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    println!("{text}");
    Some(text.lines().map(|line| serde_json::from_str(line).unwrap()).collect())
}

fn number(row: &Value, field: &str) -> f64 {
    row[field].as_f64().unwrap_or_else(|| panic!("{field} of {row}"))
}

#[test]
fn segments_of_any_height_are_measured_better_than_in_table_7_1() {
    let Some(rows) = table("7.1") else { return };
    for height in [256, 128, 64, 32, 16, 8, 4, 2] {
        let level = format!("256x{height}, tukey 0.25");
        let row = rows.iter().find(|row| row["method"] == "whittle" && row["level"] == level).unwrap();
        assert!(number(row, "median") <= number(row, "thesis"), "{row}");
    }
}

#[test]
fn hard_edges_spoil_what_soft_ones_allow() {
    let Some(rows) = table("edges") else { return };
    for (method, window) in [("whittle", "tukey 0.25"), ("dct-pseudo-cepstrum", "hann")] {
        let mean = |level: &str| {
            let of = |row: &&Value| row["method"] == method && row["level"] == level;
            let means: Vec<f64> = rows.iter().filter(of).map(|row| number(row, "mean")).collect();
            // Lengths from 5 to 90 px in steps of 5.
            assert_eq!(means.len(), 18);
            means.iter().sum::<f64>() / 18.0
        };
        let (hard, soft) = (mean("hard disk"), mean(window));
        assert!(hard > 3.0 * soft, "{method}: {hard} {soft}");
    }
}

/// The thesis's rule holds for all its lengths: a segment twice as wide as the blur is enough. So are all wider ones up to 30 px;
/// of longer blurs some a little wider err by more than 1 %, none from 2.5 times on.
#[test]
fn a_segment_twice_as_wide_as_the_blur_suffices() {
    let Some(rows) = table("7.2") else { return };
    let at_twice: Vec<&Value> = rows
        .iter()
        .filter(|row| row["method"] == "whittle" && !row["least_width"].is_null())
        .filter(|row| row["level"].as_str().unwrap().ends_with("tukey 0.25"))
        .collect();
    assert_eq!(at_twice.len(), 9);
    for row in at_twice {
        assert!(number(row, "median") <= 1.0, "{row}");
        let (length_px, least_px) = (number(row, "true_length_px"), number(&row["least_width"], "by_median_px"));
        let most = if length_px < 40.0 { 2.0 } else { 2.5 };
        assert!(least_px <= most * length_px, "{row}");
    }
}
