//! The one error type of the crate.

use std::io;

use thiserror::Error;

/// Shorthand for results of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// Why a stream cannot run.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// The queue has no room.
    #[error("a queue of {capacity} frames holds none: give it room for at least one")]
    Capacity {
        /// Frames asked for.
        capacity: usize,
    },
    /// The worker thread cannot be started.
    #[error("the worker thread cannot be started: {0}")]
    Thread(#[source] io::Error),
    /// The worker panicked, so the frames since then were not worked on.
    #[error("the worker panicked after {done} frames: {message}")]
    Worker {
        /// Frames done before.
        done: u64,
        /// What it said.
        message: String,
    },
}
