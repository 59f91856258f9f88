//! Writing pictures without their blur: `--restore`.
//!
//! [`target`] says where each picture goes, [`restored`] undoes the blur of all its channels, and [`write()`] does it for one
//! picture of a run.

mod samples;
pub mod target;

use std::path::Path;

use blur_core::estimate::Status;
use blur_core::restore::{LineBlur, Method, Restorer, sharpness_change};
use image::{DynamicImage, ImageFormat};
use ndarray::Array2;

use self::samples::Samples;
use crate::measure::Finding;
use crate::picture::Picture;
use crate::{Error, Result};

/// `picture` without `blur`: the whole of it, upright, with the channels and the depth that it is stored with.
///
/// One filter serves all colours. Where the measurement undid the tone curve, it is undone here too and applied again. Alpha
/// stays as it is. Float samples come out with 16 bits, stretched over the range of the picture.
///
/// # Errors
/// [`Error::Estimate`] when the picture is too small for the blur.
pub fn restored(picture: &Picture, blur: &LineBlur, method: Method) -> Result<DynamicImage> {
    let mut samples = Samples::of(picture)?;
    let mut restorer = Restorer::new(picture.luma.dim(), blur, method)?;
    let views: Vec<_> = samples.channels.iter().map(Array2::view).collect();
    restorer.learn(&views)?;
    let mut scene = Array2::zeros(picture.luma.dim());
    for channel in &mut samples.channels {
        restorer.restore(channel.view(), scene.view_mut())?;
        channel.assign(&scene);
    }
    samples.into_image()
}

/// Restores `picture` with the blur that was found in it, writes the result to `path`, and notes in the record what came of
/// it. A picture without motion blur is not written.
///
/// With `--roi` the whole picture is restored with the blur of the region.
///
/// # Errors
/// Those of [`restored`], and [`Error::Write`] when the file cannot be written.
pub fn write(finding: &mut Finding, picture: &Picture, method: Method, path: &Path) -> Result<()> {
    let Finding { record, blur, .. } = finding;
    let Some(kernel) = LineBlur::measured(blur)? else {
        record.add_note("not restored: there is no motion blur to undo");
        return Ok(());
    };
    let change = sharpness_change(picture.luma.view(), &kernel)?;
    let scene = restored(picture, &kernel, method)?;
    scene.save_with_format(path, target::format(path).unwrap_or(ImageFormat::Png)).map_err(|error| match error {
        image::ImageError::IoError(error) => Error::Write(error).in_file(path),
        other => Error::Encode(other).in_file(path),
    })?;
    record.restored = Some(path.display().to_string());
    record.sharpness_change = Some(change);
    if matches!(blur.status, Status::LowConfidence(_)) {
        record.add_note("restored with a blur of low confidence: if that is wrong, the picture got worse");
    }
    if change <= 0.0 {
        record.add_note("undoing the blur that was found does not make the picture sharper: the blur may be wrong");
    }
    if LineBlur::sign_is_assumed(blur) {
        record.add_note("restored as if the motion sped up along the angle: one picture does not tell the sign");
    }
    Ok(())
}
