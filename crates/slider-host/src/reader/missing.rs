//! Why the rest of a run is missing.

use slider_proto::ProtoError;
use slider_proto::section::LevelRepeated;

/// What ended a run before its own end. What was received up to there is sound.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Missing {
    /// The sequence numbers have a gap.
    #[error("{0} frames were lost or came twice (modulo 256)")]
    Frames(u8),
    /// A frame of the right checksum has a payload that this program cannot read.
    #[error("a frame cannot be read: {0}")]
    Unreadable(ProtoError),
    /// The device began anew, with this cause.
    #[error("the device was reset ({})", super::reset_cause(*.0))]
    Reset(u8),
    /// Something of another run came before the end of this one.
    #[error("a frame of run {0} came before its end")]
    OtherRun(u16),
    /// Edges are left out or repeated.
    #[error("edge {found} came where edge {expected} was due")]
    Index {
        /// Index of the next edge.
        expected: u16,
        /// First index of the batch.
        found: u16,
    },
    /// The first edge is not the one that triggered the camera.
    #[error("the first edge is at tick {found}, the start was told for tick {told}")]
    Start {
        /// Tick of the start.
        told: u32,
        /// Tick of the first edge.
        found: u32,
    },
    /// The first edge leads into a slit.
    #[error("the first edge is the end of a tooth whose beginning is missing")]
    SlitFirst,
    /// Two edges led to the same level.
    #[error(transparent)]
    Level(#[from] LevelRepeated),
    /// Time does not go forward.
    #[error("edge {index} at tick {tick} is not after the one before it, at tick {before}")]
    Order {
        /// Index of the edge.
        index: usize,
        /// Its tick.
        tick: u32,
        /// Tick of the edge before it.
        before: u32,
    },
    /// The count of the end is another.
    #[error("its end tells {told} edges and {received} were received")]
    Count {
        /// Edges that the timer sent.
        told: u16,
        /// Edges received.
        received: usize,
    },
    /// The count of late edges is another.
    #[error("its end tells {told} late edges and {received} were received")]
    Late {
        /// Late edges that the timer sent.
        told: u16,
        /// Late edges received.
        received: usize,
    },
    /// The line went away.
    #[error("the line went away")]
    Line,
    /// The user ended it.
    #[error("the program was stopped")]
    Stopped,
    /// A file of the run ends without it.
    #[error("the file ends before it")]
    File,
}
