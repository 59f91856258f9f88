//! `check_board.py` of the README, on the real firmware behind a pseudo-terminal.

#![allow(clippy::expect_used)]

mod rig;

use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, Output, Stdio};

/// A running board, ended with the test.
struct Board(Child);

impl Drop for Board {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Starts a board in real time and checks it with further arguments.
fn check(program: &str, board: &[&str], check: &[&str]) -> Output {
    let child = Command::new(env!("CARGO_BIN_EXE_board"))
        .arg(rig::elf(program))
        .args(board)
        .stdout(Stdio::piped())
        .spawn()
        .expect("the program was just built");
    let mut board = Board(child);
    let mut line = String::new();
    BufReader::new(board.0.stdout.take().expect("piped")).read_line(&mut line).expect("a first line");
    let port = line.trim_end().strip_prefix("pty ").expect("pty PATH");
    let script = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../check_board.py");
    Command::new("python3").arg(script).arg(port).args(check).output().expect("python3")
}

fn assert_passed(output: &Output, says: &str) {
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
    assert!(text.contains(says) && text.trim_end().ends_with("ok"), "{text}");
}

#[test]
fn a_timer_with_its_loop_back_passes() {
    let output = check("timer", &["--level", "D2=1", "--wire", "D5:D8"], &[]);
    assert_passed(&output, "26 edges, worst error 0 ticks");
}

#[test]
fn a_timer_without_its_loop_back_fails() {
    let output = check("timer", &["--level", "D2=1"], &[]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(String::from_utf8_lossy(&output.stdout).contains("0 edges"), "{output:?}");
}

#[test]
fn a_timer_with_a_rail_takes_a_run() {
    let output = check("timer", &["--level", "D2=1", "--speed", "0.5", "--every", "3s"], &["--arm"]);
    assert_passed(&output, "26 edges");
}

#[test]
fn a_drive_with_its_limit_switch_closed_passes() {
    let output = check("drive", &["--level", "D2=0", "--level", "D3=1"], &[]);
    assert_passed(&output, "stopped");
}
