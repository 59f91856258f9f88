//! What the core is wired to: the lines, the serial line, the timers' outputs; and which registers they look after.

use crate::{
    avr::{Bus, Write},
    ports::Ports,
    pwm::Timers,
    uart::{self, Uart},
};

const EIFR: u16 = 0x3c;
/// EIMSK, PCICR and TIMSK0 to TIMSK2.
const ENABLES: [u16; 5] = [0x3d, 0x68, 0x6e, 0x6f, 0x70];
/// Registers of flags that a written 1 clears, where simavr is wrong about SBI: TIFR0 to TIFR2, EIFR.
pub(crate) const FLAG_REGISTERS: [u16; 4] = [0x35, 0x36, 0x37, EIFR];
/// Registers whose writes come here.
pub(crate) const HOOKED_WRITES: [u16; 26] = [
    EIFR,
    ENABLES[0],
    ENABLES[1],
    ENABLES[2],
    ENABLES[3],
    ENABLES[4],
    0x44,
    0x45,
    0x46,
    0x47,
    0x48,
    0x80,
    0x81,
    0x84,
    0x86,
    0x88,
    0x8a,
    0xb0,
    0xb1,
    0xb2,
    0xb3,
    0xb4,
    uart::UCSR0A,
    uart::UCSR0B,
    uart::UDR0,
    0xc4,
];
/// Registers whose reads come here.
pub(crate) const HOOKED_READS: [u16; 2] = [uart::UCSR0A, uart::UDR0];

/// Everything around the core.
#[derive(Debug, Default)]
pub(crate) struct Board {
    pub(crate) ports: Ports,
    pub(crate) uart: Uart,
    pub(crate) timers: Timers,
    scheduled: Option<u64>,
}

impl Board {
    /// Puts everything in the state after a reset; what the rig drives and plays goes on.
    pub(crate) fn reset(&mut self, bus: Bus<'_>) {
        self.timers.reset(bus.cycle());
        self.uart.reset(bus);
        self.ports.reset(bus);
        self.scheduled = None;
        self.reschedule(bus);
    }

    /// Has the core call again when the next thing is due.
    pub(crate) fn reschedule(&mut self, bus: Bus<'_>) {
        let due = [self.ports.due(), self.uart.due(), self.timers.due()].into_iter().flatten().min();
        if due != self.scheduled {
            self.scheduled = due;
            bus.schedule(due);
        }
    }

    pub(crate) fn before_write(&mut self, bus: Bus<'_>, address: u16, value: u8) -> Write {
        match address {
            EIFR => bus.clear_flags(EIFR, value),
            uart::UCSR0A | uart::UCSR0B | uart::UDR0 => {
                self.uart.write(bus, address, value);
                self.reschedule(bus);
            }
            _ => return Write::Pass,
        }
        Write::Taken
    }

    pub(crate) fn after_write(&mut self, bus: Bus<'_>, address: u16) {
        if ENABLES.contains(&address) {
            bus.serve_latched(address);
        } else if let Some(unit) = Timers::unit_of(address) {
            self.timers.written(unit, bus, address);
            self.show(unit, bus);
            self.reschedule(bus);
        }
    }

    pub(crate) fn read(&mut self, bus: Bus<'_>, address: u16) -> u8 {
        self.uart.read(bus, address)
    }

    /// Does what is due at `due`, when the core has come to `now`.
    pub(crate) fn event(&mut self, bus: Bus<'_>, due: u64, now: u64) {
        self.scheduled = None;
        self.ports.event(bus, due, now);
        self.uart.event(bus, due);
        for unit in self.timers.due_units(due) {
            self.timers.event(unit, bus, due);
            self.show(unit, bus);
        }
        self.reschedule(bus);
    }

    /// After an interrupt was entered.
    pub(crate) fn refresh(bus: Bus<'_>) {
        Uart::refresh(bus);
    }

    pub(crate) fn direction(&mut self, port: usize, value: u8, bus: Bus<'_>) {
        self.ports.direction(bus, port, value);
        for unit in 0..3 {
            self.timers.note(unit, bus.cycle(), |pin| self.ports.is_output(pin));
        }
    }

    pub(crate) fn port(&mut self, port: usize, value: u8, bus: Bus<'_>) {
        self.ports.port(bus, port, value);
    }

    fn show(&mut self, unit: usize, bus: Bus<'_>) {
        for (pin, level) in self.timers.outputs(unit) {
            self.ports.compare(bus, pin, level);
        }
        self.timers.note(unit, bus.cycle(), |pin| self.ports.is_output(pin));
    }
}
