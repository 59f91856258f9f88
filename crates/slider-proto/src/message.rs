//! The messages and their payloads.

use crate::frame::ProtoError;
use crate::wire::{Reader, Writer};

/// A message that a frame can carry: a [`Command`] or a [`Report`].
pub trait Message: sealed::Payload {}

impl Message for Command {}
impl Message for Report {}

pub(crate) mod sealed {
    use super::{ProtoError, Reader, Writer};

    /// Kind and payload on the wire.
    pub trait Payload: Sized {
        /// Writes the kind and the payload.
        fn write(&self, writer: &mut Writer<'_>);

        /// Reads the payload of a message of this `kind`.
        fn read(kind: u8, reader: &mut Reader<'_>) -> Result<Self, ProtoError>;
    }
}

/// A fieldless enumeration with its codes on the wire.
macro_rules! coded {
    ($(#[$meta:meta])* $name:ident { $($(#[$variant_meta:meta])* $variant:ident = $code:literal,)+ }) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[repr(u8)]
        pub enum $name { $($(#[$variant_meta])* $variant = $code,)+ }

        impl $name {
            fn read(reader: &mut Reader<'_>) -> Result<Self, ProtoError> {
                match reader.u8()? {
                    $($code => Ok(Self::$variant),)+
                    _ => Err(ProtoError::Payload),
                }
            }
        }
    };
}

coded! {
    /// Which firmware speaks.
    Unit {
        /// The encoder timer.
        Timer = 0,
        /// The motor drive.
        Drive = 1,
    }
}

coded! {
    /// Level of the sensor's output.
    Level {
        /// Blocked: a tooth.
        Low = 0,
        /// Open: a slit.
        High = 1,
    }
}

impl Level {
    /// The other level.
    #[inline]
    #[must_use]
    pub const fn inverse(self) -> Self {
        match self {
            Self::Low => Self::High,
            Self::High => Self::Low,
        }
    }
}

coded! {
    /// What the timer is doing.
    TimerState {
        /// Nothing: edges are ignored.
        Idle = 0,
        /// Waiting for the first tooth.
        Armed = 1,
        /// Stamping edges.
        Running = 2,
        /// Measuring its own reference signal.
        SelfTest = 3,
    }
}

coded! {
    /// Why a run ended.
    EndReason {
        /// No edge for the time that was set when it was armed.
        Quiet = 0,
        /// The end of travel was reached.
        Limit = 1,
        /// The host said stop.
        Stopped = 2,
        /// 65535 edges, the most that a run can number.
        Full = 3,
        /// Edges came faster than they could be sent, for too long.
        Overrun = 4,
    }
}

coded! {
    /// Direction of travel.
    Direction {
        /// Towards the limit switch.
        Forward = 0,
        /// Away from it.
        Reverse = 1,
    }
}

coded! {
    /// What the drive is doing.
    DriveState {
        /// The motor is off.
        Stopped = 0,
        /// The duty rises to that of the preset.
        Starting = 1,
        /// The duty is that of the preset.
        Running = 2,
        /// The limit switch has cut the motor off.
        AtLimit = 3,
    }
}

coded! {
    /// Why a command was refused.
    Refusal {
        /// The frame could not be read; the sequence number is not known and given as 0.
        Garbled = 0,
        /// This unit does not have that command.
        NotMine = 1,
        /// A run or a self-test is going on.
        Busy = 2,
        /// The sensor is blocked: the first tooth would be missed.
        SensorBlocked = 3,
        /// There is no preset with this number.
        NoSuchPreset = 4,
        /// The carriage stands at the limit switch and the preset goes towards it.
        AtLimit = 5,
        /// A value is outside its range.
        OutOfRange = 6,
    }
}

/// One edge of the sensor's output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Edge {
    /// Time in ticks of [`TICK_HZ`](crate::TICK_HZ), modulo 2^32.
    pub tick: u32,
    /// Level after the edge.
    pub level: Level,
    /// The edge came before the one before it had been served, so the hardware has not captured it. Its time is when
    /// the interrupt found it: too late by at most the length of that interrupt, some 15 us.
    pub late: bool,
}

/// Up to eight edges of a run, in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EdgeBatch {
    /// The run they belong to.
    pub run: u16,
    /// Number of edges of the run before the first of these.
    pub first_index: u16,
    edges: [Edge; Self::CAPACITY],
    length: u8,
}

impl EdgeBatch {
    /// Most edges in one batch.
    pub const CAPACITY: usize = 8;

    /// An empty batch.
    #[must_use]
    pub const fn new(run: u16, first_index: u16) -> Self {
        let none = Edge { tick: 0, level: Level::Low, late: false };
        Self { run, first_index, edges: [none; Self::CAPACITY], length: 0 }
    }

    /// Adds an edge; if the batch is full, gives it back.
    pub fn push(&mut self, edge: Edge) -> Result<(), Edge> {
        match self.edges.get_mut(usize::from(self.length)) {
            Some(slot) => {
                *slot = edge;
                self.length += 1;
                Ok(())
            }
            None => Err(edge),
        }
    }

    /// The edges.
    #[must_use]
    pub fn edges(&self) -> &[Edge] {
        self.edges.get(..usize::from(self.length)).unwrap_or_default()
    }

    /// Payload: run `u16`, first index `u16`, count `u8`, levels `u8` (bit i is the level of edge i), late `u8`
    /// (likewise), first tick `u32`, then the ticks from each edge to the next as varints.
    fn write(&self, writer: &mut Writer<'_>) {
        writer.u16(self.run);
        writer.u16(self.first_index);
        writer.u8(self.length);
        let bits =
            |is: fn(&Edge) -> bool| self.edges().iter().rev().fold(0u8, |bits, edge| (bits << 1) | u8::from(is(edge)));
        writer.u8(bits(|edge| edge.level == Level::High));
        writer.u8(bits(|edge| edge.late));
        let mut before = None;
        for edge in self.edges() {
            match before {
                None => writer.u32(edge.tick),
                Some(before) => writer.varint(edge.tick.wrapping_sub(before)),
            }
            before = Some(edge.tick);
        }
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, ProtoError> {
        let mut batch = Self::new(reader.u16()?, reader.u16()?);
        let length = reader.u8()?;
        let (levels, late) = (reader.u8()?, reader.u8()?);
        let beyond = if length < 8 { !0u8 << length } else { 0 };
        if length == 0 || usize::from(length) > Self::CAPACITY || (levels | late) & beyond != 0 {
            return Err(ProtoError::Payload);
        }
        let mut tick = reader.u32()?;
        for i in 0..length {
            if i > 0 {
                tick = tick.wrapping_add(reader.varint()?);
            }
            let level = if levels >> i & 1 == 0 { Level::Low } else { Level::High };
            let edge = Edge { tick, level, late: late >> i & 1 == 1 };
            batch.push(edge).map_err(|_| ProtoError::Payload)?;
        }
        Ok(batch)
    }
}

/// How a run is to be taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ArmSettings {
    /// Number that the host gives the run.
    pub run: u16,
    /// Length of the camera's trigger pulse in ms, at least 1.
    pub trigger_ms: u16,
    /// The run ends when no edge came for so many ms, at least 1.
    pub quiet_ms: u16,
}

impl Default for ArmSettings {
    /// A pulse of 100 ms, and an end after 2 s without an edge.
    fn default() -> Self {
        Self { run: 0, trigger_ms: 100, quiet_ms: 2000 }
    }
}

/// One motor preset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Preset {
    /// Duty of the PWM, from 0 (off) to 255 (always on).
    pub duty: u8,
    /// Direction of travel.
    pub direction: Direction,
}

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

impl sealed::Payload for Command {
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

impl sealed::Payload for Report {
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
