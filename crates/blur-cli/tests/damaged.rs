//! Pictures that are damaged, extreme or missing: each is named with its reason and the others are still measured.

mod common;

use std::path::Path;

use common::*;
use image::{GrayImage, ImageFormat, Luma};

/// Runs the program on one bad input beside a good one; the reason given for the bad one.
fn reason_beside_a_good_picture(folder: &Path, bad: &Path) -> String {
    let good = write(folder, "good.png", &png(blurred(256, 256, 20, 1)));
    let output = run([bad.as_os_str(), good.as_os_str()]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let complaint = stderr(&output);
    let start = format!("estimate: {}: ", bad.display());
    assert!(complaint.starts_with(&start) && complaint.lines().count() == 1, "{complaint}");
    assert!(stdout(&output).starts_with(&good.display().to_string()), "{output:?}");

    let (status, records) = run_json([bad, &good]);
    assert_eq!((status, records.len()), (1, 2));
    let reason = complaint.trim_end()[start.len()..].to_owned();
    assert_eq!(records[0], serde_json::json!({"image": bad.display().to_string(), "error": reason}));
    assert_blur(&records[1], 0.0, 20.0);
    reason
}

#[test]
fn a_truncated_png() {
    let folder = folder("truncated_png");
    let whole = png(blurred(64, 64, 8, 1));
    let reason = reason_beside_a_good_picture(&folder, &write(&folder, "bad.png", &whole[..whole.len() / 2]));
    assert!(reason.contains("cannot be decoded"), "{reason}");
}

#[test]
fn a_truncated_jpeg_is_not_measured_half_grey() {
    let folder = folder("truncated_jpeg");
    let whole = encode(blurred(64, 64, 8, 1), ImageFormat::Jpeg);
    let reason = reason_beside_a_good_picture(&folder, &write(&folder, "bad.jpg", &whole[..whole.len() / 2]));
    assert!(reason.contains("truncated"), "{reason}");
}

#[test]
fn a_text_named_png() {
    let folder = folder("text");
    let reason = reason_beside_a_good_picture(&folder, &write(&folder, "text.png", b"Dear reader, this is text."));
    assert!(reason.contains("not a picture") && reason.contains("Dear reader"), "{reason}");
    let reason = reason_beside_a_good_picture(&folder, &write(&folder, "empty.png", b""));
    assert!(reason.contains("empty"), "{reason}");
}

#[test]
fn a_jpeg_named_png_is_read_as_what_it_is() {
    let folder = folder("misnamed");
    let path = write(&folder, "really_a_jpeg.png", &encode(blurred(256, 256, 20, 1), ImageFormat::Jpeg));
    let (status, records) = run_json([path]);
    assert_eq!(status, 0);
    assert_blur(&records[0], 0.0, 20.0);
}

#[test]
fn no_pixels_and_one_pixel() {
    let folder = folder("tiny");
    let reason = reason_beside_a_good_picture(&folder, &write(&folder, "zero.png", &png_header(0, 0)));
    assert!(reason.contains("cannot be decoded"), "{reason}");
    let one = GrayImage::from_pixel(1, 1, Luma([7]));
    let reason = reason_beside_a_good_picture(&folder, &write(&folder, "one.png", &png(one)));
    assert!(reason.contains("1x1"), "{reason}");
}

#[test]
fn a_header_that_announces_more_than_memory() {
    let folder = folder("bomb");
    let reason = reason_beside_a_good_picture(&folder, &write(&folder, "bomb.png", &png_header(60_000, 60_000)));
    assert!(reason.contains("60000x60000"), "{reason}");
    let reason = reason_beside_a_good_picture(&folder, &write(&folder, "short.png", &png_header(8192, 8192)));
    assert!(reason.contains("cannot be decoded"), "{reason}");
}

#[test]
fn a_constant_picture_and_a_strip() {
    let folder = folder("no_content");
    let grey = GrayImage::from_pixel(64, 64, Luma([200]));
    let reason = reason_beside_a_good_picture(&folder, &write(&folder, "grey.png", &png(grey)));
    assert!(reason.contains("200") && reason.contains("contrast"), "{reason}");
    let strip = blurred(20_000, 20, 20, 1);
    let reason = reason_beside_a_good_picture(&folder, &write(&folder, "strip.png", &png(strip)));
    assert!(reason.contains("20000x20") && reason.contains("32"), "{reason}");
}

#[test]
fn a_pixel_that_is_no_number_is_named() {
    let folder = folder("nan");
    let mut samples: Vec<f32> = blurred(64, 48, 8, 1).as_raw().iter().map(|&p| p.into()).collect();
    samples[7 * 64 + 9] = f32::NAN;
    let reason = reason_beside_a_good_picture(&folder, &write(&folder, "nan.tif", &float_tiff(64, 48, &samples)));
    assert!(reason.contains("row 7, column 9 is NaN"), "{reason}");
}

#[test]
fn a_saturated_picture_is_measured() {
    let folder = folder("saturated");
    // A threshold at the mean leaves half of the pixels black and half white.
    let mut picture = blurred(256, 256, 20, 1);
    picture.pixels_mut().for_each(|p| p.0 = [if p.0[0] < 128 { 0 } else { 255 }]);
    let (status, records) = run_json([write(&folder, "saturated.png", &png(picture))]);
    assert_eq!(status, 0);
    let word = records[0]["status"].as_str().unwrap();
    assert!(["ok", "low_confidence", "no_motion_blur"].contains(&word), "{word}");
}

#[test]
fn inputs_that_are_not_there() {
    let folder = folder("missing");
    let file = write(&folder, "file.png", &png(blurred(64, 64, 8, 1)));
    for missing in [folder.join("none.png"), folder.join("none*.png"), file.join("x"), file.join("*")] {
        reason_beside_a_good_picture(&folder, &missing);
    }
    let empty = common::folder("missing_empty");
    let reason = reason_beside_a_good_picture(&folder, &empty);
    assert!(reason.contains("no picture"), "{reason}");
}
