//! What is wrong with a line is told in one line that says what to do. On real terminals.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::panic, missing_docs, unreachable_pub, dead_code, reason = "tests")]

mod rig;

use std::time::Duration;

use rig::{Play, Rig};
use slider_host::Error;
use slider_host::port::{BAUD, Greeting, Line, Patience, SerialLine, list};
use slider_host::reader::{Event, Missing};
use slider_proto::{Command, Refusal, Report, Unit};

const SHORT: Patience =
    Patience { reset: Duration::from_millis(300), answer: Duration::from_millis(100), questions: 2 };

fn greet(play: Play, wanted: Unit) -> Result<Greeting, Error> {
    let rig = Rig::new(play);
    Line::open(&rig.port(), BAUD)?.greet(Some(wanted), SHORT)
}

/// The line, which has to be one line.
fn trouble(play: Play) -> String {
    let text = greet(play, Unit::Timer).unwrap_err().to_string();
    assert!(!text.contains('\n'), "{text}");
    text
}

#[test]
fn each_board_is_greeted() {
    let timer = greet(Play::Timer { edges: 2 }, Unit::Timer).unwrap();
    assert_eq!(timer, Greeting { unit: Unit::Timer, firmware: [0, 1, 0], tick_hz: 2_000_000 });
    assert_eq!(timer.note(), None);
    assert_eq!(greet(Play::Drive, Unit::Drive).unwrap().unit, Unit::Drive);
}

#[test]
fn silence_is_told() {
    let text = trouble(Play::Silent);
    assert!(text.contains("nothing received in 0.5 s: is the board on, and is this its port?"), "{text}");
}

#[test]
fn bytes_that_are_no_frames_are_told() {
    let text = trouble(Play::Noise);
    assert!(text.contains("no frame among them: another baud rate than 57600 (--baud), or another device"), "{text}");
}

#[test]
fn another_version_of_the_format_is_told_with_the_side_to_update() {
    let text = trouble(Play::Version(2));
    assert!(text.contains("version 2 of the format and this program version 1: update this program"), "{text}");
    let text = trouble(Play::Version(0));
    assert!(text.contains("version 0 of the format and this program version 1: flash the board"), "{text}");
}

#[test]
fn the_other_board_is_told() {
    let text = trouble(Play::Drive);
    assert!(text.contains("this is the drive, and the timer is needed"), "{text}");
}

#[test]
fn board_that_does_not_hear_is_told() {
    let text = trouble(Play::Deaf);
    assert!(text.contains("the board sends frames but does not answer to hello"), "{text}");
}

#[test]
fn newer_and_older_firmware_are_noted() {
    let newer = greet(Play::Firmware([0, 2, 0]), Unit::Timer).unwrap().note().unwrap();
    assert!(newer.contains("firmware 0.2.0 is newer") && newer.contains("update this program"), "{newer}");
    let older = greet(Play::Firmware([0, 0, 9]), Unit::Timer).unwrap().note().unwrap();
    assert!(older.contains("firmware 0.0.9 is older") && older.contains("flash the board"), "{older}");
    assert_eq!(greet(Play::Firmware([0, 1, 7]), Unit::Timer).unwrap().note(), None);
}

#[test]
fn missing_port_is_told() {
    let text = Line::open("/dev/no-such-port", BAUD).unwrap_err().to_string();
    assert_eq!(
        text,
        "/dev/no-such-port: there is no such port: is the board plugged in? 'slider ports' lists the ports"
    );
}

#[test]
fn file_that_is_no_port_is_told() {
    let folder = rig::folder();
    let file = folder.join("file");
    std::fs::write(&file, "").unwrap();
    let text = Line::open(file.to_str().unwrap(), BAUD).unwrap_err().to_string();
    assert!(text.contains("cannot be opened as a serial port"), "{text}");
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn port_in_use_is_told() {
    let rig = Rig::new(Play::Timer { edges: 2 });
    let _first = Line::open(&rig.port(), BAUD).unwrap();
    let text = Line::open(&rig.port(), BAUD).unwrap_err().to_string();
    assert!(text.contains("another program uses this port: close it"), "{text}");
}

#[test]
fn refusal_is_told_with_its_reason() {
    let rig = Rig::new(Play::Drive);
    let mut line = Line::open(&rig.port(), BAUD).unwrap();
    line.greet(Some(Unit::Drive), SHORT).unwrap();
    let error = line.ask(Command::Go { index: 10 }).unwrap_err();
    assert!(matches!(error, Error::Refused { reason: Refusal::NoSuchPreset, .. }));
    assert!(error.to_string().contains("go was refused: there is no such preset"), "{error}");
    line.ask(Command::Go { index: 9 }).unwrap();
}

fn next(line: &mut SerialLine) -> Result<Event, Error> {
    loop {
        if let Some(event) = line.event()? {
            return Ok(event);
        }
    }
}

#[test]
fn answer_may_come_in_one_piece_with_the_acceptance() {
    let rig = Rig::new(Play::Timer { edges: 2 });
    let mut line = Line::open(&rig.port(), BAUD).unwrap();
    line.greet(None, SHORT).unwrap();
    for _ in 0..300 {
        let status = |report: &Report| matches!(report, Report::Status { .. }).then_some(());
        line.answer(Command::Status, Duration::from_secs(1), status).unwrap();
    }
}

#[test]
fn pulled_cable_leaves_what_was_received() {
    let mut rig = Rig::new(Play::Pulled { edges: 26, after: 16, run: 0 });
    let mut line = Line::open(&rig.port(), BAUD).unwrap();
    line.greet(Some(Unit::Timer), SHORT).unwrap();
    line.ask(Command::Arm(slider_proto::ArmSettings::default())).unwrap();
    let error = loop {
        if let Err(error) = next(&mut line) {
            break error;
        }
    };
    assert!(error.to_string().contains("the line went away"), "{error}");
    let ended = line.close(Missing::Line).unwrap();
    let sent = rig.passed.lock().unwrap()[0].clone();
    assert!(ended.run.edges.len() >= 16 && sent.starts_with(&ended.run.edges), "{ended:?}");
    rig.wait();
}

#[test]
fn reset_while_an_answer_is_awaited_is_told() {
    let rig = Rig::new(Play::Reset { edges: 26, after: 8 });
    let mut line = Line::open(&rig.port(), BAUD).unwrap();
    line.greet(Some(Unit::Timer), SHORT).unwrap();
    line.ask(Command::Arm(slider_proto::ArmSettings { run: 1, ..Default::default() })).unwrap();
    let never = |_: &Report| None::<()>;
    let error = line.answer(Command::Status, Duration::from_secs(5), never).unwrap_err();
    assert!(error.to_string().contains("the board was reset in between (by low voltage: check its supply)"), "{error}");
}

#[test]
fn ports_are_listed_without_failing() {
    // Which there are depends on the machine.
    for listed in list().unwrap() {
        assert!(!listed.port.is_empty());
    }
}
