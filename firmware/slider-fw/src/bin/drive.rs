//! The motor drive: ten presets by remote or serial line, a display, and a limit switch that cuts the motor off.

#![no_std]
#![no_main]
#![feature(abi_avr_interrupt)]

use avr_device::atmega328p::Peripherals;
use avr_device::interrupt::CriticalSection;
use embedded_hal::digital::OutputPin;
use slider_fw::board::Pins;
use slider_fw::clock::{self, Clock};
use slider_fw::infrared::{self, Infrared};
use slider_fw::lcd::{Delay, Lcd};
use slider_fw::motor::{self, Motor};
use slider_fw::serial::{self, Serial};
use slider_fw::watchdog::{self, Watchdog};
use slider_proto::drive::DriveUnit;
use slider_proto::{Command, Decoder, DriveState, display};

// Lower numbers are served first: INT0 stops the motor before anything else is done.

#[avr_device::interrupt(atmega328p)]
fn INT0() {
    // SAFETY: an interrupt is served with interrupts off.
    motor::on_limit(unsafe { CriticalSection::new() });
}

#[avr_device::interrupt(atmega328p)]
fn INT1() {
    // SAFETY: an interrupt is served with interrupts off.
    infrared::on_change(unsafe { CriticalSection::new() });
}

#[avr_device::interrupt(atmega328p)]
fn TIMER1_OVF() {
    // SAFETY: an interrupt is served with interrupts off.
    clock::on_overflow(unsafe { CriticalSection::new() });
}

#[avr_device::interrupt(atmega328p)]
fn USART_RX() {
    // SAFETY: an interrupt is served with interrupts off.
    serial::on_byte(unsafe { CriticalSection::new() });
}

#[avr_device::entry]
fn main() -> ! {
    // SAFETY: this is the only call, before anything else runs.
    let (peripherals, pins) = unsafe { (Peripherals::steal(), Pins::take()) };
    // The motor's pins first: low, and outputs.
    let (enable, forward, reverse) = (pins.d11.into_output(), pins.a0.into_output(), pins.a1.into_output());
    let reset_cause = watchdog::take_reset_cause(&peripherals.CPU);
    let mut watchdog = Watchdog::start(&peripherals.WDT);
    let mut led = pins.d13.into_output();
    let clock = Clock::start(peripherals.TC1);
    let mut serial = Serial::open(peripherals.USART0, pins.d0, pins.d1);
    let interrupts = &peripherals.EXINT;
    let mut motor = Motor::new(peripherals.TC2, enable, forward, reverse, pins.d2.into_pull_up_input(), interrupts);
    let mut infrared = Infrared::new(pins.d3.into_pull_up_input(), interrupts);
    let data = (pins.d6.into_output(), pins.d7.into_output(), pins.d8.into_output(), pins.d9.into_output());
    let mut lcd = Lcd::new(pins.d4.into_output(), pins.d5.into_output(), data, Delay, clock.now());
    let mut decoder = Decoder::<Command>::default();
    let mut unit = DriveUnit::new(slider_fw::VERSION, reset_cause);
    // SAFETY: nothing is half set up any more.
    unsafe { avr_device::interrupt::enable() };

    loop {
        watchdog.feed();
        serial.poll();
        let now = clock.now();
        if let Some(tick) = motor.take_hit() {
            unit.limit_hit(tick, &mut motor);
        }
        if let Some(key) = infrared.key() {
            unit.key(key, now, &mut motor);
        }
        unit.step(now, &mut motor);
        if serial.is_free() {
            // A command is read only when its answer can be sent.
            let answer =
                serial.read().and_then(|byte| decoder.push(byte)).map(|frame| unit.command(frame, now, &mut motor));
            if let Some(report) = answer.or_else(|| unit.report(&motor)) {
                serial.send(&report);
            }
        }
        lcd.poll(now, &display::text(&unit));
        let Ok(()) = led.set_state((unit.state() != DriveState::Stopped).into());
    }
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    avr_device::interrupt::disable();
    motor::cut();
    // The watchdog resets the board.
    loop {
        avr_device::asm::nop();
    }
}
