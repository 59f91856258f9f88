//! The serial line: 57600 baud, 8 bits, no parity, one stop bit, as an HC-05 is set up.

use core::cell::Cell;

use avr_device::atmega328p::USART0;
use avr_device::interrupt::{self, CriticalSection};
use slider_proto::{MAX_FRAME, Report, encode};

use crate::board::{CLOCK_HZ, D0, D1, Floating};
use crate::queue::Queue;

/// Bits a second asked for; the divider makes 57143 of them (-0.8 %), well inside the 2 % that a receiver bears.
pub const BAUD: u32 = 57_600;
const DIVIDER: u16 = ((CLOCK_HZ / 8 + BAUD / 2) / BAUD - 1) as u16;

/// Bytes that wait for the main loop: two of the longest commands, or 5 ms of the line.
const RECEIVED: usize = 32;

static BYTES: Queue<u8, RECEIVED> = Queue::new([const { Cell::new(0) }; RECEIVED]);

/// The line, with room for one outgoing frame.
pub struct Serial {
    registers: USART0,
    frame: [u8; MAX_FRAME],
    length: u8,
    sent: u8,
    sequence: u8,
}

impl Serial {
    /// Opens the line. The first byte out is the zero that ends whatever noise the host may have seen.
    #[must_use]
    pub fn open(registers: USART0, _: D0<Floating>, _: D1<Floating>) -> Self {
        registers.ubrr0.write(|w| w.bits(DIVIDER));
        registers.ucsr0a.write(|w| w.u2x0().set_bit());
        registers.ucsr0c.write(|w| w.ucsz0().chr8());
        registers.ucsr0b.write(|w| w.rxen0().set_bit().txen0().set_bit().rxcie0().set_bit());
        Self { registers, frame: [0; MAX_FRAME], length: 1, sent: 0, sequence: 0 }
    }

    /// Whether the next frame can be taken.
    #[inline]
    #[must_use]
    pub const fn is_free(&self) -> bool {
        self.sent == self.length
    }

    /// Takes a frame; only while [`Serial::is_free`].
    pub fn send(&mut self, report: &Report) {
        self.length = encode(report, self.sequence, &mut self.frame).len() as u8;
        self.sent = 0;
        self.sequence = self.sequence.wrapping_add(1);
        self.poll();
    }

    /// Says whether the interrupt takes received bytes. If not, [`Serial::poll`] has to be called every 350 us, since the
    /// hardware keeps two bytes; nothing else is then delayed by that interrupt.
    #[inline]
    pub fn interrupt(&mut self, on: bool) {
        self.registers.ucsr0b.modify(|_, w| w.rxcie0().bit(on));
    }

    /// Hands the next byte to the hardware if that is ready, and takes a received one. A byte takes 175 us and one is
    /// buffered.
    #[inline]
    pub fn poll(&mut self) {
        if self.registers.ucsr0a.read().rxc0().bit_is_set() {
            interrupt::free(|cs| {
                // The interrupt may have taken it meanwhile.
                if self.registers.ucsr0a.read().rxc0().bit_is_set() {
                    on_byte(cs);
                }
            });
        }
        if !self.is_free() && self.registers.ucsr0a.read().udre0().bit_is_set() {
            let byte = self.frame.get(usize::from(self.sent)).copied().unwrap_or(0);
            self.registers.udr0.write(|w| w.bits(byte));
            self.sent += 1;
        }
    }

    /// Takes a received byte.
    #[inline]
    pub fn read(&mut self) -> Option<u8> {
        BYTES.pop()
    }
}

/// Keeps a received byte: the interrupt `USART_RX` of both boards. A byte that finds no room is dropped, and the checksum
/// of its frame tells.
#[inline(always)]
pub fn on_byte(cs: CriticalSection<'_>) {
    // SAFETY: this is the only reader of the data register; reading it ends the interrupt.
    let byte = unsafe { (*USART0::ptr()).udr0.read().bits() };
    BYTES.push(cs, byte);
}
