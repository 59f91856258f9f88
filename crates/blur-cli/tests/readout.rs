//! Rolling shutters: the rows are those of the sensor, and the speed may change while they are read.

mod common;

use common::*;
use image::{GrayImage, imageops};

/// Exposure 10 ms, 1 mm a pixel, 20 ms from the first row to the last.
const KNOWN: [&str; 6] = ["--exposure", "10ms", "--scale", "1mm/px", "--readout", "20ms"];

/// Blurred along its rows, by one pixel more for every 64 rows down.
fn speeding() -> GrayImage {
    let mut picture = GrayImage::new(512, 512);
    for strip in 0..8_u32 {
        let length = 24 + strip as usize;
        imageops::replace(&mut picture, &blurred(512, 64, length, length as u64), 0, i64::from(64 * strip));
    }
    picture
}

#[test]
fn a_change_of_the_speed_is_seen_along_the_rows_of_the_sensor() {
    let folder = folder("readout_change");
    // 1/64 px a row; a row every 20 ms / 512; 10 ms of exposure.
    let truth_px_s2 = 1.0 / 64.0 / 0.01 / (0.02 / 512.0);
    for (orientation, rows_run) in [(1, "down"), (3, "up"), (6, "left"), (8, "right"), (5, "right")] {
        let path = write(&folder, "a.png", &png_with_exif(&speeding(), exif(orientation, (1, 100))));
        let arguments = KNOWN.into_iter().chain(["--map", "128", path.to_str().unwrap()]);
        let (status, records) = run_json(arguments);
        assert_eq!(status, 0);
        let readout = &records[0]["readout"];
        assert_eq!(readout["rows_run"], rows_run);
        assert_eq!(records[0]["map"]["readout_ignored"], false);
        let [change, std] = ["change_px_s2", "change_std_px_s2"].map(|field| number(readout, field));
        assert!((change - truth_px_s2).abs() <= 2.0 * std, "orientation {orientation}: {readout}");
        assert!(std < 0.2 * truth_px_s2 && readout["significant"] == true, "{readout}");
        let [metric, metric_std] = ["change_m_s2", "change_std_m_s2"].map(|field| number(readout, field));
        assert!((metric - 1e-3 * change).abs() < 1e-9 * metric && (metric_std - 1e-3 * std).abs() < 1e-9 * metric);
    }
}

#[test]
fn the_readout_of_a_picture_on_its_side_runs_across_it() {
    let folder = folder("readout_side");
    // Upright, the blur is horizontal; on the sensor it is along the readout.
    let upright = blurred(320, 256, 30, 1);
    let stored = imageops::rotate270(&upright);
    let path = write(&folder, "a.png", &png_with_exif(&stored, exif(6, (1, 100))));
    let (_, records) = run_json(KNOWN.into_iter().chain([path.to_str().unwrap()]));
    let (length, readout) = (number(&records[0], "length_px"), &records[0]["readout"]);
    // 320 rows on the sensor: v = k L / (T +- L t).
    for (field, sign) in [("speed_down_m_s", 1.0), ("speed_up_m_s", -1.0)] {
        let expected = 1e-3 * length / (0.01 + sign * length * 0.02 / 320.0);
        assert!((number(readout, field) / expected - 1.0).abs() < 1e-3, "{field}: {expected} {readout}");
    }
    assert_eq!(readout["rows_run"], "left");
    let output = run(KNOWN.into_iter().chain([path.to_str().unwrap()]));
    let text = stdout(&output);
    assert!(text.contains("if it moved left") && text.contains("if it moved right"), "{text}");
    // Stored as it is shown, it is across the readout: both ways are alike.
    let plain = write(&folder, "b.png", &png(upright));
    let (_, records) = run_json(KNOWN.into_iter().chain([plain.to_str().unwrap()]));
    let [down, up] = ["speed_down_m_s", "speed_up_m_s"].map(|field| number(&records[0]["readout"], field));
    assert!((down / up - 1.0).abs() < 0.01, "{down} {up}");
}

#[test]
fn what_a_map_cannot_tell_of_the_readout_is_said() {
    let folder = folder("readout_missing");
    let path = write(&folder, "a.png", &png(speeding()));
    let path = path.to_str().unwrap();
    let (_, records) = run_json(["--map", "128", path]);
    assert_eq!(records[0]["map"]["readout_ignored"], true);
    assert!(records[0].get("readout").is_none());
    // Tiles of 256 pixels lie in three rows.
    let (_, records) = run_json(KNOWN.into_iter().chain(["--map", "256", path]));
    let reason = records[0]["readout"]["change_reason"].as_str().unwrap();
    assert!(reason.contains("at least 4"), "{reason}");
    assert!(records[0]["readout"].get("change_px_s2").is_none());
    let (_, records) = run_json(["--readout", "20ms", "--map", "128", path]);
    assert!(records[0]["readout"]["change_reason"].as_str().unwrap().contains("exposure"));
}

#[test]
fn a_moving_region_has_a_speed_for_either_way() {
    // 512 rows, of which the whole moves as one.
    let sample = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/sample.png");
    let (_, records) = run_json(KNOWN.into_iter().chain(["--map", "128", sample]));
    let regions = records[0]["map"]["regions"].as_array().unwrap();
    assert!(!regions.is_empty());
    for region in regions {
        let length = number(region, "length_px");
        let rows = length * number(region, "angle_deg").to_radians().sin();
        for (field, sign) in [("speed_down_m_s", 1.0), ("speed_up_m_s", -1.0)] {
            let expected = 1e-3 * length / (0.01 + sign * rows * 0.02 / 512.0);
            assert!((number(region, field) / expected - 1.0).abs() < 1e-9, "{field}: {expected} {region}");
        }
    }
    assert_eq!(records[0]["readout"]["significant"], false, "{}", records[0]["readout"]);
}
