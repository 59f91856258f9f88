//! Resets are counted, sleep takes no real time, and a program that goes astray says so.

mod common;

use slider_sim::{Pin, SimError, micros, millis};
use std::time::{Duration, Instant};

#[test]
fn watchdog_resets_are_counted_and_time_goes_on() -> Result<(), SimError> {
    let mut mcu = common::load("watchdog", &[]);
    mcu.set(Pin::D8, true);
    mcu.watch(Pin::D13);
    let edges = (1..20).map(|i| (i * millis(5), i % 2 == 0));
    mcu.play(Pin::D8, edges);
    mcu.run_until(millis(100))?;
    assert_eq!(mcu.resets(), 2);
    assert_eq!(common::variable(&mcu, "starts"), 3);
    assert_eq!(common::variable(&mcu, "cause") & 8, 8, "WDRF");
    assert!((millis(100)..millis(100) + 5).contains(&mcu.cycle()));
    // 2048 cycles of 128 kHz, 16 ms, each; the pin falls when the reset releases it and rises when the program is back.
    let rises: Vec<_> = mcu.changes(Pin::D13).iter().filter(|change| change.level).map(|change| change.cycle).collect();
    assert_eq!(rises.len(), 3);
    for pair in rises.windows(2) {
        assert!((millis(16)..millis(16) + micros(20)).contains(&(pair[1] - pair[0])), "{rises:?}");
    }
    assert_eq!(mcu.delivered(Pin::D8).len(), 19, "the play outlives the resets");
    Ok(())
}

#[test]
fn sleep_passes_no_faster_or_slower_than_the_timers_and_takes_no_real_time() -> Result<(), SimError> {
    let mut mcu = common::load("stuck", &["WAY=0"]);
    let begun = Instant::now();
    mcu.run_for(millis(2000))?;
    assert!(begun.elapsed() < Duration::from_millis(1500), "{:?}", begun.elapsed());
    let overflows = mcu.interrupts().of("TIMER0_OVF").expect("a vector");
    // The timer was started some instructions after power-up: 256 cycles each.
    assert_eq!(overflows.runs, millis(2000) / 256 - 1);
    assert!(overflows.longest_latency <= 2, "{overflows:?}");
    Ok(())
}

#[test]
fn a_program_that_ends_badly_is_reported() {
    let run = |way: &str| common::load("stuck", &[way]).run_for(millis(10));
    assert!(matches!(run("WAY=1"), Err(SimError::Asleep { .. })));
    assert!(matches!(run("WAY=2"), Err(SimError::BadInstruction { opcode: 0x9414, .. })));
    assert!(matches!(run("WAY=3"), Err(SimError::Crashed { pc, .. }) if pc >= 0x7e00));
}

#[test]
fn what_is_no_program_is_refused() {
    let missing = slider_sim::Mcu::load("/no/such/file.elf".as_ref());
    assert!(matches!(missing, Err(SimError::Read { .. })));
    let text = slider_sim::Mcu::load(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml").as_ref());
    assert!(matches!(text, Err(SimError::Elf { .. })));
}
