//! The waveform generators of the three timers: exact edges of OC0A to OC2B, and the duty that they stand for.
//!
//! simavr's own compare outputs are cut off: they write into PORT, know no buffering of OCR and count phase-correct
//! modes up only. Here the six outputs follow the datasheet's chapters 15, 16 and 18: the pin moves one timer clock after
//! the match; in PWM modes a new OCR counts from BOTTOM (fast) or TOP (phase correct) on; OCR = TOP never falls in fast
//! modes, OCR = 0 never rises in phase-correct ones. Left out: forced compares, external clocks, the common phase of the
//! two prescalers (a timer's clock begins when its CS bits are written), and the history of an output from before it was
//! connected in a PWM mode (its first period looks as if it had always been). A timer that
//! stands takes a new OCR at once. The phase-and-frequency-correct modes
//! update at TOP as the phase-correct ones do.

mod waveform;

use crate::{avr::Bus, pin::Pin};
use waveform::{LAYOUTS, Unit};

/// What a compare output does from a cycle on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PwmChange {
    /// For a write of a register, the cycle in which the writing instruction starts; for a new OCR in a PWM mode, the
    /// timer's cycle at which it leaves its buffer.
    pub cycle: u64,
    /// Share of the time that the pin is high, 0 to 1; `None` when the timer does not drive the pin (COM bits 0 or DDR
    /// bit 0).
    pub duty: Option<f64>,
    /// Frequency of the wave, Hz; 0 for a steady level.
    pub frequency_hz: f64,
}

/// The three timers' outputs.
#[derive(Debug, Default)]
pub(crate) struct Timers {
    units: [Unit; 3],
}

impl Timers {
    pub(crate) fn reset(&mut self, cycle: u64) {
        for unit in &mut self.units {
            let logs = unit.channels.each_mut().map(|channel| std::mem::take(&mut channel.log));
            *unit = Unit::default();
            for (channel, log) in unit.channels.iter_mut().zip(logs) {
                channel.log = log;
                channel.note(cycle, None, 0.0);
            }
        }
    }

    /// The timer that a register belongs to.
    pub(crate) fn unit_of(address: u16) -> Option<usize> {
        LAYOUTS.iter().position(|layout| {
            [layout.control_a, layout.control_b, layout.count, layout.capture].contains(&address)
                || layout.compare.contains(&address)
        })
    }

    pub(crate) fn outputs(&self, unit: usize) -> [(Pin, Option<bool>); 2] {
        let channels = &self.units[unit].channels;
        [0, 1].map(|i| (LAYOUTS[unit].pins[i], (channels[i].com != 0).then_some(channels[i].level)))
    }

    pub(crate) fn changes(&self, pin: Pin) -> &[PwmChange] {
        self.units
            .iter()
            .zip(&LAYOUTS)
            .flat_map(|(unit, layout)| unit.channels.iter().zip(layout.pins))
            .find(|(_, output)| *output == pin)
            .map_or(&[], |(channel, _)| &channel.log)
    }

    pub(crate) fn due(&self) -> Option<u64> {
        self.units.iter().filter_map(Unit::due).min()
    }

    /// The units for which something is due.
    pub(crate) fn due_units(&self, due: u64) -> impl Iterator<Item = usize> + use<> {
        let units = [0, 1, 2].map(|unit| self.units[unit].due().is_some_and(|cycle| cycle <= due));
        (0..3).filter(move |unit| units[*unit])
    }

    pub(crate) fn event(&mut self, unit: usize, bus: Bus<'_>, due: u64) {
        self.units[unit].event(&LAYOUTS[unit], bus, due);
    }

    pub(crate) fn written(&mut self, unit: usize, bus: Bus<'_>, address: u16) {
        self.units[unit].written(&LAYOUTS[unit], bus, address);
    }

    /// Logs what the outputs of a timer do now.
    pub(crate) fn note(&mut self, unit: usize, cycle: u64, is_output: impl Fn(Pin) -> bool) {
        let layout = &LAYOUTS[unit];
        let unit = &mut self.units[unit];
        for i in 0..2 {
            let (duty, frequency_hz) = unit.wave(i);
            let driven = unit.channels[i].com != 0 && is_output(layout.pins[i]);
            let frequency_hz = if driven { frequency_hz } else { 0.0 };
            unit.channels[i].note(cycle, driven.then_some(duty), frequency_hz);
        }
    }
}
