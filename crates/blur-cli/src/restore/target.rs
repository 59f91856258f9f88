//! Where restored pictures are written.

use std::collections::HashSet;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use image::ImageFormat;

use crate::input::Input;
use crate::{Error, Result};

/// The file for each input, in their order; `None` for inputs that have failed already.
///
/// `path` is a file or a folder: a folder exists or ends in a separator. Files in a folder have the names of the inputs with the
/// extension `.png`, and a number where two inputs would have one name.
///
/// # Errors
/// [`Error::RestoreFolder`] for several inputs and one file, [`Error::RestoreFormat`] for a file that is neither PNG nor TIFF,
/// [`Error::RestoreOverwrites`] when a file is one of the inputs.
pub fn targets(inputs: &[Input], path: &Path) -> Result<Vec<Option<PathBuf>>> {
    let targets = if is_folder(path) {
        in_folder(inputs, path)
    } else if inputs.len() > 1 {
        return Err(Error::RestoreFolder { path: path.to_owned(), inputs: inputs.len() });
    } else {
        format(path).ok_or_else(|| Error::RestoreFormat { path: path.to_owned() })?;
        inputs.iter().map(|input| (!matches!(input, Input::Failed { .. })).then(|| path.to_owned())).collect()
    };
    // A link to an input is that input too.
    let sources: HashSet<PathBuf> =
        inputs.iter().filter_map(file).filter_map(|path| fs::canonicalize(path).ok()).collect();
    match targets.iter().flatten().find(|target| fs::canonicalize(target).is_ok_and(|path| sources.contains(&path))) {
        Some(target) => Err(Error::RestoreOverwrites { path: target.clone() }),
        None => Ok(targets),
    }
}

/// [`targets`], after making the folder that they lie in when it is named and missing.
///
/// # Errors
/// Those of [`targets`], and [`Error::Write`].
pub(crate) fn prepare(inputs: &[Input], path: &Path) -> Result<Vec<Option<PathBuf>>> {
    let targets = targets(inputs, path)?;
    if is_folder(path) {
        fs::create_dir_all(path).map_err(|error| Error::Write(error).in_file(path))?;
    }
    Ok(targets)
}

/// The format that a file is written in, by its extension.
pub(super) fn format(path: &Path) -> Option<ImageFormat> {
    ImageFormat::from_path(path).ok().filter(|format| matches!(format, ImageFormat::Png | ImageFormat::Tiff))
}

fn is_folder(path: &Path) -> bool {
    path.is_dir() || path.to_string_lossy().ends_with(std::path::is_separator)
}

fn file(input: &Input) -> Option<&Path> {
    match input {
        Input::File(path) => Some(path),
        Input::Sample | Input::Failed { .. } => None,
    }
}

fn in_folder(inputs: &[Input], folder: &Path) -> Vec<Option<PathBuf>> {
    let mut taken = HashSet::new();
    inputs
        .iter()
        .map(|input| {
            let stem = match input {
                Input::File(path) => path.file_stem().unwrap_or(path.as_os_str()).to_owned(),
                Input::Sample => OsString::from("sample"),
                Input::Failed { .. } => return None,
            };
            let mut name = numbered(&stem, 1);
            // Names that differ in their case only are one file on some systems.
            for number in 2.. {
                if taken.insert(name.to_string_lossy().to_lowercase()) {
                    break;
                }
                name = numbered(&stem, number);
            }
            Some(folder.join(name))
        })
        .collect()
}

/// `name.png`, `name-2.png`, `name-3.png` ...
fn numbered(stem: &std::ffi::OsStr, number: usize) -> OsString {
    let mut name = stem.to_owned();
    if number > 1 {
        name.push(format!("-{number}"));
    }
    name.push(".png");
    name
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a path that is refused fails the test")]

    use super::*;

    fn files(names: &[&str]) -> Vec<Input> {
        names.iter().map(|name| Input::File(PathBuf::from(name))).collect()
    }

    #[test]
    fn inputs_of_one_name_do_not_overwrite_each_other() {
        let inputs = files(&["a/x.png", "b/x.jpg", "b/X.tif", "x-2.png", "c/y.png"]);
        let names: Vec<_> = targets(&inputs, Path::new("out/")).unwrap().into_iter().flatten().collect();
        let expected = ["out/x.png", "out/x-2.png", "out/X-3.png", "out/x-2-2.png", "out/y.png"];
        assert_eq!(names, expected.map(PathBuf::from));
    }

    #[test]
    fn several_inputs_need_a_folder() {
        let refused = targets(&files(&["a.png", "b.png"]), Path::new("out.png"));
        assert!(matches!(refused, Err(Error::RestoreFolder { inputs: 2, .. })));
        assert_eq!(targets(&files(&["a.png"]), Path::new("out.png")).unwrap(), [Some(PathBuf::from("out.png"))]);
    }

    #[test]
    fn a_file_is_png_or_tiff() {
        for name in ["out.jpg", "out", "out.gif"] {
            assert!(matches!(targets(&files(&["a.png"]), Path::new(name)), Err(Error::RestoreFormat { .. })), "{name}");
        }
        assert!(targets(&files(&["a.png"]), Path::new("out.TIFF")).is_ok());
    }
}
