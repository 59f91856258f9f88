//! From one picture to one record.

use std::time::Instant;

use blur_core::camera::Scale;
use blur_core::estimate::{JointEstimator, MotionBlur, Settings, Status};
use blur_core::image::Region;
use blur_core::motion::{AcceleratedPath, COVERAGE_K, Exposure, PathAcceleration, Speed};
use metrology::Measurement;

use crate::Result;
use crate::method::Method;
use crate::picture::{Linearize, Picture};
use crate::record::{AccelerationFields, EvidenceFields, ExposureSource, NoSpeed, Record};

/// What to measure and how, for all pictures of a run.
#[derive(Clone)]
pub struct Options {
    /// The estimator.
    pub method: Method,
    /// Its settings.
    pub settings: Settings,
    /// The part of the upright picture to measure; `None`: all of it.
    pub roi: Option<Region>,
    /// When to undo the tone curve.
    pub linearize: Linearize,
    /// Exposure time in seconds; `None`: what the EXIF data of each picture say.
    pub exposure_s: Option<f64>,
    /// Standard uncertainty in seconds of the exposure time, wherever that comes from.
    pub exposure_std_s: f64,
    /// Scale of the pictures; without it there is no speed.
    pub scale: Option<Scale>,
}

/// An estimator with the options that it serves. Build one for each thread and reuse it.
pub struct Measurer<'a> {
    options: &'a Options,
    method: String,
    estimator: Box<dyn JointEstimator>,
}

impl<'a> Measurer<'a> {
    /// A measurer with its own estimator.
    pub fn new(options: &'a Options) -> Self {
        Self { options, method: options.method.name(), estimator: options.method.build(&options.settings) }
    }

    /// The options served.
    pub fn options(&self) -> &'a Options {
        self.options
    }

    /// Measures `picture` and reports it under the name `image`.
    pub fn measure(&mut self, image: String, picture: &Picture) -> Result<Record> {
        let (height, width) = picture.luma.dim();
        let whole = picture.luma.view();
        let view = match self.options.roi {
            Some(region) => region.of(whole)?,
            None => whole,
        };
        let start = Instant::now();
        let blur = self.estimator.estimate(view)?;
        let time_ms = start.elapsed().as_secs_f64() * 1e3;

        let exposure = self.exposure(picture)?;
        let (speed, no_speed) = self.speed(&blur, exposure.map(|(exposure, _)| exposure));
        let speed_std_m_s = speed.and_then(|speed| speed.std_m_s);
        Ok(Record {
            image,
            width,
            height,
            method: self.method.clone(),
            linearized: picture.linearized,
            angle_deg: blur.angle.deg(),
            angle_std_deg: blur.angle_std_deg,
            direction_deg: blur.direction_deg,
            length_px: blur.length_px,
            length_std_px: blur.length_std_px,
            correlation: blur.correlation,
            status: blur.status.name(),
            reason: blur.status.doubt().map(|doubt| doubt.to_string()),
            acceleration: self.acceleration(&blur, exposure.map(|(exposure, _)| exposure))?,
            evidence: blur.evidence.map(EvidenceFields::from),
            exposure_s: exposure.map(|(exposure, _)| exposure.seconds().value()),
            exposure_source: exposure.map(|(_, source)| source),
            speed_m_s: speed.map(|speed| speed.value_m_s),
            speed_std_m_s,
            speed_expanded_m_s: speed.and_then(|speed| speed.expanded_m_s()),
            coverage_k: speed_std_m_s.map(|_| COVERAGE_K),
            time_ms,
            no_speed,
            note: picture.exif.note.clone(),
        })
    }

    fn exposure(&self, picture: &Picture) -> Result<Option<(Exposure, ExposureSource)>> {
        let (seconds, source) = match (self.options.exposure_s, picture.exif.exposure_s) {
            (Some(seconds), _) => (seconds, ExposureSource::Option),
            (None, Some(seconds)) => (seconds, ExposureSource::Exif),
            (None, None) => return Ok(None),
        };
        let exposure = Exposure::new(Measurement::new(seconds, self.options.exposure_std_s)?)?;
        Ok(Some((exposure, source)))
    }

    fn acceleration(&self, blur: &MotionBlur, exposure: Option<Exposure>) -> Result<Option<AccelerationFields>> {
        // Without a blur there is nothing that could accelerate.
        let Some(found) = blur.acceleration.filter(|_| !matches!(blur.status, Status::NoMotionBlur(_))) else {
            return Ok(None);
        };
        let length_px = Measurement::new(blur.length_px, blur.length_std_px.unwrap_or(0.0))?;
        let to_metric = self.options.scale.zip(exposure).map(|(scale, exposure)| {
            move |ratio: f64, std: f64| -> Result<PathAcceleration> {
                let ratio = Measurement::new(ratio, std)?;
                let path = AcceleratedPath {
                    ratio,
                    length_px,
                    correlation: found.signed.map_or(found.length_correlation, |signed| signed.length_correlation),
                };
                Ok(PathAcceleration::from_blur(&path, scale, exposure))
            }
        });
        AccelerationFields::new(found, to_metric).map(Some)
    }

    fn speed(&self, blur: &MotionBlur, exposure: Option<Exposure>) -> (Option<Speed>, Option<NoSpeed>) {
        match (self.options.scale, exposure) {
            (Some(_), Some(_)) if matches!(blur.status, Status::NoMotionBlur(_)) => (None, Some(NoSpeed::NoMotionBlur)),
            (Some(scale), Some(exposure)) => {
                (Some(Speed::from_blur(blur.length_px, blur.length_std_px, scale, exposure)), None)
            }
            (Some(_), None) => (None, Some(NoSpeed::ExposureMissing)),
            (None, Some(_)) => (None, Some(NoSpeed::ScaleMissing)),
            (None, None) => (None, None),
        }
    }
}
