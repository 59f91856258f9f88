//! The display shows what a driver from the data sheet writes, and reports the one time that is too short.

mod common;

use slider_sim::{
    Mcu, Pin, SimError,
    lcd::{Lcd, LcdPins, Rule},
    millis,
};

const PINS: LcdPins = LcdPins { rs: Pin::D12, e: Pin::D10, d: [Pin::D4, Pin::D5, Pin::D6, Pin::D7] };

fn run(define: &str) -> Result<(Mcu, Lcd), SimError> {
    let mut mcu = common::load("lcd", &[define]);
    let lcd = Lcd::new(PINS);
    lcd.watch(&mut mcu);
    assert!(mcu.run_while(|mcu| !mcu.level(Pin::D13), millis(40))?);
    Ok((mcu, lcd))
}

#[test]
fn a_patient_driver_shows_its_text_and_breaks_no_rule() -> Result<(), SimError> {
    let (mcu, mut lcd) = run("TOO_FAST=0")?;
    lcd.follow(&mcu);
    assert_eq!((lcd.text(0).as_str(), lcd.text(1).as_str()), ("Slider          ", "v=0.500 m/s     "));
    assert_eq!(lcd.violations(), []);
    assert!(lcd.controller().is_four_bits() && lcd.controller().is_on() && !lcd.controller().shows_cursor());
    Ok(())
}

#[test]
fn the_one_time_that_is_too_short_is_reported_with_its_length() -> Result<(), SimError> {
    let (mcu, mut lcd) = run("TOO_FAST=1")?;
    lcd.follow(&mcu);
    assert_eq!(lcd.violations().len(), 1, "{:?}", lcd.violations());
    let violation = lcd.violations()[0];
    assert_eq!((violation.rule, violation.needs_ns), (Rule::Execution, 1_520_000.0));
    // 1000 us and the 43 us that the driver waits after each byte.
    assert!((1_043_000.0..1_048_000.0).contains(&violation.took_ns), "{violation:?}");
    Ok(())
}

#[test]
fn following_online_comes_to_the_same_picture() -> Result<(), SimError> {
    let (mcu, mut afterwards) = run("TOO_FAST=1")?;
    afterwards.follow(&mcu);
    let mut mcu = common::load("lcd", &["TOO_FAST=1"]);
    let mut online = Lcd::new(PINS);
    online.watch(&mut mcu);
    while !mcu.level(Pin::D13) {
        mcu.run_for(777)?;
        online.follow(&mcu);
    }
    assert_eq!(online.text(0), afterwards.text(0));
    assert_eq!(online.violations(), afterwards.violations());
    Ok(())
}
