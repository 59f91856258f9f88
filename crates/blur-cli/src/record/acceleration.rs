//! The fields of an acceleration.

use blur_core::estimate::Acceleration;
use blur_core::motion::PathAcceleration;
use serde::Serialize;

use crate::Error;

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
