//! A run is what was sent, as far as that is beyond doubt.
#![allow(clippy::unwrap_used, clippy::panic, missing_docs, unreachable_pub, reason = "tests")]

mod damage;

use damage::{Corpus, Random};
use slider_host::reader::{Event, Missing, Reader};
use slider_host::run::End;
use slider_proto::section::LevelRepeated;
use slider_proto::{Edge, EdgeBatch, EndReason, Level, MAX_FRAME, ProtoError, Report, Unit, encode};

const RUN: u16 = 7;

fn edge(index: u32) -> Edge {
    let level = if index.is_multiple_of(2) { Level::Low } else { Level::High };
    Edge { tick: 5000 + 1000 * index, level, late: false }
}

fn batch(run: u16, first: u16, edges: &[Edge]) -> Report {
    let mut batch = EdgeBatch::new(run, first);
    for &edge in edges {
        batch.push(edge).unwrap();
    }
    Report::Edges(batch)
}

fn begin() -> Report {
    Report::RunStart { run: RUN, tick: 5000 }
}

fn edges(range: std::ops::Range<u32>) -> Report {
    batch(RUN, range.start as u16, &range.map(edge).collect::<Vec<_>>())
}

fn end(edges: u16) -> Report {
    Report::RunEnd { run: RUN, edges, late: 0, lost: 0, reason: EndReason::Limit }
}

fn hello() -> Report {
    Report::Hello { unit: Unit::Timer, firmware: [0, 1, 0], tick_hz: 1_000_000, reset_cause: 4 }
}

fn events(frames: &[(u8, Report)]) -> Vec<Event> {
    let mut events = Vec::new();
    let mut reader = Reader::default();
    for (sequence, report) in frames {
        reader.push(encode(report, *sequence, &mut [0; MAX_FRAME]), |event| events.push(event));
    }
    events.extend(reader.close(Missing::Line).map(Event::Ended));
    events
}

/// Why the run is incomplete that these frames, numbered one after the other, make, and how many edges it keeps.
fn missing(reports: &[Report]) -> (Missing, usize) {
    let frames: Vec<_> = (100..).zip(reports.iter().copied()).collect();
    first_missing(&events(&frames))
}

fn first_missing(events: &[Event]) -> (Missing, usize) {
    let ended = events.iter().find_map(|event| if let Event::Ended(ended) = event { Some(ended) } else { None });
    let ended = ended.unwrap();
    assert_eq!(ended.run.end, End::Missing);
    assert!(!ended.run.is_complete());
    let sent: Vec<Edge> = (0..).map(edge).take(ended.run.edges.len()).collect();
    assert_eq!(ended.run.edges, sent);
    (ended.missing.unwrap(), ended.run.edges.len())
}

#[test]
fn whole_run_is_complete_with_every_edge() {
    let events = events(&[(0, hello()), (1, begin()), (2, edges(0..8)), (3, edges(8..10)), (4, end(10))]);
    let [Event::Reset(4), Event::Message(_), Event::Began { run: RUN, tick: 5000, tick_hz: 1_000_000 }, rest @ ..] =
        events.as_slice()
    else {
        panic!("{events:?}")
    };
    let [Event::Edges(_), Event::Edges(_), Event::Ended(ended)] = rest else { panic!("{rest:?}") };
    assert!(ended.run.is_complete() && ended.missing.is_none());
    assert_eq!(ended.run.edges, (0..10).map(edge).collect::<Vec<_>>());
    assert_eq!(ended.run.tick_hz, 1_000_000);
}

#[test]
fn ticks_go_on_across_the_wrap_of_the_counter() {
    let ticks = [u32::MAX - 10, 5];
    let levels = [Level::Low, Level::High];
    let pair: Vec<Edge> = ticks.iter().zip(levels).map(|(&tick, level)| Edge { tick, level, late: true }).collect();
    let end = Report::RunEnd { run: RUN, edges: 2, late: 2, lost: 0, reason: EndReason::Quiet };
    let events = events(&[(9, Report::RunStart { run: RUN, tick: ticks[0] }), (10, batch(RUN, 0, &pair)), (11, end)]);
    assert!(matches!(events.last(), Some(Event::Ended(ended)) if ended.run.is_complete()), "{events:?}");
}

#[test]
fn overrun_is_an_end_that_is_told_but_not_complete() {
    let end = Report::RunEnd { run: RUN, edges: 8, late: 0, lost: 3, reason: EndReason::Overrun };
    let events = events(&[(1, begin()), (2, edges(0..8)), (3, end)]);
    let Some(Event::Ended(ended)) = events.last() else { panic!("{events:?}") };
    assert_eq!(ended.run.end, End::Told { reason: EndReason::Overrun, edges: 8, lost: 3 });
    assert!(ended.missing.is_none() && !ended.run.is_complete());
}

#[test]
fn each_flaw_ends_the_run_with_its_reason_and_keeps_what_came_before() {
    let first = edges(0..8);
    assert_eq!(missing(&[begin(), first]), (Missing::Line, 8));
    assert_eq!(missing(&[begin(), first, edges(16..18), end(18)]), (Missing::Index { expected: 8, found: 16 }, 8));
    assert_eq!(missing(&[begin(), first, first, end(8)]), (Missing::Index { expected: 8, found: 0 }, 8));
    assert_eq!(missing(&[begin(), first, end(9)]), (Missing::Count { told: 9, received: 8 }, 8));
    let late = Report::RunEnd { run: RUN, edges: 8, late: 2, lost: 0, reason: EndReason::Limit };
    assert_eq!(missing(&[begin(), first, late]), (Missing::Late { told: 2, received: 0 }, 8));
    assert_eq!(missing(&[begin(), first, batch(8, 8, &[edge(8)])]), (Missing::OtherRun(8), 8));
    assert_eq!(missing(&[begin(), first, Report::RunStart { run: 9, tick: 1 }]), (Missing::OtherRun(9), 8));
    let other = Report::RunEnd { run: 6, edges: 8, late: 0, lost: 0, reason: EndReason::Limit };
    assert_eq!(missing(&[begin(), first, other]), (Missing::OtherRun(6), 8));
    let start = Report::RunStart { run: RUN, tick: 4999 };
    assert_eq!(missing(&[start, first]), (Missing::Start { told: 4999, found: 5000 }, 0));
    let slit = batch(RUN, 0, &[Edge { level: Level::High, ..edge(0) }]);
    assert_eq!(missing(&[begin(), slit]), (Missing::SlitFirst, 0));
    let again = batch(RUN, 0, &[edge(0), edge(1), edge(3)]);
    assert_eq!(missing(&[begin(), again]), (LevelRepeated { tick: 8000, level: Level::High }.into(), 2));
    for tick in [6000, 5999, 6000 + (1 << 31)] {
        let back = batch(RUN, 0, &[edge(0), edge(1), Edge { tick, ..edge(2) }]);
        assert_eq!(missing(&[begin(), back]), (Missing::Order { index: 2, tick, before: 6000 }, 2));
    }
}

#[test]
fn lost_frame_ends_the_run_even_if_its_edges_seem_to_follow() {
    let events = events(&[(1, begin()), (2, edges(0..8)), (4, edges(8..10)), (5, end(10))]);
    assert!(events.contains(&Event::Lost(1)));
    assert!(events.contains(&Event::Stray(edges(8..10))) && events.contains(&Event::Stray(end(10))));
    assert_eq!(first_missing(&events), (Missing::Frames(1), 8));
}

#[test]
fn reset_ends_the_run_whatever_its_number() {
    for before in [20, 255] {
        let frames = [(before - 1, begin()), (before, edges(0..8)), (0, hello()), (1, end(8))];
        let events = events(&frames);
        assert_eq!(first_missing(&events), (Missing::Reset(4), 8));
        assert!(events.contains(&Event::Reset(4)));
    }
}

#[test]
fn answer_to_a_question_is_no_reset() {
    let events = events(&[(255, Report::Ack { sequence: 1 }), (0, hello())]);
    assert!(!events.contains(&Event::Reset(4)), "{events:?}");
}

#[test]
fn frame_that_cannot_be_read_ends_the_run() {
    // Kind 130 without a payload, the checksum right: a decoder of `Command` would not know the kind either.
    let mut body = vec![1, 3, 130];
    let crc = crc32(&body);
    body.extend(crc.to_le_bytes());
    let mut frame = cobs(&body);
    frame.push(0);
    let mut reader = Reader::default();
    let mut events = Vec::new();
    for (sequence, report) in [(1, begin()), (2, edges(0..8))] {
        reader.push(encode(&report, sequence, &mut [0; MAX_FRAME]), |event| events.push(event));
    }
    reader.push(&frame, |event| events.push(event));
    assert!(events.contains(&Event::Damaged(ProtoError::Payload)), "{events:?}");
    assert_eq!(first_missing(&events), (Missing::Unreadable(ProtoError::Payload), 8));
}

/// CRC-32 of ISO-HDLC, bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes
        .iter()
        .fold(!0, |crc: u32, &byte| (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 * (crc & 1))))
}

/// COBS of fewer than 254 bytes.
fn cobs(bytes: &[u8]) -> Vec<u8> {
    bytes.split(|&byte| byte == 0).flat_map(|group| [&[group.len() as u8 + 1], group].concat()).collect()
}

#[test]
fn undamaged_streams_are_received_whole() {
    let mut random = Random(1);
    let corpus = Corpus::new(&mut random);
    let tally = corpus.damage(2000, 0, &mut random);
    assert_eq!((tally.runs_complete, tally.runs_incomplete), (tally.runs_sent, 0), "{tally:?}");
}

/// Ten million streams are read by the long test of the same name in `tests`.
#[test]
fn no_damage_makes_an_edge_that_was_not_sent() {
    let mut random = Random(2);
    let corpus = Corpus::new(&mut random);
    let tally = corpus.damage(100_000, 4, &mut random);
    // Most of the runs are not hit: a reader that refuses everything would be of no use.
    assert!(tally.runs_complete * 4 > tally.runs_sent && tally.runs_incomplete > 0, "{tally:?}");
}
