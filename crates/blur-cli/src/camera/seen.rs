//! The blur of a picture as its camera saw it.

use blur_core::camera::{IdealBlur, Intrinsics, LocalBlur};
use blur_core::estimate::{AxialAngle, MotionBlur};

use super::rough;
use crate::Result;
use crate::picture::Picture;
use crate::record::FocalLengthSource;

/// A blur with the camera that saw it.
#[derive(Debug, Clone, PartialEq)]
pub struct SeenBlur {
    /// The blur without distortion, in the frame of the stored picture.
    pub ideal: IdealBlur,
    /// Its axis in the upright picture.
    pub angle: AxialAngle,
    /// The camera, for pictures of this size.
    pub camera: Intrinsics,
    /// Where its focal length is from.
    pub source: FocalLengthSource,
    /// What is worth knowing about the camera.
    pub note: Option<String>,
}

/// The camera for a picture: the calibrated one or, if there is none, what the EXIF data tell; `None` when they do not.
fn camera_of(calibrated: Option<&Intrinsics>, picture: &Picture) -> Result<Option<(Intrinsics, FocalLengthSource)>> {
    let frame = picture.stored_frame();
    let (width, height) = (frame.stored_width_px(), frame.stored_height_px());
    match calibrated {
        Some(camera) => Ok(Some((camera.resized(width, height)?, FocalLengthSource::Camera))),
        None => match rough::camera(&picture.exif.focal, width, height) {
            Some(camera) => Ok(Some((camera?, FocalLengthSource::Exif))),
            None => Ok(None),
        },
    }
}

/// A blur measured about `centre_px`, column and row of a picture, as its camera saw it; `None` when no camera is known.
///
/// # Errors
/// When the picture has another shape than the camera's, or the blur lies where the distortion cannot be undone.
pub fn seen(
    calibrated: Option<&Intrinsics>,
    picture: &Picture,
    centre_px: [f64; 2],
    blur: &MotionBlur,
) -> Result<Option<SeenBlur>> {
    let Some((camera, source)) = camera_of(calibrated, picture)? else { return Ok(None) };
    let frame = picture.stored_frame();
    let angle = AxialAngle::from_deg(frame.stored_deg(blur.angle.deg()));
    let correlation = blur.correlation.unwrap_or(0.0);
    let ideal = camera.ideal_blur(LocalBlur {
        centre_px: frame.stored(centre_px),
        angle,
        angle_std_deg: blur.angle_std_deg.unwrap_or(0.0),
        length_px: blur.length_px,
        length_std_px: blur.length_std_px.unwrap_or(0.0),
        correlation: if frame.is_mirrored() { -correlation } else { correlation },
    })?;
    let note = calibrated.filter(|of| of.width_px() != camera.width_px()).map(|of| {
        format!(
            "the camera was calibrated at {}x{} pixels; its parameters are scaled to this picture",
            of.width_px(),
            of.height_px()
        )
    });
    let angle = AxialAngle::from_deg(frame.upright_deg(ideal.angle().deg()));
    Ok(Some(SeenBlur { ideal, angle, camera, source, note }))
}
