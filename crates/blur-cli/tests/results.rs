//! What is measured, and how it is reported.

mod common;

use std::io::{BufRead, BufReader};
use std::process::Stdio;

use blur_core::estimate::AxialAngle;
use blur_sim::expose::expose;
use blur_sim::motion::Motion;
use blur_sim::scene::{DeadLeaves, dead_leaves};
use blur_sim::sensor::Sensor;
use common::*;
use image::{DynamicImage, GrayImage, ImageBuffer, ImageFormat, Luma, LumaA, Rgb, Rgba};
use serde_json::Value;

#[test]
fn a_horizontal_and_a_vertical_blur_of_known_length() {
    let folder = folder("known_blur");
    let picture = blurred(256, 256, 20, 1);
    let vertical = image::imageops::rotate90(&picture);
    let files = [write(&folder, "a.png", &png(picture)), write(&folder, "b.png", &png(vertical))];
    let (status, records) = run_json(files);
    assert_eq!(status, 0);
    assert_blur(&records[0], 0.0, 20.0);
    assert_blur(&records[1], 90.0, 20.0);
}

#[test]
fn a_record_has_the_promised_fields() {
    let folder = folder("fields");
    let path = write(&folder, "a.png", &png(blurred(300, 256, 20, 1)));
    let output = run(["--json", "--exposure", "1/10s", "--scale", "0.7789mm/px", path.to_str().unwrap()]);
    assert_eq!(stdout(&output).lines().count(), 1);
    let record: Value = serde_json::from_str(stdout(&output)).unwrap();
    let (required, optional) = (
        "image width height method linearized angle_deg angle_std_deg length_px length_std_px correlation status \
         gain_per_bin rival_share incoherent_share misfit band_cycles_per_px exposure_s exposure_source speed_m_s \
         speed_std_m_s speed_expanded_m_s coverage_k time_ms",
        "reason",
    );
    let fields = record.as_object().unwrap();
    for name in required.split(' ') {
        assert!(fields.contains_key(name), "{name} is missing in {record}");
    }
    for (name, value) in fields {
        assert!(required.split(' ').chain(optional.split(' ')).any(|known| known == name), "{name} in {record}");
        let text = ["image", "method", "status", "reason", "exposure_source"].contains(&name.as_str());
        let kind = if text { value.is_string() } else { value.is_number() || name == "linearized" };
        assert!(kind, "{name} in {record}");
    }
    assert_eq!((&record["width"], &record["height"]), (&300.into(), &256.into()));
    assert_eq!(record["image"], path.to_str().unwrap());
    // v = k L / T
    let expected = 0.7789e-3 * number(&record, "length_px") / 0.1;
    assert!((number(&record, "speed_m_s") - expected).abs() < 1e-12 * expected, "{record}");
}

#[test]
fn what_was_not_computed_has_no_field() {
    let folder = folder("absent");
    let path = write(&folder, "a.png", &png(blurred(256, 256, 20, 1)));
    let path = path.to_str().unwrap();
    let evidence = ["gain_per_bin", "rival_share", "incoherent_share", "misfit", "band_cycles_per_px"];
    let acceleration = ["accel_ratio", "accel_ratio_std", "accel_ratio_limit"];
    for (arguments, has_evidence, has_acceleration) in [
        (vec!["--method", "whittle", path], true, false),
        (vec!["--method", "whittle", "--accel", path], true, true),
        (vec!["--method", "phase-autocorrelation", path], false, false),
        (vec!["--angle", "dft-radon", path], false, false),
    ] {
        let (_, records) = run_json(&arguments);
        let fields = records[0].as_object().unwrap();
        for name in evidence {
            assert_eq!(fields.contains_key(name), has_evidence, "{arguments:?}: {name}");
        }
        for name in acceleration {
            assert_eq!(fields.contains_key(name), has_acceleration, "{arguments:?}: {name}");
        }
    }
}

#[test]
fn an_acceleration_is_told_from_a_uniform_motion() {
    let folder = folder("acceleration");
    let motion = Motion::new(30.0, AxialAngle::from_deg(20.0), 0.7).unwrap();
    let scene = dead_leaves(3, 320, 320, &DeadLeaves::default()).unwrap();
    let exposure = expose(scene.view(), &motion).unwrap();
    let pixels = Sensor::ideal().with_psnr_db(40.0).unwrap().record(exposure.view(), 3).unwrap();
    let (height, width) = pixels.dim();
    let grey = GrayImage::from_fn(width as u32, height as u32, |x, y| Luma([pixels[[y as usize, x as usize]]]));
    let path = write(&folder, "accelerated.png", &png(grey));
    let (status, records) = run_json(["--accel".as_ref(), path.as_os_str()]);
    assert_eq!(status, 0);
    let fields = ["accel_ratio", "accel_ratio_std", "accel_ratio_limit"];
    let [ratio, std, limit] = fields.map(|field| number(&records[0], field));
    assert!(ratio > limit && std < 0.1 && records[0]["accel_detected"] == true, "{}", records[0]);
    // Four standard deviations: one normal error in 16000 is larger.
    assert!((ratio - 0.7).abs() < 4.0 * std, "{}", records[0]);
    let output = run(["--accel".as_ref(), path.as_os_str()]);
    assert!(stdout(&output).contains("\n    acceleration ratio 0."), "{output:?}");

    let rig = ["--accel", "--exposure", "100ms", "--scale", "1.1mm/px", path.to_str().unwrap()];
    let (_, records) = run_json(rig);
    let metric = ["accel_m_s2", "accel_std_m_s2", "accel_expanded_m_s2", "accel_limit_m_s2", "length_px"];
    let [value, std_m_s2, expanded, limit_m_s2, length_px] = metric.map(|field| number(&records[0], field));
    // a = 2 r k L / T^2
    let per_ratio = 2.0 * 1.1e-3 * length_px / 0.01;
    assert!(
        (value - per_ratio * ratio).abs() < 1e-9 && (limit_m_s2 - per_ratio * limit).abs() < 1e-9,
        "{}",
        records[0]
    );
    assert!((0.9..1.2).contains(&(std_m_s2 / (per_ratio * std))), "{}", records[0]);
    assert!((expanded - 2.0 * std_m_s2).abs() < 1e-12, "{}", records[0]);
    // One per cent of the exposure is two of the acceleration, and nothing else changes.
    let (_, records) = run_json(rig.into_iter().chain(["--exposure-u", "1ms"]));
    let wider = number(&records[0], "accel_std_m_s2");
    assert!((wider * wider - std_m_s2 * std_m_s2 - (0.02 * value).powi(2)).abs() < 1e-9, "{}", records[0]);

    // The motion of the sample is uniform.
    let (_, records) = run_json(["--accel"]);
    let [ratio, std, limit] = fields.map(|field| number(&records[0], field));
    assert!(ratio <= limit && std < 0.2 && limit < 0.2, "{}", records[0]);
    assert_eq!(records[0]["accel_detected"], false);
    let output = run(["--accel"]);
    assert!(stdout(&output).contains("\n    acceleration below detection limit: ratio under 0."), "{output:?}");
    assert!(!stdout(&run(["--method", "whittle"])).contains("acceleration"));
}

#[test]
fn without_motion_there_is_neither_speed_nor_acceleration() {
    let folder = folder("still");
    let scene = dead_leaves(4, 256, 256, &DeadLeaves::default()).unwrap();
    let grey = GrayImage::from_fn(256, 256, |x, y| Luma([scene[[y as usize, x as usize]].round() as u8]));
    let path = write(&folder, "a.png", &png(grey));
    let (_, records) = run_json(["--accel", "--exposure", "10ms", "--scale", "1mm/px", path.to_str().unwrap()]);
    assert_eq!(records[0]["status"], "no_motion_blur", "{}", records[0]);
    assert!(records[0]["speed_m_s"].is_null() && records[0]["accel_ratio"].is_null(), "{}", records[0]);
}

#[test]
fn the_uncertainty_of_the_speed_follows_that_of_the_length() {
    let folder = folder("uncertainty");
    let path = write(&folder, "a.png", &png(blurred(256, 256, 20, 1)));
    let path = path.to_str().unwrap();
    let (_, records) = run_json(
        ["--exposure", "100ms", "--exposure-u", "1ms", "--scale", "1mm/px", "--scale-u", "0.02mm/px", path].iter(),
    );
    let record = &records[0];
    let length_std = number(record, "length_std_px");
    let relative = ((length_std / number(record, "length_px")).powi(2) + 0.02_f64.powi(2) + 0.01_f64.powi(2)).sqrt();
    let expected = number(record, "speed_m_s") * relative;
    assert!((number(record, "speed_std_m_s") - expected).abs() < 1e-9 * expected, "{record}");
    assert_eq!(number(record, "coverage_k"), 2.0);
    assert_eq!(number(record, "speed_expanded_m_s"), 2.0 * number(record, "speed_std_m_s"));

    // A method that states no uncertainty must not promise one for the speed.
    let (_, records) =
        run_json(["--length", "autocorrelation", "--exposure", "100ms", "--scale", "1mm/px", path].iter());
    let record = &records[0];
    assert!(number(record, "speed_m_s") > 0.0 && record["length_std_px"].is_null(), "{record}");
    assert!(record["speed_std_m_s"].is_null() && record["coverage_k"].is_null(), "{record}");
}

#[test]
fn the_exposure_comes_from_the_option_or_else_from_exif() {
    let folder = folder("exposure");
    let path = write(&folder, "a.png", &png_with_exif(&blurred(256, 256, 20, 1), exif(1, (1, 100))));
    let path = path.to_str().unwrap();
    let (_, records) = run_json(["--scale", "1mm/px", path]);
    assert_eq!((number(&records[0], "exposure_s"), &records[0]["exposure_source"]), (0.01, &"exif".into()));
    let expected = 1e-3 * number(&records[0], "length_px") / 0.01;
    assert!((number(&records[0], "speed_m_s") - expected).abs() < 1e-12 * expected);
    let (_, records) = run_json(["--scale", "1mm/px", "--exposure", "20ms", path]);
    assert_eq!((number(&records[0], "exposure_s"), &records[0]["exposure_source"]), (0.02, &"option".into()));

    let output = run([path]);
    assert!(stdout(&output).contains("exposure 10 ms (EXIF)"), "{}", stdout(&output));
    assert!(stdout(&output).contains("no speed: --scale is missing"), "{}", stdout(&output));
    assert!(!stdout(&output).contains("m/s"), "{}", stdout(&output));
}

#[test]
fn without_any_exposure_the_output_says_what_is_missing() {
    let folder = folder("no_exposure");
    let path = write(&folder, "a.png", &png(blurred(256, 256, 20, 1)));
    let output = run(["--scale", "1mm/px", path.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0));
    assert!(stdout(&output).contains("no speed: --exposure is missing"), "{}", stdout(&output));
}

/// EXIF 2.32, tag 0x0112: where the stored pixel of row `i` and column `j` belongs in the upright picture.
fn upright_position(orientation: u16, i: u32, j: u32, width: u32, height: u32) -> (u32, u32) {
    let (right, bottom) = (width - 1, height - 1);
    match orientation {
        1 => (i, j),
        2 => (i, right - j),
        3 => (bottom - i, right - j),
        4 => (bottom - i, j),
        5 => (j, i),
        6 => (j, right - i),
        7 => (bottom - j, right - i),
        _ => (bottom - j, i),
    }
}

#[test]
fn all_eight_orientations_give_the_upright_blur() {
    let folder = folder("orientation");
    let upright = blurred(288, 256, 20, 1);
    let (width, height) = upright.dimensions();
    let files = (1..=8).map(|orientation| {
        let (w, h) = if orientation < 5 { (width, height) } else { (height, width) };
        let stored = GrayImage::from_fn(w, h, |j, i| {
            let (row, column) = upright_position(orientation, i, j, width, height);
            *upright.get_pixel(column, row)
        });
        write(&folder, &format!("{orientation}.png"), &png_with_exif(&stored, exif(orientation, (1, 100))))
    });
    let (status, records) = run_json(files);
    assert_eq!((status, records.len()), (0, 8));
    for record in &records {
        assert_eq!((&record["width"], &record["height"]), (&width.into(), &height.into()));
        assert_blur(record, 0.0, 20.0);
        assert_eq!((&record["angle_deg"], &record["length_px"]), (&records[0]["angle_deg"], &records[0]["length_px"]));
    }
}

#[test]
fn a_region_counts_in_the_upright_picture() {
    let folder = folder("region");
    // Upright, the left part is blurred by 20 px and the right part by 40 px; stored, it lies on its side.
    let mut upright = blurred(512, 256, 20, 1);
    image::imageops::replace(&mut upright, &blurred(256, 256, 40, 2), 256, 0);
    let stored = image::imageops::rotate270(&upright);
    let path = write(&folder, "a.png", &png_with_exif(&stored, exif(6, (1, 100))));
    let path = path.to_str().unwrap();
    for (roi, length) in [("0,0,256,256", 20.0), ("256,0,256,256", 40.0)] {
        let (status, records) = run_json(["--roi", roi, path]);
        assert_eq!(status, 0);
        assert_blur(&records[0], 0.0, length);
    }
    let (status, records) = run_json(["--roi", "300,0,256,256", path]);
    assert_eq!(status, 1);
    assert!(records[0]["error"].as_str().unwrap().contains("512x256"), "{}", records[0]);
}

#[test]
fn depth_channels_and_container_do_not_change_the_result() {
    let folder = folder("depths");
    let grey = blurred(256, 256, 20, 1);
    let (w, h) = grey.dimensions();
    let at = |x: u32, y: u32| grey.get_pixel(x, y).0[0];
    let wide = |x: u32, y: u32| 257 * u16::from(at(x, y));
    // The alpha channel is noise: it must not be looked at.
    let pictures: [DynamicImage; 8] = [
        grey.clone().into(),
        ImageBuffer::from_fn(w, h, |x, y| LumaA([at(x, y), at(y, x)])).into(),
        ImageBuffer::from_fn(w, h, |x, y| Rgb([at(x, y); 3])).into(),
        ImageBuffer::from_fn(w, h, |x, y| Rgba([at(x, y), at(x, y), at(x, y), at(y, x)])).into(),
        ImageBuffer::from_fn(w, h, |x, y| image::Luma([wide(x, y)])).into(),
        ImageBuffer::from_fn(w, h, |x, y| LumaA([wide(x, y), wide(y, x)])).into(),
        ImageBuffer::from_fn(w, h, |x, y| Rgb([wide(x, y); 3])).into(),
        ImageBuffer::from_fn(w, h, |x, y| Rgba([wide(x, y), wide(x, y), wide(x, y), wide(y, x)])).into(),
    ];
    let mut files = Vec::new();
    for (i, picture) in pictures.into_iter().enumerate() {
        if !matches!(picture, DynamicImage::ImageLumaA8(_) | DynamicImage::ImageLumaA16(_)) {
            files.push(write(&folder, &format!("{i}.tif"), &encode(picture.clone(), ImageFormat::Tiff)));
        }
        files.push(write(&folder, &format!("{i}.png"), &png(picture)));
    }
    let floats: Vec<f32> = grey.as_raw().iter().map(|&p| p.into()).collect();
    files.push(write(&folder, "float.tif", &float_tiff(w, h, &floats)));
    let (status, records) = run_json(files);
    assert_eq!((status, records.len()), (0, 15));
    assert_blur(&records[0], 0.0, 20.0);
    for record in &records {
        // Luma of a grey differs from the grey by rounding in f32, 1e-7 of it.
        for field in ["angle_deg", "length_px"] {
            assert!((number(record, field) - number(&records[0], field)).abs() < 1e-3, "{field} of {record}");
        }
    }
}

#[test]
fn only_jpegs_are_linearized_by_themselves() {
    let folder = folder("linearize");
    let picture = blurred(256, 256, 20, 1);
    let camera = write(&folder, "camera.jpg", &jpeg_with_exif(&picture, &exif(1, (1, 100))));
    let plain = write(&folder, "plain.jpg", &encode(picture.clone(), ImageFormat::Jpeg));
    let png = write(&folder, "camera.png", &png_with_exif(&picture, exif(1, (1, 100))));
    let linearized = |when: &str| -> Vec<bool> {
        let (status, records) =
            run_json([when.as_ref(), camera.as_os_str(), plain.as_os_str(), png.as_os_str()].iter());
        assert_eq!(status, 0);
        records.iter().map(|record| record["linearized"].as_bool().unwrap()).collect()
    };
    assert_eq!(linearized("--linearize=auto"), [true, true, false]);
    assert_eq!(linearized("--linearize=on"), [true, true, true]);
    assert_eq!(linearized("--linearize=off"), [false, false, false]);
    assert!(stdout(&run([camera])).contains("linearized (sRGB)"));
}

#[test]
fn damaged_exif_is_a_note_and_not_an_error() {
    let folder = folder("exif");
    let mut broken = exif(1, (1, 100));
    broken.truncate(30);
    let path = write(&folder, "a.png", &png_with_exif(&blurred(256, 256, 20, 1), broken));
    let output = run([&path]);
    assert_eq!(output.status.code(), Some(0));
    assert!(stderr(&output).contains("note: ") && stderr(&output).contains("EXIF"), "{}", stderr(&output));
}

#[test]
fn results_come_in_the_order_of_the_inputs() {
    let folder = folder("order");
    // The slowest first, so that later ones are ready before it.
    let mut expected = Vec::new();
    for (i, side) in [700, 64, 300, 64, 64, 400, 64, 64].into_iter().enumerate() {
        let name = format!("{i}.png");
        expected.push(write(&folder, &name, &png(blurred(side, side, 10, i as u64))).display().to_string());
    }
    write(&folder, "notes.txt", b"not looked at");
    let images = |arguments: &[&str]| -> Vec<String> {
        let (status, records) = run_json(arguments.iter());
        assert_eq!(status, 0);
        records.iter().map(|record| record["image"].as_str().unwrap().to_owned()).collect()
    };
    let path = folder.to_str().unwrap();
    assert_eq!(images(&["--jobs", "2", path]), expected);
    assert_eq!(images(&["--jobs", "2", &format!("{path}/*.png")]), expected);
    expected.reverse();
    let reversed: Vec<&str> = ["--jobs", "2"].into_iter().chain(expected.iter().map(String::as_str)).collect();
    assert_eq!(images(&reversed), expected);
}

#[test]
fn a_reader_that_leaves_early_is_no_failure() {
    let folder = folder("pipe");
    let path = write(&folder, "a.png", &png(blurred(64, 64, 8, 1)));
    let mut child =
        estimate().arg("--json").args(vec![path; 500]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut reader = BufReader::new(child.stdout.take().unwrap());
    let mut line = String::new();
    reader.read_line(&mut line).unwrap();
    drop(reader);
    let output = child.wait_with_output().unwrap();
    assert!(serde_json::from_str::<Value>(&line).is_ok(), "{line}");
    assert_eq!((output.status.code(), stderr(&output)), (Some(0), ""));
}
