//! The fields of a calibrated or rotating camera.

use blur_core::camera::Scale;
use blur_core::motion::{COVERAGE_K, Exposure};
use metrology::{Measurement, combined_std};
use serde::Serialize;

use crate::Result;
use crate::camera::seen::SeenBlur;

/// Where a focal length came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FocalLengthSource {
    /// A calibrated camera.
    Camera,
    /// The EXIF data of the picture: rough.
    Exif,
}

/// What the camera adds to a measurement.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CameraFields {
    /// Axis of the motion in the upright picture without distortion and with square pixels, in degrees.
    #[serde(rename = "angle_undistorted_deg")]
    pub angle_deg: f64,
    /// Blur length in such a picture, in pixels.
    #[serde(rename = "length_undistorted_px")]
    pub length_px: f64,
    /// Focal length in pixels.
    pub focal_length_px: f64,
    /// Its standard uncertainty.
    pub focal_length_std_px: f64,
    /// Where it came from.
    pub focal_length_source: FocalLengthSource,
    /// Metres in the scene for each pixel of the blur as measured, when the distance is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scale_m_per_px: Option<f64>,
    /// Its standard uncertainty.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scale_std_m_per_px: Option<f64>,
    /// How fast the camera turned.
    #[serde(flatten)]
    pub rate: Option<AngularRate>,
}

/// How fast a camera turned about an axis perpendicular to the ray through the middle of the region.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AngularRate {
    /// The angular rate in radians per second.
    #[serde(rename = "angular_rate_rad_s")]
    pub value_rad_s: f64,
    /// Its combined standard uncertainty, when the length has one.
    #[serde(rename = "angular_rate_std_rad_s", skip_serializing_if = "Option::is_none")]
    pub std_rad_s: Option<f64>,
    /// Its expanded uncertainty, two standard uncertainties.
    #[serde(rename = "angular_rate_expanded_rad_s", skip_serializing_if = "Option::is_none")]
    pub expanded_rad_s: Option<f64>,
}

impl CameraFields {
    /// What a camera saw, with its scale there if the distance is known.
    pub fn new(seen: &SeenBlur, scale: Option<Scale>) -> Result<Self> {
        let focal_length = seen.camera.fx_px()?;
        Ok(Self {
            angle_deg: seen.angle.deg(),
            length_px: seen.ideal.length_px(),
            focal_length_px: focal_length.value(),
            focal_length_std_px: focal_length.std(),
            focal_length_source: seen.source,
            scale_m_per_px: scale.map(|scale| scale.m_per_px().value()),
            scale_std_m_per_px: scale.map(|scale| scale.m_per_px().std()),
            rate: None,
        })
    }
}

impl AngularRate {
    /// The rate `turn / T`. It is as certain as the blur length, so there is no uncertainty where that has none.
    pub fn new(turn_rad: Measurement, length_has_std: bool, exposure: Exposure) -> Self {
        let seconds = exposure.seconds();
        let value_rad_s = turn_rad.value() / seconds.value();
        let std =
            combined_std([(1.0 / seconds.value(), turn_rad.std()), (value_rad_s / seconds.value(), seconds.std())]);
        let std_rad_s = length_has_std.then_some(std);
        Self { value_rad_s, std_rad_s, expanded_rad_s: std_rad_s.map(|std| COVERAGE_K * std) }
    }
}
