//! The flat record of one measurement.

use std::borrow::Cow;

use crate::estimate::registry::Choice;
use crate::estimate::{Acceleration, MotionBlur, Status};
use crate::motion::COVERAGE_K;

/// All that one picture tells, in plain numbers. What was not computed is `None`.
///
/// The same pixels under the same [`Configuration`](crate::meter::Configuration) give the same record, bit for bit, by
/// whatever way they come.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Record {
    /// Columns of the picture.
    pub width: usize,
    /// Rows of the picture.
    pub height: usize,
    /// The method.
    pub method: Choice,
    /// Whether the sRGB tone curve was undone first.
    pub linearized: bool,
    /// Whether the fit started from the result of the frame before instead of a search.
    pub tracked: bool,
    /// Axis of the motion in degrees, in `[0, 180)`, counter-clockwise from +x as seen.
    pub angle_deg: f64,
    /// Its standard uncertainty.
    pub angle_std_deg: Option<f64>,
    /// Where the content of the picture moved, in degrees, in `[0, 360)`, when that is known.
    pub direction_deg: Option<f64>,
    /// Blur length in pixels.
    pub length_px: f64,
    /// Its standard uncertainty.
    pub length_std_px: Option<f64>,
    /// Correlation coefficient of angle and length.
    pub correlation: Option<f64>,
    /// How far to trust the result.
    pub status: Status,
    /// The ratio `a T / (2 v)`, see [`Acceleration`]: without its sign unless the method knows it.
    pub accel_ratio: Option<f64>,
    /// Its standard uncertainty.
    pub accel_ratio_std: Option<f64>,
    /// The least ratio that counts as detected.
    pub accel_ratio_limit: Option<f64>,
    /// Whether the ratio stands out from that of a uniform motion.
    pub accel_detected: Option<bool>,
    /// Acceleration in metres per second squared.
    pub accel_m_s2: Option<f64>,
    /// Its combined standard uncertainty.
    pub accel_std_m_s2: Option<f64>,
    /// Gain in log-likelihood over no blur, for each bin of signal.
    pub gain_per_bin: Option<f64>,
    /// Evidence for the best other blur, relative to the one found.
    pub rival_share: Option<f64>,
    /// Share of the light that does not follow the motion.
    pub incoherent_share: Option<f64>,
    /// Mean squared standardised residual of the spectrum.
    pub misfit: Option<f64>,
    /// Highest frequency that the result rests on, in cycles per pixel.
    pub band_cycles_per_px: Option<f64>,
    /// Exposure time in seconds.
    pub exposure_s: Option<f64>,
    /// Metres in the scene for each pixel of the blur as measured, when camera and distance tell.
    pub scale_m_per_px: Option<f64>,
    /// Its standard uncertainty.
    pub scale_std_m_per_px: Option<f64>,
    /// Mean speed during the exposure in metres per second.
    pub speed_m_s: Option<f64>,
    /// Its combined standard uncertainty.
    pub speed_std_m_s: Option<f64>,
    /// How fast the camera turned in radians per second, when it did in front of a scene at rest.
    pub angular_rate_rad_s: Option<f64>,
    /// Its combined standard uncertainty.
    pub angular_rate_std_rad_s: Option<f64>,
}

/// The value of a field of a [`Record`].
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A number of things.
    Count(usize),
    /// A measured number.
    Number(f64),
    /// Yes or no.
    Flag(bool),
    /// A name or a sentence.
    Text(Cow<'static, str>),
}

impl Record {
    /// The record of a blur that was measured in a picture of `width` and `height`, without what is to be known of camera
    /// and exposure.
    pub(crate) fn of_blur(blur: &MotionBlur, (height, width): (usize, usize), method: Choice) -> Self {
        let has_motion = !matches!(blur.status, Status::NoMotionBlur(_));
        // Without a blur there is nothing that could accelerate.
        let acceleration = blur.acceleration.filter(|_| has_motion);
        let evidence = blur.evidence;
        Self {
            width,
            height,
            method,
            linearized: false,
            tracked: false,
            angle_deg: blur.angle.deg(),
            angle_std_deg: blur.angle_std_deg,
            direction_deg: blur.direction_deg,
            length_px: blur.length_px,
            length_std_px: blur.length_std_px,
            correlation: blur.correlation,
            status: blur.status,
            accel_ratio: acceleration.map(|found| found.signed.map_or(found.ratio, |signed| signed.ratio)),
            accel_ratio_std: acceleration.map(|found| found.ratio_std),
            accel_ratio_limit: acceleration.map(|found| found.detection_limit),
            accel_detected: acceleration.as_ref().map(Acceleration::is_detected),
            accel_m_s2: None,
            accel_std_m_s2: None,
            gain_per_bin: evidence.map(|found| found.gain_per_bin),
            rival_share: evidence.map(|found| found.rival_share),
            incoherent_share: evidence.map(|found| found.incoherent_share),
            misfit: evidence.map(|found| found.misfit),
            band_cycles_per_px: evidence.map(|found| found.band_cycles_per_px),
            exposure_s: None,
            scale_m_per_px: None,
            scale_std_m_per_px: None,
            speed_m_s: None,
            speed_std_m_s: None,
            angular_rate_rad_s: None,
            angular_rate_std_rad_s: None,
        }
    }

    /// Expanded uncertainty of the speed in metres per second, with the coverage factor [`COVERAGE_K`].
    pub fn speed_expanded_m_s(&self) -> Option<f64> {
        self.speed_std_m_s.map(|std| COVERAGE_K * std)
    }

    /// All fields by the names that machine-readable output uses, in its order; those that were not computed are left out.
    pub fn fields(&self) -> impl Iterator<Item = (&'static str, Value)> {
        let number = |value: Option<f64>| value.map(Value::Number);
        let text = |text: String| Some(Value::Text(Cow::Owned(text)));
        [
            ("width", Some(Value::Count(self.width))),
            ("height", Some(Value::Count(self.height))),
            ("method", text(self.method.to_string())),
            ("linearized", Some(Value::Flag(self.linearized))),
            ("tracked", Some(Value::Flag(self.tracked))),
            ("angle_deg", Some(Value::Number(self.angle_deg))),
            ("angle_std_deg", number(self.angle_std_deg)),
            ("direction_deg", number(self.direction_deg)),
            ("length_px", Some(Value::Number(self.length_px))),
            ("length_std_px", number(self.length_std_px)),
            ("correlation", number(self.correlation)),
            ("status", Some(Value::Text(Cow::Borrowed(self.status.name())))),
            ("reason", self.status.doubt().and_then(|doubt| text(doubt.to_string()))),
            ("accel_ratio", number(self.accel_ratio)),
            ("accel_ratio_std", number(self.accel_ratio_std)),
            ("accel_ratio_limit", number(self.accel_ratio_limit)),
            ("accel_detected", self.accel_detected.map(Value::Flag)),
            ("accel_m_s2", number(self.accel_m_s2)),
            ("accel_std_m_s2", number(self.accel_std_m_s2)),
            ("gain_per_bin", number(self.gain_per_bin)),
            ("rival_share", number(self.rival_share)),
            ("incoherent_share", number(self.incoherent_share)),
            ("misfit", number(self.misfit)),
            ("band_cycles_per_px", number(self.band_cycles_per_px)),
            ("exposure_s", number(self.exposure_s)),
            ("scale_m_per_px", number(self.scale_m_per_px)),
            ("scale_std_m_per_px", number(self.scale_std_m_per_px)),
            ("speed_m_s", number(self.speed_m_s)),
            ("speed_std_m_s", number(self.speed_std_m_s)),
            ("speed_expanded_m_s", number(self.speed_expanded_m_s())),
            ("coverage_k", self.speed_std_m_s.map(|_| Value::Number(COVERAGE_K))),
            ("angular_rate_rad_s", number(self.angular_rate_rad_s)),
            ("angular_rate_std_rad_s", number(self.angular_rate_std_rad_s)),
        ]
        .into_iter()
        .filter_map(|(name, value)| Some((name, value?)))
    }
}

/// One flat map of the [`fields`](Record::fields).
#[cfg(feature = "serde")]
impl serde::Serialize for Record {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.fields())
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for Value {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Count(count) => serializer.serialize_u64(*count as u64),
            Self::Number(number) => serializer.serialize_f64(*number),
            Self::Flag(flag) => serializer.serialize_bool(*flag),
            Self::Text(text) => serializer.serialize_str(text),
        }
    }
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use super::*;
    use crate::meter::{Configuration, Meter};

    fn record() -> Record {
        let picture = Array2::from_shape_fn((48, 64), |(row, column)| ((row * 7 + column * 13) % 31) as f32);
        Meter::new(Configuration::default()).unwrap().measure_grey(picture.view()).unwrap()
    }

    #[test]
    fn fields_that_were_not_computed_are_left_out() {
        let record = record();
        let names: Vec<_> = record.fields().map(|(name, _)| name).collect();
        assert_eq!(&names[..6], ["width", "height", "method", "linearized", "tracked", "angle_deg"]);
        assert!(!names.contains(&"speed_m_s") && !names.contains(&"coverage_k"), "{names:?}");
        let value = |wanted: &str| record.fields().find(|(name, _)| *name == wanted).unwrap().1;
        assert_eq!(value("width"), Value::Count(64));
        assert_eq!(value("method"), Value::Text("whittle".into()));
        assert_eq!(value("length_px"), Value::Number(record.length_px));
    }

    #[cfg(feature = "serde")]
    #[test]
    fn a_record_is_one_flat_object_whose_numbers_come_back() {
        let record = record();
        let text = serde_json::to_string(&record).unwrap();
        let back: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(back.as_object().unwrap().len(), record.fields().count());
        assert_eq!(back["length_px"].as_f64().unwrap().to_bits(), record.length_px.to_bits());
        assert_eq!(back["status"], record.status.name());
    }
}
