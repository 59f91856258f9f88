//! The program `accel evaluate`.
#![allow(clippy::unwrap_used, reason = "a program that does not run or answer fails the test")]

mod common;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use blur_accel::regression::PRESETS;
use common::{folder, number, stderr, stdout};
use serde_json::Value;

fn accel(arguments: &[&str]) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_accel")).args(arguments).output().unwrap();
    assert!(!stderr(&output).contains("panicked"), "{}", stderr(&output));
    output
}

/// Blurred pictures that are evaluated, of 125: one of each scene and acceleration.
const PICTURES: usize = 25;

/// Small pictures of the rig with lengths that say nothing of the acceleration; made once.
fn data() -> &'static Path {
    static DATA: OnceLock<PathBuf> = OnceLock::new();
    DATA.get_or_init(|| {
        let data = folder("evaluate-rig").join("data");
        let path = data.to_str().unwrap();
        let made = accel(&["simulate", "--design", "random-release", "--side", "160", "-o", path]);
        assert_eq!(made.status.code(), Some(0), "{}", stderr(&made));
        let table = fs::read_to_string(data.join("pictures.csv")).unwrap();
        let kept = |row: &&str| !row.contains(",blurred,") || row.split(',').next().unwrap().ends_with("-1.png");
        fs::write(data.join("pictures.csv"), table.lines().filter(kept).collect::<Vec<_>>().join("\n")).unwrap();
        data
    })
}

fn evaluate(arguments: &[&str]) -> Output {
    let mut all = vec!["evaluate", "--data", data().to_str().unwrap()];
    all.extend(arguments);
    accel(&all)
}

fn rows(output: &Output) -> Vec<Value> {
    assert_eq!(output.status.code(), Some(0), "{}", stderr(output));
    stdout(output).lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn every_method_has_its_line_and_its_plots() {
    let plots = folder("evaluate-plots");
    let found = rows(&evaluate(&["--json", "--plots", plots.to_str().unwrap()]));
    let names: Vec<_> = found.iter().map(|row| row["method"].as_str().unwrap().to_owned()).collect();
    let mut expected = vec!["length-only"];
    expected.extend(PRESETS.iter().map(|preset| preset.name));
    expected.extend(["blind", "reference"]);
    assert_eq!(names, expected);
    for row in &found {
        // A blind answer that is not certain is none.
        assert!(row["n"] == PICTURES || row["method"] == "blind", "{row}");
        let [rmse, mse, mae] = ["rmse_m_s2", "mse_m2_s4", "mae_m_s2"].map(|field| number(row, field));
        assert!((rmse * rmse - mse).abs() < 1e-9 * mse && mae <= rmse, "{row}");
    }
    let matern = found.iter().find(|row| row["method"] == "gpr-matern52").unwrap();
    assert_eq!(number(matern, "thesis_rmse_m_s2"), 0.2547);
    let reference = found.last().unwrap();
    assert_eq!(number(reference, "right_sign"), 1.0, "{reference}");
    assert_eq!(reference["beats_length"], true, "{reference}");
    for name in expected {
        for kind in ["predicted", "residuals", "response"] {
            let drawn = fs::read_to_string(plots.join(format!("{name}-{kind}.svg"))).unwrap();
            assert!(drawn.starts_with("<svg") && drawn.contains("m/s2"), "{name} {kind}");
        }
    }
}

#[test]
fn the_table_does_not_depend_on_the_threads_and_scenes_can_stay_together() {
    let of = |arguments: &[&str]| {
        let mut all = vec!["--json", "--model", "linear"];
        all.extend(arguments);
        let mut found = rows(&evaluate(&all));
        for row in &mut found {
            // Times of the wall clock.
            row.as_object_mut().unwrap().retain(|name, _| name != "training_s" && name != "predictions_per_s");
        }
        found
    };
    let once = of(&["--jobs", "1"]);
    assert_eq!(once, of(&["--jobs", "3"]));
    assert_eq!(once.len(), 4);
    let by_scene = of(&["--group", "scene"]);
    assert_ne!(number(&once[1], "rmse_m_s2"), number(&by_scene[1], "rmse_m_s2"));
    // Physics learns nothing and so does not care.
    assert_eq!(once[3]["rmse_m_s2"], by_scene[3]["rmse_m_s2"]);
}

#[test]
fn without_a_camera_there_is_no_physics() {
    let copied = folder("evaluate-without-camera");
    let table = fs::read_to_string(data().join("pictures.csv")).unwrap();
    let header = table.lines().next().unwrap().replace("exposure_s", "unknown");
    let rest: Vec<_> = table.lines().skip(1).collect();
    for row in &rest {
        let image = row.split(',').next().unwrap();
        fs::copy(data().join(image), copied.join(image)).unwrap();
    }
    fs::write(copied.join("pictures.csv"), format!("{header}\n{}\n", rest.join("\n"))).unwrap();
    let found = rows(&accel(&["evaluate", "--data", copied.to_str().unwrap(), "--json", "--model", "linear"]));
    let names: BTreeSet<_> = found.iter().map(|row| row["method"].as_str().unwrap()).collect();
    assert_eq!(names, BTreeSet::from(["length-only", "linear"]));
}

#[test]
fn pictures_of_two_sizes_are_refused() {
    let mixed = folder("evaluate-two-sizes");
    let table = fs::read_to_string(data().join("pictures.csv")).unwrap();
    for row in table.lines().skip(1) {
        let image = row.split(',').next().unwrap();
        let mut picture = image::open(data().join(image)).unwrap();
        if row.contains(",bars,") {
            picture = picture.crop(0, 0, 128, 128);
        }
        picture.save(mixed.join(image)).unwrap();
    }
    fs::write(mixed.join("pictures.csv"), table).unwrap();
    let output = accel(&["evaluate", "--data", mixed.to_str().unwrap(), "--model", "linear"]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let said = stderr(&output);
    assert!(said.lines().count() == 1 && said.contains("scene 'bars'") && said.contains("128x128"), "{said}");
}

#[test]
fn what_cannot_be_evaluated_is_refused_in_one_line() {
    for (arguments, expected) in [
        (vec!["--folds", "1"], "folds = 1 is not allowed"),
        (vec!["--folds", "200"], "25 observations are too few"),
        (vec!["--folds", "6", "--group", "scene"], "5 observations are too few: 6 are needed as groups"),
    ] {
        let output = evaluate(&[arguments, vec!["--model", "linear"]].concat());
        assert_eq!(output.status.code(), Some(1), "{output:?}");
        let said = stderr(&output);
        assert!(said.lines().count() == 1 && said.contains(expected), "{said}");
    }
    let unknown = evaluate(&["--model", "gpr"]);
    assert_eq!(unknown.status.code(), Some(2));
    let missing = accel(&["evaluate", "--data", "/nowhere"]);
    assert_eq!(missing.status.code(), Some(1));
    assert!(stderr(&missing).contains("/nowhere/pictures.csv: cannot be read"), "{missing:?}");
}
