//! From the host.

use super::sealed::Payload;
use super::{ArmSettings, Direction, Preset};
use crate::frame::ProtoError;
use crate::wire::{Reader, Writer};

/// What the host asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Command {
    /// Kind 1, no payload: send `Hello`.
    Hello,
    /// Kind 2, no payload: send the status.
    Status,
    /// Kind 3: get ready for a run. Payload: run `u16`, trigger pulse in ms `u16`, quiet time in ms `u16`.
    Arm(ArmSettings),
    /// Kind 4, no payload: end the run, or stop the motor.
    Stop,
    /// Kind 5: set a preset. Payload: number `u8` from 0 to 9, duty `u8`, direction `u8`. Motion in that preset ends.
    SetPreset {
        /// Number of the preset.
        index: u8,
        /// Its new setting.
        preset: Preset,
    },
    /// Kind 6: move at a preset. Payload: number `u8`.
    Go {
        /// Number of the preset.
        index: u8,
    },
    /// Kind 7, no payload: measure the board's own reference signal through the loop-back wire.
    SelfTest,
}

impl Payload for Command {
    fn write(&self, writer: &mut Writer<'_>) {
        match *self {
            Self::Hello => writer.u8(1),
            Self::Status => writer.u8(2),
            Self::Arm(settings) => {
                writer.u8(3);
                writer.u16(settings.run);
                writer.u16(settings.trigger_ms);
                writer.u16(settings.quiet_ms);
            }
            Self::Stop => writer.u8(4),
            Self::SetPreset { index, preset } => {
                writer.u8(5);
                writer.u8(index);
                writer.u8(preset.duty);
                writer.u8(preset.direction as u8);
            }
            Self::Go { index } => {
                writer.u8(6);
                writer.u8(index);
            }
            Self::SelfTest => writer.u8(7),
        }
    }

    fn read(kind: u8, reader: &mut Reader<'_>) -> Result<Self, ProtoError> {
        Ok(match kind {
            1 => Self::Hello,
            2 => Self::Status,
            3 => Self::Arm(ArmSettings { run: reader.u16()?, trigger_ms: reader.u16()?, quiet_ms: reader.u16()? }),
            4 => Self::Stop,
            5 => Self::SetPreset {
                index: reader.u8()?,
                preset: Preset { duty: reader.u8()?, direction: Direction::read(reader)? },
            },
            6 => Self::Go { index: reader.u8()? },
            7 => Self::SelfTest,
            unknown => return Err(ProtoError::Kind(unknown)),
        })
    }
}
