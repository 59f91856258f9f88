//! What the timers do to their pins, by duty and by edge.

mod common;

use slider_sim::{Change, Pin, SimError, millis};

/// Share of high time between two cycles.
fn high_share(changes: &[Change], from: u64, to: u64) -> f64 {
    let mut high = 0;
    let mut last = (from, false);
    for change in changes.iter().filter(|change| change.cycle < to) {
        if change.cycle <= from {
            last = (from, change.level);
            continue;
        }
        high += if last.1 { change.cycle - last.0 } else { 0 };
        last = (change.cycle, change.level);
    }
    high += if last.1 { to - last.0 } else { 0 };
    high as f64 / (to - from) as f64
}

#[test]
fn duties_and_frequencies_are_those_of_the_registers_and_of_the_edges() -> Result<(), SimError> {
    let mut mcu = common::load("pwm", &[]);
    mcu.watch(Pin::D11);
    mcu.run_for(millis(4))?;
    let pwm = mcu.pwm(Pin::D11);
    let duties: Vec<_> = pwm.iter().map(|change| change.duty.map(|duty| (duty * 255.0).round())).collect();
    // The first 1 is the moment between TCCR2A and TCCR2B, when the output stands at its level.
    let waves = [Some(51.0), Some(204.0), Some(0.0), Some(255.0), Some(102.0), None];
    assert_eq!(duties[1..7], waves, "{pwm:?}");
    let edges = mcu.changes(Pin::D11);
    for pair in pwm[1..6].windows(2) {
        let [now, next] = pair else { unreachable!() };
        // Whole periods of 510 cycles from the middle of one on, where the edges have settled.
        let periods = (next.cycle - now.cycle) / 510 - 1;
        let from = now.cycle + 255;
        let share = high_share(edges, from, from + periods * 510);
        assert!((share - now.duty.unwrap()).abs() < 1e-12, "{now:?} {share}");
    }
    assert_eq!(pwm[1].frequency_hz, 16e6 / 510.0);
    assert_eq!(pwm[3].frequency_hz, 0.0, "a steady level");
    let fast = pwm.iter().rev().find(|change| change.frequency_hz > 0.0).unwrap();
    assert_eq!((fast.duty, fast.frequency_hz), (Some(0.75), 16e6 / 8.0 / 256.0));
    let share = high_share(edges, fast.cycle + 2048, fast.cycle + 3 * 2048);
    assert!((share - 0.75).abs() < 1e-12, "{share}");
    Ok(())
}

#[test]
fn a_new_duty_counts_from_the_next_top_on() -> Result<(), SimError> {
    let mut mcu = common::load("pwm", &[]);
    mcu.run_for(millis(4))?;
    let pwm = mcu.pwm(Pin::D11);
    for pair in pwm[2..6].windows(2) {
        assert_eq!((pair[1].cycle - pair[0].cycle) % 510, 0, "updates come at TOP");
    }
    Ok(())
}

#[test]
fn a_cut_is_exact_to_the_instruction() -> Result<(), SimError> {
    let mut mcu = common::load("pwm", &[]);
    mcu.watch(Pin::D11);
    mcu.watch(Pin::D13);
    mcu.run_for(millis(4))?;
    let pwm = mcu.pwm(Pin::D11);
    let cuts: Vec<_> = pwm.iter().filter(|change| change.duty.is_none()).map(|change| change.cycle).collect();
    let led = mcu.changes(Pin::D13);
    // SBI, 2 cycles, stands before the first cut; CBI, 2 cycles, is the second, and LDI and OUT follow it.
    assert_eq!(cuts[0], led[0].cycle + 2);
    assert!((2..=4).contains(&(led[1].cycle - cuts[1])), "{cuts:?} {led:?}");
    let edges = mcu.changes(Pin::D11);
    let quiet = edges.iter().find(|edge| edge.cycle > cuts[0]).expect("the second wave");
    assert!(quiet.cycle - cuts[0] > 200 * 16, "PORT holds the pin low");
    assert!(edges.iter().all(|edge| edge.cycle <= cuts[1]), "a released pin is left alone");
    assert!(!mcu.level(Pin::D11) || !mcu.is_output(Pin::D11));
    Ok(())
}
