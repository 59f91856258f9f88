//! The program `reproduce`: mistakes, help, and each table on a few pictures.
#![allow(clippy::unwrap_used, reason = "a program that does not run or answer fails the test")]

mod common;

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use blur_cli::reproduce::TABLES;
use blur_core::estimate::registry::{ANGLE, JOINT, LENGTH};
use blur_sim::scene::{DeadLeaves, dead_leaves};
use common::{folder, number, png, stderr, stdout, write};
use image::GrayImage;
use serde_json::Value;

fn reproduce<S: AsRef<OsStr>>(arguments: impl IntoIterator<Item = S>) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_reproduce")).args(arguments).output().unwrap();
    assert!(output.status.code().is_some(), "ended by a signal: {output:?}");
    assert!(!stderr(&output).contains("panicked"), "{}", stderr(&output));
    output
}

/// A sharp picture as PNG.
fn sharp(seed: u64, width: u32, height: u32) -> Vec<u8> {
    let scene = dead_leaves(seed, height as usize, width as usize, &DeadLeaves::default()).unwrap();
    png(GrayImage::from_fn(width, height, |x, y| image::Luma([scene[[y as usize, x as usize]].round() as u8])))
}

/// Two pictures to measure, one that is too small for any blur, and one that is left out by its name.
fn pictures(name: &str) -> PathBuf {
    let folder = folder(name);
    for (name, picture) in
        [("a.png", sharp(1, 300, 260)), ("b.png", sharp(2, 240, 280)), ("small.png", sharp(3, 65, 65))]
    {
        write(&folder, name, &picture);
    }
    write(&folder, "moon.png", &sharp(4, 300, 300));
    folder
}

fn objects(output: &Output) -> Vec<Value> {
    assert_eq!(output.status.code(), Some(0), "{}", stderr(output));
    stdout(output).lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

fn arguments<'a>(line: &'a str, images: &'a Path) -> Vec<&'a str> {
    line.split(' ').chain(["--images", images.to_str().unwrap()]).collect()
}

#[test]
fn mistakes_end_with_status_2_before_anything_is_measured() {
    for arguments in [
        "",
        "nonsense",
        "coverage efficiency",
        "coverage --method nonsense",
        "coverage --method dft-radon+nonsense",
        "4.1 --method nonsense",
        "4.1 --method dct-pseudo-cepstrum",
        "5.3 --method dct-radon",
        "4.4 --step 0",
        "coverage --per-level 0",
        "efficiency --fields -3",
        "coverage --step 0",
        "coverage --seed x",
        "coverage --jobs 0",
        "coverage --frobnicate",
    ] {
        let output = reproduce(arguments.split_whitespace());
        assert_eq!(output.status.code(), Some(2), "{arguments}: {output:?}");
        assert_eq!(stdout(&output), "", "{arguments}");
        assert!(!stderr(&output).is_empty(), "{arguments}");
    }
    assert!(stderr(&reproduce(["nonsense"])).contains("coverage, efficiency, negatives"));
    assert!(stderr(&reproduce(["4.1", "--method", "nonsense"])).contains("dct-radon"));
}

#[test]
fn the_help_lists_every_table() {
    let output = reproduce(["--help"]);
    assert_eq!(output.status.code(), Some(0));
    for table in TABLES {
        assert!(stdout(&output).contains(table.name) && stdout(&output).contains(table.summary), "{}", table.name);
    }
}

#[test]
fn folders_without_pictures_are_named() {
    let empty = folder("reproduce-empty");
    for (folder, complaint) in [(empty.as_path(), "no picture"), (Path::new("/nonexistent"), "/nonexistent")] {
        let output = reproduce(arguments("coverage", folder));
        assert_eq!(output.status.code(), Some(1), "{output:?}");
        assert_eq!(stdout(&output), "");
        assert!(stderr(&output).contains(complaint) && stderr(&output).contains(folder.to_str().unwrap()));
    }
}

#[test]
fn coverage_reports_every_picture_at_every_level() {
    let images = pictures("reproduce-coverage");
    // Six draws go twice round three pictures, one of which is too small each time.
    let output = reproduce(arguments("coverage --per-level 6 --json --pictures --seed 3", &images));
    let objects = objects(&output);
    let (rows, pictures): (Vec<&Value>, Vec<&Value>) = objects.iter().partition(|object| object["image"].is_null());
    assert_eq!((rows.len(), pictures.len()), (2 * 4, 4 * 4));
    assert_eq!(stderr(&output).matches("small.png: skipped").count(), 2, "{}", stderr(&output));
    for (row, level) in rows.iter().zip(["clean", "36 dB", "28 dB", "20 dB"].repeat(2)) {
        assert_eq!((&row["table"], &row["level"], &row["n"]), (&"coverage".into(), &level.into(), &4.into()), "{row}");
        assert!(row["method"].is_string() && row["thesis"].is_null(), "{row}");
    }
    for picture in &pictures {
        assert!(["a.png", "b.png"].contains(&picture["image"].as_str().unwrap()), "{picture}");
        let (truth, length) = (number(picture, "true_length_px"), number(picture, "length_px"));
        assert!((6.0..=90.0).contains(&truth), "{picture}");
        assert!((number(picture, "length_error_px") - (length - truth)).abs() < 1e-9, "{picture}");
    }
    // Fresh motions in every round, one for all levels of a draw.
    let mut lengths: Vec<String> = pictures.iter().map(|picture| picture["true_length_px"].to_string()).collect();
    lengths.dedup();
    assert_eq!(lengths.len(), 4);
    // Clean dead leaves are measured well by every method that may be the default.
    assert!(number(rows[0], "n_ok") >= 2.0 && number(rows[4], "median") < 0.5, "{}", stdout(&output));
}

#[test]
fn results_do_not_depend_on_the_threads_but_on_the_seed() {
    let images = pictures("reproduce-threads");
    let made = |options: &str| {
        let line = format!("coverage --per-level 4 --pictures {options}");
        let output = reproduce(arguments(&line, &images));
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        stdout(&output).to_owned()
    };
    assert_eq!(made("--jobs 1"), made("--jobs 2"));
    assert_ne!(made("--seed 1"), made("--seed 2"));
}

#[test]
fn plots_are_drawn_beside_the_table() {
    let (images, plots) = (pictures("reproduce-plots"), folder("reproduce-svg").join("made"));
    let line = format!("coverage --per-level 2 --plots {}", plots.display());
    let output = reproduce(arguments(&line, &images));
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    for name in ["coverage-angle_deg.svg", "coverage-length_px.svg"] {
        let drawn = std::fs::read_to_string(plots.join(name)).unwrap();
        assert!(drawn.starts_with("<svg") && drawn.contains("clean"), "{name}");
    }
}

#[test]
fn efficiency_needs_no_pictures_and_states_both_bounds() {
    let output = reproduce("efficiency --fields 1 --json".split(' '));
    let rows = objects(&output);
    assert_eq!(rows.len(), 2 * 4);
    for row in &rows {
        assert_eq!(row["n"], 1, "{row}");
        assert!(number(row, "bound") > 0.0 && number(row, "bound_windowed") > number(row, "bound"), "{row}");
        assert!(number(&row["ratio_all"], "value") > 0.0, "{row}");
    }
}

#[test]
fn negatives_counts_pictures_that_did_not_move() {
    let images = pictures("reproduce-negatives");
    let output = reproduce(arguments("negatives --json --pictures", &images));
    let objects = objects(&output);
    let (rows, pictures): (Vec<&Value>, Vec<&Value>) = objects.iter().partition(|object| object["image"].is_null());
    let row = |level: &str| *rows.iter().find(|row| row["level"] == level).unwrap();
    // All four as they are; the two that are no squares cut as well.
    assert_eq!((&row("sharp")["n"], &row("sharp, centre")["n"]), (&4.into(), &2.into()));
    assert_eq!(row("photograph")["n"], 0);
    assert!(stderr(&output).contains("text_defocus.jpg: skipped"));
    assert!(number(row("disk, clean"), "n") >= 3.0);
    let offenders: usize = rows.iter().map(|row| row["offenders"].as_array().unwrap().len()).sum();
    assert_eq!(offenders, pictures.iter().filter(|picture| picture["status"] == "ok").count());
    assert!(pictures.iter().all(|picture| picture["true_length_px"].is_null()));
}

#[test]
fn every_method_answers_to_the_same_thinned_pictures() {
    let images = pictures("reproduce-compare");
    // Four pictures, one of which is too small, by 91 angles, one pair in 60.
    let objects = objects(&reproduce(arguments("4.2 --step 60 --json --pictures", &images)));
    let (rows, answers): (Vec<&Value>, Vec<&Value>) = objects.iter().partition(|object| object["image"].is_null());
    let methods = ANGLE.len() + JOINT.len();
    assert_eq!(rows.len(), 4 * methods);
    let n = number(rows[0], "n") as usize;
    assert!((4..=7).contains(&n), "{n}");
    assert_eq!(answers.len(), 3 * methods * n);
    for rows in rows.chunks(4) {
        let [first, .., pooled] = rows else { unreachable!() };
        assert_eq!((&first["level"], &pooled["level"]), (&"36 dB".into(), &"36-20 dB".into()));
        assert_eq!(number(pooled, "n") as usize, 3 * n);
        // The thesis states its errors over all noise.
        assert!(first["thesis"].is_null() && (pooled["thesis"].is_null() || pooled["thesis_q1"].is_number()));
        let own = answers.iter().filter(|answer| answer["method"] == pooled["method"]);
        let mean = own.map(|answer| number(answer, "error").abs()).sum::<f64>() / (3 * n) as f64;
        assert!((number(pooled, "mean") - mean).abs() < 1e-9, "{pooled}");
    }
    let truths: std::collections::BTreeSet<String> = answers.iter().map(|answer| answer["truth"].to_string()).collect();
    assert_eq!(truths.len(), n, "every case has an angle of its own");
}

#[test]
fn compared_methods_do_not_depend_on_each_other_or_on_the_threads() {
    let images = pictures("reproduce-compare-threads");
    let made = |options: &str| objects(&reproduce(arguments(&format!("4.4 --json {options}"), &images)));
    let all = made("--step 60 --jobs 1");
    assert_eq!(made("--step 60 --jobs 2"), all);
    let one = made("--step 60 --method dct-pseudo-cepstrum");
    assert_eq!(one.iter().collect::<Vec<_>>(), [&all[0]]);
    assert_ne!(made("--step 30 --method dct-pseudo-cepstrum"), one);
}

#[test]
fn compared_methods_are_drawn_side_by_side() {
    let (images, plots) = (pictures("reproduce-compare-plots"), folder("reproduce-compare-svg"));
    let line = format!("4.5 --step 100 --plots {}", plots.display());
    assert_eq!(reproduce(arguments(&line, &images)).status.code(), Some(0));
    for name in ["4.5-36dB.svg", "4.5-28dB.svg", "4.5-20dB.svg", "4.5-36-20dB.svg"] {
        let drawn = std::fs::read_to_string(plots.join(name)).unwrap();
        assert!(LENGTH.iter().all(|method| drawn.contains(method.name)), "{name}");
    }
}
