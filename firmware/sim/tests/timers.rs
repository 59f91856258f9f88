//! Timer interrupts keep time without drift.

mod common;

use slider_sim::{Pin, SimError, millis};

#[test]
fn compare_interrupts_come_at_their_periods_and_do_not_drift() -> Result<(), SimError> {
    let mut mcu = common::load("timers", &[]);
    let periods = [(Pin::D13, 16_000), (Pin::D12, 3200), (Pin::D11, 40_000)];
    for (pin, _) in periods {
        mcu.watch(pin);
    }
    mcu.run_for(millis(500))?;
    for (pin, period) in periods {
        let changes = mcu.changes(pin);
        let first = changes[0].cycle;
        assert!(changes.len() as u64 >= millis(500) / period - 1, "{pin:?}");
        for (n, change) in (0..).zip(changes) {
            // Other handlers run for some 50 cycles each, and an instruction lasts up to 4.
            let late = change.cycle as i64 - (first + n * period) as i64;
            assert!((-110..110).contains(&late), "{pin:?} {n} {late}");
        }
    }
    Ok(())
}

#[test]
fn an_entry_takes_the_hardwares_four_cycles() -> Result<(), SimError> {
    let mut mcu = common::load("timers", &[]);
    mcu.record_interrupts(true);
    mcu.watch(Pin::D13);
    mcu.run_for(millis(5))?;
    let run = *mcu.interrupts().runs().iter().find(|run| run.vector == 14).expect("TIMER0_COMPA");
    let toggle = mcu.changes(Pin::D13).iter().find(|change| change.cycle > run.entered).expect("a toggle").cycle;
    // 4 for the entry and 3 for the JMP of the table; then SBI 2 and RETI 4.
    assert_eq!((toggle - run.entered, run.left - run.entered), (7, 13), "{run:?}");
    Ok(())
}

#[test]
fn fast_pwm_with_top_in_ocra_overflows_once_a_period() -> Result<(), SimError> {
    let mut mcu = common::load("timers", &["FAST"]);
    mcu.watch(Pin::A0);
    mcu.watch(Pin::A1);
    mcu.run_for(millis(100))?;
    for pin in [Pin::A0, Pin::A1] {
        let changes = mcu.changes(pin);
        assert!(changes.len() as u64 >= millis(100) / 12_800 - 1, "{pin:?} {}", changes.len());
        for (n, change) in (0..).zip(changes) {
            let late = change.cycle as i64 - (changes[0].cycle + n * 12_800) as i64;
            assert!(late.abs() < 10, "{pin:?} {n} {late}");
        }
    }
    // The compare comes a tick behind OCR0B = 99, and the handler reads TCNT0 within the tick.
    assert_eq!(common::variable(&mcu, "count_max"), 100);
    Ok(())
}
