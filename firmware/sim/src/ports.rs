//! The lines between the pins and the rig: who drives them, what is played into them, what is logged.

use crate::{
    avr::Bus,
    pin::{Change, Delivered, Pin},
};
use std::{cmp::Reverse, collections::BinaryHeap};

const EICRA: u16 = 0x69;
const EIMSK: u16 = 0x3d;
const EIFR: u16 = 0x3c;

/// A level to be put on a pin; ordered by time, then as asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Event {
    due: u64,
    order: u64,
    pin: Pin,
    level: bool,
}

/// The 20 lines.
#[derive(Debug, Default)]
pub(crate) struct Ports {
    direction: [u8; 3],
    output: [u8; 3],
    /// Level that the rig puts on a pin.
    outside: [Option<bool>; 20],
    /// Level that a compare unit puts on a pin instead of PORT.
    compare: [Option<bool>; 20],
    /// Level of the line.
    level: [bool; 20],
    watched: [bool; 20],
    changes: [Vec<Change>; 20],
    delivered: [Vec<Delivered>; 20],
    wires: Vec<(Pin, Pin)>,
    events: BinaryHeap<Reverse<Event>>,
    order: u64,
}

impl Ports {
    pub(crate) fn reset(&mut self, bus: Bus<'_>) {
        self.direction = [0; 3];
        self.output = [0; 3];
        self.compare = [None; 20];
        for pin in Pin::ALL {
            if let Some(level) = self.outside[pin.index()] {
                Self::put(bus, pin, level);
            }
            self.settle(bus, pin, true);
        }
    }

    pub(crate) fn is_output(&self, pin: Pin) -> bool {
        self.direction[pin.port_index()] >> pin.bit() & 1 != 0
    }

    pub(crate) fn level(&self, pin: Pin) -> bool {
        self.level[pin.index()]
    }

    pub(crate) fn watch(&mut self, pin: Pin) {
        self.watched[pin.index()] = true;
    }

    pub(crate) fn changes(&self, pin: Pin) -> &[Change] {
        &self.changes[pin.index()]
    }

    pub(crate) fn delivered(&self, pin: Pin) -> &[Delivered] {
        &self.delivered[pin.index()]
    }

    pub(crate) fn wire(&mut self, bus: Bus<'_>, from: Pin, to: Pin) {
        self.wires.push((from, to));
        if self.is_output(from) {
            self.drive(bus, to, self.level(from));
        }
    }

    /// Puts a level on a pin from outside, for good.
    pub(crate) fn drive(&mut self, bus: Bus<'_>, pin: Pin, level: bool) {
        self.outside[pin.index()] = Some(level);
        Self::put(bus, pin, level);
        self.settle(bus, pin, false);
    }

    fn put(bus: Bus<'_>, pin: Pin, level: bool) {
        bus.drive(pin.port_index(), pin.bit(), level);
        // simavr latches a flag for a low level even where the interrupt is off; the datasheet (13.2.3) does not.
        let Some(int) = [Pin::D2, Pin::D3].iter().position(|&int| int == pin) else { return };
        let by_level = bus.data(EICRA) & 0b11 << (2 * int) == 0;
        if by_level && bus.data(EIMSK) >> int & 1 == 0 {
            bus.clear_flags(EIFR, 1 << int);
        }
    }

    pub(crate) fn play(&mut self, now: u64, pin: Pin, levels: impl IntoIterator<Item = (u64, bool)>) {
        for (cycle, level) in levels {
            let event = Event { due: cycle.max(now), order: self.order, pin, level };
            self.order += 1;
            self.events.push(Reverse(event));
        }
    }

    /// Whether something is still to be played into the pin.
    pub(crate) fn is_playing(&self, pin: Pin) -> bool {
        self.events.iter().any(|event| event.0.pin == pin)
    }

    pub(crate) fn due(&self) -> Option<u64> {
        self.events.peek().map(|event| event.0.due)
    }

    /// Delivers what is due at `due`, at a moment when the core has come to `now`.
    pub(crate) fn event(&mut self, bus: Bus<'_>, due: u64, now: u64) {
        while let Some(&Reverse(Event { due: asked, pin, level, .. })) = self.events.peek() {
            if asked > due {
                break;
            }
            self.events.pop();
            self.drive(bus, pin, level);
            self.delivered[pin.index()].push(Delivered { asked, cycle: now, level });
        }
    }

    pub(crate) fn direction(&mut self, bus: Bus<'_>, port: usize, value: u8) {
        let before = std::mem::replace(&mut self.direction[port], value);
        for pin in Pin::of_port(port) {
            self.settle(bus, pin, before >> pin.bit() & 1 != 0);
        }
    }

    pub(crate) fn port(&mut self, bus: Bus<'_>, port: usize, value: u8) {
        self.output[port] = value;
        for pin in Pin::of_port(port) {
            self.settle(bus, pin, false);
        }
    }

    /// A compare unit takes the pin with a level, or leaves it to PORT.
    pub(crate) fn compare(&mut self, bus: Bus<'_>, pin: Pin, level: Option<bool>) {
        self.compare[pin.index()] = level;
        self.settle(bus, pin, false);
    }

    /// Works out the level of the line; what the controller changed of it is logged and goes down the wires.
    fn settle(&mut self, bus: Bus<'_>, pin: Pin, was_output: bool) {
        let i = pin.index();
        let port_bit = self.output[pin.port_index()] >> pin.bit() & 1 != 0;
        let is_output = self.is_output(pin);
        let level = match (is_output, self.outside[i]) {
            (true, _) => self.compare[i].unwrap_or(port_bit),
            (false, Some(outside)) => outside,
            // The pull-up; without it the line floats and keeps what it had.
            (false, None) => port_bit || self.level[i],
        };
        let moved = std::mem::replace(&mut self.level[i], level) != level;
        if moved && self.watched[i] && (is_output || was_output) {
            self.changes[i].push(Change { cycle: bus.cycle(), level });
        }
        if is_output && (moved || !was_output) {
            for wire in 0..self.wires.len() {
                let (from, to) = self.wires[wire];
                if from == pin && self.outside[to.index()] != Some(level) {
                    self.drive(bus, to, level);
                }
            }
        }
    }
}
