//! Reading.

use std::fs;
use std::path::Path;

use serde_json::Value;
use slider_proto::EdgeBatch;

use crate::Error;
use crate::reader::{Assembly, Ended, Missing, ToldEnd};
use crate::run::Run;

use super::VERSION;
use super::line::{FORMAT, Header, Line};

/// A run of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Logged {
    /// Who received it.
    pub header: Header,
    /// What was received.
    pub run: Run,
    /// Why its end is missing, if it is.
    pub incomplete: Option<String>,
    /// What was computed of it last.
    pub result: Option<Value>,
}

/// The runs of a file.
///
/// A last line that is torn is left out, as if the run had been cut off before it.
///
/// # Errors
///
/// [`Error::File`] if the file cannot be read; [`Error::Log`], with the number of the line, for a line that is no line
/// of such a file, of a version that this program does not know, or that does not follow from those before it.
pub fn load(path: impl AsRef<Path>) -> Result<Vec<Run>, Error> {
    Ok(read(path)?.into_iter().map(|logged| logged.run).collect())
}

/// The runs of a file with all that is known of them; otherwise as [`load`].
pub fn read(path: impl AsRef<Path>) -> Result<Vec<Logged>, Error> {
    let path = path.as_ref();
    let text = fs::read(path).map_err(|source| Error::File { path: path.to_owned(), source })?;
    parse(path, &text)
}

/// The runs of the `text` of a file; its `path` is for messages.
pub fn parse(path: &Path, text: &[u8]) -> Result<Vec<Logged>, Error> {
    runs(text).map_err(|(line, why)| Error::Log { path: path.to_owned(), line, why })
}

type Wrong = (usize, String);

fn runs(text: &[u8]) -> Result<Vec<Logged>, Wrong> {
    let mut loader = Loader::default();
    let mut number = 0;
    for line in text.split_inclusive(|&byte| byte == b'\n') {
        number += 1;
        let torn = line.last() != Some(&b'\n');
        if line.trim_ascii().is_empty() {
            continue;
        }
        match serde_json::from_slice::<Value>(line) {
            Ok(value) => loader.line(value).map_err(|why| (number, why))?,
            Err(_) if torn => {}
            Err(error) => return Err((number, format!("no JSON ({error})"))),
        }
    }
    loader.finish();
    Ok(loader.runs)
}

#[derive(Default)]
struct Loader {
    runs: Vec<Logged>,
    open: Option<(Header, Assembly)>,
}

impl Loader {
    fn line(&mut self, value: Value) -> Result<(), String> {
        if let Some(header) = value.get("header") {
            check_version(header)?;
        } else if self.open.is_none() && self.runs.is_empty() {
            return Err("the file does not begin with the header of a run".to_owned());
        }
        match serde_json::from_value(value).map_err(|error| format!("no line of a run ({error})"))? {
            Line::Header(header) => {
                self.finish();
                if header.tick_hz == 0 {
                    return Err("tick_hz is 0".to_owned());
                }
                let assembly = Assembly::new(header.run, header.tick, header.tick_hz);
                self.open = Some((header, assembly));
            }
            Line::Edges(edges) => {
                let (header, assembly) = self.open.as_mut().ok_or("edges after the end of the run")?;
                let batch = edges.batch(header.run)?;
                refuse_missing(assembly.batch(&batch))?;
            }
            Line::End(end) => {
                let told = ToldEnd { reason: end.reason, edges: end.edges, late: end.late, lost: end.lost };
                self.close(|assembly| {
                    let ended = assembly.end(told);
                    match ended.missing {
                        Some(missing) => Err(missing.to_string()),
                        None => Ok((ended, None)),
                    }
                })?;
            }
            Line::Incomplete(incomplete) => self.close(|assembly| {
                let ended = assembly.without_end(Missing::File);
                match ended.run.edges.len() {
                    found if found == incomplete.edges => Ok((ended, Some(incomplete.reason))),
                    found => Err(format!("{} edges are told and {found} are there", incomplete.edges)),
                }
            })?,
            Line::Result(result) => {
                let last = if self.open.is_none() { self.runs.last_mut() } else { None };
                last.ok_or("a result before the end of the run")?.result = Some(result);
            }
        }
        Ok(())
    }

    fn close(&mut self, end: impl FnOnce(Assembly) -> Result<(Ended, Option<String>), String>) -> Result<(), String> {
        let (header, assembly) = self.open.take().ok_or("a second end of the run")?;
        let (Ended { run, .. }, incomplete) = end(assembly)?;
        self.runs.push(Logged { header, run, incomplete, result: None });
        Ok(())
    }

    /// Ends a run that has no end.
    fn finish(&mut self) {
        if let Some((header, assembly)) = self.open.take() {
            let Ended { run, missing } = assembly.without_end(Missing::File);
            let incomplete = missing.map(|missing| missing.to_string());
            self.runs.push(Logged { header, run, incomplete, result: None });
        }
    }
}

/// Says so, before its fields are looked at, if the file is not for this program.
fn check_version(header: &Value) -> Result<(), String> {
    if header.get("format").and_then(Value::as_str) != Some(FORMAT) {
        return Err(format!("this is not a file of the format '{FORMAT}'"));
    }
    match header.get("version").and_then(Value::as_u64) {
        Some(version) if (1..=u64::from(VERSION)).contains(&version) => Ok(()),
        Some(version) => Err(format!("version {version} of the format, this program knows up to {VERSION}: update it")),
        None => Err("no version of the format".to_owned()),
    }
}

fn refuse_missing((_, missing): (EdgeBatch, Option<Missing>)) -> Result<(), String> {
    missing.map_or(Ok(()), |missing| Err(missing.to_string()))
}
