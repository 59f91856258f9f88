//! The slider's two boards, Arduino Nano with `ATmega328P` at 16 MHz: what `timer` and `drive` share, and each part of
//! the hardware that one of them uses.
//!
//! All decisions are taken in [`slider_proto`], which is tested on any machine; here are registers. `unsafe` stands
//! where a register demands it and where an interrupt shares state with the main loop.

#![no_std]
#![feature(abi_avr_interrupt, asm_experimental_arch)]

pub mod arithmetic;
pub mod board;
pub mod capture;
pub mod clock;
pub mod infrared;
pub mod lcd;
pub mod motor;
pub mod queue;
pub mod serial;
pub mod watchdog;

/// Version of both firmwares, as `Hello` tells it.
pub const VERSION: [u8; 3] = [
    part(env!("CARGO_PKG_VERSION_MAJOR")),
    part(env!("CARGO_PKG_VERSION_MINOR")),
    part(env!("CARGO_PKG_VERSION_PATCH")),
];

/// One number of a version, which cargo has checked.
const fn part(digits: &str) -> u8 {
    let digits = digits.as_bytes();
    let mut value = 0;
    let mut at = 0;
    while at < digits.len() {
        value = value * 10 + (digits[at] - b'0');
        at += 1;
    }
    value
}
