//! Input capture sees the injected edges in their own cycle.

mod common;

use slider_sim::{Mcu, Pin, SimError, millis};

/// Runs until the program has started Timer1, and gives the cycle at which TCNT1 was 0 (TCCR1B written).
fn started(mcu: &mut Mcu) -> Result<u64, SimError> {
    mcu.watch(Pin::D13);
    assert!(mcu.run_while(|mcu| mcu.changes(Pin::D13).is_empty(), millis(1))?);
    // STS, then SBI as the next instruction (two of them with PWM); the counter starts with the STS, which takes 2.
    Ok(mcu.changes(Pin::D13)[0].cycle - 2)
}

fn captured(mcu: &Mcu) -> Vec<(u32, bool)> {
    let count = usize::from(common::variable(mcu, "count"));
    let levels = common::bytes(mcu, "levels", count);
    let ticks = common::bytes(mcu, "ticks", 4 * count).chunks(4);
    let ticks = ticks.map(|tick| u32::from_le_bytes([tick[0], tick[1], tick[2], tick[3]]));
    ticks.zip(levels).map(|(tick, level)| (tick, *level != 0)).collect()
}

#[test]
fn captures_are_exact_across_overflows() -> Result<(), SimError> {
    for (define, prescaler) in [("PRESCALER=1", 1), ("PRESCALER=2", 8)] {
        let mut mcu = common::load("capture", &[define]);
        mcu.set(Pin::D8, true);
        let zero = started(&mut mcu)?;
        // Steps that visit every phase of the instructions, and edges around the first overflows.
        let mut edges: Vec<_> = (0..100).map(|i: u64| zero + 3000 + i * 12_345 + i * i).collect();
        edges.extend((15..25).map(|i| zero + i * 65_536 * prescaler + i * 200 - 4000));
        edges.sort_unstable();
        edges.dedup_by(|a, b| *a < *b + 300);
        mcu.play(Pin::D8, edges.iter().enumerate().map(|(i, cycle)| (*cycle, i % 2 == 1)));
        mcu.run_until(edges.last().expect("edges") + 1000)?;
        let seen = captured(&mcu);
        let asked: Vec<_> =
            (0..).zip(&edges).map(|(i, cycle)| (((cycle - zero) / prescaler) as u32, i % 2 == 1)).collect();
        assert_eq!(seen, asked, "prescaler {prescaler}");
    }
    Ok(())
}

#[test]
fn hardware_pwm_on_oc0b_comes_into_icp1_by_a_wire() -> Result<(), SimError> {
    let mut mcu = common::load("capture", &["PRESCALER=1", "PWM"]);
    mcu.wire(Pin::D5, Pin::D8);
    mcu.watch(Pin::D5);
    mcu.run_for(millis(40))?;
    let seen = captured(&mcu);
    assert!(seen.len() > 70, "{}", seen.len());
    // 100 of 250 ticks of 64 cycles, to the cycle.
    for pair in seen.windows(2) {
        let expected = if pair[0].1 { 6400 } else { 9600 };
        assert_eq!(pair[1].0 - pair[0].0, expected, "{pair:?}");
    }
    let pwm = mcu.pwm(Pin::D5);
    let last = pwm.last().expect("a wave");
    assert_eq!(last.duty, Some(0.4));
    assert!((last.frequency_hz - 1000.0).abs() < 1e-9);
    let widths: Vec<_> = mcu.changes(Pin::D5).windows(2).map(|pair| pair[1].cycle - pair[0].cycle).collect();
    assert!(widths[1..].iter().all(|width| [6400, 9600].contains(width)), "{widths:?}");
    Ok(())
}
