//! No thread is left behind. Alone in its program, which has no other streams.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, reason = "a stream that cannot run fails the test")]

use std::time::{Duration, Instant};
use std::{fs, thread};

use blur_stream::{Limits, Stream};

/// Threads of this program that carry the worker's name.
fn workers() -> usize {
    let tasks = fs::read_dir("/proc/self/task").unwrap();
    let names = tasks.filter_map(|task| fs::read_to_string(task.unwrap().path().join("comm")).ok());
    names.filter(|name| name.trim() == "blur-stream").count()
}

/// Whether so many workers are left. A thread that has been joined stays in the table of the kernel for a moment.
fn comes_to(expected: usize) -> bool {
    let end = Instant::now() + Duration::from_secs(10);
    while workers() != expected && Instant::now() < end {
        thread::sleep(Duration::from_millis(1));
    }
    workers() == expected
}

fn started() -> Stream<u32> {
    let mut stream = Stream::start(Limits::default(), || 0, |_| ()).unwrap();
    assert!(stream.push(|frame| *frame = 1));
    stream
}

#[test]
fn every_end_of_a_stream_ends_its_thread() {
    assert!(comes_to(0));
    let streams = [started(), started(), started()];
    assert!(comes_to(3));
    let [finished, stopped, dropped] = streams;
    finished.finish().unwrap();
    assert!(comes_to(2));
    stopped.stop().unwrap();
    assert!(comes_to(1));
    drop(dropped);
    assert!(comes_to(0));
}
