//! From a folder of pictures to what a model is trained on.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use blur_accel::homomorphic::Variant;
use blur_accel::model::{Features, sha256};
use ndarray::{Array1, Array2, ArrayView2};

use super::collection::{self, Blurred, Collection, Scene};
use crate::picture::{self, Linearize};
use crate::{Error, Result};

/// The PSFs of the blurred pictures of a folder with their accelerations.
#[derive(Debug, Clone, PartialEq)]
pub struct TrainingSet {
    /// How the PSFs were made.
    pub features: Features,
    /// One picture a row, in the order of the table.
    pub inputs: Array2<f64>,
    /// Accelerations in m/s².
    pub targets: Array1<f64>,
    /// Exposure in seconds, when all pictures state the same.
    pub exposure_s: Option<f64>,
    /// Metres in the scene for each pixel, when all pictures state the same.
    pub scale_m_per_px: Option<f64>,
    /// The SHA-256 checksum of every byte that was read: of what `sha256sum`, run in the folder, prints for the table, the
    /// stills scene by scene, and the blurred pictures.
    pub sha256: String,
}

impl TrainingSet {
    /// Reads the pictures of a [`collection`], all of one size.
    ///
    /// # Errors
    /// Those of [`Collection::read`]; [`Error::NoBlurred`] when there is nothing to learn from; [`Error::InFile`] with
    /// the path of a picture that is refused.
    pub fn read(folder: &Path, variant: Variant) -> Result<Self> {
        let collection = Collection::read(folder)?;
        let Some(size) = first_size(&collection)? else { return Err(Error::NoBlurred) };
        let features = Features { variant, height_px: size.0, width_px: size.1 };
        let mut extractor = features.extractor();
        let mut inputs = Array2::zeros((collection.blurred.len(), features.length()));
        for (number, scene) in collection.scenes.iter().enumerate() {
            let mut blurred = collection.blurred.iter().enumerate().filter(|(_, of)| of.scene == number).peekable();
            if blurred.peek().is_none() {
                continue;
            }
            let scene = prototype(&features, &scene.stills)?;
            for (row, Blurred { path, .. }) in blurred {
                let extracted = read_luma(path)
                    .and_then(|luma| Ok(extractor.extract(luma.view(), &scene)?))
                    .map_err(|error| error.in_file(path))?;
                inputs.row_mut(row).iter_mut().zip(extracted).for_each(|(to, &from)| *to = from);
            }
        }
        Ok(Self {
            features,
            inputs,
            targets: collection.blurred.iter().map(|blurred| blurred.accel_m_s2).collect(),
            exposure_s: common(&collection, |blurred| blurred.exposure_s),
            scale_m_per_px: common(&collection, |blurred| blurred.scale_m_per_px),
            sha256: checksum(folder, &collection)?,
        })
    }
}

/// A scene from the files of its stills, which must all be of the size that the features expect.
///
/// # Errors
/// [`Error::InFile`] for a still that is refused; [`Error::Accel`] for none.
pub(super) fn prototype<P: AsRef<Path>>(
    features: &Features,
    stills: &[P],
) -> Result<blur_accel::homomorphic::Prototype> {
    let pictures = read_stills(features, stills)?;
    let views: Vec<ArrayView2<'_, f32>> = pictures.iter().map(Array2::view).collect();
    Ok(features.prototype(&views)?)
}

/// The pictures in the files of a scene's stills, which must all be of the size that the features expect.
///
/// # Errors
/// [`Error::InFile`] for a still that is refused.
pub(super) fn read_stills<P: AsRef<Path>>(features: &Features, stills: &[P]) -> Result<Vec<Array2<f32>>> {
    let mut pictures = Vec::with_capacity(stills.len());
    for path in stills.iter().map(AsRef::as_ref) {
        let checked = read_luma(path).and_then(|luma| {
            let (height, width) = luma.dim();
            let (expected_height, expected_width) = (features.height_px, features.width_px);
            if (height, width) == (expected_height, expected_width) {
                blur_core::image::check(luma.view())?;
                Ok(luma)
            } else {
                Err(blur_accel::Error::PictureSize { width, height, expected_width, expected_height }.into())
            }
        });
        pictures.push(checked.map_err(|error| error.in_file(path))?);
    }
    Ok(pictures)
}

pub(super) fn read_luma(path: &Path) -> Result<Array2<f32>> {
    Ok(picture::read(path, Linearize::Auto)?.luma)
}

/// Rows and columns of the first blurred picture.
pub(super) fn first_size(collection: &Collection) -> Result<Option<(usize, usize)>> {
    let Some(Blurred { path, .. }) = collection.blurred.first() else { return Ok(None) };
    let luma = read_luma(path).map_err(|error| error.in_file(path))?;
    Ok(Some(luma.dim()))
}

/// What all blurred pictures state alike.
fn common(collection: &Collection, stated: impl Fn(&Blurred) -> Option<f64>) -> Option<f64> {
    let mut values = collection.blurred.iter().map(stated);
    let first = values.next()??;
    values.all(|value| value == Some(first)).then_some(first)
}

/// See [`TrainingSet::sha256`].
fn checksum(folder: &Path, collection: &Collection) -> Result<String> {
    let stills = collection.scenes.iter().flat_map(|Scene { stills, .. }| stills.iter().cloned());
    let blurred = collection.blurred.iter().map(|Blurred { path, .. }| path.clone());
    let mut listing = String::new();
    for path in [folder.join(collection::FILE)].into_iter().chain(stills).chain(blurred) {
        let bytes = fs::read(&path).map_err(|error| Error::Read(error).in_file(&path))?;
        let name = path.strip_prefix(folder).unwrap_or(&path);
        // Writing to a string does not fail.
        let _ = writeln!(listing, "{}  {}", sha256(&bytes), name.display());
    }
    Ok(sha256(listing.as_bytes()))
}
