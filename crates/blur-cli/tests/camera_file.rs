//! Cameras in files: what is written comes back, what is damaged is refused with one clear line.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a camera that cannot be made fails the test")]

#[path = "common/mod.rs"]
mod common;

use blur_cli::Error;
use blur_cli::camera::file::{from_json, to_json};
use blur_core::camera::{Calibration, Intrinsics, Lens, Model, PARAMETERS};
use common::Random;
use serde_json::{Value, json};

fn calibration() -> Calibration {
    let parameters = [533.05, 533.15, 341.9, 233.98, 0.0, -0.285, 0.055, 1.1e-3, -7e-5, 0.0];
    let mut covariance = [[0.0; PARAMETERS]; PARAMETERS];
    for (i, row) in covariance.iter_mut().enumerate() {
        row[i] = if parameters[i] == 0.0 { 0.0 } else { (1e-3_f64 * parameters[i]).powi(2) };
    }
    (covariance[0][1], covariance[1][0]) = (0.28, 0.28);
    Calibration {
        intrinsics: Intrinsics::new(parameters, covariance, 640, 480).unwrap(),
        model: Model { skew: false, lens: Lens::Four },
        rms_px: 0.177,
        view_rms_px: vec![0.18; 13],
        view_tilt_deg: vec![20.0; 13],
        points: 702,
    }
}

fn document() -> Value {
    serde_json::from_str(&to_json(&calibration()).unwrap()).unwrap()
}

/// What reading says after a change to the document, whose checksum is left out as in a file written by hand.
fn after(change: impl Fn(&mut Value)) -> Result<Intrinsics, String> {
    let mut document = document();
    document.as_object_mut().unwrap().remove("sha256");
    change(&mut document);
    from_json(document.to_string().as_bytes()).map_err(|error| error.one_line())
}

#[test]
fn what_is_written_comes_back() {
    let calibration = calibration();
    let text = to_json(&calibration).unwrap();
    assert_eq!(from_json(text.as_bytes()).unwrap(), calibration.intrinsics);
    // One line for each row of the covariance: a person can read it.
    assert!(text.lines().count() < 80, "{text}");
    let focal = &document()["camera"]["parameters"][0];
    assert_eq!((&focal["name"], &focal["value"]), (&json!("fx_px"), &json!(533.05)));
    assert!((focal["std"].as_f64().unwrap() - 0.533_05).abs() < 1e-12);
}

#[test]
fn a_file_may_be_written_by_hand() {
    let text = r#"{"format": "blur camera", "version": 1, "program": "hand", "camera": {"model": "", "width_px": 1920,
        "height_px": 1440, "views": 0, "points": 0, "rms_px": 0, "parameters": [{"name": "fx_px", "value": 1441, "std": 5},
        {"name": "fy_px", "value": 1441, "std": 5}], "covariance": [[25, 25], [25, 25]]}}"#;
    let found = from_json(text.as_bytes()).unwrap();
    assert_eq!((found.parameters()[1], found.stds()[1], found.parameters()[2]), (1441.0, 5.0, 0.0));
}

#[test]
fn what_is_no_camera_is_refused_with_its_reason() {
    assert!(after(|_| {}).is_ok());
    let parameter = |i: usize, key: &'static str, value: Value| {
        after(move |d| d["camera"]["parameters"][i][key] = value.clone()).unwrap_err()
    };
    assert!(parameter(0, "value", json!(-533.05)).contains("fx_px = -533.05"));
    assert!(parameter(2, "value", json!(null)).contains("null"));
    assert!(parameter(0, "std", json!(0.6)).contains("0.6 of fx_px is not the root of its variance"));
    assert!(parameter(0, "std", json!(-0.53305)).contains("not the root"));
    assert!(parameter(3, "name", json!("f")).contains("no parameter 'f'"));
    assert!(parameter(3, "name", json!("cx_px")).contains("twice"));
    let message = after(|d| d["camera"]["covariance"][2][2] = json!(-1.0)).unwrap_err();
    assert!(message.contains("cx_px and cx_px is -1"), "{message}");
    let message = after(|d| d["camera"]["covariance"][2] = json!([1.0])).unwrap_err();
    assert!(message.contains("side of 1"), "{message}");
    let message = after(|d| d["camera"]["width_px"] = json!(0)).unwrap_err();
    assert!(message.contains("width"), "{message}");
    let message = after(|d| d["version"] = json!(0)).unwrap_err();
    assert!(message.contains("version 0"), "{message}");
    let message = after(|d| (d["version"], d["program"]) = (json!(2), json!("9.9"))).unwrap_err();
    assert!(message.contains("version 2") && message.contains("9.9"), "{message}");
    assert!(after(|d| d["format"] = json!("other")).unwrap_err().contains("calibrate"));
    for text in ["", "{}", "hello", "{\"format\":\"blur-accel model\",\"version\":1}"] {
        assert!(matches!(from_json(text.as_bytes()), Err(Error::NotACamera)), "{text}");
    }
}

/// A changed byte that leaves the content as it was may pass (a space, the version of the program); any other is noticed.
#[test]
fn every_damage_is_noticed() {
    let text = to_json(&calibration()).unwrap();
    let written = from_json(text.as_bytes()).unwrap();
    let mut random = Random(7);
    let (mut refused, mut same) = (0, 0);
    for _ in 0..4000 {
        let mut damaged = text.clone().into_bytes();
        match random.below(3) {
            0 => damaged.truncate(random.below(text.len() - 2)),
            1 => damaged[random.below(text.len())] = b" 0123456789-.e{}[]\",xn\xff"[random.below(23)],
            _ => {
                damaged.remove(random.below(text.len()));
            }
        }
        match from_json(&damaged) {
            Ok(found) => {
                assert_eq!(found, written, "{}", String::from_utf8_lossy(&damaged));
                same += 1;
            }
            Err(error) => {
                assert!(!error.one_line().is_empty());
                refused += 1;
            }
        }
    }
    assert!(refused > 2000 && same > 0, "{refused} {same}");
}
