//! The encoder timer: stamps the edges of a toothed sheet and triggers the camera on the first tooth.

#![no_std]
#![no_main]
#![feature(abi_avr_interrupt, asm_experimental_arch)]

use core::arch::naked_asm;

use avr_device::atmega328p::Peripherals;
use avr_device::interrupt::CriticalSection;
use embedded_hal::digital::OutputPin;
use slider_fw::board::Pins;
use slider_fw::capture::{self, Capture};
use slider_fw::clock::{self, Clock};
use slider_fw::serial::{self, Serial};
use slider_fw::watchdog::{self, Watchdog};
use slider_proto::timer::TimerUnit;
use slider_proto::{Command, Decoder, TimerState};

/// The vector of `TIMER1_CAPT`: raises D9 if armed, then stamps the edge.
///
/// Neither `sbic` nor `sbi` changes a register or a flag, so nothing has to be saved before them.
#[unsafe(naked)]
#[unsafe(no_mangle)]
extern "C" fn __vector_10() {
    // 0x1e is GPIOR0, whose bit 0 says that it is armed; 0x05 is PORTB, whose bit 1 is D9. The two words are a `jmp`,
    // which the assembler behind this macro does not know that the chip has.
    naked_asm!("sbic 0x1e, 0", "sbi 0x05, 1", ".word 0x940c", ".word pm({})", sym capture::on_capture)
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
    let reset_cause = watchdog::take_reset_cause(&peripherals.CPU);
    let mut watchdog = Watchdog::start(&peripherals.WDT);
    let mut led = pins.d13.into_output();
    let clock = Clock::start(peripherals.TC1);
    let mut serial = Serial::open(peripherals.USART0, pins.d0, pins.d1);
    let mut capture = Capture::new(
        pins.d8.into_pull_up_input(),
        pins.d9.into_output(),
        pins.d2.into_pull_up_input(),
        pins.d5.into_output(),
        peripherals.TC0,
        &peripherals.EXINT,
    );
    let mut decoder = Decoder::<Command>::default();
    let mut unit = TimerUnit::new(slider_fw::VERSION, reset_cause);
    // SAFETY: nothing is half set up any more.
    unsafe { avr_device::interrupt::enable() };

    loop {
        watchdog.feed();
        serial.poll();
        let now = clock.now();
        if capture.take_limit(&peripherals.EXINT) {
            unit.limit_hit(now, &mut capture);
        }
        unit.step(now, &mut capture);
        // While the first tooth is awaited, nothing may delay the trigger that need not.
        serial.interrupt(unit.state() != TimerState::Armed);
        if serial.is_free() {
            // A command is read only when its answer can be sent.
            let answer =
                serial.read().and_then(|byte| decoder.push(byte)).map(|frame| unit.command(frame, now, &mut capture));
            if let Some(report) = answer.or_else(|| unit.report(now, &mut capture)) {
                serial.send(&report);
            }
        }
        let Ok(()) = led.set_state((unit.state() != TimerState::Idle).into());
    }
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    avr_device::interrupt::disable();
    // The watchdog resets the board.
    loop {
        avr_device::asm::nop();
    }
}
