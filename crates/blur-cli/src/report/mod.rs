//! The report: one page of HTML with a section for every picture.
//!
//! The modules are the path that a section takes: [`section`] gathers what is known of a picture and calls the
//! [`figure`]s, one file each and one line in its list; these draw with [`svg`] and [`raster`] and write with [`html`],
//! which escapes whatever did not come from this program; [`page`] puts the sections together.
//!
//! The page needs nothing besides itself: style and pictures are inside it, and its content security policy forbids
//! everything else.

mod date;
pub mod figure;
pub mod html;
pub mod page;
pub mod raster;
pub mod section;
pub mod svg;

use std::fs;
use std::path::{Path, PathBuf};

use crate::measure::Finding;
use crate::{Error, Result};

/// Name of the page in its folder.
pub const FILE: &str = "report.html";

/// A report in the making.
#[derive(Debug)]
pub struct Report {
    folder: PathBuf,
    command: Vec<String>,
    entries: Vec<Entry>,
}

/// One picture in the report.
#[derive(Debug)]
struct Entry {
    image: String,
    /// Direction and length in a few words, or that there is no result.
    summary: String,
    status: &'static str,
    /// HTML of the section.
    section: String,
}

impl Report {
    /// A report in `folder`, which is made if it does not exist, of a run that was started as `command`.
    pub fn new(folder: &Path, command: Vec<String>) -> Result<Self> {
        if folder.exists() && !folder.is_dir() {
            return Err(Error::ReportIsFile.in_file(folder));
        }
        fs::create_dir_all(folder).map_err(|error| Error::Write(error).in_file(folder))?;
        Ok(Self { folder: folder.to_owned(), command, entries: Vec::new() })
    }

    /// Adds the next picture, named `image`.
    pub fn add(&mut self, image: &str, outcome: std::result::Result<&Finding, &Error>) {
        let entry = match outcome {
            Ok(finding) => Entry {
                image: image.to_owned(),
                summary: page::summary(&finding.record),
                status: finding.record.status,
                section: finding.section.clone().unwrap_or_default(),
            },
            Err(error) => Entry {
                image: image.to_owned(),
                summary: String::from("not measured"),
                status: "failed",
                section: section::of_failure(error),
            },
        };
        self.entries.push(entry);
    }

    /// Writes the page, in place of an older one, and returns where it is.
    pub fn write(&self) -> Result<PathBuf> {
        let path = self.folder.join(FILE);
        let unfinished = self.folder.join(format!("{FILE}.unfinished"));
        let html = page::html(&self.command, &self.entries, &date::now());
        let written = fs::write(&unfinished, html).and_then(|()| fs::rename(&unfinished, &path));
        written.map_err(|error| Error::Write(error).in_file(&path))?;
        Ok(path)
    }
}
