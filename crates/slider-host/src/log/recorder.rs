//! From what happens on the line to files.

use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use serde::Serialize;

use crate::Error;
use crate::reader::{Ended, Event};

use super::line::FORMAT;
use super::{Header, Log, VERSION};

/// Where runs come from, for the headers.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Source {
    /// The serial port.
    pub port: String,
    /// `timer`, or `drive`.
    pub unit: String,
    /// Version of the firmware.
    pub firmware: String,
    /// Name of the sheet.
    pub sheet: Option<String>,
}

/// Saves the runs of a line, each in a file of its own.
#[derive(Debug)]
pub struct Recorder {
    folder: PathBuf,
    source: Source,
    open: Option<Log>,
}

/// A run that is on the disk.
#[derive(Debug)]
pub struct Saved {
    log: Log,
}

impl Saved {
    /// The file.
    pub fn path(&self) -> &Path {
        self.log.path()
    }

    /// Adds what was computed of the run.
    pub fn result(&mut self, result: &impl Serialize) -> Result<(), Error> {
        self.log.result(result)
    }
}

impl Recorder {
    /// Saves runs in `folder`.
    pub fn new(folder: impl Into<PathBuf>, source: Source) -> Self {
        Self { folder: folder.into(), source, open: None }
    }

    /// Changes what the headers of the next runs say.
    pub fn set_source(&mut self, source: Source) {
        self.source = source;
    }

    /// Writes what belongs into the file of a run. At the end of the run, returns that file.
    pub fn record(&mut self, event: &Event) -> Result<Option<Saved>, Error> {
        match event {
            Event::Began { run, tick, tick_hz } => {
                let Source { port, unit, firmware, sheet } = self.source.clone();
                let header = Header {
                    format: FORMAT.to_owned(),
                    version: VERSION,
                    program: env!("CARGO_PKG_VERSION").to_owned(),
                    port,
                    unit,
                    firmware,
                    tick_hz: *tick_hz,
                    // Milliseconds are what a serial line leaves of it.
                    started_s: (now_s() * 1e3).round() / 1e3,
                    sheet,
                    run: *run,
                    tick: *tick,
                };
                self.open = Some(Log::create(&self.folder, header)?);
            }
            Event::Edges(batch) => {
                if let Some(log) = &mut self.open {
                    log.edges(batch)?;
                }
            }
            Event::Ended(ended) => return self.ended(ended),
            _ => {}
        }
        Ok(None)
    }

    /// Writes the end of a run that the line did not tell, as [`Reader::close`](crate::reader::Reader::close) returns it.
    pub fn ended(&mut self, ended: &Ended) -> Result<Option<Saved>, Error> {
        let Some(mut log) = self.open.take() else { return Ok(None) };
        log.ended(ended)?;
        Ok(Some(Saved { log }))
    }

    /// To be called several times a second, so that no edge waits longer than a second for the disk.
    pub fn sync_if_due(&mut self) -> Result<(), Error> {
        self.open.as_mut().map_or(Ok(()), Log::sync_if_due)
    }
}

/// Time of day by the computer's clock, s since 1970-01-01 UTC; 0 if it is set to before that.
fn now_s() -> f64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0.0, |passed| passed.as_secs_f64())
}
