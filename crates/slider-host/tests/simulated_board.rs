//! A host on the virtual slider's pseudo-terminal gets exactly the edges of its rig.
#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a helper that fails, fails the test")]

mod board_host;

use board_host::{Host, start};
use slider_host::simulate::rig::Clock;
use slider_proto::{
    ArmSettings, Command, Direction, DriveState, Edge, EndReason, Level, Preset, Refusal, Report, TICK_HZ, TimerState,
    Unit,
};

/// The rig's edges as ticks from the first one.
fn expected(arguments: &[&str], index: u32) -> Vec<(u32, Level)> {
    let track = board_host::options(arguments).track().unwrap();
    let clock = Clock { start_tick: 0, ..track.rig.clock() };
    let pass = track.pass(index).unwrap();
    let first = pass.crossings[0].time_s;
    pass.crossings.iter().map(|crossing| (clock.tick(crossing.time_s - first), crossing.level)).map(short).collect()
}

fn short((tick, level): (u64, Level)) -> (u32, Level) {
    (u32::try_from(tick).unwrap(), level)
}

/// Both ends of an interval are rounded, so it is right within a tick.
fn check(edges: &[Edge], expected: &[(u32, Level)]) {
    assert_eq!(edges.len(), expected.len());
    for (edge, &(tick, level)) in edges.iter().zip(expected) {
        let found = edge.tick.wrapping_sub(edges[0].tick);
        assert!(found.abs_diff(tick) <= 1, "{found} {tick}");
        assert_eq!((edge.level, edge.late), (level, false));
    }
}

fn settings(run: u16) -> ArmSettings {
    ArmSettings { run, trigger_ms: 10, quiet_ms: 100 }
}

#[test]
fn runs_come_one_after_the_other_with_the_edges_of_the_rig() {
    let arguments = ["--fast", "--preset", "0,9", "--jitter", "3", "--ppm", "30", "--runs", "4"];
    let (path, slider) = start(&arguments);
    let mut host = Host::open(&path);
    for index in 0..4u16 {
        let run = host.run(settings(40 + index));
        assert_eq!((run.number, run.reason, run.late, run.lost), (40 + index, EndReason::Quiet, 0, 0));
        check(&run.edges, &expected(&arguments, index.into()));
    }
    assert!(host.errors.is_empty(), "{:?}", host.errors);
    slider.join().unwrap().unwrap();
}

#[test]
fn real_time_is_kept() {
    let arguments = ["--speed", "0.6", "--runs", "1", "--delay", "100"];
    let (path, slider) = start(&arguments);
    let mut host = Host::open(&path);
    let begun = std::time::Instant::now();
    let run = host.run(settings(1));
    // A start of 0.255 s to 0.6 m/s, 20 mm of lead, 99.1 mm of sheet and 0.1 s of quiet: 0.65 s with the delay.
    let took = begun.elapsed().as_secs_f64();
    assert!((0.6..5.0).contains(&took), "{took}");
    check(&run.edges, &expected(&arguments, 0));
    slider.join().unwrap().unwrap();
}

#[test]
fn the_counter_wraps_in_the_middle_of_a_run() {
    // 2^32 ticks are 2147.48 s. At 0.01 m/s the sheet comes 2.1 s after the arming and passes for 9.9 s, so the host may
    // arm up to 5 s after the start.
    let arguments = ["--fast", "--speed", "0.01", "--uptime", "2140", "--runs", "1", "--delay", "0"];
    let (path, slider) = start(&arguments);
    let mut host = Host::open(&path);
    let run = host.run(ArmSettings { quiet_ms: 1000, ..settings(1) });
    check(&run.edges, &expected(&arguments, 0));
    let wrapped = run.edges.windows(2).any(|pair| pair[1].tick < pair[0].tick);
    assert!(wrapped, "{:?}", run.edges);
    slider.join().unwrap().unwrap();
}

#[test]
fn the_truth_is_there_before_the_run_is_told() {
    let file = std::env::temp_dir().join(format!("slider-truth-{}.jsonl", std::process::id()));
    let name = file.to_str().unwrap();
    let arguments = ["--fast", "--incline", "15", "--runs", "2", "--truth", name];
    let (path, slider) = start(&arguments);
    let mut host = Host::open(&path);
    for number in [7, 9] {
        let run = host.run(settings(number));
        let text = std::fs::read_to_string(&file).unwrap();
        let truth: serde_json::Value = serde_json::from_str(text.lines().last().unwrap()).unwrap();
        assert_eq!(truth["run"], number);
        let accel = truth["accel_m_s2"].as_f64().unwrap();
        assert!((accel - 2.4623).abs() < 1e-3, "{accel}");
        let last = truth["edges_s"][25].as_f64().unwrap() * f64::from(TICK_HZ);
        let found = run.edges[25].tick.wrapping_sub(run.edges[0].tick);
        assert!((f64::from(found) - last).abs() <= 1.0);
    }
    slider.join().unwrap().unwrap();
    std::fs::remove_file(file).unwrap();
}

#[test]
fn the_end_of_travel_ends_the_run() {
    let (path, slider) = start(&["--fast", "--travel", "5", "--runs", "1"]);
    let mut host = Host::open(&path);
    let run = host.run(ArmSettings { quiet_ms: 5000, ..settings(1) });
    assert_eq!((run.edges.len(), run.reason), (26, EndReason::Limit));
    let limit = host.reports.iter().find_map(|report| match report {
        Report::LimitHit { tick } => Some(tick.wrapping_sub(run.edges[25].tick)),
        _ => None,
    });
    // 5 mm at the 0.4674 m/s of preset 5, and a turn of the main loop.
    let late = f64::from(limit.unwrap()) / f64::from(TICK_HZ) - 0.005 / 0.4674;
    assert!((0.0..0.0005).contains(&late), "{late}");
    slider.join().unwrap().unwrap();
}

#[test]
fn a_timer_that_is_stopped_calls_the_pass_off() {
    let file = std::env::temp_dir().join(format!("slider-called-off-{}.jsonl", std::process::id()));
    // In real time, so that the host is in time to stop it: the first tooth would come after 0.7 s.
    let (path, slider) = start(&["--delay", "500", "--runs", "1", "--truth", file.to_str().unwrap()]);
    let mut host = Host::open(&path);
    host.order(Command::Arm(settings(1)));
    host.order(Command::Stop);
    std::thread::sleep(std::time::Duration::from_secs(1));
    host.order(Command::Status);
    let status = host.wait(|report| matches!(report, Report::Status { .. }));
    let Report::Status { state, edges, sensor, limit, .. } = status else { unreachable!() };
    assert_eq!((state, edges, sensor, limit), (TimerState::Idle, 0, Level::High, false));
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "", "no pass");
    let run = host.run(settings(2));
    assert_eq!((run.number, run.edges.len()), (2, 26));
    slider.join().unwrap().unwrap();
    std::fs::remove_file(file).unwrap();
}

#[test]
fn it_answers_like_the_firmware() {
    let (path, slider) = start(&["--fast", "--runs", "1"]);
    let mut host = Host::open(&path);
    let hello = host.wait(|report| matches!(report, Report::Hello { .. }));
    assert_eq!(hello, Report::Hello { unit: Unit::Timer, firmware: [0, 1, 0], tick_hz: TICK_HZ, reset_cause: 1 });
    host.order(Command::SelfTest);
    let test = host.wait(|report| matches!(report, Report::SelfTest { .. }));
    assert_eq!(test, Report::SelfTest { edges: 26, worst_error_ticks: 0 });
    let refused = host.ask(Command::Go { index: 1 });
    assert!(matches!(refused, Report::Nak { reason: Refusal::NotMine, .. }), "{refused:?}");
    assert_eq!(host.run(settings(1)).edges.len(), 26);
    slider.join().unwrap().unwrap();
}

#[test]
fn the_presets_of_the_drive_set_the_speed() {
    let (told, slider) = board_host::tell(&["--drive", "--fast", "--runs", "3"], 2);
    let mut timer = Host::open(told[0].strip_prefix("pty ").unwrap());
    let mut drive = Host::open(told[1].strip_prefix("drive ").unwrap());
    let hello = drive.wait(|report| matches!(report, Report::Hello { .. }));
    assert!(matches!(hello, Report::Hello { unit: Unit::Drive, .. }));
    let mut speed = |number| {
        let edges = timer.run(settings(number)).edges;
        // 12 pitches of 8 mm and a tooth of 3.1.
        0.0991 / (f64::from(edges[25].tick.wrapping_sub(edges[0].tick)) / f64::from(TICK_HZ))
    };
    assert!((speed(1) - 0.2243).abs() < 1e-5, "preset 0");
    drive.order(Command::Go { index: 9 });
    drive.wait(|report| matches!(report, Report::Preset { index: 9, state: DriveState::Running, .. }));
    assert!((speed(2) - 0.6021).abs() < 1e-5, "preset 9");
    // Half way between the duties of presets 2 and 3, 108 and 129.
    let preset = Preset { duty: 118, direction: Direction::Forward };
    drive.order(Command::SetPreset { index: 9, preset });
    let between = 0.3454 + (0.3935 - 0.3454) * 10.0 / 21.0;
    drive.wait(|report| matches!(report, Report::Preset { preset: Preset { duty: 118, .. }, .. }));
    assert!((speed(3) - between).abs() < 1e-5, "a preset of the host");
    slider.join().unwrap().unwrap();
}

#[test]
fn hosts_may_come_and_go() {
    let (path, slider) = start(&["--fast", "--runs", "2"]);
    for number in 1..=2 {
        let mut host = Host::open(&path);
        assert_eq!(host.run(settings(number)).edges.len(), 26);
    }
    slider.join().unwrap().unwrap();
}

#[test]
fn options_that_cannot_be_are_refused() {
    for arguments in [
        &["--speed", "0"][..],
        &["--accel", "0"],
        &["--incline", "0.1"],
        &["--missing-tooth", "14"],
        &["--sheet", "/no/such.toml"],
        &["--jitter", "NaN"],
        &["--ripple", "100"],
    ] {
        let refused = slider_host::simulate::run(&board_host::options(arguments), &mut Vec::new());
        assert!(refused.is_err(), "{arguments:?}");
    }
}
