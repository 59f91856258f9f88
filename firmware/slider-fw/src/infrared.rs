//! The infra-red receiver at D3: its changes, stamped by the interrupt INT1 and decoded by the main loop.

use core::cell::Cell;

use avr_device::atmega328p::{EXINT, PORTD};
use avr_device::interrupt::{CriticalSection, Mutex};
use slider_proto::remote::{Key, Remote};

use crate::board::{D3, PullUp};
use crate::clock;
use crate::queue::Queue;

/// PD3, which is D3.
const RECEIVER: u8 = 1 << 3;
/// Changes that wait for the main loop, which passes every few 100 us; a frame has one every 560 us or more.
const WAITING: usize = 16;
/// The level after a change stands in the top bit, the ticks since the change before it in the others.
const HIGH: u16 = 0x8000;

static CHANGES: Queue<u16, WAITING> = Queue::new([const { Cell::new(0) }; WAITING]);
static LAST: Mutex<Cell<u32>> = Mutex::new(Cell::new(0));

/// Stamps a change: the interrupt INT1. A change that finds no room is dropped; what is left is then no frame.
#[inline(always)]
pub fn on_change(cs: CriticalSection<'_>) {
    // SAFETY: reads an input register; that changes nothing.
    let high = unsafe { (*PORTD::ptr()).pind.read().bits() & RECEIVER != 0 };
    let tick = clock::now(cs);
    let since = tick.wrapping_sub(LAST.borrow(cs).replace(tick));
    let since = if since < u32::from(HIGH) { since as u16 } else { HIGH - 1 };
    CHANGES.push(cs, since | if high { HIGH } else { 0 });
}

/// The receiver and its decoder.
pub struct Infrared {
    remote: Remote,
}

impl Infrared {
    /// Takes the pin and listens.
    #[must_use]
    pub fn new(_: D3<PullUp>, interrupts: &EXINT) -> Self {
        // Both edges at D3.
        interrupts.eicra.modify(|_, w| w.isc1().val_0x01());
        interrupts.eimsk.modify(|_, w| w.int1().set_bit());
        Self { remote: Remote::new() }
    }

    /// Decodes what has come and returns the next key.
    pub fn key(&mut self) -> Option<Key> {
        while let Some(change) = CHANGES.pop() {
            if let Some(key) = self.remote.change(change & HIGH != 0, change & !HIGH) {
                return Some(key);
            }
        }
        None
    }
}
