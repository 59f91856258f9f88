//! Writing.

use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde::Serialize;
use slider_proto::{EdgeBatch, EndReason};

use crate::Error;
use crate::reader::Ended;
use crate::run::End;

use super::line::{Edges, Header, Incomplete, Line, TimerEnd};
use super::name::file_name;

/// The longest that a line waits for the disk.
const SYNC: Duration = Duration::from_secs(1);

/// The file of one run.
#[derive(Debug)]
pub struct Log {
    file: File,
    path: PathBuf,
    text: Vec<u8>,
    /// When the first line came that is not yet on the disk.
    unsynced: Option<Instant>,
}

impl Log {
    /// Makes a new file in `folder`, which is made if it is not there, and writes the header. A file that is there is
    /// never touched: the name gets a number more.
    pub fn create(folder: &Path, header: Header) -> Result<Self, Error> {
        let failed = |path: &Path| {
            let path = path.to_owned();
            move |source| Error::File { path, source }
        };
        fs::create_dir_all(folder).map_err(failed(folder))?;
        let name = file_name(header.started_s, header.run);
        let mut path = folder.join(&name);
        let mut copy = 1_u32;
        let file = loop {
            match File::options().append(true).create_new(true).open(&path) {
                Ok(file) => break file,
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                    copy += 1;
                    path = folder.join(format!("{}-{copy}.jsonl", name.trim_end_matches(".jsonl")));
                }
                Err(error) => return Err(failed(&path)(error)),
            }
        };
        let mut log = Self { file, path, text: Vec::new(), unsynced: None };
        log.line(&Line::<()>::Header(header))?;
        log.sync()?;
        // The name is on the disk when the folder is; where a folder cannot be opened, the system does that.
        if let Ok(folder) = File::open(folder) {
            let _ = folder.sync_all();
        }
        Ok(log)
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes a batch.
    pub fn edges(&mut self, batch: &EdgeBatch) -> Result<(), Error> {
        self.line(&Line::<()>::Edges(Edges::from(batch)))?;
        self.sync_if_due()
    }

    /// Writes the end of the run, or why it is missing.
    pub fn ended(&mut self, ended: &Ended) -> Result<(), Error> {
        let edges = &ended.run.edges;
        let line = match (ended.run.end, ended.missing) {
            (End::Told { reason, edges: told, lost }, None) => {
                let late = edges.iter().filter(|edge| edge.late).count();
                Line::<()>::End(Self::end(reason, told, late, lost))
            }
            (_, missing) => {
                let reason = missing.map_or_else(|| "unknown".to_owned(), |missing| missing.to_string());
                Line::Incomplete(Incomplete { reason, edges: edges.len() })
            }
        };
        self.line(&line)?;
        self.sync()
    }

    fn end(reason: EndReason, edges: u16, late: usize, lost: u16) -> TimerEnd {
        TimerEnd { reason, edges, late: u16::try_from(late).unwrap_or(u16::MAX), lost }
    }

    /// Writes what was computed of the run.
    pub fn result(&mut self, result: &impl Serialize) -> Result<(), Error> {
        self.line(&Line::Result(result))?;
        self.sync()
    }

    /// To be called several times a second: brings to the disk what has waited for a second.
    pub fn sync_if_due(&mut self) -> Result<(), Error> {
        match self.unsynced {
            Some(since) if since.elapsed() >= SYNC => self.sync(),
            _ => Ok(()),
        }
    }

    fn sync(&mut self) -> Result<(), Error> {
        self.unsynced = None;
        self.file.sync_data().map_err(|source| self.failed(source))
    }

    fn line<R: Serialize>(&mut self, line: &Line<R>) -> Result<(), Error> {
        self.text.clear();
        serde_json::to_writer(&mut self.text, line).map_err(|error| self.failed(error.into()))?;
        self.text.push(b'\n');
        self.unsynced.get_or_insert_with(Instant::now);
        self.file.write_all(&self.text).map_err(|source| self.failed(source))
    }

    fn failed(&self, source: io::Error) -> Error {
        Error::File { path: self.path.clone(), source }
    }
}
