//! The thesis in one test: the speed by the slider's encoder and the speed by one blurred picture are the same.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::env;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use blur_core::estimate::AxialAngle;
use blur_sim::expose::expose;
use blur_sim::motion::Motion;
use blur_sim::scene::{DeadLeaves, dead_leaves};
use blur_sim::sensor::Sensor;
use e2e_tests::program;
use serde_json::Value;

/// Speeds of table 5.1, m/s: the presets of `slider simulate`.
const SPEEDS_M_S: [f64; 10] = [0.2243, 0.2871, 0.3454, 0.3935, 0.4303, 0.4674, 0.5109, 0.5329, 0.5444, 0.6021];
/// Directions of the motion in the picture, degrees.
const ANGLES_DEG: [f64; 2] = [0.0, 35.0];
/// Exposure and scale of section 5.3.
const EXPOSURE_S: f64 = 0.1;
const SCALE_M_PER_PX: f64 = 0.7789e-3;
const SIZE: usize = 512;

/// The slider in a simulated chip, ended with the test.
struct Slider(Child);

impl Drop for Slider {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Whether the firmware and the program that runs it are built; `cargo xtask test` does that first.
fn has_firmware() -> bool {
    let target = program::root().join("firmware/target");
    let elf = target.join("avr-none/release/timer.elf");
    let board = std::fs::read_dir(&target)
        .into_iter()
        .flatten()
        .filter_map(Result::ok)
        .any(|folder| folder.path().join("release/board").is_file());
    if elf.is_file() && board {
        return true;
    }
    assert!(
        env::var_os("BLUR_REQUIRE_FIRMWARE").is_none(),
        "BLUR_REQUIRE_FIRMWARE is set and the firmware is not built"
    );
    eprintln!("SKIPPED: the firmware and its simulator are not built: cargo xtask test");
    false
}

fn json(command: &mut Command) -> Value {
    let output = command.stderr(Stdio::inherit()).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{command:?}: {text}");
    serde_json::from_str(text.trim()).unwrap()
}

/// Speed and its expanded uncertainty by the encoder: a rig whose sheet differs from its description as much as that
/// says, the firmware, and the host.
fn by_encoder(slider: &Path, preset: usize) -> (f64, f64) {
    let sheet = program::root().join("fixtures/sheet13.toml");
    let child = Command::new(slider)
        .args(["simulate", "--fast", "--runs", "1", "--jitter", "0.5", "--firmware"])
        .arg(program::root().join("firmware"))
        .args(["--preset", &preset.to_string(), "--seed", &preset.to_string(), "--sheet"])
        .arg(&sheet)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut rig = Slider(child);
    let mut line = String::new();
    BufReader::new(rig.0.stdout.take().unwrap()).read_line(&mut line).unwrap();
    let port = line.trim().strip_prefix("pty ").unwrap();
    let result = json(
        Command::new(slider)
            .args(["listen", "--once", "--json", "--degree", "1", "--quiet-ms", "200", "--port", port, "--sheet"])
            .arg(&sheet),
    );
    assert_eq!(result["edges"], 26, "{result}");
    (result["speed_m_s"].as_f64().unwrap(), result["speed_expanded_m_s"].as_f64().unwrap())
}

/// Speed and its expanded uncertainty by one picture of a scene that moves at `speed_m_s`.
fn by_picture(estimate: &Path, speed_m_s: f64, angle_deg: f64, seed: u64) -> (f64, f64) {
    let motion = Motion::uniform(speed_m_s * EXPOSURE_S / SCALE_M_PER_PX, AxialAngle::from_deg(angle_deg)).unwrap();
    let margin = 128;
    let scene = dead_leaves(seed, SIZE + margin, SIZE + margin, &DeadLeaves::default()).unwrap();
    let exposure = expose(scene.view(), &motion).unwrap();
    let picture = Sensor::ideal().with_psnr_db(36.0).unwrap().record(exposure.view(), seed).unwrap();
    let (rows, columns) = picture.dim();
    let pixels: Vec<u8> = picture.iter().copied().collect();
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("slider-{seed}.png"));
    image::save_buffer(&path, &pixels, columns as u32, rows as u32, image::ExtendedColorType::L8).unwrap();
    let result = json(
        Command::new(estimate)
            .args(["--json", "--exposure", "100ms", "--exposure-u", "0.05ms"])
            .args(["--scale", "0.7789mm/px", "--scale-u", "0.0005mm/px"])
            .arg(&path),
    );
    assert_eq!(result["status"], "ok", "{result}");
    let error = (result["angle_deg"].as_f64().unwrap() - angle_deg + 90.0).rem_euclid(180.0) - 90.0;
    assert!(error.abs() < 0.5, "{result}");
    (result["speed_m_s"].as_f64().unwrap(), result["speed_expanded_m_s"].as_f64().unwrap())
}

#[test]
fn encoder_and_picture_agree_on_ten_speeds_in_two_directions() {
    if !has_firmware() {
        return;
    }
    let slider = program::built("slider-host", "slider");
    let estimate = program::built("blur-cli", "estimate");
    println!("truth m/s   encoder m/s             angle   picture m/s             difference / U");
    for (preset, truth) in SPEEDS_M_S.into_iter().enumerate() {
        let (encoder, u_encoder) = by_encoder(&slider, preset);
        for (n, angle) in ANGLES_DEG.into_iter().enumerate() {
            let seed = (10 * preset + n) as u64;
            let (picture, u_picture) = by_picture(&estimate, truth, angle, seed);
            // Normalised error of ISO 13528: at most 1 where both uncertainties hold.
            let share = (encoder - picture).abs() / u_encoder.hypot(u_picture);
            println!(
                "{truth:.4}      {encoder:.5} +- {u_encoder:.5}      {angle:>4}    {picture:.5} +- {u_picture:.5}      {share:.2}"
            );
            assert!(
                share <= 1.0,
                "{truth} m/s, {angle} degrees: {encoder} +- {u_encoder} and {picture} +- {u_picture}"
            );
        }
        // Both know the speed well, or the agreement would say nothing.
        assert!(u_encoder < 0.01 * truth, "{u_encoder}");
    }
}
