//! Streams of bytes as a timer sends them, damaged in every way that comes to mind, and what a reader may make of them.

use std::collections::HashMap;

use slider_host::reader::{Event, Missing, Reader};
use slider_host::run::{End, Run};
use slider_proto::{Edge, EdgeBatch, EndReason, Level, MAX_FRAME, Report, Unit, encode};

/// What became of the streams.
#[derive(Debug, Default)]
pub struct Tally {
    pub runs_sent: u64,
    pub runs_complete: u64,
    pub runs_incomplete: u64,
    pub edges_accepted: u64,
}

/// `SplitMix64`: G. Steele, D. Lea, C. Flood, *Fast Splittable Pseudorandom Number Generators*, OOPSLA 2014.
pub struct Random(pub u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number below `bound`, which is above 0.
    pub fn below(&mut self, bound: usize) -> usize {
        (self.next() % bound as u64) as usize
    }
}

/// Frames of a timer from its reset on, with runs of which it sent nothing else.
struct Session {
    frames: Vec<Vec<u8>>,
    runs: u64,
}

/// Sessions, and by number the edges of all their runs.
pub struct Corpus {
    sessions: Vec<Session>,
    sent: HashMap<u16, Vec<Edge>>,
}

fn edges(random: &mut Random) -> Vec<Edge> {
    let count = 2 + random.below(25);
    // Some runs cross the wrap of the counter.
    let mut tick = if random.below(4) == 0 { u32::MAX - 20_000 } else { random.next() as u32 };
    let mut level = Level::High;
    let mut edges = Vec::new();
    for _ in 0..count {
        level = level.inverse();
        edges.push(Edge { tick, level, late: random.below(30) == 0 });
        tick = tick.wrapping_add(1 + random.below(20_000) as u32);
    }
    edges
}

impl Corpus {
    /// All runs have numbers of their own, as a host gives them.
    pub fn new(random: &mut Random) -> Self {
        let (mut sent, mut number) = (HashMap::new(), 0);
        let sessions = (0..64).map(|_| {
            let mut reports =
                vec![Report::Hello { unit: Unit::Timer, firmware: [0, 1, 0], tick_hz: 2_000_000, reset_cause: 2 }];
            // Some sessions wrap the sequence numbers.
            for _ in 0..[1, 1, 1, 245][random.below(4)] {
                reports.push(Report::Ack { sequence: random.next() as u8 });
            }
            let runs = 1 + random.below(4) as u64;
            for _ in 0..runs {
                number += 1;
                let edges = edges(random);
                reports.push(Report::Ack { sequence: number as u8 });
                reports.push(Report::RunStart { run: number, tick: edges[0].tick });
                let mut at = 0;
                while at < edges.len() {
                    let mut batch = EdgeBatch::new(number, at as u16);
                    for &edge in edges.iter().skip(at).take(1 + random.below(8)) {
                        batch.push(edge).unwrap();
                    }
                    at += batch.edges().len();
                    reports.push(Report::Edges(batch));
                }
                let late = edges.iter().filter(|edge| edge.late).count() as u16;
                let (run, edges_sent) = (number, edges.len() as u16);
                reports.push(Report::RunEnd { run, edges: edges_sent, late, lost: 0, reason: EndReason::Quiet });
                sent.insert(number, edges);
            }
            let frames = (0..=255).cycle().zip(&reports);
            let mut frames: Vec<Vec<u8>> =
                frames.map(|(sequence, report)| encode(report, sequence, &mut [0; MAX_FRAME]).to_vec()).collect();
            frames[0].insert(0, 0);
            // The acks that only moved the numbers on are not needed.
            let idle = frames.len().saturating_sub(40).min(245);
            frames.drain(1..=idle.max(1));
            Session { frames, runs }
        });
        let sessions = sessions.collect();
        Self { sessions, sent }
    }

    /// A session as sent, frame by frame, and how many runs it has.
    fn session(&self, random: &mut Random) -> (&[Vec<u8>], u64) {
        let session = &self.sessions[random.below(self.sessions.len())];
        (&session.frames, session.runs)
    }

    /// Feeds `streams` streams, each with up to `most` damages, and checks every event.
    ///
    /// # Panics
    ///
    /// If an edge is accepted that was not sent at its place, or a run is called complete that is not.
    pub fn damage(&self, streams: u64, most: usize, random: &mut Random) -> Tally {
        let mut tally = Tally::default();
        let (mut bytes, mut frames) = (Vec::new(), Vec::new());
        for stream in 0..streams {
            let (session, runs) = self.session(random);
            tally.runs_sent += runs;
            frames.clear();
            frames.extend(session.iter().map(Vec::as_slice));
            let damages = if most == 0 { 0 } else { 1 + random.below(most) };
            let of_frames = if damages == 0 { 0 } else { random.below(damages + 1) };
            for _ in 0..of_frames {
                self.move_frames(&mut frames, random);
            }
            bytes.clear();
            for frame in &frames {
                bytes.extend_from_slice(frame);
            }
            for _ in of_frames..damages {
                hurt_bytes(&mut bytes, random);
            }
            self.read(&bytes, random, &mut tally, stream);
        }
        tally
    }

    /// Loses, doubles, swaps, moves or splices frames.
    fn move_frames<'a>(&'a self, frames: &mut Vec<&'a [u8]>, random: &mut Random) {
        if frames.is_empty() {
            return;
        }
        let (one, two) = (random.below(frames.len()), random.below(frames.len()));
        let (from, to) = (one.min(two), one.max(two));
        match random.below(7) {
            0 => drop(frames.remove(one)),
            1 => drop(frames.drain(from..to)),
            2 => frames.insert(one, frames[one]),
            3 => frames.insert(two, frames[one]),
            4 => frames.swap(one, two),
            5 => {
                let other = self.session(random).0;
                let (a, b) = (random.below(other.len()), random.below(other.len()));
                frames.splice(from..to, other[a.min(b)..a.max(b)].iter().map(Vec::as_slice));
            }
            // Two sessions mixed like cards.
            _ => {
                let other = self.session(random).0;
                for frame in other {
                    let at = random.below(frames.len() + 1);
                    frames.insert(at, frame);
                }
            }
        }
    }

    fn read(&self, bytes: &[u8], random: &mut Random, tally: &mut Tally, stream: u64) {
        let mut reader = Reader::default();
        let mut open: Option<(u16, usize)> = None;
        let mut rest = bytes;
        let mut closed = false;
        loop {
            let mut check = |event: Event| match event {
                Event::Began { run, tick, .. } => {
                    assert_eq!(open, None, "stream {stream}: run {run} began in another");
                    assert_eq!(self.sent[&run][0].tick, tick, "stream {stream}, run {run}");
                    open = Some((run, 0));
                }
                Event::Edges(batch) => {
                    let (run, count) = open.unwrap();
                    assert_eq!((batch.run, usize::from(batch.first_index)), (run, count), "stream {stream}");
                    let next = count + batch.edges().len();
                    assert_eq!(&self.sent[&run][count..next], batch.edges(), "stream {stream}, run {run}");
                    open = Some((run, next));
                    tally.edges_accepted += batch.edges().len() as u64;
                }
                Event::Ended(ended) => {
                    let (run, count) = open.take().unwrap();
                    assert_eq!((ended.run.number, ended.run.edges.len()), (run, count), "stream {stream}");
                    assert_eq!(ended.run.edges, self.sent[&run][..count], "stream {stream}, run {run}");
                    assert_eq!(ended.missing.is_some(), ended.run.end == End::Missing, "stream {stream}, run {run}");
                    if ended.missing.is_none() {
                        let whole = count == self.sent[&run].len();
                        assert!(whole && ended.run.is_complete(), "stream {stream}, run {run}: {count} edges");
                        tally.runs_complete += 1;
                    } else {
                        tally.runs_incomplete += 1;
                    }
                }
                _ => {}
            };
            if rest.is_empty() {
                if !closed {
                    closed = true;
                    if let Some(ended) = reader.close(Missing::Line) {
                        check(Event::Ended(ended));
                    }
                    continue;
                }
                assert_eq!(open, None, "stream {stream}: a run without an end");
                return;
            }
            let (part, left) = rest.split_at(rest.len().min(1 + random.below(200)));
            reader.push(part, &mut check);
            rest = left;
        }
    }

    /// The runs that were sent, by number.
    #[allow(dead_code, reason = "not every test that shares this file needs it")]
    pub fn sent(&self) -> &HashMap<u16, Vec<Edge>> {
        &self.sent
    }
}

/// Cuts, doubles, flips, overwrites or adds bytes.
fn hurt_bytes(bytes: &mut Vec<u8>, random: &mut Random) {
    if bytes.is_empty() {
        return;
    }
    let at = random.below(bytes.len());
    let end = (at + 1 + random.below(60)).min(bytes.len());
    match random.below(8) {
        0 => drop(bytes.remove(at)),
        1 => drop(bytes.drain(at..end)),
        2 => bytes.truncate(at),
        3 => bytes[at] ^= 1 << random.below(8),
        4 => bytes[at] = random.next() as u8,
        5 => bytes[at..end].fill_with(|| random.next() as u8),
        6 => {
            let part = bytes[at..end].to_vec();
            let to = random.below(bytes.len());
            bytes.splice(to..to, part);
        }
        _ => bytes.insert(at, if random.below(2) == 0 { 0 } else { random.next() as u8 }),
    }
}

/// The runs of an undamaged stream.
#[allow(dead_code, reason = "not every test that shares this file needs it")]
pub fn runs(bytes: &[u8]) -> Vec<Run> {
    let mut runs = Vec::new();
    let mut reader = Reader::default();
    reader.push(bytes, |event| {
        if let Event::Ended(ended) = event {
            runs.push(ended.run);
        }
    });
    runs
}
