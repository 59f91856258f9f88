//! The virtual slider with the real firmware in between tells the same edges.
//!
//! Needs the firmware and the program that simulates its chip: `cargo xtask firmware`, and in `firmware/sim`
//! `cargo build --release --bin board`. Without them these tests say so and pass; with `BLUR_REQUIRE_FIRMWARE` set they
//! fail.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper that fails, fails the test")]

mod board_host;

use std::path::PathBuf;

use board_host::{Host, options, start};
use slider_host::simulate;
use slider_proto::{ArmSettings, Command, EndReason, Report, TICK_HZ, Unit};

/// The options that name both, or `None` if one of them is not there.
fn firmware() -> Option<Vec<String>> {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..");
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("firmware/target"), |to| root.join(to));
    let elf = target.join("avr-none/release/timer.elf");
    let folders = std::fs::read_dir(&target).into_iter().flatten().flatten().map(|entry| entry.path());
    let built = folders.chain([target]).map(|folder| folder.join("release/board"));
    let board =
        std::env::var_os("SLIDER_BOARD").map(PathBuf::from).into_iter().chain(built).find(|path| path.is_file());
    match (elf.is_file(), board) {
        (true, Some(board)) => {
            let name = |path: PathBuf| path.to_str().unwrap().to_owned();
            Some(["--firmware".into(), "--elf".into(), name(elf), "--board".into(), name(board)].into())
        }
        (_, board) => {
            let missing = format!("firmware {} or program board {board:?} is not built", elf.display());
            assert!(std::env::var_os("BLUR_REQUIRE_FIRMWARE").is_none(), "{missing}");
            println!("skipped: {missing}");
            None
        }
    }
}

fn settings(run: u16) -> ArmSettings {
    ArmSettings { run, trigger_ms: 10, quiet_ms: 100 }
}

#[test]
fn the_firmware_tells_the_edges_of_the_rig() {
    let Some(firmware) = firmware() else { return };
    let rig = ["--fast", "--preset", "2,9", "--jitter", "2", "--ppm", "-25", "--runs", "3"];
    let arguments: Vec<&str> = rig.into_iter().chain(firmware.iter().map(String::as_str)).collect();
    let track = options(&rig).track().unwrap();
    let (path, slider) = start(&arguments);
    let mut host = Host::open(&path);
    let hello = host.wait(|report| matches!(report, Report::Hello { .. }));
    assert!(matches!(hello, Report::Hello { unit: Unit::Timer, tick_hz: TICK_HZ, .. }), "{hello:?}");
    for index in 0..3 {
        let run = host.run(settings(index));
        assert_eq!((run.number, run.reason, run.late, run.lost), (index, EndReason::Quiet, 0, 0));
        let pass = track.pass(index.into()).unwrap();
        assert_eq!(run.edges.len(), pass.crossings.len());
        for (edge, crossing) in run.edges.iter().zip(&pass.crossings) {
            let time = crossing.time_s - pass.crossings[0].time_s;
            let expected = time * f64::from(TICK_HZ) * (1.0 - 25e-6);
            let found = f64::from(edge.tick.wrapping_sub(run.edges[0].tick));
            // The edge is rounded to a cycle of 1/8 tick, and the count cut off.
            assert!((found - expected).abs() <= 1.0 + 1.0 / 8.0, "{found} {expected}");
            assert_eq!(edge.level, crossing.level);
        }
    }
    assert!(host.errors.is_empty(), "{:?}", host.errors);
    slider.join().unwrap().unwrap();
}

#[test]
fn a_pass_that_is_called_off_comes_at_the_next_arming() {
    let Some(firmware) = firmware() else { return };
    // In real time, so that the host is in time to stop it.
    let rig = ["--speed", "0.6", "--runs", "1", "--delay", "1000"];
    let arguments: Vec<&str> = rig.into_iter().chain(firmware.iter().map(String::as_str)).collect();
    let (path, slider) = start(&arguments);
    let mut host = Host::open(&path);
    // What comes before it, the chip does not hear.
    host.wait(|report| matches!(report, Report::Hello { .. }));
    host.order(Command::Arm(settings(1)));
    host.order(Command::Stop);
    assert_eq!(host.run(settings(2)).edges.len(), 26);
    slider.join().unwrap().unwrap();
}

#[test]
fn what_is_missing_is_named() {
    let refused = |arguments: &[&str]| simulate::run(&options(arguments), &mut Vec::new()).unwrap_err().to_string();
    let nowhere = std::env::temp_dir();
    let nowhere = nowhere.to_str().unwrap();
    let message = refused(&["--firmware", nowhere, "--board", "/no/such/board"]);
    assert!(message.contains("/no/such/board"), "{message}");
    let program = std::env::current_exe().unwrap();
    let message = refused(&["--firmware", nowhere, "--board", program.to_str().unwrap()]);
    assert!(message.contains("timer.elf") && message.contains("cargo xtask firmware"), "{message}");
    // A program that is no board: this one does not know its arguments.
    let message =
        refused(&["--firmware", nowhere, "--board", program.to_str().unwrap(), "--elf", program.to_str().unwrap()]);
    assert!(message.contains("exit status") && message.contains("wave"), "{message}");
}
