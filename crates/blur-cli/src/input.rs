//! Which pictures to measure: files, folders and patterns in a fixed order.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use crate::{Error, Result, sample};

/// Extensions by which a folder's pictures are recognised, in lower case. A file named on its own may be called anything.
pub const EXTENSIONS: &[&str] = &["png", "jpg", "jpeg", "tif", "tiff"];

/// One thing to measure.
#[derive(Debug)]
pub enum Input {
    /// A picture file.
    File(PathBuf),
    /// The built-in sample.
    Sample,
    /// An argument that leads to no picture; the others are measured all the same.
    Failed {
        /// The argument.
        argument: PathBuf,
        /// Why it leads nowhere.
        error: Error,
    },
}

impl Input {
    /// The name under which results are reported.
    pub fn name(&self) -> String {
        match self {
            Self::File(path) | Self::Failed { argument: path, .. } => path.display().to_string(),
            Self::Sample => sample::NAME.to_owned(),
        }
    }
}

/// The pictures that command-line arguments stand for, in the order of the arguments.
///
/// - A file stands for itself.
/// - A folder stands for the pictures directly in it (by [extension](EXTENSIONS)), sorted by name; folders inside it are
///   not entered.
/// - Anything else with `*`, `?` or `[` is a pattern; its matches are sorted by name and treated like arguments.
pub fn expand<P: AsRef<Path>>(arguments: &[P]) -> Vec<Input> {
    arguments.iter().flat_map(|argument| expand_argument(argument.as_ref())).collect()
}

fn expand_argument(argument: &Path) -> Vec<Input> {
    // A file whose name holds a '[' is found before the name is tried as a pattern.
    let Err(missing) = fs::metadata(argument) else {
        return expand_existing(argument);
    };
    match argument.to_str() {
        Some(pattern) if pattern.contains(['*', '?', '[']) => match matches(pattern) {
            Ok(inputs) => inputs,
            Err(error) => vec![failed(argument, error)],
        },
        _ => vec![failed(argument, Error::Read(missing))],
    }
}

fn expand_existing(path: &Path) -> Vec<Input> {
    if !path.is_dir() {
        return vec![Input::File(path.to_owned())];
    }
    match pictures_in(path) {
        Ok(paths) => paths.into_iter().map(Input::File).collect(),
        Err(error) => vec![failed(path, error)],
    }
}

fn pictures_in(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder).map_err(Error::Read)? {
        let path = entry.map_err(Error::Read)?.path();
        if has_picture_extension(&path) && !path.is_dir() {
            paths.push(path);
        }
    }
    if paths.is_empty() {
        return Err(Error::NoPictureInFolder { extensions: EXTENSIONS });
    }
    paths.sort();
    Ok(paths)
}

fn has_picture_extension(path: &Path) -> bool {
    let extension = path.extension().and_then(OsStr::to_str).map(str::to_ascii_lowercase);
    extension.is_some_and(|extension| EXTENSIONS.contains(&extension.as_str()))
}

/// Matches in the order of `glob`, which sorts by name.
fn matches(pattern: &str) -> Result<Vec<Input>> {
    let mut inputs = Vec::new();
    for found in glob::glob(pattern)? {
        match found {
            Ok(path) => inputs.extend(expand_existing(&path)),
            Err(error) => {
                let path = error.path().to_owned();
                inputs.push(failed(&path, Error::Read(error.into())));
            }
        }
    }
    if inputs.is_empty() { Err(Error::NoMatch) } else { Ok(inputs) }
}

fn failed(argument: &Path, error: Error) -> Input {
    Input::Failed { argument: argument.to_owned(), error }
}
