//! A slider without hardware: for those who have none, and for tests that need to know what is true.
//!
//! ```text
//! motion -> rig (sheet, sensor, clock) -> board (the timer's own logic, or its firmware) -> pseudo-terminal
//! ```
//!
//! [`motion`] knows where the carriage is at a time; [`rig`] makes the edges of a pass of it and tells what is true of
//! them; [`board`] is a timer that stamps them, with the logic of the firmware; [`run`] offers its line to a host. [`drive`] is a
//! drive whose presets set the speed.
//!
//! With the real firmware a host has to wait for its `Hello`, as with a board: the chip hears nothing before.

pub mod board;
pub mod drive;
mod firmware;
#[cfg(unix)]
mod line;
pub mod motion;
mod options;
mod random;
pub mod rig;
#[cfg(unix)]
mod session;
mod wire;

pub use options::Options;

use std::io::Write;

use crate::Error;
use motion::Motion;
use rig::{Pass, Rig};

/// Streams of a seed from here on draw the phases of the ripple.
const PHASE_STREAM: u64 = 1 << 32;

/// A rig and how its carriage moves in one pass after the other.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// The rig.
    pub rig: Rig,
    /// The motions, which are used in turn.
    pub motions: Vec<Motion>,
    /// Time from the arming to the start of the carriage, s.
    pub delay_s: f64,
    /// What the phases of the motor's ripple are drawn from.
    pub seed: u64,
}

impl Track {
    /// Pass number `index`, from 0; `None` without a motion.
    pub fn pass(&self, index: u32) -> Option<Pass> {
        let phase_rad = std::f64::consts::TAU * random::Random::new(self.seed, PHASE_STREAM + u64::from(index)).unit();
        let motion = self.motions.get((index as usize).checked_rem(self.motions.len())?)?;
        Some(self.rig.pass(&motion.with_phase(phase_rad), index))
    }
}

/// Runs a virtual slider as `options` say: the first line to `out` is `pty PATH`, and whatever opens PATH talks to a
/// timer; if there is a drive, a second line `drive PATH` names its line. Returns after the number of runs that was asked for, and never without one.
///
/// # Errors
/// [`Error::Simulation`] for a slider that cannot be, [`Error::File`] and [`Error::Sheet`] for a sheet that cannot be
/// read, [`Error::PseudoTerminal`] when the line fails, [`Error::Firmware`] when the firmware was asked for and does not run.
pub fn run(options: &Options, out: &mut dyn Write) -> Result<(), Error> {
    let track = options.track()?;
    if options.firmware.is_some() {
        return firmware::run(options, &track, out);
    }
    #[cfg(unix)]
    return session::run(options, track, out);
    #[cfg(not(unix))]
    Err(Error::Simulation("this system has no pseudo-terminals".to_owned()))
}
