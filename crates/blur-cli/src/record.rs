//! The machine-readable result of one picture: a flat JSON object.

use std::io::{self, Write};

use serde::Serialize;

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
    /// No exposure was given and the picture states none.
    ExposureMissing,
    /// Without a blur there is no motion to speak of.
    NoMotionBlur,
}

/// The measurement of one picture. Fields that were not computed are absent from the JSON object.
#[derive(Debug, Clone, PartialEq, Serialize)]
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
    /// Axis of the motion in degrees, in `[0, 180)`, counter-clockwise from +x as seen.
    pub angle_deg: f64,
    /// Its standard uncertainty.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle_std_deg: Option<f64>,
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
    /// Exposure time in seconds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exposure_s: Option<f64>,
    /// Where the exposure time came from.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exposure_source: Option<ExposureSource>,
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
    /// Time that the estimator took in milliseconds; reading and decoding the file is not in it.
    pub time_ms: f64,
    /// Why there is no speed.
    #[serde(skip)]
    pub no_speed: Option<NoSpeed>,
    /// What is worth knowing about the file.
    #[serde(skip)]
    pub note: Option<String>,
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
        Err(error) => serde_json::to_writer(&mut *out, &Failure { image, error: &error.one_line() })?,
    }
    out.write_all(b"\n")
}
