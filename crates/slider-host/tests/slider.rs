//! The program, on real terminals with a board at their other end.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::panic, missing_docs, unreachable_pub, dead_code, reason = "tests")]

mod rig;

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::Duration;

use rig::{Play, Rig};
use serde_json::Value;
use slider_host::log::{Logged, read};
use slider_host::run::End;
use slider_proto::Command as Ask;

/// Far longer than anything takes here.
const LONG: Duration = Duration::from_secs(60);

struct Program {
    child: Child,
    out: Receiver<String>,
    err: Receiver<String>,
}

struct Result {
    status: i32,
    out: Vec<String>,
    err: String,
}

fn lines(from: impl Read + Send + 'static) -> Receiver<String> {
    let (sender, receiver) = channel();
    thread::spawn(move || BufReader::new(from).lines().map_while(std::io::Result::ok).try_for_each(|l| sender.send(l)));
    receiver
}

impl Program {
    fn start(args: &[&str]) -> Self {
        let mut command = Command::new(env!("CARGO_BIN_EXE_slider"));
        command.args(args).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = spawn(&mut command);
        let (out, err) = (lines(child.stdout.take().unwrap()), lines(child.stderr.take().unwrap()));
        Self { child, out, err }
    }

    /// Waits for a message.
    fn told(&self, what: &str) {
        let mut seen = Vec::new();
        loop {
            let line = self.err.recv_timeout(LONG).unwrap_or_else(|_| panic!("no '{what}' in {seen:#?}"));
            if line.contains(what) {
                return;
            }
            seen.push(line);
        }
    }

    /// Waits for a result.
    fn json(&self) -> Value {
        serde_json::from_str(&self.out.recv_timeout(LONG).unwrap()).unwrap()
    }

    fn interrupt(&self) {
        let id = self.child.id().to_string();
        assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    }

    fn end(mut self) -> Result {
        let out = self.out.iter().collect();
        let err: Vec<String> = self.err.iter().collect();
        Result { status: self.child.wait().unwrap().code().unwrap(), out, err: err.join("\n") }
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.child.kill();
    }
}

fn slider(args: &[&str]) -> Result {
    let mut command = Command::new(env!("CARGO_BIN_EXE_slider"));
    command.args(args).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let output = spawn(&mut command).wait_with_output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let out = text(output.stdout).lines().map(str::to_owned).collect();
    Result { status: output.status.code().unwrap(), out, err: text(output.stderr) }
}

fn spawn(command: &mut Command) -> Child {
    let _held = rig::INHERITED.lock();
    command.spawn().unwrap()
}

/// What the files of a folder hold, in the order of their names.
fn saved(folder: &Path) -> Vec<Logged> {
    let mut files: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files.iter().flat_map(|file| read(file).unwrap()).collect()
}

/// A rig, its port and a folder for runs.
fn rig(play: Play) -> (Rig, String, String) {
    let rig = Rig::new(play);
    let (port, runs) = (rig.port(), rig.folder().join("runs"));
    (rig, port, runs.to_str().unwrap().to_owned())
}

#[test]
fn run_is_armed_received_saved_and_told() {
    let (rig, port, runs) = rig(Play::Timer { edges: 26 });
    let sheet = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/encoder5.toml");
    let args = ["listen", "--port", &port, "--save", &runs, "--once", "--json", "--quiet-ms", "150", "--sheet", sheet];
    let result = slider(&[&args[..], &["--trigger-ms", "30"]].concat());
    assert_eq!(result.status, 0, "{}", result.err);
    let [line] = result.out.as_slice() else { panic!("{:?}", result.out) };
    let json: Value = serde_json::from_str(line).unwrap();
    assert_eq!((&json["complete"], &json["edges"], &json["end"]), (&true.into(), &26.into(), &"quiet".into()));
    assert_eq!(json["interval_ticks"], serde_json::json!(vec![4000; 25]), "{json}");
    let logged = saved(Path::new(&runs));
    assert_eq!(logged[0].run.edges, rig.passed.lock().unwrap()[0]);
    assert!(logged.len() == 1 && logged[0].run.is_complete());
    assert_eq!(logged[0].header.sheet.as_deref(), Some("encoder 5, first five teeth"));
    assert_eq!((logged[0].header.firmware.as_str(), logged[0].header.port.as_str()), ("0.1.0", port.as_str()));
    let arms: Vec<_> = rig.heard.lock().unwrap().iter().copied().filter_map(arm).collect();
    assert_eq!(arms, [(1, 30, 150)]);
}

fn arm(command: Ask) -> Option<(u16, u16, u16)> {
    if let Ask::Arm(settings) = command { Some((settings.run, settings.trigger_ms, settings.quiet_ms)) } else { None }
}

#[test]
fn run_follows_run_and_ctrl_c_disarms_the_timer() {
    let (rig, port, _) = rig(Play::Timer { edges: 26 });
    let program = Program::start(&["listen", "--port", &port, "--json", "--quiet-ms", "100"]);
    for number in 1..=3 {
        let json = program.json();
        assert_eq!((&json["run"], &json["complete"]), (&number.into(), &true.into()));
    }
    program.told("armed for run 4");
    program.interrupt();
    let result = program.end();
    assert_eq!(result.status, 0, "{}", result.err);
    rig.hears_at_last(Ask::Stop);
}

#[test]
fn text_is_for_people() {
    let (_rig, port, _) = rig(Play::Timer { edges: 4 });
    let result = slider(&["listen", "--port", &port, "--once", "--quiet-ms", "100"]);
    let text = result.out.join("\n");
    assert_eq!(result.status, 0, "{}", result.err);
    // Teeth of 3.1 mm and slits of 4.9 mm in 2 ms each: no motion of the nominal sheet, but four points are few.
    assert!(text.starts_with("run 1: 4 edges, 0 late, complete (quiet)\n"), "{text}");
    assert!(text.contains("\n  speed  ") && text.contains(" m/s   U = "), "{text}");
    assert!(text.contains("the run is incomplete: it ends with edge 4 of 26"), "{text}");
}

#[test]
fn pulled_cable_leaves_every_received_edge_on_the_disk() {
    let (rig, port, runs) = rig(Play::Pulled { edges: 200, after: 32, run: 1 });
    let result = slider(&["listen", "--port", &port, "--save", &runs, "--once", "--json"]);
    assert_eq!(result.status, 1, "{}", result.err);
    assert!(
        result.err.contains("the line went away") && result.err.contains("is the cable plugged in"),
        "{}",
        result.err
    );
    let logged = saved(Path::new(&runs));
    assert_eq!(logged[0].incomplete.as_deref(), Some("the line went away"));
    assert_eq!((logged[0].run.edges.len(), logged[0].run.end), (32, End::Missing));
    assert!(rig.passed.lock().unwrap()[0].starts_with(&logged[0].run.edges));
    let json: Value = serde_json::from_str(&result.out[0]).unwrap();
    assert_eq!((&json["complete"], &json["edges"]), (&false.into(), &32.into()));
}

#[test]
fn port_that_comes_back_is_served_again() {
    let (mut rig, port, runs) = rig(Play::Pulled { edges: 26, after: 16, run: 2 });
    let args = ["listen", "--port", &port, "--save", &runs, "--json", "--quiet-ms", "100"];
    let program = Program::start(&args);
    assert_eq!(program.json()["complete"], true);
    assert_eq!(program.json()["complete"], false);
    program.told("waiting for it to come back");
    rig.wait();
    rig.plug(Play::Timer { edges: 26 });
    let json = program.json();
    assert_eq!((&json["complete"], &json["run"], &json["edges"]), (&true.into(), &3.into(), &26.into()));
    program.interrupt();
    assert_eq!(program.end().status, 0);
    let logged = saved(Path::new(&runs));
    let complete: Vec<_> = logged.iter().take(3).map(|logged| logged.run.is_complete()).collect();
    assert_eq!(complete, [true, false, true]);
}

#[test]
fn ctrl_c_in_a_run_closes_its_file() {
    let (rig, port, runs) = rig(Play::Timer { edges: 10_000 });
    let program = Program::start(&["listen", "--port", &port, "--save", &runs, "--json"]);
    program.told("run 1 begins");
    thread::sleep(Duration::from_millis(300));
    program.interrupt();
    let json = program.json();
    assert_eq!(json["incomplete"], "the program was stopped");
    assert_eq!(program.end().status, 0);
    let logged = saved(Path::new(&runs));
    assert_eq!(logged[0].incomplete.as_deref(), Some("the program was stopped"));
    assert!(!logged[0].run.edges.is_empty());
    assert!(rig.passed.lock().unwrap()[0].starts_with(&logged[0].run.edges));
    rig.hears_at_last(Ask::Stop);
}

#[test]
fn reset_ends_the_run_and_the_timer_is_armed_again() {
    let (rig, port, runs) = rig(Play::Reset { edges: 26, after: 8 });
    let program = Program::start(&["listen", "--port", &port, "--save", &runs, "--json", "--quiet-ms", "100"]);
    let json = program.json();
    assert_eq!(json["incomplete"], "the device was reset (by low voltage: check its supply)");
    program.told("the board was reset (by low voltage: check its supply)");
    let json = program.json();
    assert_eq!((&json["run"], &json["complete"]), (&2.into(), &true.into()));
    program.interrupt();
    assert_eq!(program.end().status, 0);
    assert!(rig.passed.lock().unwrap()[0].starts_with(&saved(Path::new(&runs))[0].run.edges));
}

#[test]
fn timer_that_somebody_else_arms_is_left_alone() {
    let (rig, port, _) = rig(Play::Timer { edges: 26 });
    let program = Program::start(&["listen", "--port", &port, "--no-arm"]);
    program.told("timer, firmware 0.1.0");
    thread::sleep(Duration::from_millis(300));
    program.interrupt();
    assert_eq!(program.end().status, 0);
    assert!(rig.heard.lock().unwrap().iter().all(|command| *command == Ask::Hello));
}

#[test]
fn status_stop_and_selftest_talk_to_the_timer() {
    let (rig, port, _) = rig(Play::Timer { edges: 2 });
    let result = slider(&["status", "--port", &port, "--json"]);
    let json: Value = serde_json::from_str(&result.out[0]).unwrap();
    assert_eq!((result.status, &json["unit"], &json["state"]), (0, &"timer".into(), &"idle".into()));
    assert_eq!(slider(&["stop", "--port", &port]).status, 0);
    rig.hears_at_last(Ask::Stop);
    let result = slider(&["selftest", "--port", &port]);
    assert_eq!(
        (result.status, result.out.as_slice()),
        (0, &["26 of 26 edges, worst error 0 ticks: good".to_owned()][..])
    );
}

#[test]
fn presets_are_set_and_moved_at() {
    let (rig, port, _) = rig(Play::Drive);
    assert_eq!(slider(&["preset", "set", "4", "--duty", "99", "--port", &port]).status, 0);
    let result = slider(&["preset", "go", "3", "--duty", "77", "--direction", "reverse", "--port", &port]);
    assert_eq!(result.status, 0, "{}", result.err);
    let heard = format!("{:?}", rig.heard.lock().unwrap());
    assert!(heard.contains("SetPreset { index: 4, preset: Preset { duty: 99, direction: Forward } }"), "{heard}");
    assert!(
        heard.contains("SetPreset { index: 3, preset: Preset { duty: 77, direction: Reverse } }, Go { index: 3 }"),
        "{heard}"
    );
    let result = slider(&["status", "--port", &port, "--json"]);
    let json: Value = serde_json::from_str(&result.out[0]).unwrap();
    assert_eq!((&json["unit"], &json["preset"], &json["duty"]), (&"drive".into(), &3.into(), &77.into()));
    assert_eq!(json["direction"], "reverse");
}

#[test]
fn failures_are_one_line_on_standard_error_and_status_1() {
    let (_rig, port, _) = rig(Play::Drive);
    let run = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/slider/run_v1.jsonl");
    for (args, what) in [
        (&["listen", "--port", "/dev/no-such-port"][..], "there is no such port"),
        (&["listen", "--port", &port, "--json"], "this is the drive, and the timer is needed"),
        (&["selftest", "--port", &port], "this is the drive, and the timer is needed"),
        (&["listen", "--port", &port, "--sheet", run], "sheet: "),
        (&["fit", "/no/such/run.jsonl"], "/no/such/run.jsonl: "),
        (&["fit", concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml")], "Cargo.toml, line 1: no JSON"),
    ] {
        let result = slider(args);
        assert_eq!((result.status, result.out.len()), (1, 0), "{args:?}");
        assert!(result.err.starts_with("slider: ") && result.err.contains(what), "{}", result.err);
    }
}

#[test]
fn saved_runs_are_told_again() {
    let run = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/slider/run_v1.jsonl");
    let result = slider(&["fit", run, "--degree", "1", "--json"]);
    assert_eq!((result.status, result.out.len()), (0, 2), "{}", result.err);
    let json: Value = serde_json::from_str(&result.out[1]).unwrap();
    assert_eq!((&json["run"], &json["incomplete"]), (&4.into(), &"the line went away".into()));
}

#[test]
fn usage_is_status_2_and_help_is_status_0() {
    for args in [
        &[][..],
        &["listen"],
        &["walk"],
        &["listen", "--port", "p", "--degree", "3"],
        &["listen", "--port", "p", "--quiet-ms", "0"],
        &["preset", "go", "10", "--port", "p"],
        &["preset", "set", "1", "--port", "p"],
        &["preset", "go", "1", "--direction", "reverse", "--port", "p"],
    ] {
        let result = slider(args);
        assert_eq!((result.status, result.out.len()), (2, 0), "{args:?}: {}", result.err);
    }
    assert_eq!(slider(&["--help"]).status, 0);
    assert_eq!(slider(&["ports"]).status, 0);
    assert!(slider(&["ports", "--json"]).out.iter().all(|line| serde_json::from_str::<Value>(line).is_ok()));
}
