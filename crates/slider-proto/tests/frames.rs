//! What is sent is received, in exactly the bytes that the format says.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a frame that cannot be read fails the test")]

mod naive;

use proptest::prelude::*;
use slider_proto::{
    ArmSettings, Command, Decoder, Direction, DriveState, Edge, EdgeBatch, EndReason, Frame, Level, MAX_FRAME,
    MAX_PAYLOAD, Message, Preset, ProtoError, Refusal, Report, TICK_HZ, TimerState, Unit, VERSION, encode,
};

fn encoded<M: Message>(message: &M, sequence: u8) -> Vec<u8> {
    encode(message, sequence, &mut [0; MAX_FRAME]).to_vec()
}

fn decoded<M: Message>(bytes: &[u8]) -> Vec<Result<Frame<M>, ProtoError>> {
    let mut decoder = Decoder::default();
    bytes.iter().filter_map(|&byte| decoder.push(byte)).collect()
}

/// Low seven bits first; all but the last byte have the top bit. The number of bytes comes from the number of bits.
fn varint(value: u32) -> Vec<u8> {
    let bytes = (32 - value.leading_zeros()).div_ceil(7).max(1);
    (0..bytes).map(|i| (value >> (7 * i) & 0x7f) as u8 + if i + 1 < bytes { 0x80 } else { 0 }).collect()
}

/// Kind and payload by the tables in the documentation of the message.
fn command_payload(command: Command) -> Vec<u8> {
    match command {
        Command::Hello => vec![1],
        Command::Status => vec![2],
        Command::Arm(ArmSettings { run, trigger_ms, quiet_ms }) => {
            [&[3][..], &run.to_le_bytes(), &trigger_ms.to_le_bytes(), &quiet_ms.to_le_bytes()].concat()
        }
        Command::Stop => vec![4],
        Command::SetPreset { index, preset } => vec![5, index, preset.duty, preset.direction as u8],
        Command::Go { index } => vec![6, index],
        Command::SelfTest => vec![7],
        _ => panic!("a new command: write its payload here and add it to `commands`"),
    }
}

/// Kind and payload by the tables in the documentation of the message.
fn report_payload(report: &Report) -> Vec<u8> {
    match *report {
        Report::Hello { unit, firmware: [major, minor, patch], tick_hz, reset_cause } => {
            [&[128, unit as u8, major, minor, patch][..], &tick_hz.to_le_bytes(), &[reset_cause]].concat()
        }
        Report::RunStart { run, tick } => [&[129][..], &run.to_le_bytes(), &tick.to_le_bytes()].concat(),
        Report::Edges(ref batch) => {
            let edges = batch.edges();
            let bits = |of: fn(&Edge) -> bool| (0..edges.len()).map(|i| u8::from(of(&edges[i])) << i).sum();
            let mut bytes = [&[130][..], &batch.run.to_le_bytes(), &batch.first_index.to_le_bytes()].concat();
            bytes.extend([edges.len() as u8, bits(|edge| edge.level == Level::High), bits(|edge| edge.late)]);
            bytes.extend(edges[0].tick.to_le_bytes());
            bytes.extend(edges.windows(2).flat_map(|pair| varint(pair[1].tick.wrapping_sub(pair[0].tick))));
            bytes
        }
        Report::RunEnd { run, edges, late, lost, reason } => {
            let counts = [run, edges, late, lost].map(u16::to_le_bytes).concat();
            [&[131][..], &counts, &[reason as u8]].concat()
        }
        Report::LimitHit { tick } => [&[132][..], &tick.to_le_bytes()].concat(),
        Report::Preset { index, preset, state, limit } => {
            vec![133, index, preset.duty, preset.direction as u8, state as u8, u8::from(limit)]
        }
        Report::Status { state, run, edges, sensor, limit } => {
            let counts = [run, edges].map(u16::to_le_bytes).concat();
            [&[134, state as u8][..], &counts, &[sensor as u8, u8::from(limit)]].concat()
        }
        Report::Ack { sequence } => vec![135, sequence],
        Report::Nak { sequence, reason } => vec![136, sequence, reason as u8],
        Report::SelfTest { edges, worst_error_ticks } => [&[137, edges][..], &worst_error_ticks.to_le_bytes()].concat(),
        _ => panic!("a new report: write its payload here and add it to `reports`"),
    }
}

fn by_definition(sequence: u8, payload: &[u8]) -> Vec<u8> {
    naive::frame(&[&[VERSION, sequence][..], payload].concat())
}

fn preset() -> impl Strategy<Value = Preset> {
    let direction = prop_oneof![Just(Direction::Forward), Just(Direction::Reverse)];
    (any::<u8>(), direction).prop_map(|(duty, direction)| Preset { duty, direction })
}

fn level() -> impl Strategy<Value = Level> {
    prop_oneof![Just(Level::Low), Just(Level::High)]
}

/// Every command with any values.
fn commands() -> impl Strategy<Value = Command> {
    prop_oneof![
        Just(Command::Hello),
        Just(Command::Status),
        any::<(u16, u16, u16)>().prop_map(|(run, trigger_ms, quiet_ms)| Command::Arm(ArmSettings {
            run,
            trigger_ms,
            quiet_ms
        })),
        Just(Command::Stop),
        (any::<u8>(), preset()).prop_map(|(index, preset)| Command::SetPreset { index, preset }),
        any::<u8>().prop_map(|index| Command::Go { index }),
        Just(Command::SelfTest),
    ]
}

/// Any edges: ticks up and down and across the wrap, and small steps, whose bytes are fewer.
fn batches() -> impl Strategy<Value = EdgeBatch> {
    let step = prop_oneof![any::<u32>(), 0..300_u32, 16_000..17_000_u32];
    let edges = prop::collection::vec((step, level(), any::<bool>()), 1..=EdgeBatch::CAPACITY);
    (any::<(u16, u16, u32)>(), edges).prop_map(|((run, first_index, mut tick), edges)| {
        let mut batch = EdgeBatch::new(run, first_index);
        for (step, level, late) in edges {
            tick = tick.wrapping_add(step);
            batch.push(Edge { tick, level, late }).unwrap();
        }
        batch
    })
}

/// Every report with any values.
fn reports() -> impl Strategy<Value = Report> {
    let unit = prop_oneof![Just(Unit::Timer), Just(Unit::Drive)];
    let reason = prop_oneof![
        Just(EndReason::Quiet),
        Just(EndReason::Limit),
        Just(EndReason::Stopped),
        Just(EndReason::Full),
        Just(EndReason::Overrun)
    ];
    let drive_state = prop_oneof![
        Just(DriveState::Stopped),
        Just(DriveState::Starting),
        Just(DriveState::Running),
        Just(DriveState::AtLimit)
    ];
    let timer_state = prop_oneof![
        Just(TimerState::Idle),
        Just(TimerState::Armed),
        Just(TimerState::Running),
        Just(TimerState::SelfTest)
    ];
    let refusal = prop::sample::select(vec![
        Refusal::Garbled,
        Refusal::NotMine,
        Refusal::Busy,
        Refusal::SensorBlocked,
        Refusal::NoSuchPreset,
        Refusal::AtLimit,
        Refusal::OutOfRange,
    ]);
    prop_oneof![
        (unit, any::<[u8; 3]>(), any::<u32>(), any::<u8>()).prop_map(|(unit, firmware, tick_hz, reset_cause)| {
            Report::Hello { unit, firmware, tick_hz, reset_cause }
        }),
        any::<(u16, u32)>().prop_map(|(run, tick)| Report::RunStart { run, tick }),
        batches().prop_map(Report::Edges),
        (any::<[u16; 4]>(), reason).prop_map(|([run, edges, late, lost], reason)| Report::RunEnd {
            run,
            edges,
            late,
            lost,
            reason
        }),
        any::<u32>().prop_map(|tick| Report::LimitHit { tick }),
        (any::<u8>(), preset(), drive_state, any::<bool>()).prop_map(|(index, preset, state, limit)| Report::Preset {
            index,
            preset,
            state,
            limit
        }),
        (timer_state, any::<(u16, u16)>(), level(), any::<bool>())
            .prop_map(|(state, (run, edges), sensor, limit)| Report::Status { state, run, edges, sensor, limit }),
        any::<u8>().prop_map(|sequence| Report::Ack { sequence }),
        (any::<u8>(), refusal).prop_map(|(sequence, reason)| Report::Nak { sequence, reason }),
        any::<(u8, u16)>().prop_map(|(edges, worst_error_ticks)| Report::SelfTest { edges, worst_error_ticks }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn every_command_is_received_as_it_was_sent(command in commands(), sequence: u8) {
        let bytes = encoded(&command, sequence);
        prop_assert_eq!(decoded(&bytes), [Ok(Frame { sequence, lost: 0, message: command })]);
    }

    #[test]
    fn every_report_is_received_as_it_was_sent(report in reports(), sequence: u8) {
        let bytes = encoded(&report, sequence);
        prop_assert_eq!(decoded(&bytes), [Ok(Frame { sequence, lost: 0, message: report })]);
    }

    #[test]
    fn bytes_of_a_command_are_those_of_the_definition(command in commands(), sequence: u8) {
        prop_assert_eq!(encoded(&command, sequence), by_definition(sequence, &command_payload(command)));
    }

    #[test]
    fn bytes_of_a_report_are_those_of_the_definition(report in reports(), sequence: u8) {
        prop_assert_eq!(encoded(&report, sequence), by_definition(sequence, &report_payload(&report)));
    }

    #[test]
    fn zero_is_the_end_of_a_frame_and_nothing_else(report in reports(), sequence: u8) {
        let bytes = encoded(&report, sequence);
        prop_assert_eq!(bytes.iter().position(|&byte| byte == 0), Some(bytes.len() - 1));
    }
}

#[test]
fn bytes_are_those_of_pythons_zlib() {
    // In Python 3, with `content` the bytes before the checksum:
    //     body = content + struct.pack("<I", zlib.crc32(content))
    //     b"".join(bytes([len(run) + 1]) + run for run in body.split(b"\0")) + b"\0"
    // The first is the check value of CRC-32/ISO-HDLC, 0xcbf43926.
    let check = [14, b'1', b'2', b'3', b'4', b'5', b'6', b'7', b'8', b'9', 0x26, 0x39, 0xf4, 0xcb, 0];
    assert_eq!(naive::frame(b"123456789"), check);
    // bytes([1, 41, 4])
    assert_eq!(encoded(&Command::Stop, 41), [0x08, 0x01, 0x29, 0x04, 0xd7, 0xe8, 0xa8, 0xbd, 0x00]);
    // bytes([1, 255, 3]) + struct.pack("<HHH", 0x0102, 100, 2000)
    let arm = Command::Arm(ArmSettings { run: 0x0102, trigger_ms: 100, quiet_ms: 2000 });
    let golden = [0x07, 0x01, 0xff, 0x03, 0x02, 0x01, 0x64, 0x07, 0xd0, 0x07, 0xc5, 0xa4, 0x61, 0x3d, 0x00];
    assert_eq!(encoded(&arm, 255), golden);
    // bytes([1, 0, 128, 0, 0, 1, 0]) + struct.pack("<IB", 2000000, 1)
    let hello = Report::Hello { unit: Unit::Timer, firmware: [0, 1, 0], tick_hz: TICK_HZ, reset_cause: 1 };
    let golden =
        [0x02, 0x01, 0x02, 0x80, 0x01, 0x02, 0x01, 0x04, 0x80, 0x84, 0x1e, 0x06, 0x01, 0xa7, 0xa7, 0x60, 0x12, 0x00];
    assert_eq!(encoded(&hello, 0), golden);
    // bytes([1, 9, 130]) + struct.pack("<HHBBBI", 7, 8, 3, 0b010, 0b010, 0xfffffff0) + bytes([0x20, 0xac, 0x02]),
    // the last two being 300 = 0x2c + 2 * 128.
    let mut batch = EdgeBatch::new(7, 8);
    batch.push(Edge { tick: 0xffff_fff0, level: Level::Low, late: false }).unwrap();
    batch.push(Edge { tick: 0x10, level: Level::High, late: true }).unwrap();
    batch.push(Edge { tick: 0x10 + 300, level: Level::Low, late: false }).unwrap();
    let golden = [
        0x05, 0x01, 0x09, 0x82, 0x07, 0x02, 0x08, 0x0f, 0x03, 0x02, 0x02, 0xf0, 0xff, 0xff, 0xff, 0x20, 0xac, 0x02,
        0x8d, 0xb9, 0x3c, 0xd1, 0x00,
    ];
    assert_eq!(encoded(&Report::Edges(batch), 9), golden);
}

#[test]
fn longest_frame_fits() {
    // Eight edges, each step as long as steps can be: 11 bytes, and 7 times 5.
    let mut batch = EdgeBatch::new(u16::MAX, u16::MAX);
    for i in 0..8_u32 {
        let edge = Edge { tick: u32::MAX.wrapping_mul(i + 1), level: Level::High, late: true };
        batch.push(edge).unwrap();
    }
    let one_more = Edge { tick: 0, level: Level::Low, late: false };
    assert_eq!(batch.push(one_more), Err(one_more));
    let report = Report::Edges(batch);
    let payload = report_payload(&report).len() - 1;
    assert_eq!(payload, 46);
    assert!(payload <= MAX_PAYLOAD);
    let bytes = encoded(&report, 255);
    // Version, sequence number, kind; checksum; the byte of COBS and the zero.
    assert_eq!(bytes.len(), 3 + payload + 4 + 2);
    assert!(bytes.len() <= MAX_FRAME);
    assert_eq!(decoded(&bytes), [Ok(Frame { sequence: 255, lost: 0, message: report })]);
}

#[test]
fn batch_without_edges_is_not_a_message() {
    let bytes = encoded(&Report::Edges(EdgeBatch::new(1, 2)), 0);
    assert_eq!(decoded::<Report>(&bytes), [Err(ProtoError::Payload)]);
}

#[test]
fn missing_frames_are_counted() {
    for first in [0, 1, 128, 255_u8] {
        for missing in 0..=255_u8 {
            let second = first.wrapping_add(1).wrapping_add(missing);
            let third = second.wrapping_add(1);
            let bytes = [first, second, third].map(|sequence| encoded(&Command::Status, sequence)).concat();
            let lost: Vec<u8> = decoded::<Command>(&bytes).into_iter().map(|frame| frame.unwrap().lost).collect();
            assert_eq!(lost, [0, missing, 0]);
        }
    }
}

#[test]
fn zero_before_the_first_frame_is_no_error() {
    let bytes = [vec![0], encoded(&Command::Stop, 3)].concat();
    assert_eq!(decoded(&bytes), [Ok(Frame { sequence: 3, lost: 0, message: Command::Stop })]);
}
