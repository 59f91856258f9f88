//! The timer tells every edge of a run once, in order, and fires the camera at its first tooth.
#![allow(clippy::panic, reason = "a report that is not told fails the test")]

use proptest::prelude::*;
use slider_proto::ring::EdgeRing;
use slider_proto::timer::{Port, REFERENCE_TICKS, TimerUnit};
use slider_proto::{
    ArmSettings, Command, Direction, Edge, EndReason, Frame, Level, MAX_FRAME, Preset, ProtoError, Refusal, Report,
    TICK_HZ, TimerState, Unit, encode, ticks_between, ticks_from_ms,
};

/// One turn of the main loop: 200 us.
const TURN: u32 = 400;
/// One byte on the line, at 57600 baud and ten bits: 174 us.
const BYTE: u32 = 347;

/// The hardware and its interrupts: the sensor, the input capture, the trigger pin.
#[allow(clippy::struct_excessive_bools, reason = "pins and bits of registers")]
struct Board {
    ring: EdgeRing,
    sensor: Level,
    limit: bool,
    /// The level after the edge that the hardware waits for, while it captures.
    awaits: Option<Level>,
    /// The first edge raises the trigger.
    armed: bool,
    trigger: bool,
    /// The reference signal is on.
    reference: bool,
    /// When the trigger pin rose and, by the clock of the main loop, fell.
    rose: Vec<u32>,
    fell: Vec<u32>,
    now: u32,
    /// Edges of the present run that were captured, those without room in the ring included.
    captured: Vec<Edge>,
    /// A tooth comes between the start of the capture and the look at the sensor.
    tooth_while_arming: bool,
}

impl Board {
    fn new() -> Self {
        Self {
            ring: EdgeRing::new(),
            sensor: Level::High,
            limit: false,
            awaits: None,
            armed: false,
            trigger: false,
            reference: false,
            rose: Vec::new(),
            fell: Vec::new(),
            now: 0,
            captured: Vec::new(),
            tooth_while_arming: false,
        }
    }

    /// The sensor changes. The hardware sees it only if it waits for an edge of this kind.
    fn edge(&mut self, tick: u32, late: bool) {
        self.sensor = self.sensor.inverse();
        if self.awaits != Some(self.sensor) {
            return;
        }
        self.awaits = Some(self.sensor.inverse());
        if std::mem::take(&mut self.armed) {
            assert!(!self.trigger, "the camera sees no edge of a pin that is high already");
            self.trigger = true;
            self.rose.push(tick);
        }
        let edge = Edge { tick, level: self.sensor, late };
        self.ring.push(edge);
        self.captured.push(edge);
    }

    fn start(&mut self, armed: bool) {
        self.ring.clear();
        self.captured.clear();
        self.awaits = Some(Level::Low);
        self.armed = armed;
    }
}

impl Port for Board {
    fn arm(&mut self) -> Level {
        self.start(true);
        if std::mem::take(&mut self.tooth_while_arming) {
            self.edge(self.now, false);
        }
        self.sensor
    }

    fn start_self_test(&mut self) {
        self.start(false);
        self.reference = true;
    }

    fn stop_capture(&mut self) {
        self.awaits = None;
        self.armed = false;
        self.reference = false;
    }

    fn next_edge(&mut self) -> Option<Edge> {
        self.ring.pop()
    }

    fn waiting(&self) -> u8 {
        self.ring.len()
    }

    fn lost(&self) -> u16 {
        self.ring.lost()
    }

    fn release_trigger(&mut self) {
        if std::mem::take(&mut self.trigger) {
            self.fell.push(self.now);
        }
    }

    fn sensor(&self) -> Level {
        self.sensor
    }

    fn limit(&self) -> bool {
        self.limit
    }
}

/// The firmware's main loop, and a line that takes its time.
struct Bench {
    unit: TimerUnit,
    board: Board,
    now: u32,
    told: Vec<Report>,
    free_at: u32,
}

impl Bench {
    /// A timer at this time that has said hello.
    fn at(now: u32) -> Self {
        let unit = TimerUnit::new([0, 1, 0], 4);
        let mut bench = Self { unit, board: Board::new(), now, told: Vec::new(), free_at: now };
        bench.turn(TURN);
        let hello = Report::Hello { unit: Unit::Timer, firmware: [0, 1, 0], tick_hz: TICK_HZ, reset_cause: 4 };
        assert_eq!(bench.told, [hello]);
        bench.told.clear();
        bench
    }

    /// One turn of the loop, `ticks` after the one before.
    fn turn(&mut self, ticks: u32) {
        self.now = self.now.wrapping_add(ticks);
        self.board.now = self.now;
        self.unit.step(self.now, &mut self.board);
        if self.now.wrapping_sub(self.free_at).cast_signed() >= 0 {
            self.tell();
        }
    }

    fn tell(&mut self) {
        if let Some(report) = self.unit.report(self.now, &mut self.board) {
            let bytes = encode(&report, 0, &mut [0; MAX_FRAME]).len() as u32;
            self.free_at = self.now.wrapping_add(bytes * BYTE);
            self.told.push(report);
        }
    }

    /// Turns of the loop until `ticks` have passed.
    fn pass(&mut self, ticks: u32) {
        let mut left = ticks;
        while left > 0 {
            let part = left.min(TURN);
            self.turn(part);
            left -= part;
        }
    }

    fn command(&mut self, message: Command) -> Report {
        self.unit.command(Ok(Frame { sequence: 77, lost: 0, message }), self.now, &mut self.board)
    }

    fn obey(&mut self, message: Command) {
        assert_eq!(self.command(message), Report::Ack { sequence: 77 });
    }

    fn refuse(&mut self, message: Command, reason: Refusal) {
        assert_eq!(self.command(message), Report::Nak { sequence: 77, reason });
    }

    fn limit_hit(&mut self) {
        self.board.limit = true;
        self.unit.limit_hit(self.now, &mut self.board);
    }

    /// Edges of the sensor, the first at once, then with these times between them.
    fn teeth(&mut self, between: &[u32]) {
        self.board.edge(self.now, false);
        for &ticks in between {
            self.pass(ticks);
            self.board.edge(self.now, false);
        }
    }
}

const RUN: u16 = 9;

fn arm(trigger_ms: u16, quiet_ms: u16) -> Command {
    Command::Arm(ArmSettings { run: RUN, trigger_ms, quiet_ms })
}

/// The sequence of reports of one run, checked: start, edges one after the other, end.
fn run(told: &[Report]) -> (u32, Vec<Edge>, Report) {
    let [Report::RunStart { run: RUN, tick }, batches @ .., end] = told else { panic!("{told:?}") };
    let mut edges = Vec::new();
    for report in batches {
        let Report::Edges(batch) = report else { panic!("{told:?}") };
        assert_eq!((batch.run, usize::from(batch.first_index)), (RUN, edges.len()));
        assert!(!batch.edges().is_empty());
        edges.extend(batch.edges());
    }
    (*tick, edges, *end)
}

fn end(edges: u16, lost: u16, reason: EndReason) -> Report {
    Report::RunEnd { run: RUN, edges, late: 0, lost, reason }
}

/// Thirteen teeth, slower and slower: 4 ms to 5.2 ms each, as 5 mm at 1.25 m/s.
fn thirteen_teeth() -> Vec<u32> {
    (0..25).map(|i| 8000 + 100 * i + 7 * (i % 3)).collect()
}

#[test]
fn run_of_thirteen_teeth_is_told_edge_by_edge() {
    // The second begins just before the counter wraps.
    for start in [1_000_000, u32::MAX - 100_000] {
        let mut bench = Bench::at(start);
        bench.obey(arm(100, 500));
        assert_eq!(bench.unit.state(), TimerState::Armed);
        bench.pass(50_000);
        let first = bench.now;
        bench.teeth(&thirteen_teeth());
        assert_eq!(bench.unit.state(), TimerState::Running);
        bench.pass(ticks_from_ms(600));
        let (tick, edges, last) = run(&bench.told);
        assert_eq!((tick, last), (first, end(26, 0, EndReason::Quiet)));
        assert_eq!(edges, bench.board.captured);
        // What was captured is what was played.
        let ticks: Vec<u32> = edges.windows(2).map(|pair| ticks_between(pair[0].tick, pair[1].tick)).collect();
        assert_eq!((edges[0].tick, ticks), (first, thirteen_teeth()));
        assert_eq!(bench.unit.state(), TimerState::Idle);
    }
}

#[test]
fn late_edges_are_counted() {
    let mut bench = Bench::at(0);
    bench.obey(arm(1, 50));
    for i in 0..20 {
        bench.pass(3000);
        bench.board.edge(bench.now, i % 7 == 3);
    }
    bench.pass(ticks_from_ms(200));
    let (_, edges, last) = run(&bench.told);
    assert_eq!(edges, bench.board.captured);
    assert_eq!(last, Report::RunEnd { run: RUN, edges: 20, late: 3, lost: 0, reason: EndReason::Quiet });
}

#[test]
fn run_ends_when_it_has_been_quiet_for_the_time_that_was_set() {
    for quiet_ms in [1, 20, 2000, u16::MAX] {
        let mut bench = Bench::at(0);
        bench.obey(arm(1, quiet_ms));
        bench.teeth(&[500, 500]);
        bench.pass(ticks_from_ms(quiet_ms) - 1);
        assert!(bench.board.awaits.is_some(), "still captures");
        // An edge now begins the time anew.
        bench.board.edge(bench.now, false);
        bench.pass(ticks_from_ms(quiet_ms) - 1);
        assert!(bench.board.awaits.is_some(), "still captures");
        bench.pass(1);
        assert!(bench.board.awaits.is_none(), "captures no more");
        bench.pass(100_000);
        assert_eq!(run(&bench.told).2, end(4, 0, EndReason::Quiet));
    }
}

#[test]
fn run_ends_at_the_limit() {
    let mut bench = Bench::at(0);
    bench.obey(arm(1, 2000));
    bench.teeth(&[3000; 10]);
    let hit = bench.now;
    bench.limit_hit();
    // What comes after it is not of the run.
    bench.teeth(&[3000; 4]);
    bench.pass(100_000);
    let limit = Report::LimitHit { tick: hit };
    assert_eq!(bench.told.iter().filter(|report| **report == limit).count(), 1);
    bench.told.retain(|report| *report != limit);
    let (_, edges, last) = run(&bench.told);
    assert_eq!((edges.len(), last), (11, end(11, 0, EndReason::Limit)));
}

#[test]
fn limit_is_told_without_a_run_and_ends_none_later() {
    let mut bench = Bench::at(0);
    bench.limit_hit();
    bench.pass(20_000);
    assert!(matches!(bench.told[..], [Report::LimitHit { .. }]));
    bench.obey(arm(1, 50));
    bench.limit_hit();
    bench.pass(10_000);
    assert_eq!(bench.unit.state(), TimerState::Armed);
    bench.told.clear();
    bench.teeth(&[3000; 3]);
    bench.pass(ticks_from_ms(100));
    assert_eq!(run(&bench.told).2, end(4, 0, EndReason::Quiet));
}

#[test]
fn run_ends_at_the_hosts_word() {
    let mut bench = Bench::at(0);
    bench.obey(arm(1, 2000));
    bench.teeth(&[3000; 10]);
    bench.obey(Command::Stop);
    bench.obey(Command::Stop);
    bench.teeth(&[3000; 4]);
    bench.pass(100_000);
    let (_, edges, last) = run(&bench.told);
    assert_eq!((edges.len(), last), (11, end(11, 0, EndReason::Stopped)));
}

#[test]
fn first_reason_to_end_is_the_one_that_is_told() {
    let mut bench = Bench::at(0);
    bench.obey(arm(1, 1));
    bench.teeth(&[3000 / 2; 10]);
    bench.obey(Command::Stop);
    bench.limit_hit();
    bench.pass(100_000);
    bench.told.retain(|report| !matches!(report, Report::LimitHit { .. }));
    assert_eq!(run(&bench.told).2, end(11, 0, EndReason::Stopped));
}

#[test]
fn busy_line_does_not_make_a_run_quiet() {
    // For 0.2 s nothing can be told, and an edge comes every 5 ms.
    let mut bench = Bench::at(0);
    bench.obey(arm(1, 20));
    bench.free_at = bench.now + 400_000;
    bench.teeth(&[10_000; 40]);
    bench.pass(ticks_from_ms(200));
    assert_eq!(run(&bench.told).2, end(41, 0, EndReason::Quiet));
}

#[test]
fn run_ends_at_the_last_edge_that_it_can_number() {
    let mut bench = Bench::at(0);
    // A line as fast as need be, and an encoder that goes on: edges wait when the last that has a number is taken.
    bench.obey(arm(1, 2000));
    for _ in 0..17_000 {
        for i in 0..4 {
            bench.board.edge(bench.now + i, false);
        }
        bench.free_at = bench.now;
        bench.turn(TURN);
    }
    bench.pass(100_000);
    let (_, edges, last) = run(&bench.told);
    assert_eq!(last, end(65_535, 0, EndReason::Full));
    assert_eq!(edges, bench.board.captured[..65_535]);
    // And then it is ready for the next.
    bench.board.sensor = Level::High;
    bench.obey(arm(1, 2000));
}

#[test]
fn overrun_is_told_and_the_edges_before_it_are_whole() {
    let mut bench = Bench::at(0);
    bench.obey(arm(1, 50));
    // 1000 edges at 20 kHz are too many for the line.
    bench.teeth(&[100; 999]);
    bench.pass(ticks_from_ms(500));
    let (_, edges, last) = run(&bench.told);
    let kept = edges.len();
    // At least the ring and the batch on its way.
    assert!((64 + 8..999).contains(&kept), "{kept}");
    assert_eq!(edges, bench.board.captured[..kept]);
    // It ends when the last edge that there was room for is on its way.
    let Report::RunEnd { edges, lost, reason: EndReason::Overrun, .. } = last else { panic!("{last:?}") };
    assert_eq!(usize::from(edges), kept);
    assert!(lost > 0 && usize::from(lost) <= 1000 - kept, "{lost} lost");
}

#[test]
fn edges_lost_by_the_interrupt_are_told() {
    let mut bench = Bench::at(0);
    bench.obey(arm(1, 50));
    bench.teeth(&[3000; 5]);
    bench.board.ring.lose(1);
    bench.pass(ticks_from_ms(200));
    assert_eq!(run(&bench.told).2, end(6, 1, EndReason::Overrun));
}

#[test]
fn edge_is_told_within_20_ms_of_a_free_line() {
    let mut bench = Bench::at(0);
    bench.obey(arm(1, 2000));
    bench.teeth(&[]);
    bench.pass(ticks_from_ms(20) - 1);
    assert!(matches!(bench.told[..], [Report::RunStart { .. }]), "{:?}", bench.told);
    bench.pass(1 + TURN);
    assert!(matches!(bench.told[..], [Report::RunStart { .. }, Report::Edges(_)]), "{:?}", bench.told);
}

#[test]
fn trigger_pulse_has_the_length_that_was_set() {
    for trigger_ms in [1, 2, 100, 3000] {
        // Shorter than the run, and longer.
        let mut bench = Bench::at(u32::MAX - 5000);
        bench.obey(arm(trigger_ms, 50));
        bench.pass(20_000);
        assert!(!bench.board.trigger);
        let first = bench.now;
        bench.teeth(&thirteen_teeth());
        bench.pass(ticks_from_ms(trigger_ms) + 200_000);
        assert_eq!(bench.board.rose, [first]);
        let [fell] = bench.board.fell[..] else { panic!("{:?}", bench.board.fell) };
        let pulse = ticks_between(first, fell);
        assert!((0..TURN).contains(&(pulse - ticks_from_ms(trigger_ms))), "{trigger_ms} ms: {pulse}");
    }
}

#[test]
fn trigger_pulse_is_not_cut_short() {
    let mut bench = Bench::at(0);
    bench.obey(arm(1000, 10));
    let first = bench.now;
    bench.teeth(&[1000]);
    bench.pass(ticks_from_ms(500));
    assert!(matches!(bench.told.last(), Some(Report::RunEnd { .. })));
    bench.obey(Command::Stop);
    bench.refuse(arm(1, 10), Refusal::Busy);
    bench.pass(ticks_from_ms(600));
    assert!(ticks_between(first, bench.board.fell[0]) >= ticks_from_ms(1000));
    bench.obey(arm(1, 10));
}

#[test]
fn what_cannot_be_done_is_refused() {
    let mut bench = Bench::at(0);
    bench.refuse(arm(0, 100), Refusal::OutOfRange);
    bench.refuse(arm(100, 0), Refusal::OutOfRange);
    bench.refuse(Command::Go { index: 0 }, Refusal::NotMine);
    let preset = Preset { duty: 1, direction: Direction::Forward };
    bench.refuse(Command::SetPreset { index: 0, preset }, Refusal::NotMine);
    let garbled = bench.unit.command(Err(ProtoError::TooLong), bench.now, &mut bench.board);
    assert_eq!(garbled, Report::Nak { sequence: 0, reason: Refusal::Garbled });
    assert_eq!(bench.unit.state(), TimerState::Idle);

    bench.obey(arm(1, 100));
    bench.refuse(Command::SelfTest, Refusal::Busy);
    bench.teeth(&[1000; 3]);
    bench.pass(TURN);
    bench.refuse(arm(1, 100), Refusal::Busy);
    bench.refuse(Command::SelfTest, Refusal::Busy);
    bench.obey(Command::Stop);
    // The end is still to be told.
    bench.refuse(arm(1, 100), Refusal::Busy);
    bench.refuse(Command::SelfTest, Refusal::Busy);
    bench.pass(100_000);
    assert_eq!(run(&bench.told).2, end(4, 0, EndReason::Stopped));

    bench.obey(Command::SelfTest);
    bench.refuse(Command::SelfTest, Refusal::Busy);
    bench.refuse(arm(1, 100), Refusal::Busy);
}

#[test]
fn blocked_sensor_is_refused_and_triggers_nothing() {
    let mut bench = Bench::at(0);
    bench.board.edge(0, false);
    bench.refuse(arm(1, 100), Refusal::SensorBlocked);
    assert_eq!(bench.unit.state(), TimerState::Idle);
    // The tooth goes on, and the next comes.
    bench.teeth(&[1000; 5]);
    bench.pass(500_000);
    assert_eq!((bench.told.len(), bench.board.rose.len()), (0, 0));
}

#[test]
fn tooth_that_comes_while_arming_is_refused_and_leaves_the_trigger_low() {
    let mut bench = Bench::at(0);
    bench.board.tooth_while_arming = true;
    bench.refuse(arm(1, 100), Refusal::SensorBlocked);
    assert!(!bench.board.trigger);
    bench.teeth(&[1000; 4]);
    bench.pass(500_000);
    assert_eq!((bench.told.len(), bench.board.trigger), (0, false));
    bench.board.sensor = Level::High;
    bench.obey(arm(1, 100));
}

#[test]
fn hello_and_status_are_told_when_asked_for() {
    let mut bench = Bench::at(0);
    bench.obey(Command::Hello);
    bench.pass(20_000);
    assert!(matches!(bench.told[..], [Report::Hello { unit: Unit::Timer, .. }]));
    let status = |bench: &mut Bench| {
        bench.told.clear();
        bench.obey(Command::Status);
        bench.pass(20_000);
        bench.told.iter().find(|report| matches!(report, Report::Status { .. })).copied()
    };
    let expected = |state, run, edges, sensor, limit| Some(Report::Status { state, run, edges, sensor, limit });
    assert_eq!(status(&mut bench), expected(TimerState::Idle, 0, 0, Level::High, false));
    bench.obey(arm(1, 1000));
    assert_eq!(status(&mut bench), expected(TimerState::Armed, RUN, 0, Level::High, false));
    bench.teeth(&[1000; 10]);
    assert_eq!(status(&mut bench), expected(TimerState::Running, RUN, 11, Level::Low, false));
    bench.limit_hit();
    bench.pass(100_000);
    assert_eq!(status(&mut bench), expected(TimerState::Idle, RUN, 11, Level::Low, true));
    bench.obey(Command::SelfTest);
    assert_eq!(status(&mut bench), expected(TimerState::SelfTest, RUN, 11, Level::Low, true));
}

/// Plays these times between edges of the reference signal, after a first edge, and returns what is told.
fn self_test(between: &[u32]) -> Vec<Report> {
    let mut bench = Bench::at(u32::MAX - 10_000);
    bench.obey(Command::SelfTest);
    assert!(bench.board.reference);
    bench.pass(REFERENCE_TICKS);
    bench.teeth(between);
    bench.pass(ticks_from_ms(150));
    assert!(!bench.board.reference && bench.board.awaits.is_none());
    assert_eq!((bench.unit.state(), bench.board.rose.len()), (TimerState::Idle, 0));
    bench.told
}

#[test]
fn self_test_measures_the_reference_signal() {
    // 64 cycles of 16 MHz to a count, 128 counts to half a period, 8 cycles to a tick.
    assert_eq!(REFERENCE_TICKS, 64 * 128 / 8);
    assert_eq!(self_test(&[1024; 60]), [Report::SelfTest { edges: 26, worst_error_ticks: 0 }]);
}

#[test]
fn self_test_tells_the_worst_interval() {
    for (wrong, error) in [(1000, 24), (1037, 13), (1, 1023)] {
        let mut between = [1024; 25];
        between[3] = wrong;
        between[24] = 1020;
        assert_eq!(self_test(&between), [Report::SelfTest { edges: 26, worst_error_ticks: error }]);
    }
    // Longer than a `u16` can tell, with the edges that came within 100 ms.
    let told = self_test(&[1024, 180_000]);
    assert_eq!(told, [Report::SelfTest { edges: 3, worst_error_ticks: u16::MAX }]);
}

#[test]
fn self_test_without_its_wire_has_no_edges() {
    let mut bench = Bench::at(0);
    bench.obey(Command::SelfTest);
    bench.pass(ticks_from_ms(99));
    assert_eq!(bench.told, []);
    bench.pass(ticks_from_ms(2));
    assert_eq!(bench.told, [Report::SelfTest { edges: 0, worst_error_ticks: 0 }]);
}

#[test]
fn self_test_tells_a_missing_edge() {
    let mut bench = Bench::at(0);
    bench.obey(Command::SelfTest);
    bench.teeth(&[1024; 8]);
    // The ring gets two edges of one level, as if an interrupt had been missed.
    let edge = Edge { tick: bench.now + 2048, level: bench.board.sensor, late: false };
    bench.board.ring.push(edge);
    bench.pass(ticks_from_ms(150));
    assert_eq!(bench.told, [Report::SelfTest { edges: 10, worst_error_ticks: u16::MAX }]);
}

#[test]
fn self_test_can_be_stopped() {
    let mut bench = Bench::at(0);
    bench.obey(Command::SelfTest);
    bench.teeth(&[1024; 8]);
    bench.obey(Command::Stop);
    bench.teeth(&[1024; 50]);
    bench.pass(ticks_from_ms(150));
    assert_eq!((bench.told.len(), bench.board.reference), (0, false));
    // The next one begins anew.
    bench.board.sensor = Level::High;
    bench.obey(Command::SelfTest);
    bench.teeth(&[1024; 30]);
    bench.pass(ticks_from_ms(150));
    assert_eq!(bench.told, [Report::SelfTest { edges: 26, worst_error_ticks: 0 }]);
}

#[test]
fn stop_disarms() {
    let mut bench = Bench::at(0);
    bench.obey(arm(1, 100));
    bench.obey(Command::Stop);
    assert_eq!(bench.unit.state(), TimerState::Idle);
    bench.teeth(&[1000; 5]);
    bench.pass(500_000);
    assert_eq!((bench.told.len(), bench.board.rose.len()), (0, 0));
}

#[test]
fn first_tooth_just_before_stop_is_a_run() {
    let mut bench = Bench::at(0);
    bench.obey(arm(20, 100));
    bench.pass(5000);
    // Between two turns of the loop.
    bench.board.edge(bench.now, false);
    bench.obey(Command::Stop);
    bench.refuse(arm(20, 100), Refusal::Busy);
    bench.pass(200_000);
    let (_, edges, last) = run(&bench.told);
    assert_eq!((edges.len(), last), (1, end(1, 0, EndReason::Stopped)));
    assert_eq!((bench.board.rose.len(), bench.board.fell.len()), (1, 1));
}

#[test]
fn first_tooth_just_before_arming_anew_is_a_run() {
    // And whether it has passed already or not.
    for edges in [1, 2] {
        let mut bench = Bench::at(0);
        bench.obey(arm(20, 100));
        bench.pass(5000);
        for _ in 0..edges {
            bench.board.edge(bench.now, false);
        }
        bench.refuse(arm(20, 100), Refusal::Busy);
        bench.pass(ticks_from_ms(300));
        assert_eq!(run(&bench.told).2, end(edges, 0, EndReason::Quiet));
        assert_eq!((bench.board.rose.len(), bench.board.fell.len()), (1, 1));
    }
}

#[test]
fn armed_timer_can_be_armed_anew() {
    let mut bench = Bench::at(0);
    bench.obey(arm(1, 1));
    bench.pass(1000);
    bench.obey(Command::Arm(ArmSettings { run: RUN + 1, trigger_ms: 5, quiet_ms: 20 }));
    bench.teeth(&[1000; 2]);
    bench.pass(100_000);
    assert!(matches!(bench.told[0], Report::RunStart { run, .. } if run == RUN + 1));
}

#[derive(Debug, Clone, Copy)]
enum Event {
    Edges(u8, u32, bool),
    Limit,
    Command(Command),
    Garbled,
    /// The line becomes free.
    Tell,
    /// Turns of the loop: how many, how long each, and whether the line takes reports.
    Turns(u8, u32, bool),
}

fn events() -> impl Strategy<Value = Event> {
    let settings = (0..4_u16, 0..6_u16, 0..30_u16)
        .prop_map(|(run, trigger_ms, quiet_ms)| Command::Arm(ArmSettings { run, trigger_ms, quiet_ms }));
    let preset = Preset { duty: 1, direction: Direction::Forward };
    let command = prop_oneof![
        6 => settings,
        2 => Just(Command::Stop),
        1 => Just(Command::Hello),
        1 => Just(Command::Status),
        1 => Just(Command::SelfTest),
        1 => Just(Command::Go { index: 3 }),
        1 => Just(Command::SetPreset { index: 3, preset }),
    ];
    prop_oneof![
        6 => (1..40_u8, 20..6000_u32, any::<bool>()).prop_map(|(edges, ticks, late)| Event::Edges(edges, ticks, late)),
        1 => Just(Event::Limit),
        6 => command.prop_map(Event::Command),
        1 => Just(Event::Garbled),
        2 => Just(Event::Tell),
        8 => (1..60_u8, 1..10_000_u32, prop::bool::weighted(0.8)).prop_map(|(n, ticks, free)| Event::Turns(n, ticks, free)),
    ]
}

/// Follows what is told and compares it with what the hardware has captured.
#[derive(Default)]
struct Host {
    runs: usize,
    /// Number and edges of the run that is going on.
    run: Option<(u16, Vec<Edge>)>,
    seen: usize,
}

impl Host {
    fn listen(&mut self, bench: &Bench) {
        for report in &bench.told[self.seen..] {
            match (report, &mut self.run) {
                (&Report::RunStart { run, tick }, none @ None) => {
                    assert_eq!(tick, bench.board.captured[0].tick);
                    *none = Some((run, Vec::new()));
                    self.runs += 1;
                }
                (Report::Edges(batch), Some((run, edges))) => {
                    assert_eq!((batch.run, usize::from(batch.first_index)), (*run, edges.len()));
                    edges.extend(batch.edges());
                    assert!(bench.board.captured.starts_with(edges), "{edges:?}");
                }
                (&Report::RunEnd { run, edges, late, lost, .. }, going @ Some(_)) => {
                    let Some((number, told)) = going.take() else { panic!("there is one") };
                    assert_eq!((run, usize::from(edges)), (number, told.len()));
                    assert_eq!(usize::from(late), told.iter().filter(|edge| edge.late).count());
                    assert_eq!(usize::from(lost), bench.board.captured.len() - told.len(), "lost {lost}");
                }
                (Report::RunStart { .. } | Report::Edges(_) | Report::RunEnd { .. }, _) => {
                    panic!("out of order: {:?}", bench.told)
                }
                _ => {}
            }
        }
        self.seen = bench.told.len();
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn whatever_happens_each_run_is_told_once_and_whole(
        start in prop_oneof![Just(0), Just(u32::MAX - 200_000), any::<u32>()],
        events in prop::collection::vec(events(), 1..60),
    ) {
        let mut bench = Bench::at(start);
        let mut host = Host::default();
        // The pulse of the run, and the turns of the loop since it began: the first learns of it.
        let (mut pulse, mut turns_high) = (0, 0);
        for event in events {
            match event {
                Event::Edges(edges, ticks, late) => {
                    for i in 0..edges {
                        bench.now = bench.now.wrapping_add(ticks / u32::from(edges));
                        bench.board.edge(bench.now, late && i > 0);
                    }
                }
                Event::Limit => bench.unit.limit_hit(bench.now, &mut bench.board),
                Event::Command(command) => {
                    let rises = bench.board.rose.len();
                    let answer = bench.command(command);
                    prop_assert_eq!(bench.board.rose.len(), rises, "a command triggers nothing");
                    let armed = matches!(answer, Report::Ack { .. });
                    if let (Command::Arm(settings), true) = (command, armed) {
                        prop_assert!(!bench.board.trigger);
                        pulse = ticks_from_ms(settings.trigger_ms);
                    }
                }
                Event::Garbled => {
                    let answer = bench.unit.command(Err(ProtoError::Empty), bench.now, &mut bench.board);
                    prop_assert_eq!(answer, Report::Nak { sequence: 0, reason: Refusal::Garbled });
                }
                Event::Tell => {
                    bench.tell();
                    host.listen(&bench);
                }
                Event::Turns(turns, ticks, free) => {
                    for _ in 0..turns {
                        if !free {
                            bench.free_at = bench.now.wrapping_add(20_000);
                        }
                        bench.turn(ticks);
                        host.listen(&bench);
                        turns_high = if bench.board.trigger { turns_high + 1 } else { 0 };
                        if turns_high > 1 {
                            let high = ticks_between(bench.board.rose[bench.board.rose.len() - 1], bench.now);
                            prop_assert!(high < pulse, "{high} of {pulse}");
                        }
                    }
                }
            }
        }
        // The end: time enough for a self-test, the longest quiet time, and the line.
        let idle_or_armed = |state| matches!(state, TimerState::Idle | TimerState::Armed);
        bench.free_at = bench.now;
        bench.pass(ticks_from_ms(1000));
        host.listen(&bench);
        prop_assert!(idle_or_armed(bench.unit.state()));
        prop_assert!(host.run.is_none());
        // The camera was triggered once in each run, and each pulse ended, not before its time.
        prop_assert_eq!(bench.board.rose.len(), host.runs);
        prop_assert_eq!(bench.board.fell.len(), host.runs);
        for (&rose, &fell) in bench.board.rose.iter().zip(&bench.board.fell) {
            prop_assert!(ticks_between(rose, fell) >= ticks_from_ms(1));
        }
        // And it is as ready as ever.
        bench.board.sensor = Level::High;
        bench.obey(arm(1, 1));
    }
}
