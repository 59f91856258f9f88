//! Runs firmware of the slider as it is flashed, an ELF file, on a simulated Arduino Nano (ATmega328P, 16 MHz), plays the
//! rig around it and reads back what it does, to the cycle.
//!
//! The instructions, timers' counters and interrupts are those of [simavr](https://github.com/buserror/simavr), which is
//! under the GPL-3.0: this crate is for tests only, is never published, and nothing of it is linked into what ships.
//!
//! # Example
//! ```no_run
//! use slider_sim::{CYCLES_PER_SECOND, Mcu, Pin, encoder, millis};
//!
//! # fn main() -> Result<(), slider_sim::SimError> {
//! let mut mcu = Mcu::load("timer.elf".as_ref())?;
//! mcu.set(Pin::D8, true); // the light barrier is open
//! mcu.watch(Pin::D4); // the trigger
//! mcu.run_for(millis(10))?;
//! mcu.send(b"arm\n");
//! let rail = encoder::Encoder::uneven(13, 0.002, 1);
//! let motion = encoder::Motion::Constant { speed_m_s: 0.5 };
//! let start = mcu.cycle() + millis(50);
//! mcu.play(Pin::D8, encoder::edges(&rail, &motion, start, CYCLES_PER_SECOND as f64));
//! mcu.run_for(millis(500))?;
//! let answer: Vec<u8> = mcu.take_sent().iter().map(|sent| sent.byte).collect();
//! println!("{}", String::from_utf8_lossy(&answer));
//! println!("trigger after {} cycles", mcu.changes(Pin::D4)[0].cycle - start);
//! for interrupt in mcu.interrupts().iter().filter(|interrupt| interrupt.runs > 0) {
//!     println!("{}: {} runs of {} cycles at most", interrupt.name(), interrupt.runs, interrupt.longest_run);
//! }
//! # Ok(())
//! # }
//! ```
//!
//! # Time
//! All times are cycles of 62.5 ns since power-up, [`CYCLES_PER_SECOND`] a second; [`micros`] and [`millis`] convert.
//! A watchdog reset does not set the clock back. Runs are deterministic: no random numbers but seeded ones, no real time.
//! A [`Mcu`] may be sent to another thread, and several may run at once.
//!
//! # What is modelled
//! - Instructions with their cycles, sleep, the watchdog, Timers 0 to 2 with their interrupts, INT0, INT1 and pin changes.
//! - Input capture: ICR1 is the count in the very cycle of the played edge, and flags are set in it; the program can act
//!   on them from the next instruction boundary on ([`Delivered`] has both times).
//! - The pins' levels from PORT, DDR, pull-ups, the timers' compare outputs and the rig ([`Mcu::set`], [`Mcu::play`],
//!   [`Mcu::wire`]).
//! - The USART in frames of real length, with the hardware's buffers and overruns.
//! - 4 cycles for the entry of an interrupt, 8 out of sleep.
//!
//! # What simavr 1.2.7 gets wrong, and is done here instead
//! - A frame of 8N1 lasts 11 bits, the transmitter has no buffer, the receiver takes 64 bytes ([`Sent`]).
//! - Compare outputs write into PORT, OCR is not buffered in PWM modes, phase-correct modes count up only ([`PwmChange`]).
//! - In the fast PWM modes with TOP in OCRA the count stays at 0.
//! - A flag that was set while its interrupt was off is never served; writing 1 to EIFR sets flags; SBI on TIFRn and EIFR
//!   clears all flags.
//! - An interrupt is entered in no time; the clock starts again at 0 with a reset; sleep ends a cycle late.
//! - A driven pin is lifted by its pull-up at the next write to PORT.
//!
//! # Limits
//! - Pins have no analogue fronts, thresholds or delays. Real inputs pass a synchroniser, 0.5 to 1.5 cycles, and ICP1 an
//!   edge detector, 2.5 to 3.5 cycles in all, which are left out; so is the noise canceller (ICNC1), 4 cycles more.
//! - The clock is exact; a Nano's ceramic resonator is off by up to 0.5 %.
//! - A register's write acts at the start of its instruction: the hardware moves a pin 1 cycle later after OUT, 2 after
//!   SBI, CBI and STS. Requests raised by simavr's own timers (overflow, compare) are seen at the next boundary, up to 3
//!   cycles late; TCNT itself is exact.
//! - A timer starts at 0 with a write that changes its CS or WGM bits, whatever was in TCNT, and its prescaler starts
//!   with it. In the phase-correct modes TCNT and the overflow interrupt follow simavr, which counts up only, twice as
//!   fast; a new TOP in OCRA acts at once on them. The outputs, [`PwmChange`], are right.
//! - PINx shows PORT, not the compare output, for a pin that a timer drives.
//! - The watchdog runs at exactly 128 kHz, a real one at 10 % less or more.
//! - ADC, SPI, TWI, EEPROM and comparator are simavr's, untried here.
//!
//! # Speed
//! 10 to 15 simulated seconds a second in a release build on one core of a shared server, twice that asleep, and 7 to 9
//! when a timer makes 60 000 to 125 000 edges a second. `cargo run --release --example speed -- ELF` measures a firmware.

pub mod encoder;
pub mod interrupts;
pub mod lcd;
pub mod pty;
pub mod remote;
pub mod wave;

mod avr;
mod board;
mod elf;
mod error;
mod mcu;
mod memory;
mod pin;
mod ports;
mod pwm;
mod random;
mod uart;

pub use error::SimError;
pub use mcu::Mcu;
pub use pin::{Change, Delivered, Pin};
pub use pwm::PwmChange;
pub use uart::Sent;

/// Clock of the Nano, Hz.
pub const CYCLES_PER_SECOND: u64 = 16_000_000;

/// Cycles of some microseconds.
pub const fn micros(microseconds: u64) -> u64 {
    microseconds * (CYCLES_PER_SECOND / 1_000_000)
}

/// Cycles of some milliseconds.
pub const fn millis(milliseconds: u64) -> u64 {
    milliseconds * (CYCLES_PER_SECOND / 1000)
}
