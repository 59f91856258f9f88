//! The encoder timer's real ELF file.

#![allow(clippy::expect_used, clippy::panic, clippy::cast_precision_loss, clippy::cast_possible_truncation)]

mod rig;

use rig::{Board, CYCLES_PER_MS, CYCLES_PER_TICK, Run};
use slider_proto::{ArmSettings, Command, EndReason, Level, Refusal, Report, TICK_HZ, TimerState, Unit};
use slider_sim::Pin;
use slider_sim::encoder::{Encoder, Motion, bounce, edges, glitches};

const HZ: f64 = slider_sim::CYCLES_PER_SECOND as f64;
/// Cycles from one wrap of the 16-bit counter to the next.
const WRAP: u64 = 65_536 * CYCLES_PER_TICK;
/// Cycles from the start of `sbi` until its pin moves.
const SBI: u64 = 2;

/// Thirteen teeth of unequal width, 8 mm from tooth to tooth on average.
fn rail() -> Encoder {
    Encoder::uneven(13, 0.004, 2026)
}

fn constant(speed_m_s: f64) -> Motion {
    Motion::Constant { speed_m_s }
}

fn from_rest(acceleration_m_s2: f64) -> Motion {
    Motion::Accelerated { start_m_s: 0.0, acceleration_m_s2 }
}

/// Largest difference of a reported time from the injected one, both from the first edge, in cycles.
fn worst_error(run: &Run, wave: &[(u64, bool)]) -> u64 {
    assert_eq!(run.edges.len(), wave.len(), "edges");
    let first = run.edges[0].tick;
    let mut worst = 0;
    for (edge, &(cycle, high)) in run.edges.iter().zip(wave) {
        assert_eq!(edge.level == Level::High, high, "level of the edge at cycle {cycle}");
        let ticks = u64::from(edge.tick.wrapping_sub(first));
        worst = worst.max((ticks * CYCLES_PER_TICK).abs_diff(cycle - wave[0].0));
    }
    worst
}

/// Cycle at which the counter was 0, by a first run; it wraps every [`WRAP`] cycles from there.
fn zero_of_the_counter(timer: &mut Board) -> u64 {
    timer.arm(0, 1, 3);
    let start = timer.mcu.cycle() + 1000;
    let run = timer.pass(&[(start, false), (start + 800, true)]);
    start - u64::from(run.edges[0].tick) * CYCLES_PER_TICK
}

#[test]
fn a_hello_comes_at_reset() {
    let mut timer = Board::timer();
    let hello = timer.wait(|report| matches!(report, Report::Hello { .. }), 20);
    let Report::Hello { unit, firmware, tick_hz, reset_cause } = hello else { unreachable!() };
    assert_eq!((unit, tick_hz), (Unit::Timer, TICK_HZ));
    assert_eq!(firmware, [0, 1, 0]);
    assert_eq!(reset_cause, 1, "power-on");
    assert!(timer.errors.is_empty());
}

#[test]
fn all_edges_of_thirteen_teeth_are_within_one_tick() {
    println!("motion                    edges  worst error");
    for (name, motion) in [
        ("0.17 m/s", constant(0.17)),
        ("0.67 m/s", constant(0.67)),
        ("2.00 m/s", constant(2.0)),
        ("0.35 m/s2 from rest", from_rest(0.35)),
        ("2.46 m/s2 from rest", from_rest(2.46)),
    ] {
        let mut timer = Board::timer();
        timer.run_ms(3);
        timer.arm(1, 10, 300);
        let wave = edges(&rail(), &motion, timer.mcu.cycle() + 12_345, HZ);
        let run = timer.pass(&wave);
        assert_eq!((run.late, run.lost, run.reason), (0, 0, EndReason::Quiet));
        let worst = worst_error(&run, &wave);
        println!("{name:<24}  {:>5}  {worst} cycles, {:.3} us", run.edges.len(), worst as f64 / 16.0);
        assert!(worst <= CYCLES_PER_TICK, "{name}: {worst} cycles");
    }
}

/// Each run puts one of its edges at a chosen distance from a wrap of the 16-bit counter.
#[test]
fn five_hundred_runs_across_the_wrap_are_right() {
    let mut timer = Board::timer();
    timer.run_ms(3);
    let zero = zero_of_the_counter(&mut timer);
    let mut worst = 0;
    for n in 0..500u64 {
        timer.arm(n as u16, 1, 3);
        // 13 teeth at some 60 m/s: 26 edges in 1.7 ms.
        let rail = edges(&rail(), &constant(60.0), 0, HZ);
        let (edge, offset) = (n as usize % rail.len(), (n / 26) as i64 * 11 - 110);
        let now = timer.mcu.cycle() - zero;
        // Late enough for the edges before the wrap.
        let wrap = (now + 40_000).div_ceil(WRAP) * WRAP + zero;
        let start = (wrap - rail[edge].0).checked_add_signed(offset).expect("after reset");
        let wave: Vec<_> = rail.iter().map(|&(cycle, level)| (cycle + start, level)).collect();
        let run = timer.pass(&wave);
        assert_eq!((run.number, run.late, run.lost), (n as u16, 0, 0));
        let error = worst_error(&run, &wave);
        assert!(error <= CYCLES_PER_TICK, "run {n}: {error} cycles");
        worst = worst.max(error);
    }
    println!("500 runs across the wrap: worst error {worst} cycles");
}

#[test]
fn the_trigger_is_raised_within_five_microseconds() {
    let mut timer = Board::timer();
    timer.run_ms(3);
    let mut latencies = Vec::new();
    for n in 0..200u64 {
        timer.arm(n as u16, 1, 2);
        // At every phase of the main loop, and with bytes of a command coming in.
        let start = timer.mcu.cycle() + 3000 + n * 37;
        timer.mcu.send(&[0x55; 3]);
        timer.mcu.play(Pin::D8, [(start, false), (start + 1600, true)]);
        timer.run_until(start + 2000);
        let raised = timer.mcu.changes(Pin::D9).last().copied().expect("a trigger");
        assert!(raised.level);
        latencies.push(raised.cycle + SBI - start);
        timer.mcu.send(&[0]);
        timer.wait(|report| matches!(report, Report::RunEnd { .. }), 50);
        timer.run_ms(2);
        timer.reports.clear();
    }
    let (min, max) = (latencies.iter().min().expect("runs"), latencies.iter().max().expect("runs"));
    let mean = latencies.iter().sum::<u64>() as f64 / 200.0;
    let variance = latencies.iter().map(|&l| (l as f64 - mean).powi(2)).sum::<f64>() / 199.0;
    println!(
        "first edge to trigger, 200 runs: {min} to {max} cycles ({:.2} to {:.2} us), mean {:.2} us, jitter (1 s) {:.3} us",
        *min as f64 / 16.0,
        *max as f64 / 16.0,
        mean / 16.0,
        variance.sqrt() / 16.0
    );
    assert!(*max <= 80, "{max} cycles");
}

/// The overflow interrupt is the longest thing that can be in the way.
#[test]
fn the_trigger_is_in_time_when_the_counter_wraps() {
    let mut timer = Board::timer();
    timer.run_ms(3);
    let zero = zero_of_the_counter(&mut timer);
    let mut worst = 0;
    for offset in 0..60 {
        timer.arm(offset, 1, 2);
        let wrap = (timer.mcu.cycle() - zero + 2000).div_ceil(WRAP) * WRAP + zero;
        let start = wrap + u64::from(offset) - 10;
        timer.mcu.play(Pin::D8, [(start, false), (start + 1600, true)]);
        timer.run_until(start + 2000);
        let raised = timer.mcu.changes(Pin::D9).last().copied().expect("a trigger");
        worst = worst.max(raised.cycle + SBI - start);
        timer.wait(|report| matches!(report, Report::RunEnd { .. }), 50);
    }
    println!("first edge to trigger at a wrap of the counter: at most {worst} cycles ({:.2} us)", worst as f64 / 16.0);
    assert!(worst > 20, "the overflow was not met");
    assert!(worst <= 80, "{worst} cycles");
}

#[test]
fn the_trigger_pulse_has_its_length_and_comes_once() {
    let mut timer = Board::timer();
    timer.run_ms(3);
    timer.arm(1, 25, 60);
    let before = timer.mcu.changes(Pin::D9).len();
    let wave = edges(&rail(), &constant(2.0), timer.mcu.cycle() + 5000, HZ);
    timer.pass(&wave);
    let pulse = &timer.mcu.changes(Pin::D9)[before..];
    assert_eq!(pulse.iter().map(|change| change.level).collect::<Vec<_>>(), [true, false]);
    let length = pulse[1].cycle - pulse[0].cycle;
    assert!((25 * CYCLES_PER_MS..26 * CYCLES_PER_MS).contains(&length), "{length} cycles");
}

#[test]
fn the_trigger_stays_low_without_a_run() {
    let mut timer = Board::timer();
    let at = |cycle: u64| edges(&rail(), &constant(2.0), cycle, HZ);
    timer.mcu.play(Pin::D8, at(CYCLES_PER_MS));
    timer.run_ms(100);
    assert!(timer.mcu.changes(Pin::D9).iter().all(|change| !change.level), "before it was armed");
    timer.arm(1, 5, 20);
    timer.order(Command::Stop);
    let start = timer.mcu.cycle() + 100;
    timer.mcu.play(Pin::D8, at(start));
    timer.run_ms(100);
    assert!(timer.mcu.changes(Pin::D9).iter().all(|change| !change.level), "after it was stopped");
    assert!(!timer.reports.iter().any(|(_, report)| matches!(report, Report::RunStart { .. } | Report::Edges(_))));
}

#[test]
fn a_burst_of_edges_12_us_apart_survives() {
    for phase in 0..40 {
        let mut timer = Board::timer();
        timer.run_ms(3);
        timer.arm(1, 1, 10);
        let start = timer.mcu.cycle() + 2000 + phase * 7;
        let wave: Vec<_> = (0..26).map(|i| (start + i * 192, i % 2 == 1)).collect();
        let run = timer.pass(&wave);
        assert_eq!((run.late, run.lost), (0, 0), "phase {phase}");
        assert!(worst_error(&run, &wave) <= CYCLES_PER_TICK);
        timer.check_stack();
    }
}

#[test]
fn seven_hundred_edges_a_second_for_ten_seconds_are_all_there() {
    let mut timer = Board::timer();
    timer.run_ms(3);
    timer.arm(1, 100, 50);
    let start = timer.mcu.cycle() + 5000;
    // 700 edges/s, each moved by up to 0.2 ms.
    let wave: Vec<_> = (0..7000u64).map(|i| (start + i * 22_857 + i * i % 3200, i % 2 == 1)).collect();
    let run = timer.pass(&wave);
    assert_eq!((run.late, run.lost, run.reason), (0, 0, EndReason::Quiet));
    assert!(worst_error(&run, &wave) <= CYCLES_PER_TICK);
    timer.check_stack();
}

#[test]
fn too_many_edges_set_the_overrun_and_leave_a_right_beginning() {
    let mut timer = Board::timer();
    timer.run_ms(3);
    timer.arm(1, 1, 50);
    let start = timer.mcu.cycle() + 5000;
    // 20 000 edges/s for half a second.
    let wave: Vec<_> = (0..10_000u64).map(|i| (start + i * 800, i % 2 == 1)).collect();
    let run = timer.pass(&wave);
    assert!(run.lost > 0, "no overrun flag");
    assert_eq!(run.reason, EndReason::Overrun);
    // The ring holds 64, and some are sent meanwhile.
    assert!(run.edges.len() > 64 && run.edges.len() < 200, "{} edges", run.edges.len());
    assert!(worst_error(&run, &wave[..run.edges.len()]) <= CYCLES_PER_TICK);
    // The next run is as good as any.
    timer.run_ms(500);
    timer.arm(2, 1, 10);
    let wave = edges(&rail(), &constant(2.0), timer.mcu.cycle() + 5000, HZ);
    let run = timer.pass(&wave);
    assert_eq!((run.edges.len(), run.lost), (26, 0));
}

#[test]
fn a_broken_tooth_and_a_turned_back_rail_are_told_as_they_are() {
    let broken = edges(&rail().missing_tooth(5), &constant(0.67), 0, HZ);
    assert_eq!(broken.len(), 24);
    let turned = edges(&rail(), &Motion::Reversed { start_m_s: 0.6, deceleration_m_s2: 3.0 }, 0, HZ);
    assert!(turned.len() > 26 && turned.len() < 52, "it turns on the way: {}", turned.len());
    for wave in [broken, turned] {
        let mut timer = Board::timer();
        timer.run_ms(3);
        timer.arm(1, 10, 200);
        let start = timer.mcu.cycle() + 5000;
        let wave: Vec<_> = wave.iter().map(|&(cycle, level)| (cycle + start, level)).collect();
        let run = timer.pass(&wave);
        assert_eq!((run.late, run.lost), (0, 0));
        assert!(worst_error(&run, &wave) <= CYCLES_PER_TICK);
    }
}

#[test]
fn bounces_and_glitches_are_edges_too_and_shift_no_other() {
    let clean = edges(&rail(), &constant(0.67), 0, HZ);
    // Pulses of 12 us at random, and bursts behind every edge whose pulses may be far shorter than the interrupt.
    let dirty = [glitches(&clean, 20, 192, 3), bounce(&clean, 2, 16_000, 5)];
    for wave in dirty {
        let mut timer = Board::timer();
        timer.run_ms(3);
        timer.arm(1, 10, 200);
        let start = timer.mcu.cycle() + 5000;
        let wave: Vec<_> = wave.iter().map(|&(cycle, level)| (cycle + start, level)).collect();
        let run = timer.pass(&wave);
        assert_eq!((run.edges.len(), run.lost), (wave.len(), 0));
        let zero = run.edges[0].tick;
        for (edge, &(cycle, high)) in run.edges.iter().zip(&wave) {
            assert_eq!(edge.level == Level::High, high);
            let error = i64::from(edge.tick.wrapping_sub(zero)) * 8 - (cycle - wave[0].0) as i64;
            // A late edge is given the time at which it was found.
            let most = if edge.late { 250 } else { 8 };
            assert!((-8..=most).contains(&error), "{error} cycles at {cycle}, late: {}", edge.late);
        }
    }
}

#[test]
fn pulses_shorter_than_the_interrupt_are_told_as_late() {
    for width in [8, 16, 32, 48, 64, 96, 128] {
        let mut timer = Board::timer();
        timer.run_ms(3);
        timer.arm(1, 10, 20);
        let start = timer.mcu.cycle() + 5000;
        let wave = [(start, false), (start + width, true), (start + 40_000, false), (start + 80_000, true)];
        let run = timer.pass(&wave);
        assert_eq!((run.edges.len(), run.lost), (4, 0), "width {width}");
        assert_eq!(run.late, u16::from(run.edges[1].late));
        let length = u64::from(run.edges[1].tick - run.edges[0].tick) * 8;
        let most = if run.edges[1].late { width + 200 } else { width + 8 };
        assert!((width.saturating_sub(8)..=most).contains(&length), "width {width}: {length} cycles");
        // What comes after is exact again.
        assert!((u64::from(run.edges[3].tick - run.edges[2].tick) * 8).abs_diff(40_000) <= 8);
    }
}

#[test]
fn the_end_of_travel_ends_the_run() {
    let mut timer = Board::timer();
    timer.run_ms(3);
    timer.arm(1, 10, 1000);
    let start = timer.mcu.cycle() + 5000;
    let wave = edges(&rail(), &constant(0.67), start, HZ);
    let end = wave[25].0 + CYCLES_PER_MS;
    // A pulse too short to be seen but by the hardware's flag.
    timer.mcu.play(Pin::D2, [(end, false), (end + 40, true)]);
    let run = timer.pass(&wave);
    assert_eq!((run.edges.len(), run.reason), (26, EndReason::Limit));
    assert!(timer.mcu.cycle() < end + 30 * CYCLES_PER_MS, "it did not wait for the quiet");
    let Report::LimitHit { tick } = timer.wait(|report| matches!(report, Report::LimitHit { .. }), 1) else {
        unreachable!()
    };
    let late = (i64::from(tick - run.edges[0].tick) * 8) - (end - wave[0].0) as i64;
    assert!((0..5 * CYCLES_PER_MS as i64).contains(&late), "{late} cycles");
}

#[test]
fn what_cannot_be_done_is_refused() {
    let mut timer = Board::timer();
    timer.run_ms(3);
    let arm = Command::Arm(ArmSettings { run: 1, trigger_ms: 10, quiet_ms: 100 });
    let reason = |report| if let Report::Nak { reason, .. } = report { Some(reason) } else { None };
    assert_eq!(reason(timer.ask(Command::Go { index: 3 })), Some(Refusal::NotMine));
    let no_pulse = Command::Arm(ArmSettings { run: 1, trigger_ms: 0, quiet_ms: 100 });
    assert_eq!(reason(timer.ask(no_pulse)), Some(Refusal::OutOfRange));
    timer.mcu.set(Pin::D8, false);
    assert_eq!(reason(timer.ask(arm)), Some(Refusal::SensorBlocked));
    assert!(timer.mcu.changes(Pin::D9).iter().all(|change| !change.level), "no trigger");
    timer.mcu.set(Pin::D8, true);
    timer.order(arm);
    timer.mcu.set(Pin::D8, false);
    timer.run_ms(20);
    assert_eq!(reason(timer.ask(arm)), Some(Refusal::Busy));
    assert_eq!(reason(timer.ask(Command::SelfTest)), Some(Refusal::Busy));
    timer.order(Command::Stop);
    timer.wait(|report| matches!(report, Report::RunEnd { reason: EndReason::Stopped, edges: 1, .. }), 50);
}

#[test]
fn a_damaged_command_is_refused_and_the_next_one_obeyed() {
    let mut timer = Board::timer();
    timer.run_ms(3);
    timer.mcu.send(&[9, 1, 2, 3, 4, 5, 6, 7, 8, 0]);
    timer.wait(|report| matches!(report, Report::Nak { sequence: 0, reason: Refusal::Garbled }), 20);
    timer.order(Command::Status);
    let status = timer.wait(|report| matches!(report, Report::Status { .. }), 20);
    let expected = Report::Status { state: TimerState::Idle, run: 0, edges: 0, sensor: Level::High, limit: false };
    assert_eq!(status, expected);
    timer.arm(1, 10, 100);
}

#[test]
fn the_self_test_finds_its_wire_and_its_lack() {
    let mut timer = Board::timer();
    timer.run_ms(3);
    timer.order(Command::SelfTest);
    let result = timer.wait(|report| matches!(report, Report::SelfTest { .. }), 200);
    assert_eq!(result, Report::SelfTest { edges: 0, worst_error_ticks: 0 }, "without the wire");
    timer.mcu.wire(Pin::D5, Pin::D8);
    timer.order(Command::SelfTest);
    let result = timer.wait(|report| matches!(report, Report::SelfTest { .. }), 200);
    let Report::SelfTest { edges, worst_error_ticks } = result else { unreachable!() };
    assert_eq!(edges, 26);
    assert!(worst_error_ticks <= 1, "{worst_error_ticks} ticks");
    assert!(timer.mcu.changes(Pin::D9).iter().all(|change| !change.level), "no trigger");
}

#[test]
fn the_led_is_on_from_arming_to_the_end() {
    let mut timer = Board::timer();
    timer.run_ms(3);
    assert!(!timer.mcu.level(Pin::D13));
    timer.arm(1, 1, 10);
    assert!(timer.mcu.level(Pin::D13));
    let wave = edges(&rail(), &constant(2.0), timer.mcu.cycle() + 5000, HZ);
    timer.pass(&wave);
    timer.run_ms(1);
    assert!(!timer.mcu.level(Pin::D13));
}

#[test]
fn a_hung_timer_is_reset_by_its_watchdog() {
    let mut timer = Board::timer();
    timer.run_ms(1000);
    assert_eq!(timer.mcu.resets(), 0, "a timer that is alive is left alone");
    timer.reports.clear();
    timer.mcu.jump("__stop_program").expect("the endless loop at the end of every program");
    timer.run_ms(400);
    assert_eq!(timer.mcu.resets(), 1);
    let watchdog = 1 << 3;
    timer.wait(|report| matches!(report, Report::Hello { reset_cause, .. } if *reset_cause == watchdog), 50);
}

/// The figures of the README.
#[test]
fn interrupts_are_as_short_as_documented() {
    let mut timer = Board::timer();
    timer.run_ms(3);
    timer.arm(1, 10, 60);
    let start = timer.mcu.cycle() + 5000;
    let wave: Vec<_> = (0..400u64).map(|i| (start + i * 16_000 + i * i % 700, i % 2 == 1)).collect();
    timer.mcu.play(Pin::D8, wave);
    for _ in 0..20 {
        timer.ask(Command::Status);
    }
    timer.wait(|report| matches!(report, Report::RunEnd { .. }), 1000);
    for interrupt in timer.mcu.interrupts().iter().filter(|interrupt| interrupt.runs > 0) {
        println!(
            "{:<12} {:>5} runs, at most {:>3} cycles ({:>4.1} us), begun at most {:>3} cycles after its request",
            interrupt.name(),
            interrupt.runs,
            interrupt.longest_run,
            interrupt.longest_run as f64 / 16.0,
            interrupt.longest_latency
        );
        // A burst at 192 cycles an edge needs the longest one to be shorter than that.
        assert!(interrupt.longest_run < 192, "{}", interrupt.name());
    }
    println!("stack: {} bytes used", timer.mcu.stack_high_water());
}
