//! The USART in asynchronous mode and the serial line of the rig.
//!
//! simavr's own USART is left out of the path: it counts 11 bits for a frame of 8N1, has no transmit buffer and takes
//! 64 bytes in. This one has the hardware's: a transmit buffer before the shift register, two bytes of receive buffer
//! behind another, frames of the length that UCSR0C says, the data overrun flag. Left out: synchronous and
//! multi-processor modes, the ninth bit, parity and framing errors (a rate that is off does not garble a byte), the
//! levels of D0 and D1.

use crate::avr::Bus;
use std::collections::VecDeque;

pub(crate) const UCSR0A: u16 = 0xc0;
pub(crate) const UCSR0B: u16 = 0xc1;
const UCSR0C: u16 = 0xc2;
const UBRR0L: u16 = 0xc4;
const UBRR0H: u16 = 0xc5;
pub(crate) const UDR0: u16 = 0xc6;

const RXC: u8 = 0x80;
const TXC: u8 = 0x40;
const UDRE: u8 = 0x20;
const DOR: u8 = 0x08;
const KEPT_BITS: u8 = 0x03;
const RXEN: u8 = 0x10;
const TXEN: u8 = 0x08;

const RX_VECTOR: usize = 18;
const UDRE_VECTOR: usize = 19;
const TX_VECTOR: usize = 20;

/// A byte that the controller sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sent {
    /// Cycle at which its start bit began.
    pub started: u64,
    /// Cycle at which its stop bit ended: from then on the host has it.
    pub cycle: u64,
    /// The byte.
    pub byte: u8,
}

#[derive(Debug, Default)]
pub(crate) struct Uart {
    /// What the shift register sends.
    sending: Option<Sent>,
    waiting: Option<u8>,
    sent: Vec<Sent>,
    /// Bytes on their way to the controller.
    queue: VecDeque<u8>,
    /// When the byte in front of the queue is through.
    arrival: Option<u64>,
    received: VecDeque<u8>,
    overrun: bool,
    lost: u64,
    host_baud: Option<f64>,
}

impl Uart {
    pub(crate) fn reset(&mut self, bus: Bus<'_>) {
        self.sending = None;
        self.waiting = None;
        self.received.clear();
        self.overrun = false;
        bus.set_data(UCSR0A, UDRE);
        bus.set_data(UCSR0B, 0);
        bus.set_data(UCSR0C, 0x06);
    }

    pub(crate) fn sent(&self) -> &[Sent] {
        &self.sent
    }

    pub(crate) fn take_sent(&mut self) -> Vec<Sent> {
        std::mem::take(&mut self.sent)
    }

    /// Bytes of the host that the controller never saw: receiver off, or buffers full.
    pub(crate) fn lost(&self) -> u64 {
        self.lost
    }

    pub(crate) fn set_host_baud(&mut self, baud: Option<f64>) {
        self.host_baud = baud;
    }

    /// Bytes that are not through to the controller yet.
    pub(crate) fn unsent(&self) -> usize {
        self.queue.len()
    }

    pub(crate) fn send(&mut self, bus: Bus<'_>, bytes: &[u8]) {
        self.queue.extend(bytes);
        if self.arrival.is_none() && !self.queue.is_empty() {
            self.arrival = Some(bus.cycle() + self.host_byte_cycles(bus));
        }
    }

    /// Cycles of a frame as the controller's registers have it.
    pub(crate) fn byte_cycles(bus: Bus<'_>) -> u64 {
        let divisor = (u64::from(bus.data(UBRR0H) & 0x0f) << 8 | u64::from(bus.data(UBRR0L))) + 1;
        let bit = divisor * if bus.data(UCSR0A) & 0x02 == 0 { 16 } else { 8 };
        let format = bus.data(UCSR0C);
        let data_bits = 5 + u64::from(format >> 1 & 0b11);
        let parity = u64::from(format >> 4 & 0b11 != 0);
        let stops = 1 + u64::from(format >> 3 & 1);
        bit * (1 + data_bits + parity + stops)
    }

    fn host_byte_cycles(&self, bus: Bus<'_>) -> u64 {
        match self.host_baud {
            Some(baud) => (10.0 * crate::CYCLES_PER_SECOND as f64 / baud).round() as u64,
            None => Self::byte_cycles(bus),
        }
    }

    pub(crate) fn due(&self) -> Option<u64> {
        [self.sending.map(|sent| sent.cycle), self.arrival].into_iter().flatten().min()
    }

    pub(crate) fn event(&mut self, bus: Bus<'_>, due: u64) {
        if let Some(sent) = self.sending.take_if(|sent| sent.cycle <= due) {
            self.sent.push(sent);
            if let Some(byte) = self.waiting.take() {
                self.shift(bus, byte, due);
            } else {
                bus.raise(TX_VECTOR);
            }
            Self::set_flag(bus, UDRE, true);
        }
        if self.arrival.take_if(|arrival| *arrival <= due).is_some() {
            if let Some(byte) = self.queue.pop_front() {
                self.receive(bus, byte);
            }
            if !self.queue.is_empty() {
                self.arrival = Some(due + self.host_byte_cycles(bus));
            }
        }
        Self::refresh(bus);
    }

    fn shift(&mut self, bus: Bus<'_>, byte: u8, started: u64) {
        self.sending = Some(Sent { started, cycle: started + Self::byte_cycles(bus), byte });
    }

    fn receive(&mut self, bus: Bus<'_>, byte: u8) {
        if bus.data(UCSR0B) & RXEN == 0 {
            self.lost += 1;
            return;
        }
        // Two bytes of buffer and one that waits in the shift register until the next comes over it.
        if self.received.len() == 3 {
            self.received.pop_back();
            self.overrun = true;
            self.lost += 1;
        }
        self.received.push_back(byte);
        Self::set_flag(bus, RXC, true);
    }

    /// Flags that follow a condition ask for their interrupts for as long as it holds.
    pub(crate) fn refresh(bus: Bus<'_>) {
        let asked = bus.data(UCSR0A) & bus.data(UCSR0B);
        for (flag, vector) in [(RXC, RX_VECTOR), (UDRE, UDRE_VECTOR)] {
            match (asked & flag != 0, bus.is_pending(vector)) {
                (true, false) => bus.raise(vector),
                (false, true) => bus.clear(vector),
                _ => {}
            }
        }
    }

    pub(crate) fn write(&mut self, bus: Bus<'_>, address: u16, value: u8) {
        match address {
            UCSR0A => {
                if value & TXC != 0 {
                    bus.clear(TX_VECTOR);
                }
                bus.set_data(UCSR0A, bus.data(UCSR0A) & !KEPT_BITS | value & KEPT_BITS);
            }
            UCSR0B => {
                bus.set_data(UCSR0B, value);
                if value & RXEN == 0 {
                    self.received.clear();
                    self.overrun = false;
                    Self::set_flag(bus, RXC, false);
                }
                if value & bus.data(UCSR0A) & TXC != 0 && !bus.is_pending(TX_VECTOR) {
                    bus.raise(TX_VECTOR);
                }
            }
            _ => self.write_data(bus, value),
        }
        Self::refresh(bus);
    }

    fn write_data(&mut self, bus: Bus<'_>, byte: u8) {
        if bus.data(UCSR0B) & TXEN == 0 || self.waiting.is_some() {
            return;
        }
        if self.sending.is_none() {
            self.shift(bus, byte, bus.cycle());
        } else {
            self.waiting = Some(byte);
            Self::set_flag(bus, UDRE, false);
        }
    }

    pub(crate) fn read(&mut self, bus: Bus<'_>, address: u16) -> u8 {
        if address == UCSR0A {
            return bus.data(UCSR0A) & !DOR | if self.overrun { DOR } else { 0 };
        }
        let byte = self.received.pop_front().unwrap_or_default();
        self.overrun = false;
        Self::set_flag(bus, RXC, !self.received.is_empty());
        Self::refresh(bus);
        byte
    }

    fn set_flag(bus: Bus<'_>, flag: u8, on: bool) {
        let others = bus.data(UCSR0A) & !flag;
        bus.set_data(UCSR0A, others | if on { flag } else { 0 });
    }
}
