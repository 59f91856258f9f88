//! The machine-readable result of one picture: a flat JSON object.

use std::io::{self, Write};

use blur_core::estimate::{Acceleration, Evidence};
use blur_core::motion::PathAcceleration;
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

/// How strongly the motion accelerated.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AccelerationFields {
    /// The ratio `a T / (2 v)`, 0 for a uniform motion, 1 for one that starts from rest, without its sign unless the
    /// method knows it: then it is negative where the motion slows down, along the direction or else along the axis.
    #[serde(rename = "accel_ratio")]
    pub ratio: f64,
    /// Its standard uncertainty.
    #[serde(rename = "accel_ratio_std")]
    pub ratio_std: f64,
    /// The least ratio that counts as detected, see [`Acceleration::detection_limit`].
    #[serde(rename = "accel_ratio_limit")]
    pub limit: f64,
    /// Whether the ratio stands out from that of a uniform motion.
    #[serde(rename = "accel_detected")]
    pub detected: bool,
    /// Whether the sign of the ratio is known.
    #[serde(skip)]
    pub is_signed: bool,
    /// In metres per second squared, when exposure and scale are known.
    #[serde(flatten)]
    pub metric: Option<MetricAcceleration>,
}

/// An acceleration in metres per second squared.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MetricAcceleration {
    /// The acceleration.
    #[serde(rename = "accel_m_s2")]
    pub value_m_s2: f64,
    /// Its combined standard uncertainty.
    #[serde(rename = "accel_std_m_s2")]
    pub std_m_s2: f64,
    /// Its expanded uncertainty, two standard uncertainties.
    #[serde(rename = "accel_expanded_m_s2")]
    pub expanded_m_s2: f64,
    /// The least acceleration that counts as detected.
    #[serde(rename = "accel_limit_m_s2")]
    pub limit_m_s2: f64,
}

impl AccelerationFields {
    /// What was found, and with `to_metric`, which turns a ratio with its standard uncertainty into an acceleration, that.
    pub fn new(
        found: Acceleration,
        to_metric: Option<impl Fn(f64, f64) -> Result<PathAcceleration, Error>>,
    ) -> Result<Self, Error> {
        let ratio = found.signed.map_or(found.ratio, |signed| signed.ratio);
        let metric = match to_metric {
            Some(to_metric) => {
                let found_m_s2 = to_metric(ratio, found.ratio_std)?;
                Some(MetricAcceleration {
                    value_m_s2: found_m_s2.value_m_s2,
                    std_m_s2: found_m_s2.std_m_s2,
                    expanded_m_s2: found_m_s2.expanded_m_s2(),
                    limit_m_s2: to_metric(found.detection_limit, 0.0)?.value_m_s2,
                })
            }
            None => None,
        };
        Ok(Self {
            ratio,
            is_signed: found.signed.is_some(),
            ratio_std: found.ratio_std,
            limit: found.detection_limit,
            detected: found.is_detected(),
            metric,
        })
    }
}

/// What speaks for and against the result, see [`Evidence`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EvidenceFields {
    /// Gain in log-likelihood over no blur, for each bin of signal.
    pub gain_per_bin: f64,
    /// Evidence for the best other blur, relative to the one found.
    pub rival_share: f64,
    /// Share of the light that does not follow the motion.
    pub incoherent_share: f64,
    /// Mean squared standardised residual of the spectrum.
    pub misfit: f64,
    /// Highest frequency that the result rests on, in cycles per pixel.
    pub band_cycles_per_px: f64,
}

impl From<Evidence> for EvidenceFields {
    fn from(found: Evidence) -> Self {
        Self {
            gain_per_bin: found.gain_per_bin,
            rival_share: found.rival_share,
            incoherent_share: found.incoherent_share,
            misfit: found.misfit,
            band_cycles_per_px: found.band_cycles_per_px,
        }
    }
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
        Err(error) => return write_failure(out, image, error),
    }
    out.write_all(b"\n")
}

/// Writes why there is no result for a picture, as one JSON object on a line of its own.
pub fn write_failure(out: &mut impl Write, image: &str, error: &Error) -> io::Result<()> {
    serde_json::to_writer(&mut *out, &Failure { image, error: &error.one_line() })?;
    out.write_all(b"\n")
}
