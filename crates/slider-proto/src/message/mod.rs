//! The messages and their payloads.

mod command;
mod edges;
mod report;

pub use command::Command;
pub use edges::{Edge, EdgeBatch};
pub use report::Report;

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
