//! The drive: what it does with commands, keys, the limit switch and time.

use crate::clock::{TICK_HZ, age, ticks_between, ticks_from_ms};
use crate::frame::{Frame, ProtoError};
use crate::message::{Command, Direction, DriveState, Preset, Refusal, Report, Unit};
use crate::remote::Key;

/// Number of presets.
pub const PRESETS: usize = 10;

/// Presets at power-up: forward, from about a quarter of the supply to all of it. What speed each gives depends on motor,
/// load and supply and is to be measured with the timer.
pub const DEFAULT_PRESETS: [Preset; PRESETS] = {
    let mut presets = [Preset { duty: 0, direction: Direction::Forward }; PRESETS];
    let mut index = 0;
    while index < PRESETS {
        presets[index].duty = 66 + 21 * index as u8;
        index += 1;
    }
    presets
};

/// The duty rises by one step in this time, so from nothing to all in 255 ms.
pub const RAMP_STEP: u32 = ticks_from_ms(1);

/// The carriage is clear of the limit switch when the switch has been closed for so long. Until then its bouncing does
/// not stop a carriage that backs off.
pub const CLEAR_OF_LIMIT: u32 = ticks_from_ms(20);

/// The hardware as the drive sees it.
pub trait Port {
    /// Drives the motor at `duty` of 255; 0 switches it off. While the limit switch has it cut off, only that.
    fn drive(&mut self, direction: Direction, duty: u8);
    /// Ends a cut. With `guard`, the switch cuts the motor off at once when it opens, and now if it is open; without, it
    /// does not.
    fn release(&mut self, guard: bool);
    /// Whether the limit switch is open, that is, hit (or its wire broken).
    fn limit(&self) -> bool;
}

/// The drive's state. The main loop calls [`DriveUnit::step`] all the time, [`DriveUnit::limit_hit`] after the interrupt
/// has cut the motor off, [`DriveUnit::key`] for each key and, when the line is free, [`DriveUnit::command`] for each
/// received frame and [`DriveUnit::report`], and sends what these return.
#[derive(Debug, Clone)]
pub struct DriveUnit {
    firmware: [u8; 3],
    reset_cause: u8,
    presets: [Preset; PRESETS],
    index: u8,
    state: DriveState,
    duty: u8,
    /// When the duty was raised last.
    stepped: u32,
    /// When the limit switch was last known to be open.
    open: u32,
    /// It has been closed for [`CLEAR_OF_LIMIT`] since.
    clear: bool,
    /// The carriage backs off the limit switch, which does not guard it meanwhile.
    leaving: bool,
    to_tell: ToTell,
}

/// Reports that are due.
#[derive(Debug, Clone, Copy)]
struct ToTell {
    hello: bool,
    preset: bool,
    /// When the limit switch cut the motor off.
    limit_hit: Option<u32>,
}

impl DriveUnit {
    /// A drive that has just been reset and stands still, with the version of the firmware and register MCUSR.
    #[must_use]
    pub const fn new(firmware: [u8; 3], reset_cause: u8) -> Self {
        Self {
            firmware,
            reset_cause,
            presets: DEFAULT_PRESETS,
            index: 0,
            state: DriveState::Stopped,
            duty: 0,
            stepped: 0,
            open: 0,
            clear: false,
            leaving: false,
            to_tell: ToTell { hello: true, preset: true, limit_hit: None },
        }
    }

    /// What the drive is doing.
    #[must_use]
    pub const fn state(&self) -> DriveState {
        self.state
    }

    /// Number of the preset in use.
    #[must_use]
    pub const fn index(&self) -> u8 {
        self.index
    }

    /// The preset in use.
    #[must_use]
    pub fn preset(&self) -> Preset {
        self.presets.get(usize::from(self.index)).copied().unwrap_or(DEFAULT_PRESETS[0])
    }

    /// Obeys or refuses the command in a received frame at time `now` in ticks; the answer is to be sent.
    pub fn command(&mut self, frame: Result<Frame<Command>, ProtoError>, now: u32, port: &mut impl Port) -> Report {
        let Ok(frame) = frame else {
            return Report::Nak { sequence: 0, reason: Refusal::Garbled };
        };
        let done = match frame.message {
            Command::Hello => {
                self.to_tell.hello = true;
                Ok(())
            }
            Command::Status => {
                self.to_tell.preset = true;
                Ok(())
            }
            Command::Stop => {
                self.stop(port);
                Ok(())
            }
            Command::SetPreset { index, preset } => self.set_preset(index, preset, port),
            Command::Go { index } => self.go(index, now, port),
            _ => Err(Refusal::NotMine),
        };
        match done {
            Ok(()) => Report::Ack { sequence: frame.sequence },
            Err(reason) => Report::Nak { sequence: frame.sequence, reason },
        }
    }

    /// Obeys a key of the remote at time `now` in ticks.
    pub fn key(&mut self, key: Key, now: u32, port: &mut impl Port) {
        match key {
            Key::Stop => self.stop(port),
            // A refusal shows on the display, which keeps its text.
            Key::Digit(index) => {
                let _ = self.go(index, now, port);
            }
        }
    }

    fn set_preset(&mut self, index: u8, preset: Preset, port: &mut impl Port) -> Result<(), Refusal> {
        *self.presets.get_mut(usize::from(index)).ok_or(Refusal::NoSuchPreset)? = preset;
        if index == self.index {
            if self.is_moving() {
                self.stop(port);
            }
            self.to_tell.preset = true;
        }
        Ok(())
    }

    const fn is_moving(&self) -> bool {
        matches!(self.state, DriveState::Starting | DriveState::Running)
    }

    fn go(&mut self, index: u8, now: u32, port: &mut impl Port) -> Result<(), Refusal> {
        let preset = *self.presets.get(usize::from(index)).ok_or(Refusal::NoSuchPreset)?;
        if port.limit() && preset.direction == Direction::Forward {
            return Err(Refusal::AtLimit);
        }
        let turns = self.is_moving() && self.preset().direction != preset.direction;
        if turns || !self.is_moving() {
            // From standstill, and never from one direction straight to the other.
            port.drive(preset.direction, 0);
            self.duty = 0;
            self.leaving = preset.direction == Direction::Reverse && !self.clear;
            port.release(!self.leaving);
        }
        self.index = index;
        self.state = DriveState::Starting;
        self.stepped = now;
        self.to_tell.preset = true;
        Ok(())
    }

    fn stop(&mut self, port: &mut impl Port) {
        port.drive(self.preset().direction, 0);
        self.duty = 0;
        self.leaving = false;
        self.state = if port.limit() { DriveState::AtLimit } else { DriveState::Stopped };
        self.to_tell.preset = true;
    }

    /// Tells that the limit switch has opened, at `tick`, and that the motor has been cut off.
    pub fn limit_hit(&mut self, tick: u32, port: &mut impl Port) {
        self.to_tell.limit_hit = Some(tick);
        // By now it may be closed again, for as long as it bounces.
        self.open = tick;
        self.clear = false;
        self.stop(port);
        self.state = DriveState::AtLimit;
    }

    /// Does what is due at time `now` in ticks. To be called all the time, at least every 5 ms.
    pub fn step(&mut self, now: u32, port: &mut impl Port) {
        self.watch_limit(now, port);
        self.ramp(now, port);
    }

    /// The next report to send, if any. To be called when the line can take one.
    pub fn report(&mut self, port: &impl Port) -> Option<Report> {
        if core::mem::take(&mut self.to_tell.hello) {
            let Self { firmware, reset_cause, .. } = *self;
            return Some(Report::Hello { unit: Unit::Drive, firmware, tick_hz: TICK_HZ, reset_cause });
        }
        if let Some(tick) = self.to_tell.limit_hit.take() {
            return Some(Report::LimitHit { tick });
        }
        core::mem::take(&mut self.to_tell.preset).then(|| Report::Preset {
            index: self.index,
            preset: self.preset(),
            state: self.state,
            limit: port.limit(),
        })
    }

    fn watch_limit(&mut self, now: u32, port: &mut impl Port) {
        if port.limit() {
            self.open = now;
            self.clear = false;
            if self.state == DriveState::Stopped {
                self.state = DriveState::AtLimit;
                self.to_tell.preset = true;
            }
        } else if self.clear || age(self.open, now) >= CLEAR_OF_LIMIT {
            self.clear = true;
            if core::mem::take(&mut self.leaving) {
                port.release(true);
            }
            if self.state == DriveState::AtLimit {
                self.state = DriveState::Stopped;
                self.to_tell.preset = true;
            }
        }
    }

    /// Brings the duty one step nearer to that of the preset for every [`RAMP_STEP`] that has passed.
    fn ramp(&mut self, now: u32, port: &mut impl Port) {
        let target = self.preset().duty;
        if self.state != DriveState::Starting {
            return;
        }
        while self.duty != target && ticks_between(self.stepped, now) >= RAMP_STEP {
            self.stepped = self.stepped.wrapping_add(RAMP_STEP);
            // A slower preset is reached at once: the soft start is for the motor, not for the brake.
            self.duty = if self.duty > target { target } else { self.duty + 1 };
        }
        port.drive(self.preset().direction, self.duty);
        if self.duty == target {
            self.state = DriveState::Running;
            self.to_tell.preset = true;
        }
    }
}
