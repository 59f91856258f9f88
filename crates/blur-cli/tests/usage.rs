//! The command line itself: mistakes, help, the sample.

mod common;

use blur_cli::sample;
use blur_core::estimate::registry;
use common::*;

#[test]
fn mistakes_end_with_status_2_before_anything_is_measured() {
    for arguments in [
        "--exposure 100",
        "--exposure 0s",
        "--exposure -1ms",
        "--exposure 100ms --exposure-u 1",
        "--scale 0.7789",
        "--scale 0mm/px",
        "--scale-u 1mm/px",
        "--roi 1,2,3",
        "--roi 1,2,3,x",
        "--range 80,10",
        "--range 10",
        "--window hamming",
        "--linearize maybe",
        "--jobs 0",
        "--method nonsense",
        "--angle nonsense",
        "--length nonsense",
        "--method dct-radon+autocorrelation --angle dct-radon",
        "--method dct-radon+autocorrelation --length autocorrelation",
        "--method dct-radon+autocorrelation --known-angle 0",
        "--known-angle 0 --angle dct-radon",
        "--known-angle north",
        "--accel --method phase-autocorrelation",
        "--accel --method dct-radon+autocorrelation",
        "--accel --angle dct-radon",
        "--accel --length autocorrelation",
        "--accel --known-angle 0",
        "--frobnicate",
    ] {
        let output = run(arguments.split(' '));
        assert_eq!(output.status.code(), Some(2), "{arguments}: {output:?}");
        assert_eq!(stdout(&output), "", "{arguments}");
        assert!(!stderr(&output).is_empty(), "{arguments}");
    }
}

#[test]
fn a_number_without_unit_is_answered_with_the_units() {
    assert!(stderr(&run(["--exposure", "100"])).contains("ms, us, s"));
    assert!(stderr(&run(["--scale", "0.7"])).contains("mm/px"));
}

#[test]
fn a_method_that_cannot_tell_an_acceleration_is_answered_with_one_that_can() {
    for arguments in ["--accel --method phase-autocorrelation", "--accel --length autocorrelation"] {
        let output = run(arguments.split(' '));
        assert!(stderr(&output).contains("acceleration; known: whittle"), "{output:?}");
    }
    assert_eq!(run(["--accel", "--method", "whittle"]).status.code(), Some(0));
}

#[test]
fn the_help_lists_every_method() {
    let output = run(["--help"]);
    assert_eq!(output.status.code(), Some(0));
    let names = registry::ANGLE.iter().map(|m| m.name).chain(registry::LENGTH.iter().map(|m| m.name));
    for name in names.chain(registry::JOINT.iter().map(|m| m.name)) {
        assert!(stdout(&output).contains(name), "{name}");
    }
    assert!(stdout(&output).contains("Exit status"));
}

#[test]
fn without_input_the_sample_is_measured_and_announced() {
    let output = run(["--json"]);
    assert_eq!(output.status.code(), Some(0));
    let record: serde_json::Value = serde_json::from_str(stdout(&output)).unwrap();
    assert_eq!((&record["width"], &record["height"]), (&512.into(), &512.into()));
    assert_eq!(record["image"], sample::NAME);
    assert!(stderr(&output).contains("sample") && stderr(&output).contains("30 deg and 24.5 px"));
    assert_eq!(record["status"], "ok", "{record}");
    assert!((number(&record, "angle_deg") - sample::ANGLE_DEG).abs() < 0.5, "{record}");
    assert!((number(&record, "length_px") - sample::LENGTH_PX).abs() < 0.5, "{record}");
}

#[test]
fn the_sample_is_the_picture_and_the_truth_of_the_simulation() {
    assert_eq!(sample::ANGLE_DEG, blur_sim::sample::ANGLE_DEG);
    assert_eq!(sample::LENGTH_PX, blur_sim::sample::LENGTH_PX);
    let decoded = image::load_from_memory_with_format(sample::PNG, image::ImageFormat::Png).unwrap();
    let decoded = decoded.as_luma8().expect("eight bits, grey");
    let made = blur_sim::sample::sample_picture().unwrap();
    assert_eq!((decoded.height() as usize, decoded.width() as usize), made.dim());
    // Not assert_eq on the pixels: a failure would print them all. `cargo xtask goldens` remakes the file.
    let differing = decoded.pixels().zip(&made).filter(|(stored, made)| stored.0[0] != **made).count();
    assert_eq!(differing, 0, "pixels of fixtures/sample.png differ from the simulation");
}

#[test]
fn the_methods_asked_for_are_the_methods_used() {
    let folder = folder("methods");
    let path = write(&folder, "a.png", &png(blurred(256, 256, 20, 1)));
    let path = path.to_str().unwrap();
    let (angle, length) = (registry::ANGLE.first().unwrap().name, registry::LENGTH.first().unwrap().name);
    let pair = format!("{angle}+{length}");
    for (arguments, expected) in [
        (vec!["--angle", angle], pair.clone()),
        (vec!["--length", length], pair.clone()),
        (vec!["--method", &pair], pair.clone()),
        (vec!["--known-angle", "0"], format!("known-angle+{length}")),
        (vec![], registry::JOINT.first().unwrap().name.to_owned()),
    ] {
        let (status, records) = run_json(arguments.iter().chain([&path]));
        assert_eq!((status, &records[0]["method"]), (0, &expected.into()), "{arguments:?}");
        assert_blur(&records[0], 0.0, 20.0);
    }
    // No bound here: the phase of white noise has no peak.
    let (status, records) = run_json(["--method", "phase-autocorrelation", path]);
    assert_eq!((status, &records[0]["method"]), (0, &"phase-autocorrelation".into()));
    // An axis is the same after a turn by 180 degrees.
    let (_, records) = run_json(["--known-angle", "-180", path]);
    assert_eq!(number(&records[0], "angle_deg"), 0.0);
}
