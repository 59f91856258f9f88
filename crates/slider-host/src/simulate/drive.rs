//! The drive's board: the firmware's own logic, without a motor.

use slider_proto::drive::{DriveUnit, Port};
use slider_proto::{Direction, Preset};

use super::board::{FIRMWARE, POWER_ON, TURN_TICKS};
use super::wire::Wire;

/// The motor and the limit switch, which is never hit: the simulated track has no end for the drive.
#[derive(Debug)]
struct Hardware;

impl Port for Hardware {
    fn drive(&mut self, _: Direction, _: u8) {}

    fn release(&mut self, _: bool) {}

    fn limit(&self) -> bool {
        false
    }
}

/// A drive whose presets set the speed of the next passes.
#[derive(Debug)]
pub struct Drive {
    unit: DriveUnit,
    wire: Wire,
    now: u64,
}

impl Default for Drive {
    fn default() -> Self {
        Self::new()
    }
}

impl Drive {
    /// A drive that has just been reset.
    pub fn new() -> Self {
        Self { unit: DriveUnit::new(FIRMWARE, POWER_ON), wire: Wire::new(), now: 0 }
    }

    /// Bytes from the host; they take their time on the line.
    pub fn receive(&mut self, bytes: &[u8]) {
        self.wire.receive(bytes);
    }

    /// Whether bytes are on their way.
    pub fn is_busy(&self) -> bool {
        !self.wire.is_idle()
    }

    /// The preset in use.
    pub fn preset(&self) -> Preset {
        self.unit.preset()
    }

    /// Lets [`TURN_TICKS`] pass and returns the byte that was sent in them, if any.
    pub fn turn(&mut self) -> Option<u8> {
        self.now += TURN_TICKS;
        // The counter of the board has 32 bits.
        let now = self.now as u32;
        self.unit.step(now, &mut Hardware);
        if self.wire.is_free() {
            let answer = self.wire.command().map(|frame| self.unit.command(frame, now, &mut Hardware));
            if let Some(report) = answer.or_else(|| self.unit.report(&Hardware)) {
                self.wire.send(&report);
            }
        }
        self.wire.next()
    }
}
