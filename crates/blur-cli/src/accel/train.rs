//! From a folder of pictures to a model.

use std::fs;
use std::path::Path;

use blur_accel::homomorphic::Variant;
use blur_accel::model::{Model, Source, Training};
use blur_accel::validate::Recipe;

use super::features::TrainingSet;
use crate::{Error, Result};

/// How a model is trained.
#[derive(Clone, Copy)]
pub struct Options {
    /// Transform that the PSFs are made with.
    pub variant: Variant,
    /// Principal components and regression.
    pub recipe: Recipe,
    /// Seed of all that is drawn.
    pub seed: u64,
}

/// Trains a model on the pictures of a folder.
///
/// # Errors
/// Those of [`TrainingSet::read`] and [`Model::train`].
pub fn train(folder: &Path, options: &Options) -> Result<Model> {
    let set = TrainingSet::read(folder, options.variant)?;
    // Of `data/.` or `data/..` the name is that of the folder itself.
    let named = fs::canonicalize(folder).map_err(Error::Read)?;
    let name = named.file_name().unwrap_or(named.as_os_str()).to_string_lossy();
    Ok(Model::train(&Training {
        features: set.features,
        inputs: set.inputs.view(),
        targets: set.targets.view(),
        recipe: options.recipe,
        seed: options.seed,
        source: Source { folder: &name, sha256: &set.sha256 },
        exposure_s: set.exposure_s,
        scale_m_per_px: set.scale_m_per_px,
    })?)
}

/// Writes a model to a file.
///
/// # Errors
/// [`Error::InFile`] when it cannot be written.
pub fn write(model: &Model, path: &Path) -> Result<()> {
    let written = model.to_json().map_err(Error::from).and_then(|text| fs::write(path, text).map_err(Error::Write));
    written.map_err(|error| error.in_file(path))
}
