//! Pins keep their times, idle levels and latched flags.

mod common;

use slider_sim::{Mcu, Pin, SimError, millis};

#[test]
fn output_edges_are_where_the_instructions_put_them() -> Result<(), SimError> {
    let mut mcu = common::load("pins", &[]);
    mcu.watch(Pin::D13);
    mcu.run_for(millis(1))?;
    let changes = mcu.changes(Pin::D13);
    let start = changes[0].cycle;
    let seen: Vec<_> = changes.iter().map(|change| (change.cycle - start, change.level)).collect();
    // SBI 2 + 3 NOP; CBI 2; SBI on PIN 2. Released at low it stays there.
    assert_eq!(seen, [(0, true), (5, false), (7, true), (9, false)]);
    Ok(())
}

#[test]
fn a_released_pin_falls_back_to_its_outside_level_or_pull_up() -> Result<(), SimError> {
    let mut driven = common::load("pins", &[]);
    driven.set(Pin::A0, false);
    driven.watch(Pin::A0);
    driven.run_for(millis(1))?;
    assert!(!driven.level(Pin::A0) && !driven.is_output(Pin::A0));
    assert_eq!(driven.changes(Pin::A0).len(), 2, "high and low as an output, then low from outside");
    let mut open = common::load("pins", &[]);
    open.run_for(millis(1))?;
    assert!(open.level(Pin::A0), "the pull-up");
    Ok(())
}

#[test]
fn an_edge_while_int0_is_off_is_latched_once_and_cleared_by_writing_one() -> Result<(), SimError> {
    let mut mcu = common::load("pins", &[]);
    mcu.set(Pin::D2, true);
    mcu.set(Pin::D7, false);
    let ready = |mcu: &Mcu| !(mcu.is_output(Pin::D12) && mcu.level(Pin::D12));
    assert!(mcu.run_while(ready, millis(10))?);
    let now = mcu.cycle();
    mcu.play(Pin::D2, [(now + 100, false), (now + 200, true), (now + 300, false), (now + 400, true)]);
    mcu.play(Pin::D7, [(now + 1000, true)]);
    assert!(mcu.run_while(|mcu| mcu.level(Pin::D12), millis(10))?);
    assert_eq!(common::variable(&mcu, "flag_before"), 1);
    assert_eq!(common::variable(&mcu, "int0_runs"), 1, "one flag for two edges");
    assert_eq!(common::variable(&mcu, "flag_after"), 0);
    let now = mcu.cycle();
    mcu.play(Pin::D2, [(now + 100, false), (now + 200, true)]);
    mcu.play(Pin::D7, [(now + 1000, false)]);
    assert!(mcu.run_while(|mcu| !mcu.level(Pin::D12), millis(10))?);
    assert_eq!(common::variable(&mcu, "flag_before"), 0x11, "latched again");
    assert_eq!(common::variable(&mcu, "int0_runs"), 1, "but cleared before INT0 was on");
    assert_eq!(mcu.interrupts().of("INT0").map(|int0| int0.runs), Some(1));
    Ok(())
}

#[test]
fn thousands_of_edges_on_several_pins_arrive_in_order() -> Result<(), SimError> {
    let mut mcu = common::load("pins", &[]);
    let start = mcu.cycle() + 1000;
    for (pin, step) in [(Pin::D8, 37), (Pin::A1, 101)] {
        mcu.play(pin, (0..5000).map(|i| (start + i * step, i % 2 == 0)));
    }
    mcu.run_until(start + 5000 * 101)?;
    for (pin, step) in [(Pin::D8, 37), (Pin::A1, 101)] {
        let delivered = mcu.delivered(pin);
        assert_eq!(delivered.len(), 5000);
        for (i, edge) in (0..).zip(delivered) {
            assert_eq!((edge.asked, edge.level), (start + i * step, i % 2 == 0));
            // The longest instructions of the program are RET and CALL with 4 cycles.
            assert!((edge.asked..edge.asked + 5).contains(&edge.cycle), "{edge:?}");
        }
        assert!(!mcu.is_playing(pin));
    }
    Ok(())
}

#[test]
fn the_stack_mark_counts_frames_and_return_addresses() -> Result<(), SimError> {
    let mut mcu = common::load("pins", &[]);
    assert_eq!(mcu.stack_high_water(), 0x8ff - mcu.symbol("_end").map_or(0, |end| end as usize) + 1 - free(&mcu));
    mcu.run_for(millis(1))?;
    let mark = mcu.stack_high_water();
    // 100 bytes of locals; at most main's and the callee's saved registers and two return addresses besides.
    assert!((104..=124).contains(&mark), "{mark}");
    Ok(())
}

/// Bytes of paint left.
fn free(mcu: &Mcu) -> usize {
    mcu.memory()[mcu.symbol("_end").map_or(0, |end| end as usize)..].len()
}

#[test]
fn cores_run_in_threads_side_by_side() -> Result<(), SimError> {
    let runs: Vec<_> = (0..4)
        .map(|_| {
            let mut mcu = common::load("pins", &[]);
            mcu.watch(Pin::D13);
            std::thread::spawn(move || mcu.run_for(millis(20)).map(|()| (mcu.changes(Pin::D13).to_vec(), mcu.pc())))
        })
        .collect();
    let mut results = Vec::new();
    for run in runs {
        results.push(run.join().expect("no panic")?);
    }
    assert!(results.windows(2).all(|pair| pair[0].0 == pair[1].0));
    Ok(())
}

#[test]
fn an_interrupt_is_asked_for_in_the_cycle_of_its_edge() -> Result<(), SimError> {
    let mut mcu = common::load("pins", &[]);
    mcu.set(Pin::D2, true);
    mcu.play(Pin::D7, [(millis(1), true), (millis(2), false)]);
    mcu.run_until(millis(3))?;
    mcu.record_interrupts(true);
    let falls: Vec<_> = (0..200).map(|i| millis(3) + 1000 + i * 401).collect();
    mcu.play(Pin::D2, falls.iter().flat_map(|fall| [(*fall, false), (fall + 150, true)]));
    mcu.run_until(millis(10))?;
    let runs = mcu.interrupts().runs();
    assert_eq!(runs.len(), 200);
    for (run, fall) in runs.iter().zip(&falls) {
        assert_eq!(run.requested, *fall);
        // The program waits in a jump of 2 cycles.
        assert!(run.entered - fall <= 1, "{run:?}");
    }
    assert!(mcu.interrupts().of("INT0").is_some_and(|int0| int0.longest_latency <= 300));
    Ok(())
}
