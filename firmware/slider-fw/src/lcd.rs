//! The display: an HD44780 with 16x2 characters on four data lines, written to without waiting.
//!
//! Crates for it were tried: they wait 4 ms in every byte, in which the main loop can do nothing else. Here each call
//! sends at most one byte and the time until the next is kept by the clock.
//!
//! *Reference*: Hitachi, HD44780U data sheet, ADE-207-272(Z): figure 24 (initialisation by instruction, 4 bits), table 6
//! (execution times), figure 25 (bus timing).

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::OutputPin;
use slider_proto::display::{COLUMNS, Text};
use slider_proto::{ticks_between, ticks_from_ms};

/// One step of the initialisation: a nibble or a byte, and the ticks to wait after it.
struct Step {
    value: u8,
    whole: bool,
    ticks: u32,
}

/// An instruction or a character takes 37 us by an oscillator of 270 kHz, which may be as slow as 190 kHz: 53 us.
const EXECUTION: u32 = 120;
const POWER_UP: u32 = ticks_from_ms(50);

const INITIALISATION: [Step; 9] = [
    Step { value: 0x3, whole: false, ticks: ticks_from_ms(5) },
    Step { value: 0x3, whole: false, ticks: 300 },
    Step { value: 0x3, whole: false, ticks: 300 },
    Step { value: 0x2, whole: false, ticks: EXECUTION },
    // Four bits, two rows, 5x8 dots.
    Step { value: 0x28, whole: true, ticks: EXECUTION },
    Step { value: 0x08, whole: true, ticks: EXECUTION },
    // Clear: 1.52 ms, and slower oscillators.
    Step { value: 0x01, whole: true, ticks: ticks_from_ms(3) },
    Step { value: 0x06, whole: true, ticks: EXECUTION },
    Step { value: 0x0c, whole: true, ticks: EXECUTION },
];

/// Sets the address of a character.
const ADDRESS: u8 = 0x80;
/// Address of the first character of the second row.
const SECOND_ROW: u8 = 0x40;

/// The display.
pub struct Lcd<RS, E, D4, D5, D6, D7, D> {
    select: RS,
    enable: E,
    data: (D4, D5, D6, D7),
    delay: D,
    /// Steps of the initialisation done.
    step: u8,
    shown: Text,
    /// Where the next character goes, if it is known.
    cursor: Option<(u8, u8)>,
    since: u32,
    wait: u32,
}

impl<RS, E, D4, D5, D6, D7, D> Lcd<RS, E, D4, D5, D6, D7, D>
where
    RS: OutputPin,
    E: OutputPin,
    D4: OutputPin,
    D5: OutputPin,
    D6: OutputPin,
    D7: OutputPin,
    D: DelayNs,
{
    /// Takes the pins; the display is initialised by the first calls of [`Lcd::poll`], from 50 ms after `now` in ticks.
    pub fn new(select: RS, enable: E, data: (D4, D5, D6, D7), delay: D, now: u32) -> Self {
        let shown = [[b' '; COLUMNS]; 2];
        Self { select, enable, data, delay, step: 0, shown, cursor: None, since: now, wait: POWER_UP }
    }

    /// Brings the display one byte nearer to `text`, if it is ready at time `now` in ticks.
    pub fn poll(&mut self, now: u32, text: &Text) {
        if ticks_between(self.since, now) < self.wait {
            return;
        }
        if let Some(step) = INITIALISATION.get(usize::from(self.step)) {
            self.step += 1;
            self.start(now, step.ticks);
            let _ = self.select.set_low();
            if step.whole {
                self.byte(step.value);
            } else {
                self.nibble(step.value);
            }
            return;
        }
        let Some((row, column, character)) = self.difference(text) else { return };
        self.start(now, EXECUTION);
        if self.cursor == Some((row, column)) {
            let _ = self.select.set_high();
            self.byte(character);
            if let Some(shown) = self.shown.get_mut(usize::from(row)).and_then(|row| row.get_mut(usize::from(column))) {
                *shown = character;
            }
            self.cursor = Some((row, column + 1));
        } else {
            let _ = self.select.set_low();
            self.byte(ADDRESS | if row == 0 { 0 } else { SECOND_ROW } | column);
            self.cursor = Some((row, column));
        }
    }

    fn start(&mut self, now: u32, wait: u32) {
        self.since = now;
        self.wait = wait;
    }

    /// The first character that is not shown as it should be.
    fn difference(&self, text: &Text) -> Option<(u8, u8, u8)> {
        for (row, (wanted, shown)) in (0..).zip(text.iter().zip(&self.shown)) {
            for (column, (&wanted, &shown)) in (0..).zip(wanted.iter().zip(shown)) {
                if wanted != shown {
                    return Some((row, column, wanted));
                }
            }
        }
        None
    }

    fn byte(&mut self, value: u8) {
        self.nibble(value >> 4);
        self.nibble(value);
    }

    /// Sends the low four bits. Pins that cannot fail are all there are on this board, so their results are dropped.
    fn nibble(&mut self, value: u8) {
        let bit = |n: u8| (value >> n & 1 == 1).into();
        let _ = self.data.0.set_state(bit(0));
        let _ = self.data.1.set_state(bit(1));
        let _ = self.data.2.set_state(bit(2));
        let _ = self.data.3.set_state(bit(3));
        let _ = self.enable.set_high();
        self.delay.delay_us(1);
        let _ = self.enable.set_low();
        self.delay.delay_us(1);
    }
}

/// Waits by counting cycles.
#[derive(Clone, Copy)]
pub struct Delay;

impl DelayNs for Delay {
    fn delay_ns(&mut self, ns: u32) {
        // 62.5 ns a cycle.
        avr_device::asm::delay_cycles(ns.div_ceil(62));
    }

    fn delay_us(&mut self, us: u32) {
        avr_device::asm::delay_cycles(us.saturating_mul(16));
    }
}
