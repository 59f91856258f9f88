//! Promises of `estimate --mask`.

#![allow(clippy::unwrap_used, clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use image::{GrayImage, Luma};

fn estimate(args: &[&Path]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_estimate")).args(args).arg("--json").output().unwrap()
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// A grey value drawn for a place.
fn noise(x: u32, y: u32) -> u32 {
    let mut z = u64::from(x) << 32 | u64::from(y);
    z = z.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    (z >> 56) as u32
}

fn is_inside(x: u32, y: u32) -> bool {
    (f64::from(x) - 130.0).hypot(f64::from(y) - 110.0) < 90.0
}

/// A disk that moved by 13 pixels along the rows before a sharp background.
fn picture(path: &Path) {
    let picture = GrayImage::from_fn(280, 220, |x, y| {
        let grey =
            if is_inside(x, y) { (0..13).map(|i| noise(x + i, y)).sum::<u32>() / 13 } else { noise(x, y + 1000) };
        Luma([grey as u8])
    });
    picture.save(path).unwrap();
}

fn json(output: &Output) -> serde_json::Value {
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn the_part_under_a_mask_is_measured_and_the_record_names_the_mask() {
    let folder = folder("mask");
    let (image, mask) = (folder.join("moved.png"), folder.join("mask.png"));
    picture(&image);
    GrayImage::from_fn(280, 220, |x, y| Luma([if is_inside(x, y) { 255 } else { 0 }])).save(&mask).unwrap();
    let output = estimate(&[&image, Path::new("--mask"), &mask]);
    assert!(output.status.success(), "{output:?}");
    let record = json(&output);
    assert_eq!(record["status"], "ok", "{record}");
    assert_eq!(record["mask"], mask.display().to_string());
    let length = record["length_px"].as_f64().unwrap();
    let std = record["length_std_px"].as_f64().unwrap();
    assert!((length - 13.0).abs() < 4.0 * std, "{record}");
    // Without a mask the sharp background contradicts the motion.
    let whole = json(&estimate(&[&image]));
    assert!(whole.get("mask").is_none());
    assert!(whole["status"] != "ok" || (whole["length_px"].as_f64().unwrap() - 13.0).abs() > (length - 13.0).abs());
}

#[test]
fn masks_that_cannot_be_used_are_refused_with_the_reason() {
    let folder = folder("mask-refused");
    let image = folder.join("moved.png");
    picture(&image);
    let refusal = |mask: &Path| {
        let output = estimate(&[&image, Path::new("--mask"), mask]);
        assert_eq!(output.status.code(), Some(1), "{output:?}");
        json(&output)["error"].as_str().unwrap().to_owned()
    };
    let small = folder.join("small.png");
    GrayImage::from_pixel(100, 90, Luma([255])).save(&small).unwrap();
    let error = refusal(&small);
    assert!(error.contains("100x90") && error.contains("280x220"), "{error}");
    let black = folder.join("black.png");
    GrayImage::new(280, 220).save(&black).unwrap();
    let error = refusal(&black);
    assert!(error.contains("black.png") && error.contains("above 0"), "{error}");
    let text = folder.join("text.png");
    std::fs::write(&text, "no picture").unwrap();
    let error = refusal(&text);
    assert!(error.contains("text.png") && error.contains("not a picture"), "{error}");
    let error = refusal(&folder.join("missing.png"));
    assert!(error.contains("missing.png"), "{error}");
    let speck = folder.join("speck.png");
    GrayImage::from_fn(280, 220, |x, y| Luma([if x < 20 && y < 20 { 255 } else { 0 }])).save(&speck).unwrap();
    let error = refusal(&speck);
    assert!(error.contains("20 pixels") && error.contains("32"), "{error}");
}

#[test]
fn a_mask_goes_with_neither_a_region_nor_another_method() {
    let image = folder("mask-usage").join("moved.png");
    for other in [["--roi", "0,0,64,64"], ["--method", "phase-autocorrelation"], ["--length", "whittle"]] {
        let mut args = vec![image.as_path(), Path::new("--mask"), Path::new("m.png")];
        args.extend(other.map(Path::new));
        let output = estimate(&args);
        assert_eq!(output.status.code(), Some(2), "{other:?}: {output:?}");
    }
}
