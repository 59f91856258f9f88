//! The pictures that the project is measured on. They are not part of it: they lie in the folder named by the variable
//! `BLUR_DATA`, or in `../shared/data` beside the project.

use std::path::{Path, PathBuf};

use blur_cli::picture::{self, Linearize};
use ndarray::Array2;

/// The data folder, `None` when this machine does not have it.
///
/// # Panics
///
/// When `BLUR_REQUIRE_DATA` is set, as in continuous integration, and there is no data: then nothing may be skipped.
pub fn folder() -> Option<PathBuf> {
    let folder = std::env::var_os("BLUR_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data"), PathBuf::from);
    if folder.is_dir() {
        return Some(folder);
    }
    assert!(
        std::env::var_os("BLUR_REQUIRE_DATA").is_none(),
        "BLUR_REQUIRE_DATA is set, but there is no data in {}: set BLUR_DATA to the folder",
        folder.display()
    );
    eprintln!("SKIPPED: no data in {} (set BLUR_DATA to the folder)", folder.display());
    None
}

/// A sharp picture to blur.
#[derive(Debug, Clone)]
pub struct Sharp {
    /// File name.
    pub name: String,
    /// Luma on the 0..255 scale.
    pub luma: Array2<f64>,
}

/// All pictures of `kodak` and `skimage`, sorted by folder and name.
///
/// # Errors
///
/// When a folder or a picture cannot be read.
pub fn sharp_pictures(folder: &Path) -> Result<Vec<Sharp>, blur_cli::Error> {
    let inputs = blur_cli::input::expand(&[folder.join("kodak"), folder.join("skimage")]);
    let mut pictures = Vec::new();
    for input in inputs {
        match input {
            blur_cli::input::Input::File(path) => {
                let luma = picture::read(&path, Linearize::Off)?.luma.mapv(f64::from);
                let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
                pictures.push(Sharp { name, luma });
            }
            blur_cli::input::Input::Failed { error, .. } => return Err(error),
            blur_cli::input::Input::Sample => {}
        }
    }
    Ok(pictures)
}

/// A frame of `real_phone` with the blur that its gyroscope tells.
#[derive(Debug, Clone)]
pub struct PhoneFrame {
    /// Where the frame is.
    pub path: PathBuf,
    /// Angle in degrees, counter-clockwise with y up, in `[0, 180)`.
    pub angle_deg: f64,
    /// Blur length in pixels.
    pub length_px: f64,
}

/// The frames of `real_phone` in the order of its table.
///
/// # Errors
///
/// When the table cannot be read.
pub fn phone_frames(folder: &Path) -> std::io::Result<Vec<PhoneFrame>> {
    let folder = folder.join("real_phone");
    let table = std::fs::read_to_string(folder.join("truth_selected.csv"))?;
    let mut lines = table.lines();
    let header: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let column = |name: &str| header.iter().position(|&column| column == name);
    let (file, length, angle) = (column("file"), column("blur_len_px"), column("blur_angle_img_deg"));
    Ok(lines
        .filter_map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            let path = folder.join(cells.get(file?)?);
            let y_down: f64 = cells.get(angle?)?.parse().ok()?;
            let length_px = cells.get(length?)?.parse().ok()?;
            // The table's angles have y down.
            path.exists().then(|| PhoneFrame { path, angle_deg: (180.0 - y_down).rem_euclid(180.0), length_px })
        })
        .collect())
}
