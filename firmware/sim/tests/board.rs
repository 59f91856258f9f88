//! The `board` program is a board to its host.

// The helpers of a test may fail like the test itself.
#![allow(clippy::expect_used)]

mod common;

use std::{
    fs::File,
    io::{BufRead, BufReader, Read, Write},
    process::{Child, Command, Stdio},
    time::{Duration, Instant},
};

/// A running board, ended with the test.
struct Board(Child);

impl Drop for Board {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn board(arguments: &[&str]) -> (Board, String) {
    let elf = common::build("uart", &[]);
    let child = Command::new(env!("CARGO_BIN_EXE_board"))
        .arg(&elf)
        .args(arguments)
        .stdout(Stdio::piped())
        .spawn()
        .expect("the program was just built");
    let mut board = Board(child);
    let mut line = String::new();
    BufReader::new(board.0.stdout.take().expect("piped")).read_line(&mut line).expect("a first line");
    std::fs::remove_file(elf).expect("the file just made");
    let path = line.trim_end().strip_prefix("pty ").expect("pty PATH").to_owned();
    (board, path)
}

#[test]
fn a_host_talks_to_the_firmware_and_may_come_back() {
    for mode in ["--real-time", "--fast"] {
        let (_board, path) = board(&[mode]);
        for attempt in 0..2 {
            let mut host = File::options().read(true).write(true).open(&path).expect("the line");
            if attempt == 0 {
                let mut greeting = [0; 3];
                host.read_exact(&mut greeting).expect("a greeting");
                assert_eq!(&greeting, b"ok\n");
            }
            let text: Vec<u8> = (0..=255).collect();
            host.write_all(&text).expect("the line takes it");
            let mut back = vec![0; text.len()];
            host.read_exact(&mut back).expect("an echo");
            assert_eq!(back, text, "{mode}");
        }
    }
}

#[test]
fn real_time_is_kept() {
    let begun = Instant::now();
    let (mut board, _) = board(&["--for", "500ms"]);
    let status = board.0.wait().expect("it ends");
    assert!(status.success());
    let took = begun.elapsed();
    assert!(took >= Duration::from_millis(450) && took < Duration::from_secs(3), "{took:?}");
}

#[test]
fn endings_are_told_by_the_exit_status() {
    let status = |arguments: &[&str]| {
        let done = Command::new(env!("CARGO_BIN_EXE_board")).args(arguments).output().expect("it runs");
        (done.status.code(), String::from_utf8_lossy(&done.stderr).into_owned())
    };
    let (code, message) = status(&["/no/such.elf"]);
    assert_eq!(code, Some(1));
    assert!(message.contains("/no/such.elf"), "{message}");
    assert_eq!(status(&["x.elf", "--pin", "D99"]).0, Some(2));
    assert_eq!(status(&["x.elf", "--every", "soon"]).0, Some(2));
    assert_eq!(status(&["x.elf", "--speed", "0"]).0, Some(2));
    assert_eq!(status(&["x.elf", "--fast", "--real-time"]).0, Some(2));
}
