//! `board --wave` plays exact waveforms into the timer's real ELF file.

#![allow(clippy::expect_used, clippy::panic)]

mod rig;

use rig::{Board, CYCLES_PER_MS, CYCLES_PER_TICK, Run};
use slider_proto::{ArmSettings, Command, Decoder, Level, MAX_FRAME, Report, TimerState, encode};
use slider_sim::Pin;
use slider_sim::wave::{self, Pass, Player, Start};
use std::fs::File;
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Command as Program, Stdio};

/// Two passes: of two teeth and of three.
const FILE: &str = "# two teeth\n480000 0\n500001 1\n560000 0\n580003 1\n\n\
                    # three\n160000 0\n176000 1\n192000 0\n208000 1\n224000 0\n240000 1\n";

fn passes() -> Vec<Pass> {
    wave::parse(FILE).expect("passes")
}

fn player(board: &mut Board, start: Start) -> Player {
    Player::new(passes(), Pin::D8, start, &mut board.mcu)
}

/// Lets some milliseconds pass.
fn turn(board: &mut Board, player: &mut Player, ms: u64) {
    for _ in 0..ms {
        player.act(&mut board.mcu);
        board.run_ms(1);
    }
}

/// Cycle at which D13 rose last.
fn armed_at(board: &Board) -> u64 {
    board.mcu.changes(Pin::D13).iter().rev().find(|change| change.level).expect("it was armed").cycle
}

/// Takes a run out of what was told.
fn told(board: &mut Board) -> Run {
    let end = board.wait(|report| matches!(report, Report::RunEnd { .. }), 1000);
    let Report::RunEnd { run, late, lost, reason, .. } = end else { unreachable!() };
    let mut edges = Vec::new();
    for (_, report) in board.reports.drain(..) {
        if let Report::Edges(batch) = report {
            edges.extend_from_slice(batch.edges());
        }
    }
    Run { number: run, edges, late, lost, reason }
}

#[test]
fn every_arming_plays_the_next_pass_to_the_cycle() {
    let mut timer = Board::timer();
    let mut player = player(&mut timer, Start::Armed);
    turn(&mut timer, &mut player, 20);
    for number in 0..4 {
        let before = timer.mcu.delivered(Pin::D8).len();
        timer.arm(number, 1, 20);
        turn(&mut timer, &mut player, 100);
        let armed = armed_at(&timer);
        let pass = &passes()[usize::from(number) % 2];
        let played: Vec<_> =
            timer.mcu.delivered(Pin::D8)[before..].iter().map(|at| (at.asked - armed, at.level)).collect();
        assert_eq!(played[..pass.len()], pass[..], "pass {number}");
        let run = told(&mut timer);
        assert_eq!((run.number, run.late, run.lost, run.edges.len()), (number, 0, 0, pass.len()));
        for (edge, (cycle, high)) in run.edges.iter().zip(pass) {
            let ticks = u64::from(edge.tick.wrapping_sub(run.edges[0].tick));
            assert!((ticks * CYCLES_PER_TICK).abs_diff(cycle - pass[0].0) <= CYCLES_PER_TICK);
            assert_eq!(edge.level == Level::High, *high);
        }
        assert_eq!(player.over(), usize::from(number) + 1);
    }
}

#[test]
fn a_pass_is_called_off_before_its_first_edge() {
    let mut timer = Board::timer();
    timer.run_ms(3);
    let mut player = player(&mut timer, Start::Armed);
    timer.arm(1, 1, 20);
    turn(&mut timer, &mut player, 10);
    assert!(player.is_busy());
    timer.order(Command::Stop);
    turn(&mut timer, &mut player, 100);
    assert!(timer.mcu.delivered(Pin::D8).iter().all(|at| at.level), "no tooth came");
    assert!(!player.is_busy() && player.over() == 0);
    timer.arm(2, 1, 20);
    turn(&mut timer, &mut player, 100);
    assert_eq!(told(&mut timer).edges.len(), 4, "the first pass, which was not used up");
}

#[test]
fn a_sheet_that_stays_in_the_sensor_is_taken_out() {
    let mut timer = Board::timer();
    timer.run_ms(3);
    let passes = wave::parse("480000 0\n").expect("a pass");
    let mut player = Player::new(passes, Pin::D8, Start::Armed, &mut timer.mcu);
    for number in 1..=2 {
        timer.arm(number, 1, 20);
        turn(&mut timer, &mut player, 100);
        assert_eq!(told(&mut timer).edges.len(), 1);
    }
}

#[test]
fn passes_may_come_by_the_clock() {
    let mut timer = Board::timer();
    let every = 60 * CYCLES_PER_MS;
    let mut player = player(&mut timer, Start::Every(every));
    turn(&mut timer, &mut player, 250);
    let teeth: Vec<_> = timer.mcu.delivered(Pin::D8).iter().filter(|at| !at.level).map(|at| at.asked).collect();
    // Passes begin at 60, 120 and 180 ms; their first teeth come 30, 10 and 30 ms later.
    let first: Vec<_> =
        [(1, 480_000), (1, 560_000), (2, 160_000), (2, 192_000), (2, 224_000), (3, 480_000), (3, 560_000)]
            .map(|(turn, cycle)| turn * every + cycle)
            .into();
    assert_eq!(teeth[..first.len()], first[..]);
    timer.order(Command::Status);
    let status = timer.wait(|report| matches!(report, Report::Status { .. }), 100);
    assert!(matches!(status, Report::Status { state: TimerState::Idle, .. }));
}

#[test]
fn the_program_ends_after_its_runs_when_all_was_read() {
    let wave = std::path::PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("runs.wave");
    std::fs::write(&wave, FILE).expect("a file");
    let mut program = Program::new(env!("CARGO_BIN_EXE_board"));
    program.arg(rig::elf("timer")).arg("--wave").arg(wave).args(["--runs", "1", "--fast", "--for", "60s"]);
    let mut child = program.stdout(Stdio::piped()).spawn().expect("the program was just built");
    let mut line = String::new();
    BufReader::new(child.stdout.take().expect("piped")).read_line(&mut line).expect("a first line");
    let path = line.trim_end().strip_prefix("pty ").expect("pty PATH");
    let mut host = File::options().read(true).write(true).open(path).expect("the line");
    let mut decoder = Decoder::<Report>::default();
    let (mut edges, mut ended, mut bytes) = (0, false, [0; 64]);
    // The line is gone after the last run: 0 or an error.
    while let Ok(length @ 1..) = host.read(&mut bytes) {
        for frame in bytes[..length].iter().filter_map(|byte| decoder.push(*byte)) {
            match frame.expect("the line damages nothing").message {
                Report::Hello { .. } => {
                    let arm = Command::Arm(ArmSettings { run: 1, trigger_ms: 1, quiet_ms: 20 });
                    host.write_all(encode(&arm, 0, &mut [0; MAX_FRAME])).expect("the line takes it");
                }
                Report::Edges(batch) => edges += batch.edges().len(),
                Report::RunEnd { .. } => ended = true,
                _ => {}
            }
        }
    }
    assert!(child.wait().expect("it ends").success());
    assert_eq!((edges, ended), (4, true));
}

#[test]
fn the_program_ends_with_its_input_if_told_so() {
    let mut program = Program::new(env!("CARGO_BIN_EXE_board"));
    let begun = std::time::Instant::now();
    let done = program.arg(rig::elf("timer")).args(["--until-eof", "--for", "60s"]).stdin(Stdio::null()).status();
    assert!(done.expect("it runs").success());
    assert!(begun.elapsed().as_secs() < 30);
}

#[test]
fn the_program_says_which_line_is_wrong() {
    let file = std::path::PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("wrong.wave");
    std::fs::write(&file, "# a pass\n32000 0\nsoon 1\n").expect("a file");
    let board = |arguments: &[&str]| {
        let mut program = Program::new(env!("CARGO_BIN_EXE_board"));
        let done = program.arg("x.elf").args(arguments).output().expect("it runs");
        (done.status.code(), String::from_utf8_lossy(&done.stderr).into_owned())
    };
    let (code, message) = board(&["--wave", file.to_str().expect("a name")]);
    assert_eq!(code, Some(1));
    assert!(message.contains("wrong.wave:3: cycle 'soon'"), "{message}");
    let (code, message) = board(&["--wave", "/no/such.wave"]);
    assert_eq!(code, Some(1));
    assert!(message.contains("/no/such.wave"), "{message}");
    assert_eq!(board(&["--wave", "x", "--speed", "1"]).0, Some(2));
    assert_eq!(board(&["--runs", "1"]).0, Some(2));
}
