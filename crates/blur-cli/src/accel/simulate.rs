//! A folder of pictures of known acceleration from the virtual rig.

use std::fs;
use std::io::Cursor;
use std::path::Path;

use blur_sim::rig::{Design, POSTERS, Rig, STILLS, Shot, Still, Studio};
use image::{GrayImage, ImageFormat};
use ndarray::Array2;
use rayon::prelude::*;

use super::collection::FILE;
use crate::{Error, Result};

/// What `pictures.csv` says of each picture. Beside the columns of [`collection`](super::collection) the truth about the
/// light and the position.
const COLUMNS: [&str; 15] = [
    "image",
    "kind",
    "scene",
    "accel_m_s2",
    "preset_accel_m_s2",
    "length_px",
    "accel_ratio",
    "exposure_s",
    "scale_m_per_px",
    "release_m",
    "v0_m_s",
    "right_px",
    "down_px",
    "gain",
    "kappa",
];

/// What was written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Written {
    /// Blurred pictures.
    pub blurred: usize,
    /// Still backgrounds.
    pub stills: usize,
}

/// Takes all pictures of an experiment, on the threads of the current pool, and writes them as PNG with their
/// [`pictures.csv`](super::collection) into `folder`, which is made if it is missing. The same `seed` gives the same
/// files on any number of threads.
///
/// The table is written last: a folder without it is not complete.
///
/// # Errors
/// [`Error::InFile`] with [`Error::FolderNotEmpty`], or [`Error::Write`] when a file cannot be written; [`Error::Rig`] for
/// what the rig refuses.
pub fn write(rig: &Rig, design: Design, seed: u64, folder: &Path) -> Result<Written> {
    let takes = takes(rig, design, seed)?;
    claim(folder).map_err(|error| error.in_file(folder))?;
    let studio = Studio::new(rig)?;
    takes.par_iter().try_for_each_init(
        || studio.clone(),
        |studio, take| {
            let picture = match take {
                Take::Still(still) => studio.background(still)?,
                Take::Shot(shot) => studio.picture(shot)?,
            };
            write_file(folder, &take.file_name(), &png(&picture)?)
        },
    )?;
    write_file(folder, FILE, &table(rig, &takes)?)?;
    let stills = takes.iter().filter(|take| matches!(take, Take::Still(_))).count();
    Ok(Written { blurred: takes.len() - stills, stills })
}

/// One picture to be taken.
enum Take {
    Still(Still),
    Shot(Shot),
}

fn takes(rig: &Rig, design: Design, seed: u64) -> Result<Vec<Take>> {
    let numbers = (0..POSTERS.len()).flat_map(|poster| (0..STILLS).map(move |index| (poster, index)));
    let stills = numbers.map(|(poster, index)| Ok(Take::Still(rig.still(poster, index, seed)?)));
    let shots = rig.shots(design, seed)?.into_iter().map(|shot| Ok(Take::Shot(shot)));
    stills.chain(shots).collect()
}

impl Take {
    fn scene(&self) -> &'static str {
        match self {
            Self::Still(Still { poster, .. }) | Self::Shot(Shot { poster, .. }) => POSTERS[*poster].name,
        }
    }

    fn file_name(&self) -> String {
        let scene = self.scene();
        match self {
            Self::Still(still) => format!("{scene}-still-{}.png", still.index + 1),
            Self::Shot(shot) => format!("{scene}-{:.3}-{}.png", shot.preset_accel_m_s2, shot.index + 1),
        }
    }

    /// The line of the table, in the order of [`COLUMNS`], numbers to their last digit.
    fn record(&self, rig: &Rig) -> [String; COLUMNS.len()] {
        let (kind, setting, motion) = match self {
            Self::Still(still) => ("still", &still.setting, Default::default()),
            Self::Shot(shot) => ("blurred", &shot.setting, motion_of(shot)),
        };
        let [accel, preset, length, ratio, release, v0] = motion;
        [
            self.file_name(),
            kind.to_owned(),
            self.scene().to_owned(),
            accel,
            preset,
            length,
            ratio,
            rig.exposure_s.to_string(),
            rig.scale_m_per_px.to_string(),
            release,
            v0,
            setting.right_px.to_string(),
            setting.down_px.to_string(),
            setting.gain.to_string(),
            setting.kappa.to_string(),
        ]
    }
}

fn motion_of(shot: &Shot) -> [String; 6] {
    let Shot { accel_m_s2, preset_accel_m_s2, length_px, accel_ratio, release_m, v0_m_s, .. } = shot;
    [accel_m_s2, preset_accel_m_s2, length_px, accel_ratio, release_m, v0_m_s].map(f64::to_string)
}

fn table(rig: &Rig, takes: &[Take]) -> Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(COLUMNS).map_err(Error::Csv)?;
    for take in takes {
        writer.write_record(take.record(rig)).map_err(Error::Csv)?;
    }
    writer.into_inner().map_err(|error| Error::Write(error.into_error()))
}

/// Makes the folder, or makes sure that it is empty.
fn claim(folder: &Path) -> Result<()> {
    fs::create_dir_all(folder).map_err(Error::Write)?;
    if fs::read_dir(folder).map_err(Error::Read)?.next().is_some() { Err(Error::FolderNotEmpty) } else { Ok(()) }
}

fn png(picture: &Array2<u8>) -> Result<Vec<u8>> {
    let (height, width) = picture.dim();
    let image =
        GrayImage::from_fn(width as u32, height as u32, |x, y| image::Luma([picture[[y as usize, x as usize]]]));
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, ImageFormat::Png).map_err(|error| Error::Write(std::io::Error::other(error)))?;
    Ok(bytes.into_inner())
}

fn write_file(folder: &Path, name: &str, content: &[u8]) -> Result<()> {
    let path = folder.join(name);
    fs::write(&path, content).map_err(|error| Error::Write(error).in_file(&path))
}
