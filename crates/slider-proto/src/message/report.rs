//! From the boards.

use super::sealed::Payload;
use super::{Direction, DriveState, EdgeBatch, EndReason, Level, Preset, Refusal, TimerState, Unit};
use crate::frame::ProtoError;
use crate::wire::{Reader, Writer};

/// What a unit tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Report {
    /// Kind 128: who speaks. Payload: unit `u8`, firmware version `u8` x 3, ticks a second `u32`, cause of the reset
    /// `u8`. Sent at reset and when asked for.
    Hello {
        /// Which firmware.
        unit: Unit,
        /// Its version: major, minor, patch.
        firmware: [u8; 3],
        /// Ticks a second.
        tick_hz: u32,
        /// Register MCUSR at reset (bit 0 power-on, 1 external, 2 brown-out, 3 watchdog); 0 if the bootloader had
        /// cleared it.
        reset_cause: u8,
    },
    /// Kind 129: the first tooth came and the camera was triggered. Payload: run `u16`, tick `u32`.
    RunStart {
        /// The run.
        run: u16,
        /// Time of the first edge.
        tick: u32,
    },
    /// Kind 130: edges of the run; payload at [`EdgeBatch`].
    Edges(EdgeBatch),
    /// Kind 131: the run is over and all its edges have been sent. Payload: run `u16`, edges `u16`, late `u16`, lost
    /// `u16`, reason `u8`.
    RunEnd {
        /// The run.
        run: u16,
        /// Edges sent.
        edges: u16,
        /// Those of them that are late.
        late: u16,
        /// The overrun flag if not 0: edges lost by overrun before the run ended, 65535 if more. Those sent are all edges
        /// before the first loss.
        lost: u16,
        /// Why it ended.
        reason: EndReason,
    },
    /// Kind 132: the limit was reached. Payload: tick `u32`.
    LimitHit {
        /// When the firmware saw it.
        tick: u32,
    },
    /// Kind 133: the drive's preset and state, at every change and as its status. Payload: number `u8`, duty `u8`,
    /// direction `u8`, state `u8`, limit `u8`.
    Preset {
        /// Number of the preset in use.
        index: u8,
        /// Its setting.
        preset: Preset,
        /// What the drive is doing.
        state: DriveState,
        /// Whether the limit switch is open, that is, hit.
        limit: bool,
    },
    /// Kind 134: the timer's status. Payload: state `u8`, run `u16`, edges so far `u16`, sensor `u8`, limit `u8`.
    Status {
        /// What the timer is doing.
        state: TimerState,
        /// The present or last run.
        run: u16,
        /// Edges so far.
        edges: u16,
        /// Level of the sensor now.
        sensor: Level,
        /// Whether the end of travel is reached.
        limit: bool,
    },
    /// Kind 135: a command was accepted. Payload: its sequence number `u8`.
    Ack {
        /// Sequence number of the command.
        sequence: u8,
    },
    /// Kind 136: a command was refused. Payload: its sequence number `u8`, reason `u8`.
    Nak {
        /// Sequence number of the command.
        sequence: u8,
        /// Why.
        reason: Refusal,
    },
    /// Kind 137: result of the self-test. Payload: edges `u8`, worst error in ticks `u16`.
    SelfTest {
        /// Edges that came through the loop-back wire; 0 if it is missing.
        edges: u8,
        /// Largest difference of an interval from its nominal length, in ticks, 65535 if more.
        worst_error_ticks: u16,
    },
}

impl Payload for Report {
    fn write(&self, writer: &mut Writer<'_>) {
        match *self {
            Self::Hello { unit, firmware, tick_hz, reset_cause } => {
                writer.u8(128);
                writer.u8(unit as u8);
                for part in firmware {
                    writer.u8(part);
                }
                writer.u32(tick_hz);
                writer.u8(reset_cause);
            }
            Self::RunStart { run, tick } => {
                writer.u8(129);
                writer.u16(run);
                writer.u32(tick);
            }
            Self::Edges(ref batch) => {
                writer.u8(130);
                batch.write(writer);
            }
            Self::RunEnd { run, edges, late, lost, reason } => {
                writer.u8(131);
                for count in [run, edges, late, lost] {
                    writer.u16(count);
                }
                writer.u8(reason as u8);
            }
            Self::LimitHit { tick } => {
                writer.u8(132);
                writer.u32(tick);
            }
            Self::Preset { index, preset, state, limit } => {
                writer.u8(133);
                for byte in [index, preset.duty, preset.direction as u8, state as u8, u8::from(limit)] {
                    writer.u8(byte);
                }
            }
            Self::Status { state, run, edges, sensor, limit } => {
                writer.u8(134);
                writer.u8(state as u8);
                writer.u16(run);
                writer.u16(edges);
                writer.u8(sensor as u8);
                writer.u8(u8::from(limit));
            }
            Self::Ack { sequence } => {
                writer.u8(135);
                writer.u8(sequence);
            }
            Self::Nak { sequence, reason } => {
                writer.u8(136);
                writer.u8(sequence);
                writer.u8(reason as u8);
            }
            Self::SelfTest { edges, worst_error_ticks } => {
                writer.u8(137);
                writer.u8(edges);
                writer.u16(worst_error_ticks);
            }
        }
    }

    fn read(kind: u8, reader: &mut Reader<'_>) -> Result<Self, ProtoError> {
        Ok(match kind {
            128 => Self::Hello {
                unit: Unit::read(reader)?,
                firmware: [reader.u8()?, reader.u8()?, reader.u8()?],
                tick_hz: reader.u32()?,
                reset_cause: reader.u8()?,
            },
            129 => Self::RunStart { run: reader.u16()?, tick: reader.u32()? },
            130 => Self::Edges(EdgeBatch::read(reader)?),
            131 => Self::RunEnd {
                run: reader.u16()?,
                edges: reader.u16()?,
                late: reader.u16()?,
                lost: reader.u16()?,
                reason: EndReason::read(reader)?,
            },
            132 => Self::LimitHit { tick: reader.u32()? },
            133 => Self::Preset {
                index: reader.u8()?,
                preset: Preset { duty: reader.u8()?, direction: Direction::read(reader)? },
                state: DriveState::read(reader)?,
                limit: reader.bool()?,
            },
            134 => Self::Status {
                state: TimerState::read(reader)?,
                run: reader.u16()?,
                edges: reader.u16()?,
                sensor: Level::read(reader)?,
                limit: reader.bool()?,
            },
            135 => Self::Ack { sequence: reader.u8()? },
            136 => Self::Nak { sequence: reader.u8()?, reason: Refusal::read(reader)? },
            137 => Self::SelfTest { edges: reader.u8()?, worst_error_ticks: reader.u16()? },
            unknown => return Err(ProtoError::Kind(unknown)),
        })
    }
}
