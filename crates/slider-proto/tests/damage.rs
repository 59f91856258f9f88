//! Whatever happens to the bytes on the line, no message is received that was not sent, the damage is told, and the
//! frames after it are received.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a frame that cannot be read fails the test")]

mod naive;

use proptest::prelude::*;
use slider_proto::{
    ArmSettings, Command, Decoder, Direction, DriveState, Edge, EdgeBatch, EndReason, Frame, Level, MAX_FRAME, Message,
    Preset, ProtoError, Refusal, Report, TimerState, Unit, VERSION, encode,
};

fn decoded<M: Message>(bytes: &[u8]) -> Vec<Result<Frame<M>, ProtoError>> {
    let mut decoder = Decoder::default();
    bytes.iter().filter_map(|&byte| decoder.push(byte)).collect()
}

/// Edges as of a toothed sheet at the wrap of the counter, the steps growing so that all lengths of them occur.
fn batch(length: u32) -> EdgeBatch {
    let mut batch = EdgeBatch::new(0x0100, 8);
    let mut tick = 0xffff_fc00_u32;
    for i in 0..length {
        let level = if i % 2 == 0 { Level::Low } else { Level::High };
        batch.push(Edge { tick, level, late: i == 5 }).unwrap();
        tick = tick.wrapping_add(90 * 12_u32.pow(i));
    }
    batch
}

/// One report of each kind, and batches of all lengths between them.
fn reports() -> Vec<Report> {
    let preset = Preset { duty: 129, direction: Direction::Reverse };
    let mut reports = vec![
        Report::Hello { unit: Unit::Drive, firmware: [0, 1, 0], tick_hz: 2_000_000, reset_cause: 8 },
        Report::RunStart { run: 0x0100, tick: 0xffff_fc00 },
        Report::RunEnd { run: 0x0100, edges: 26, late: 1, lost: 0, reason: EndReason::Limit },
        Report::LimitHit { tick: 0x0012_3400 },
        Report::Preset { index: 3, preset, state: DriveState::Running, limit: true },
        Report::Status { state: TimerState::Armed, run: 513, edges: 0, sensor: Level::High, limit: false },
        Report::Ack { sequence: 0 },
        Report::Nak { sequence: 255, reason: Refusal::OutOfRange },
        Report::SelfTest { edges: 26, worst_error_ticks: 1 },
    ];
    for (at, length) in (1..=8).enumerate() {
        reports.insert(2 * at + 1, Report::Edges(batch(length)));
    }
    reports
}

/// Frames on their way, the sequence numbers with their wrap.
struct Line {
    sent: Vec<(u8, Report)>,
    frames: Vec<Vec<u8>>,
}

impl Line {
    fn new() -> Self {
        let sent: Vec<(u8, Report)> = (250..=255).chain(0..).zip(reports()).collect();
        let frames =
            sent.iter().map(|(sequence, report)| encode(report, *sequence, &mut [0; MAX_FRAME]).to_vec()).collect();
        Self { sent, frames }
    }

    /// All bytes, the frame of index `k` replaced by `frame`.
    fn with(&self, k: usize, frame: &[u8]) -> Vec<u8> {
        [&[0][..], &self.frames[..k].concat(), frame, &self.frames[k + 1..].concat()].concat()
    }

    /// `bytes` yield all frames but those `missing`, whose number is told, and an error if `told`.
    fn check(&self, bytes: &[u8], missing: std::ops::Range<usize>, told: bool, what: &dyn Fn() -> String) {
        let mut frames = Vec::new();
        let mut errors = 0;
        for result in decoded::<Report>(bytes) {
            match result {
                Ok(frame) => frames.push(frame),
                Err(_) => errors += 1,
            }
        }
        let received = frames.iter().map(|frame| (frame.sequence, frame.message));
        let left = self.sent[..missing.start].iter().chain(&self.sent[missing.end..]).copied();
        assert!(received.eq(left), "{}: {frames:?}", what());
        assert_eq!(errors > 0, told, "{}: {errors} errors", what());
        // What is lost before the first frame or after the last cannot be known from a number.
        let between = missing.start > 0 && missing.end < self.sent.len();
        let lost: usize = frames.iter().map(|frame| usize::from(frame.lost)).sum();
        assert_eq!(lost, if between { missing.len() } else { 0 }, "{}", what());
    }

    /// Index of the frame after those that are lost when byte `at` of frame `k` is: the end of a frame takes the next
    /// with it.
    fn end_of_loss(&self, k: usize, at: usize) -> usize {
        let joined = at + 1 == self.frames[k].len();
        (k + 1 + usize::from(joined)).min(self.sent.len())
    }
}

#[test]
fn undamaged_line_is_received_without_an_error() {
    let line = Line::new();
    line.check(&line.with(0, &line.frames[0]), 0..0, false, &|| String::new());
}

#[test]
fn any_changed_byte_is_told_and_costs_only_its_frame() {
    let line = Line::new();
    // Without an end, the last frame would not be seen at all.
    for (k, frame) in line.frames.iter().enumerate() {
        for at in 0..frame.len() - usize::from(k + 1 == line.frames.len()) {
            let mut changed = frame.clone();
            for difference in 1..=255 {
                changed[at] = frame[at] ^ difference;
                let missing = k..line.end_of_loss(k, at);
                line.check(&line.with(k, &changed), missing, true, &|| format!("frame {k}, byte {at}, {difference}"));
            }
        }
    }
}

#[test]
fn any_deleted_byte_is_told_and_costs_only_its_frame() {
    let line = Line::new();
    for (k, frame) in line.frames.iter().enumerate() {
        for at in 0..frame.len() - usize::from(k + 1 == line.frames.len()) {
            let deleted = [&frame[..at], &frame[at + 1..]].concat();
            let missing = k..line.end_of_loss(k, at);
            line.check(&line.with(k, &deleted), missing, true, &|| format!("frame {k}, byte {at}"));
        }
    }
}

#[test]
fn any_doubled_byte_is_told_and_costs_at_most_its_frame() {
    let line = Line::new();
    for (k, frame) in line.frames.iter().enumerate() {
        for at in 0..frame.len() {
            let doubled = [&frame[..=at], &frame[at..]].concat();
            // A second end of frame ends a frame without bytes, and the one before it is intact.
            let missing = if frame[at] == 0 { 0..0 } else { k..k + 1 };
            line.check(&line.with(k, &doubled), missing, true, &|| format!("frame {k}, byte {at}"));
        }
    }
}

#[test]
fn any_cut_frame_is_told_and_costs_at_most_the_next() {
    let line = Line::new();
    for k in 0..line.frames.len() - 1 {
        for at in 0..line.frames[k].len() {
            // What is left runs into the next frame; where nothing is left, only the numbers tell.
            let missing = if at == 0 { k..k + 1 } else { k..k + 2 };
            let told = at > 0;
            line.check(&line.with(k, &line.frames[k][..at]), missing, told, &|| format!("frame {k}, {at} bytes"));
        }
    }
}

#[test]
fn any_frame_cut_before_its_end_costs_only_itself() {
    // As when a sender is reset: it begins with a zero.
    let line = Line::new();
    for (k, frame) in line.frames.iter().enumerate() {
        for at in 0..frame.len() - 1 {
            let cut = [&frame[..at], &[0]].concat();
            line.check(&line.with(k, &cut), k..k + 1, true, &|| format!("frame {k}, {at} bytes"));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn bursts_of_noise_cost_only_the_frames_they_touch(
        from in 1..450_usize,
        length in 1..80_usize,
        noise in prop::collection::vec(any::<u8>(), 0..80),
    ) {
        let line = Line::new();
        let mut bytes = line.with(0, &line.frames[0]);
        let to = (from + length).min(bytes.len() - 1);
        let from = from.min(to - 1);
        // Frames that lie wholly before the burst, or begin after an end of frame that lies after it.
        let mut end = 1;
        let untouched: Vec<(u8, Report)> = (line.frames.iter().zip(&line.sent))
            .filter_map(|(frame, &sent)| {
                let begin = end;
                end += frame.len();
                (end <= from || begin > to).then_some(sent)
            })
            .collect();
        bytes.splice(from..to, noise);
        let received: Vec<(u8, Report)> =
            decoded::<Report>(&bytes).into_iter().flatten().map(|frame| (frame.sequence, frame.message)).collect();
        // Some frames touched may still be whole: noise that hits only the byte before them, say.
        let mut left = line.sent.iter();
        prop_assert!(received.iter().all(|message| left.any(|sent| sent == message)), "{received:?}");
        let mut left = received.iter();
        prop_assert!(untouched.iter().all(|message| left.any(|received| received == message)), "{received:?}");
        let errors = decoded::<Report>(&bytes).iter().filter(|result| result.is_err()).count();
        let lost: u32 = decoded::<Report>(&bytes).iter().flatten().map(|frame| u32::from(frame.lost)).sum();
        let whole = received.len() == line.sent.len();
        // Nothing can tell what is lost before the first frame or after the last.
        let between = received.first() == line.sent.first() && received.last() == line.sent.last();
        prop_assert!(whole || !between || errors > 0 || lost > 0);
    }

    #[test]
    fn garbage_is_no_message_and_the_frame_after_it_is_received(
        garbage in prop::collection::vec(any::<u8>(), 0..600),
        sequence: u8,
    ) {
        let stop = encode(&Command::Stop, sequence, &mut [0; MAX_FRAME]).to_vec();
        let received = decoded::<Command>(&[&garbage[..], &[0], &stop].concat());
        let (last, before) = received.split_last().unwrap();
        prop_assert_eq!(*last, Ok(Frame { sequence, lost: 0, message: Command::Stop }));
        prop_assert!(before.iter().all(Result::is_err));
        prop_assert!(decoded::<Report>(&garbage).iter().all(Result::is_err));
    }
}

#[test]
fn run_longer_than_any_frame_is_told_as_such() {
    let stop = encode(&Command::Stop, 7, &mut [0; MAX_FRAME]).to_vec();
    for byte in [1, 2, 0x39, 0xff] {
        for length in 1..400 {
            let received = decoded::<Command>(&[&vec![byte; length][..], &[0], &stop].concat());
            let [Err(error), Ok(frame)] = received[..] else { panic!("{received:?}") };
            assert_eq!(error == ProtoError::TooLong, length >= MAX_FRAME, "{length} bytes: {error}");
            assert_eq!(frame, Frame { sequence: 7, lost: 0, message: Command::Stop });
        }
    }
}

/// What is received of one frame with these bytes before its checksum, which is right.
fn only<M: Message>(content: &[u8]) -> Result<M, ProtoError> {
    let mut received = decoded::<M>(&naive::frame(content));
    assert_eq!(received.len(), 1, "one result for one frame");
    received.remove(0).map(|frame| frame.message)
}

fn with_kind<M: Message>(kind: u8, payload: &[u8]) -> Result<M, ProtoError> {
    only(&[&[VERSION, 0, kind][..], payload].concat())
}

#[test]
fn other_versions_are_refused() {
    for version in 0..=255 {
        let expected = if version == VERSION { Ok(Command::Stop) } else { Err(ProtoError::Version(version)) };
        assert_eq!(only(&[version, 0, 4]), expected);
    }
}

#[test]
fn frames_shorter_than_their_header_are_refused() {
    for content in [&[][..], &[VERSION], &[VERSION, 0]] {
        assert_eq!(only::<Command>(content), Err(ProtoError::TooShort(content.len() as u8 + 4)));
    }
    // Fewer bytes than the checksum alone.
    assert_eq!(decoded::<Command>(&[1, 1, 1, 0]), [Err(ProtoError::TooShort(2))]);
}

/// Lengths of the payloads by kind, from the tables.
const COMMAND_LENGTHS: [(u8, usize); 7] = [(1, 0), (2, 0), (3, 6), (4, 0), (5, 3), (6, 1), (7, 0)];
const REPORT_LENGTHS: [(u8, usize); 9] =
    [(128, 9), (129, 6), (131, 9), (132, 4), (133, 5), (134, 7), (135, 1), (136, 2), (137, 3)];
/// A batch of edges, whose length is not fixed.
const EDGES: u8 = 130;

#[test]
fn unknown_kinds_are_refused() {
    for kind in 0..=255 {
        // Zeros are valid in all fields.
        let command = with_kind::<Command>(kind, &[]);
        let known = COMMAND_LENGTHS.iter().any(|&(code, _)| code == kind);
        assert_eq!(command == Err(ProtoError::Kind(kind)), !known, "{kind}: {command:?}");
        let report = with_kind::<Report>(kind, &[]);
        let known = kind == EDGES || REPORT_LENGTHS.iter().any(|&(code, _)| code == kind);
        assert_eq!(report == Err(ProtoError::Kind(kind)), !known, "{kind}: {report:?}");
    }
}

#[test]
fn payloads_of_other_lengths_are_refused() {
    for length in 0..=48 {
        let zeros = vec![0; length];
        for (kind, right) in COMMAND_LENGTHS {
            let result = with_kind::<Command>(kind, &zeros);
            assert_eq!(result.is_ok(), length == right, "kind {kind}, {length} bytes: {result:?}");
            assert!(result.is_ok() || result == Err(ProtoError::Payload));
        }
        for (kind, right) in REPORT_LENGTHS {
            let result = with_kind::<Report>(kind, &zeros);
            assert_eq!(result.is_ok(), length == right, "kind {kind}, {length} bytes: {result:?}");
            assert!(result.is_ok() || result == Err(ProtoError::Payload));
        }
    }
}

#[test]
fn codes_without_a_meaning_are_refused() {
    // Kind, length of the payload, place of the code in it, number of meanings.
    let places = [(128, 9, 0, 2), (131, 9, 8, 5), (133, 5, 2, 2), (133, 5, 3, 4), (133, 5, 4, 2)];
    let more = [(134, 7, 0, 4), (134, 7, 5, 2), (134, 7, 6, 2), (136, 2, 1, 7)];
    for (kind, length, at, meanings) in places.into_iter().chain(more) {
        for code in 0..=255 {
            let mut payload = vec![0; length];
            payload[at] = code;
            let result = with_kind::<Report>(kind, &payload);
            assert_eq!(result.is_ok(), code < meanings, "kind {kind}, byte {at}, {code}: {result:?}");
        }
    }
    for code in 0..=255 {
        assert_eq!(with_kind::<Command>(5, &[0, 0, code]).is_ok(), code < 2);
    }
}

/// A batch with these count, levels, late bits and bytes after the first tick.
fn edges(count: u8, levels: u8, late: u8, steps: &[u8]) -> Result<Report, ProtoError> {
    with_kind(EDGES, &[&[1, 0, 2, 0, count, levels, late, 10, 0, 0, 0][..], steps].concat())
}

#[test]
fn batches_have_as_many_steps_and_bits_as_they_say() {
    for count in 0..=255_u8 {
        for steps in 0..30 {
            let right = (1..=8).contains(&count) && steps + 1 == usize::from(count);
            let result = edges(count, 0, 0, &vec![1; steps]);
            assert_eq!(result.is_ok(), right, "{count} edges, {steps} steps: {result:?}");
        }
    }
    for count in 1..=8_u8 {
        let steps = vec![1; usize::from(count) - 1];
        for bits in 0..=255_u8 {
            // Bit i belongs to edge i.
            let right = u32::from(bits) < 1 << count;
            assert_eq!(edges(count, bits, 0, &steps).is_ok(), right, "{count} edges, levels {bits:#b}");
            assert_eq!(edges(count, 0, bits, &steps).is_ok(), right, "{count} edges, late {bits:#b}");
        }
    }
}

#[test]
fn steps_are_accepted_in_their_shortest_form_only() {
    let tick_after = |steps: &[u8]| match edges(2, 0, 0, steps) {
        Ok(Report::Edges(batch)) => Some(batch.edges()[1].tick),
        Ok(other) => panic!("{other:?}"),
        Err(error) => {
            assert_eq!(error, ProtoError::Payload);
            None
        }
    };
    // The first tick is 10.
    assert_eq!(tick_after(&[0]), Some(10));
    assert_eq!(tick_after(&[0x7f]), Some(10 + 127));
    assert_eq!(tick_after(&[0x80, 0x01]), Some(10 + 128));
    assert_eq!(tick_after(&[0x80, 0x80, 0x80, 0x80, 0x01]), Some(10 + (1 << 28)));
    assert_eq!(tick_after(&[0xff, 0xff, 0xff, 0xff, 0x0f]), Some(9));
    // Longer than need be: a last byte of nothing.
    for low in 0x80..=0xff {
        assert_eq!(tick_after(&[low, 0]), None);
        assert_eq!(tick_after(&[low, low, 0]), None);
        assert_eq!(tick_after(&[low, low, low, 0]), None);
        assert_eq!(tick_after(&[low, low, low, low, 0]), None);
    }
    // More than 32 bits, and more than five bytes.
    for top in 0x10..=0xff {
        assert_eq!(tick_after(&[0xff, 0xff, 0xff, 0xff, top]), None);
    }
    assert_eq!(tick_after(&[0xff, 0xff, 0xff, 0xff, 0x8f, 0x01]), None);
    assert_eq!(tick_after(&[0xff, 0xff, 0xff, 0xff, 0x8f, 0x00]), None);
    // No last byte.
    assert_eq!(tick_after(&[0x80]), None);
}

#[test]
fn commands_are_no_reports_and_reports_no_commands() {
    let arm = Command::Arm(ArmSettings::default());
    let bytes = encode(&arm, 0, &mut [0; MAX_FRAME]).to_vec();
    assert_eq!(decoded::<Report>(&bytes), [Err(ProtoError::Kind(3))]);
    let bytes = encode(&Report::Ack { sequence: 0 }, 0, &mut [0; MAX_FRAME]).to_vec();
    assert_eq!(decoded::<Command>(&bytes), [Err(ProtoError::Kind(135))]);
}
