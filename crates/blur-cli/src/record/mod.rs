//! The machine-readable result of one picture: a flat JSON object.

mod acceleration;
mod camera;
mod evidence;
mod map;
mod readout;

use std::io::{self, Write};

use serde::Serialize;

pub use acceleration::{AccelerationFields, MetricAcceleration};
pub use camera::{AngularRate, CameraFields, FocalLengthSource};
pub use evidence::EvidenceFields;
pub use map::{BlurFields, MapFields, RegionFields, RegionSpeed, TileFields};
pub use readout::{ChangeFields, MetricChange, ReadoutFields, RolledSpeedFields};

use crate::Error;

/// Where an exposure time came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ExposureSource {
    /// The command line.
    Option,
    /// The EXIF data of the picture.
    Exif,
}

/// Why a measurement has no speed although an exposure or a scale is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoSpeed {
    /// No scale was given.
    ScaleMissing,
    /// A camera was given, but not the distance of the motion from it.
    DistanceMissing,
    /// No exposure was given and the picture states none.
    ExposureMissing,
    /// The camera turned, and nothing tells its focal length.
    FocalLengthMissing,
    /// Without a blur there is no motion to speak of.
    NoMotionBlur,
}

/// The measurement of one picture. Fields that were not computed are absent from the JSON object.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Record {
    /// The picture as it was named on the command line.
    pub image: String,
    /// Columns of the upright picture, before `--roi`.
    pub width: usize,
    /// Rows of the upright picture, before `--roi`.
    pub height: usize,
    /// Name of the method.
    pub method: String,
    /// Whether the sRGB tone curve was undone first.
    pub linearized: bool,
    /// The mask that marked the part measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mask: Option<String>,
    /// Axis of the motion in degrees, in `[0, 180)`, counter-clockwise from +x as seen.
    pub angle_deg: f64,
    /// Its standard uncertainty.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle_std_deg: Option<f64>,
    /// Where the content of the picture moved, in degrees, in `[0, 360)`, when the method can tell.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direction_deg: Option<f64>,
    /// Blur length in pixels.
    pub length_px: f64,
    /// Its standard uncertainty.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub length_std_px: Option<f64>,
    /// Correlation coefficient of angle and length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correlation: Option<f64>,
    /// `ok`, `low_confidence` or `no_motion_blur`.
    pub status: &'static str,
    /// Why the status is not `ok`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The acceleration, when it was asked for and there is a motion.
    #[serde(flatten)]
    pub acceleration: Option<AccelerationFields>,
    /// What speaks for and against the result, when the method weighs likelihoods.
    #[serde(flatten)]
    pub evidence: Option<EvidenceFields>,
    /// Exposure time in seconds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exposure_s: Option<f64>,
    /// Where the exposure time came from.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exposure_source: Option<ExposureSource>,
    /// What a calibrated or rotating camera adds.
    #[serde(flatten)]
    pub camera: Option<CameraFields>,
    /// Mean speed during the exposure in metres per second.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed_m_s: Option<f64>,
    /// Its combined standard uncertainty, when the length has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed_std_m_s: Option<f64>,
    /// Its expanded uncertainty `coverage_k * speed_std_m_s`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed_expanded_m_s: Option<f64>,
    /// Coverage factor of the expanded uncertainty.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coverage_k: Option<f64>,
    /// The blur over the picture, when a map was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub map: Option<MapFields>,
    /// What a rolling shutter does to the speed, when its readout is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub readout: Option<ReadoutFields>,
    /// The file that the restored picture was written to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub restored: Option<String>,
    /// By how much undoing the blur makes the picture sharper, see [`blur_core::restore::sharpness_change`]: below 0 it does
    /// not, and the blur may be wrong.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sharpness_change: Option<f64>,
    /// Time that the estimator took in milliseconds; reading and decoding the file is not in it.
    pub time_ms: f64,
    /// Why there is no speed.
    #[serde(skip)]
    pub no_speed: Option<NoSpeed>,
    /// What is worth knowing about the file.
    #[serde(skip)]
    pub note: Option<String>,
}

impl Record {
    /// Adds to what is worth knowing.
    pub(crate) fn add_note(&mut self, text: &str) {
        match &mut self.note {
            Some(note) => {
                note.push_str("; ");
                note.push_str(text);
            }
            None => self.note = Some(text.to_owned()),
        }
    }
}

#[derive(Serialize)]
struct Failure<'a> {
    image: &'a str,
    error: &'a str,
}

/// Writes the result of one picture as one JSON object on a line of its own.
pub fn write_json(out: &mut impl Write, image: &str, outcome: Result<&Record, &Error>) -> io::Result<()> {
    match outcome {
        Ok(record) => serde_json::to_writer(&mut *out, record)?,
        Err(error) => return write_failure(out, image, error),
    }
    out.write_all(b"\n")
}

/// Writes why there is no result for a picture, as one JSON object on a line of its own.
pub fn write_failure(out: &mut impl Write, image: &str, error: &Error) -> io::Result<()> {
    write_failed(out, image, &error.one_line())
}

/// Writes why there is no result for a picture, in words on one line, as one JSON object on a line of its own.
pub fn write_failed(out: &mut impl Write, image: &str, error: &str) -> io::Result<()> {
    serde_json::to_writer(&mut *out, &Failure { image, error })?;
    out.write_all(b"\n")
}
