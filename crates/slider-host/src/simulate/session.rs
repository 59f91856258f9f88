//! The boards on their lines, in real time or faster.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use slider_proto::TICK_HZ;

use super::board::Board;
use super::drive::Drive;
use super::line::Line;
use super::rig::Truth;
use super::{Options, Track};
use crate::Error;

/// Turns between two looks at the line: some 2 ms.
const SLICE: usize = 12;
/// How far the board may fall behind the clock before it gives the lost time up.
const PATIENCE: Duration = Duration::from_millis(200);
/// How long the line is held open at the end for a host that has not read everything.
const LAST_WORDS: Duration = Duration::from_secs(5);
/// How long nothing has to be unread until everything counts as read: the system takes its time to hand bytes over, and
/// until then they show nowhere.
const SETTLED: Duration = Duration::from_millis(300);

/// Keeps the board from running ahead of the clock.
struct Pace {
    begun: Instant,
    tick: u64,
}

impl Pace {
    fn from(tick: u64) -> Self {
        Self { begun: Instant::now(), tick }
    }

    fn wait(&mut self, tick: u64) {
        let due = Duration::from_secs_f64(tick.saturating_sub(self.tick) as f64 / f64::from(TICK_HZ));
        let elapsed = self.begun.elapsed();
        if elapsed < due {
            std::thread::sleep(due.saturating_sub(elapsed));
        } else if elapsed > due + PATIENCE {
            *self = Self::from(tick);
        }
    }
}

/// Where the truth goes, if anywhere.
pub(super) struct TruthFile<'a>(Option<(&'a Path, File)>);

impl<'a> TruthFile<'a> {
    pub(super) fn create(path: Option<&'a Path>) -> Result<Self, Error> {
        let Some(path) = path else { return Ok(Self(None)) };
        let file = File::create(path).map_err(|source| Error::File { path: path.into(), source })?;
        Ok(Self(Some((path, file))))
    }

    /// Writes one line, at once.
    pub(super) fn write(&mut self, truth: &Truth) -> Result<(), Error> {
        let Some((path, file)) = &mut self.0 else { return Ok(()) };
        let line = serde_json::to_string(truth).map_err(|error| Error::Simulation(error.to_string()))?;
        file.write_all(format!("{line}\n").as_bytes()).map_err(|source| Error::File { path: (*path).into(), source })
    }
}

pub(super) fn run(options: &Options, track: Track, out: &mut dyn Write) -> Result<(), Error> {
    let mut truths = TruthFile::create(options.truth.as_deref())?;
    let mut line = Line::open().map_err(Error::PseudoTerminal)?;
    let rig = track.rig.clone();
    let mut board = Board::new(track);
    let mut drive = if options.drive {
        let (line, drive) = (Line::open().map_err(Error::PseudoTerminal)?, Drive::new());
        board.set_motion(options.motion_at(drive.preset(), &rig)?);
        Some((line, drive))
    } else {
        None
    };
    writeln!(out, "pty {}", line.path()).map_err(Error::PseudoTerminal)?;
    if let Some((line, _)) = &drive {
        writeln!(out, "drive {}", line.path()).map_err(Error::PseudoTerminal)?;
    }
    out.flush().map_err(Error::PseudoTerminal)?;
    let mut pace = Pace::from(board.tick());
    let mut bytes = Vec::with_capacity(SLICE);
    while options.runs.is_none_or(|runs| board.runs() < runs) {
        board.receive(&line.read().map_err(Error::PseudoTerminal)?);
        bytes.clear();
        bytes.extend((0..SLICE).filter_map(|_| board.turn()));
        // Before the host knows of the run, so that it finds its truth.
        for truth in board.take_truths() {
            truths.write(&truth)?;
        }
        line.write(&bytes).map_err(Error::PseudoTerminal)?;
        let mut busy = board.is_busy();
        if let Some((line, drive)) = &mut drive {
            let before = drive.preset();
            drive.receive(&line.read().map_err(Error::PseudoTerminal)?);
            bytes.clear();
            bytes.extend((0..SLICE).filter_map(|_| drive.turn()));
            line.write(&bytes).map_err(Error::PseudoTerminal)?;
            if drive.preset() != before {
                board.set_motion(options.motion_at(drive.preset(), &rig)?);
            }
            busy |= drive.is_busy();
        }
        if options.fast && busy {
            pace = Pace::from(board.tick());
        } else {
            pace.wait(board.tick());
        }
    }
    wait_for_reader(&line).map_err(Error::PseudoTerminal)
}

/// Waits until the host has read everything: what is in the line goes with it when it is closed.
fn wait_for_reader(line: &Line) -> io::Result<()> {
    let ended = Instant::now();
    let mut unread_at = ended;
    while unread_at.elapsed() < SETTLED && ended.elapsed() < LAST_WORDS {
        std::thread::sleep(Duration::from_millis(5));
        if line.unread()? > 0 {
            unread_at = Instant::now();
        }
    }
    Ok(())
}
