//! The pictures that the project is measured on. They are not part of it: they lie in the folder named by the variable
//! `BLUR_DATA`, or in `../shared/data` beside the project.

use std::path::{Path, PathBuf};

use blur_cli::reproduce::pictures::FOLDER_VARIABLE;
pub use blur_cli::reproduce::pictures::{Sharp, sharp_pictures};

/// The data folder, `None` when this machine does not have it.
///
/// # Panics
///
/// When `BLUR_REQUIRE_DATA` is set, as in continuous integration, and there is no data: then nothing may be skipped.
pub fn folder() -> Option<PathBuf> {
    let folder = std::env::var_os(FOLDER_VARIABLE)
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
