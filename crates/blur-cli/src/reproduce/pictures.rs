//! The sharp pictures that are blurred, and where they lie.

use std::path::{Path, PathBuf};

use ndarray::Array2;

use crate::input::{self, Input};
use crate::picture::{self, Linearize};
use crate::{Error, Result};

/// The variable that names the data folder.
pub const FOLDER_VARIABLE: &str = "BLUR_DATA";

/// The data folder when nothing else is said: beside the project, seen from its root.
pub const DEFAULT_FOLDER: &str = "../shared/data";

/// The folders of sharp pictures in the data folder.
const SHARP_FOLDERS: [&str; 2] = ["kodak", "skimage"];

/// The folder named by [`FOLDER_VARIABLE`], or the default one.
pub fn default_folder() -> PathBuf {
    std::env::var_os(FOLDER_VARIABLE).map_or_else(|| PathBuf::from(DEFAULT_FOLDER), PathBuf::from)
}

/// A sharp picture to blur.
#[derive(Debug, Clone)]
pub struct Sharp {
    /// File name.
    pub name: String,
    /// Luma on the 0..255 scale.
    pub luma: Array2<f64>,
}

/// All pictures of `kodak` and `skimage` in `folder`, sorted by folder and name; where `folder` has neither of them,
/// the pictures directly in it.
///
/// # Errors
///
/// When a folder or a picture cannot be read.
pub fn sharp_pictures(folder: &Path) -> Result<Vec<Sharp>> {
    let mut folders: Vec<PathBuf> =
        SHARP_FOLDERS.iter().map(|name| folder.join(name)).filter(|path| path.is_dir()).collect();
    if folders.is_empty() {
        folders.push(folder.to_owned());
    }
    let mut pictures = Vec::new();
    for input in input::expand(&folders) {
        match input {
            Input::File(path) => pictures.push(sharp(&path)?),
            Input::Failed { argument, error } => return Err(error.in_file(&argument)),
            Input::Sample => {}
        }
    }
    Ok(pictures)
}

fn sharp(path: &Path) -> Result<Sharp> {
    let picture = picture::read(path, Linearize::Off).map_err(|error| Error::from(error).in_file(path))?;
    let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    Ok(Sharp { name, luma: picture.luma.mapv(f64::from) })
}
