//! Streams under load, with deadlines, and at their end.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a stream that cannot run fails the test")]

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, mpsc};
use std::thread;
use std::time::Duration;

use blur_stream::{Error, Limits, Stream};

/// A worker that waits for leave before each frame, so that a test and not the clock decides how slow it is.
fn gated(limits: Limits) -> (Stream<u32>, mpsc::Sender<()>, mpsc::Receiver<u32>, mpsc::Receiver<u32>) {
    let (leave, gate) = mpsc::channel();
    let (began, begun) = mpsc::channel();
    let (sender, results) = mpsc::channel();
    let work = move |frame: &mut u32| {
        began.send(*frame).unwrap();
        let _ = gate.recv();
        sender.send(*frame).unwrap();
    };
    (Stream::start(limits, || 0, work).unwrap(), leave, begun, results)
}

fn push(stream: &mut Stream<u32>, number: u32) {
    assert!(stream.push(|frame| *frame = number));
}

#[test]
fn a_worker_that_keeps_up_loses_nothing() {
    let (mut stream, leave, _begun, results) = gated(Limits { capacity: 1, deadline: None });
    for number in 0..100 {
        push(&mut stream, number);
        leave.send(()).unwrap();
        assert_eq!(results.recv().unwrap(), number);
    }
    let report = stream.finish().unwrap();
    assert_eq!((report.received, report.done, report.dropped, report.late), (100, 100, 0, 0));
    assert!(report.p50 <= report.p99 && report.p99 <= report.longest);
}

#[test]
fn a_worker_that_is_too_slow_gets_the_newest_frames() {
    let (mut stream, leave, begun, results) = gated(Limits { capacity: 3, deadline: None });
    push(&mut stream, 0);
    assert_eq!(begun.recv().unwrap(), 0);
    for number in 1..=10 {
        push(&mut stream, number);
    }
    drop(leave);
    let report = stream.finish().unwrap();
    assert_eq!(results.iter().collect::<Vec<_>>(), [0, 8, 9, 10]);
    assert_eq!((report.received, report.done, report.dropped), (11, 4, 7));
}

#[test]
fn a_frame_beyond_its_deadline_is_not_begun() {
    let (mut stream, leave, begun, results) = gated(Limits { capacity: 4, deadline: Some(Duration::from_millis(20)) });
    push(&mut stream, 0);
    assert_eq!(begun.recv().unwrap(), 0);
    push(&mut stream, 1);
    push(&mut stream, 2);
    thread::sleep(Duration::from_millis(40));
    drop(leave);
    let report = stream.finish().unwrap();
    assert_eq!(results.iter().collect::<Vec<_>>(), [0]);
    assert_eq!((report.received, report.done, report.late), (3, 1, 2));
}

/// A buffer that tells when it is dropped.
struct Slot {
    number: u32,
    gone: mpsc::Sender<()>,
}

impl Drop for Slot {
    fn drop(&mut self) {
        let _ = self.gone.send(());
    }
}

#[test]
fn a_stream_that_stops_drops_what_waits() {
    let (gone, gate) = mpsc::channel();
    let (sender, events) = mpsc::channel();
    let make = move || Slot { number: 0, gone: gone.clone() };
    // The worker is at its first frame until the queue has dropped one.
    let work = move |slot: &mut Slot| {
        sender.send(slot.number).unwrap();
        gate.recv().unwrap();
    };
    let mut stream = Stream::start(Limits::default(), make, work).unwrap();
    for number in 0..4 {
        assert!(stream.push(|slot| slot.number = number));
        if number == 0 {
            assert_eq!(events.recv().unwrap(), 0);
        }
    }
    let report = stream.stop().unwrap();
    assert_eq!(events.iter().count(), 0);
    assert_eq!((report.received, report.done, report.dropped), (4, 1, 3));
}

#[test]
fn no_buffer_is_made_after_the_start() {
    let made = Arc::new(AtomicU32::new(0));
    let count = Arc::clone(&made);
    let make = move || {
        count.fetch_add(1, Ordering::Relaxed);
        vec![0_u8; 1000]
    };
    let mut stream = Stream::start(Limits { capacity: 2, deadline: None }, make, |frame| frame[0] = 1).unwrap();
    let pushed = allocation_counter::measure(|| {
        for _ in 0..1000 {
            assert!(stream.push(|frame| frame[1] = 2));
        }
    });
    assert_eq!(pushed.count_total, 0);
    assert_eq!(made.load(Ordering::Relaxed), 4);
    let report = stream.finish().unwrap();
    assert_eq!(report.done + report.dropped, 1000);
}

#[test]
fn the_panic_of_a_worker_is_an_error() {
    let mut stream =
        Stream::start(Limits::default(), || 0, |frame: &mut u32| assert!(*frame < 1, "frame {frame}")).unwrap();
    push(&mut stream, 0);
    while stream.report().done < 1 {
        thread::yield_now();
    }
    push(&mut stream, 1);
    while stream.push(|frame| *frame = 1) {
        thread::yield_now();
    }
    match stream.finish() {
        Err(Error::Worker { done: 1, message }) => assert_eq!(message, "frame 1"),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_queue_without_room_is_refused() {
    let limits = Limits { capacity: 0, deadline: None };
    let error = Stream::start(limits, || 0, |_: &mut u32| ()).unwrap_err();
    assert!(error.to_string().contains("at least one"), "{error}");
}
