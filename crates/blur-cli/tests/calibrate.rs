//! The program `calibrate`, and `estimate` with its camera.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a program that cannot be run fails the test")]

#[path = "common/mod.rs"]
mod common;

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use common::{folder, run_json, stderr, stdout, write};
use image::{GrayImage, Luma};
use serde_json::Value;

const SAMPLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/sample.png");

/// Turns of the board about x, y and z.
const TURNS: [[f64; 3]; 6] =
    [[0.5, 0.1, 0.0], [-0.4, 0.3, 0.1], [0.1, -0.5, -0.1], [0.3, 0.5, 0.3], [-0.3, -0.4, 0.0], [0.0, 0.1, -0.2]];

fn calibrate<S: AsRef<std::ffi::OsStr>>(arguments: impl IntoIterator<Item = S>) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_calibrate")).args(arguments).output().unwrap();
    assert!(output.status.code().is_some() && !stderr(&output).contains("panicked"), "{}", stderr(&output));
    output
}

/// Rows of the homography from a board of 7 by 5 inner corners to a picture of 320 by 240 pixels of focal length 300.
fn homography([a, b, c]: [f64; 3]) -> [[f64; 3]; 3] {
    let (sa, ca, sb, cb, sc, cc) = (a.sin(), a.cos(), b.sin(), b.cos(), c.sin(), c.cos());
    // Columns of Rx(a) Ry(b) Rz(c).
    let right = [cb * cc, ca * sc + sa * sb * cc, sa * sc - ca * sb * cc];
    let down = [-cb * sc, ca * cc - sa * sb * sc, sa * cc + ca * sb * sc];
    let place = |i: usize| -3.0 * right[i] - 2.0 * down[i] + if i == 2 { 11.0 } else { 0.0 };
    let row = |i: usize| [right[i], down[i], place(i)];
    let (x, y, z) = (row(0), row(1), row(2));
    let mix = |p: [f64; 3], centre: f64| std::array::from_fn(|i| 300.0 * p[i] + centre * z[i]);
    [mix(x, 160.0), mix(y, 118.0), z]
}

fn solve(h: &[[f64; 3]; 3], u: f64, v: f64) -> [f64; 2] {
    // (h0 - u h2) . (x, y, 1) = 0 and (h1 - v h2) . (x, y, 1) = 0.
    let p: [f64; 3] = std::array::from_fn(|i| h[0][i] - u * h[2][i]);
    let q: [f64; 3] = std::array::from_fn(|i| h[1][i] - v * h[2][i]);
    let determinant = p[0] * q[1] - p[1] * q[0];
    [(p[1] * q[2] - p[2] * q[1]) / determinant, (p[2] * q[0] - p[0] * q[2]) / determinant]
}

fn picture(turn: [f64; 3]) -> GrayImage {
    let h = homography(turn);
    GrayImage::from_fn(320, 240, |u, v| {
        let dark = (0..36)
            .filter(|k| {
                let at = |i: u32| f64::from(i) / 6.0 - 5.0 / 12.0;
                let [x, y] = solve(&h, f64::from(u) + at(k % 6), f64::from(v) + at(k / 6));
                let is_inside = (-1.0..7.0).contains(&x) && (-1.0..5.0).contains(&y);
                is_inside && (x.floor() + y.floor()).rem_euclid(2.0) < 1.0
            })
            .count();
        Luma([(230.0 - 190.0 * dark as f64 / 36.0).round() as u8])
    })
}

fn board(folder: &Path) -> Vec<PathBuf> {
    TURNS
        .iter()
        .enumerate()
        .map(|(i, &turn)| {
            let path = folder.join(format!("board{i}.png"));
            picture(turn).save(&path).unwrap();
            path
        })
        .collect()
}

fn value(camera: &Value, name: &str) -> (f64, f64) {
    let parameters = camera["camera"]["parameters"].as_array().unwrap();
    let found = parameters.iter().find(|parameter| parameter["name"] == name).unwrap();
    (found["value"].as_f64().unwrap(), found["std"].as_f64().unwrap())
}

#[test]
fn pictures_of_a_board_become_a_camera() {
    let folder = folder("calibrate_pictures");
    let mut pictures = board(&folder);
    let file = folder.join("camera.json");
    let options = ["--board", "7x5", "--square", "30mm", "--distortion", "2", "-o", file.to_str().unwrap()];
    let all = |pictures: &[PathBuf]| {
        calibrate(pictures.iter().map(|path| path.as_os_str()).chain(options.iter().map(AsRef::as_ref)))
    };
    let output = all(&pictures);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let table = stdout(&output);
    assert!(table.contains("6 views with 210 points") && table.contains("fx "), "{table}");
    let camera: Value = serde_json::from_str(&fs::read_to_string(&file).unwrap()).unwrap();
    for name in ["fx_px", "fy_px"] {
        let (focal, std) = value(&camera, name);
        assert!((focal - 300.0).abs() < 1.0 && std < 1.0, "{name} {focal} {std}");
    }

    // A picture without a board is named and left out.
    pictures.push(PathBuf::from(SAMPLE));
    pictures.push(folder.join("missing.png"));
    let output = all(&pictures);
    assert_eq!(output.status.code(), Some(1));
    let complaints = stderr(&output);
    assert!(complaints.contains("sample.png: left out: no board of 7x5 found"), "{complaints}");
    assert!(complaints.contains("missing.png: left out: cannot be read"), "{complaints}");
    assert!(stdout(&output).contains("6 views with 210 points"));

    // And estimate takes what calibrate wrote.
    let (status, _) = run_json([
        "--camera",
        file.to_str().unwrap(),
        "--distance",
        "2m",
        "--exposure",
        "100ms",
        pictures[0].to_str().unwrap(),
    ]);
    assert_eq!(status, 0);
}

/// A file of a camera without distortion, focal length 500 and 400 pixels, for pictures of the sample's size.
fn camera_file(folder: &Path, width: usize, height: usize) -> PathBuf {
    let text = format!(
        r#"{{"format":"blur camera","version":1,"program":"hand","camera":{{"model":"","width_px":{width},"height_px":{height},
        "views":0,"points":0,"rms_px":0,"parameters":[{{"name":"fx_px","value":500,"std":5}},
        {{"name":"fy_px","value":400,"std":4}},{{"name":"cx_px","value":{},"std":0}},{{"name":"cy_px","value":{},"std":0}}],
        "covariance":[[25,0,0,0],[0,16,0,0],[0,0,0,0],[0,0,0,0]]}}}}"#,
        (width - 1) as f64 / 2.0,
        (height - 1) as f64 / 2.0
    );
    write(folder, &format!("camera{width}x{height}.json"), text.as_bytes())
}

fn sample_size() -> (usize, usize) {
    let (width, height) = image::image_dimensions(SAMPLE).unwrap();
    (width as usize, height as usize)
}

#[test]
fn a_camera_and_a_distance_give_the_speed() {
    let folder = folder("calibrate_speed");
    let (width, height) = sample_size();
    let camera = camera_file(&folder, width, height);
    let (status, objects) = run_json([
        "--camera",
        camera.to_str().unwrap(),
        "--distance",
        "2m",
        "--distance-u",
        "20mm",
        "--exposure",
        "100ms",
        SAMPLE,
    ]);
    assert_eq!(status, 0);
    let number = |name: &str| objects[0][name].as_f64().unwrap_or_else(|| panic!("{name} in {}", objects[0]));
    let (sin, cos) = number("angle_deg").to_radians().sin_cos();
    let (right, up) = (number("length_px") * cos / 500.0, number("length_px") * sin / 400.0);
    let metres = 2.0 * right.hypot(up);
    assert!((number("speed_m_s") / (metres / 0.1) - 1.0).abs() < 1e-9);
    assert!((number("length_undistorted_px") - 500.0 * right.hypot(up)).abs() < 1e-9);
    assert!((number("angle_undistorted_deg") - up.atan2(right).to_degrees().rem_euclid(180.0)).abs() < 1e-9);
    assert_eq!(objects[0]["focal_length_source"], "camera");
    // At least what the length, the distance and a focal length known to 1 % of independent fx and fy contribute.
    let relative = (number("length_std_px") / number("length_px")).hypot(0.01);
    assert!(number("speed_std_m_s") / number("speed_m_s") > relative);
    assert!(number("speed_std_m_s") / number("speed_m_s") < relative + 0.02);
}

#[test]
fn a_picture_of_another_shape_is_refused_and_of_another_size_scaled() {
    let folder = folder("calibrate_sizes");
    let (width, height) = sample_size();
    let camera = camera_file(&folder, width + 100, height);
    let (status, objects) = run_json(["--camera", camera.to_str().unwrap(), "--distance", "2m", SAMPLE]);
    assert_eq!(status, 1);
    assert!(objects[0]["error"].as_str().unwrap().contains("another shape"), "{}", objects[0]);

    let camera = camera_file(&folder, 2 * width, 2 * height);
    let output = common::run(["--camera", camera.to_str().unwrap(), "--distance", "2m", SAMPLE]);
    assert_eq!(output.status.code(), Some(0));
    assert!(stderr(&output).contains("scaled to this picture"), "{}", stderr(&output));
    assert!(stdout(&output).contains("focal length 250.0 ± 2.5 px"), "{}", stdout(&output));
}

#[test]
fn a_rotating_camera_has_an_angular_rate() {
    let folder = folder("calibrate_rotating");
    let (width, height) = sample_size();
    let camera = camera_file(&folder, width, height);
    let (status, objects) =
        run_json(["--rotating", "--camera", camera.to_str().unwrap(), "--exposure", "10ms", SAMPLE]);
    assert_eq!(status, 0);
    let number = |name: &str| objects[0][name].as_f64().unwrap_or_else(|| panic!("{name} in {}", objects[0]));
    // Both ends are as far from the axis.
    let (sin, cos) = number("angle_deg").to_radians().sin_cos();
    let half = (0.5 * number("length_px") * cos / 500.0).hypot(0.5 * number("length_px") * sin / 400.0);
    assert!((number("angular_rate_rad_s") - 2.0 * half.atan() / 0.01).abs() < 1e-9);
    assert!((number("angular_rate_expanded_rad_s") - 2.0 * number("angular_rate_std_rad_s")).abs() < 1e-12);
    assert!(objects[0].get("speed_m_s").is_none());

    // Neither camera nor EXIF data: measured all the same, and said.
    let output = common::run(["--rotating", "--exposure", "10ms", SAMPLE]);
    assert_eq!(output.status.code(), Some(0));
    assert!(stdout(&output).contains("no angular rate: --camera is missing"), "{}", stdout(&output));
}

#[test]
fn points_in_text_files_are_calibrated() {
    let folder = folder("calibrate_points");
    let mut model = String::new();
    let mut views = vec![String::new(); TURNS.len()];
    for (i, (x, y)) in (0..5).flat_map(|y| (0..7).map(move |x| (x, y))).enumerate() {
        // Two points a line, as Zhang's have four.
        let end = if i % 2 == 0 { " " } else { "\n" };
        write!(model, "{x} {y}{end}").unwrap();
        for (view, &turn) in views.iter_mut().zip(&TURNS) {
            let h = homography(turn);
            let p: [f64; 3] = std::array::from_fn(|i| h[i][0] * f64::from(x) + h[i][1] * f64::from(y) + h[i][2]);
            write!(view, "{} {}{end}", p[0] / p[2], p[1] / p[2]).unwrap();
        }
    }
    let model = write(&folder, "Model.txt", model.as_bytes());
    let mut arguments = vec!["--points".to_owned(), model.display().to_string(), "--size".into(), "320x240".into()];
    for (i, view) in views.iter().enumerate() {
        arguments.push(write(&folder, &format!("data{i}.txt"), view.as_bytes()).display().to_string());
    }
    arguments.push("--json".into());
    let output = calibrate(&arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let camera: Value = serde_json::from_str(stdout(&output)).unwrap();
    for (name, truth) in [("fx_px", 300.0), ("fy_px", 300.0), ("cx_px", 160.0), ("cy_px", 118.0), ("k1", 0.0)] {
        assert!((value(&camera, name).0 - truth).abs() < 1e-6, "{name} {:?}", value(&camera, name));
    }

    let short = write(&folder, "short.txt", b"1 2\n3 4 5 6\n");
    let odd = write(&folder, "odd.txt", b"1 2\n3 4 5\n");
    let word = write(&folder, "word.txt", b"1 two\n");
    arguments.extend([short, odd, word].map(|path| path.display().to_string()));
    let output = calibrate(&arguments);
    assert_eq!(output.status.code(), Some(1));
    let complaints = stderr(&output);
    assert!(complaints.contains("3 points; the board has 35"), "{complaints}");
    assert!(complaints.contains("line 2: '3 4 5' is not points"), "{complaints}");
    assert!(complaints.contains("line 1: '1 two'"), "{complaints}");
}

#[test]
fn mistakes_on_the_command_line_are_explained() {
    for (arguments, part) in [
        (&["a.png"][..], "--board"),
        (&["a.png", "--board", "9"], "9x6"),
        (&["a.png", "--board", "1x6"], "columns of the board"),
        (&["a.png", "--board", "9x6", "--square", "25"], "mm"),
        (&["a.png", "--board", "8x8", "--pattern", "squares"], "--pitch"),
        (&["a.png", "--board", "8x8", "--pattern", "squares", "--square", "2cm", "--pitch", "1cm"], "pitch"),
        (&["a.txt", "--points", "m.txt"], "--size"),
        (&["a.png", "--board", "9x6", "--distortion", "3"], "2, 4, 5"),
        (&["a.png", "--board", "9x6", "--corner-window", "0"], "half window"),
        (
            &["a.png", "--board", "8x8", "--pattern", "squares", "--pitch", "5cm", "--corner-window", "5"],
            "separate squares",
        ),
    ] {
        let output = calibrate(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(stderr(&output).contains(part), "{arguments:?}: {}", stderr(&output));
    }
    let output = calibrate(["missing.png", "--board", "9x6"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("0 views of the board are too few"), "{}", stderr(&output));
    let help = stdout(&calibrate(["--help"])).to_owned();
    assert!(help.lines().all(|line| line.chars().count() <= 110), "{help}");
}
