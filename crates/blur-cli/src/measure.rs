//! From one picture to one record.

use std::path::PathBuf;
use std::time::Instant;

use blur_core::camera::{Intrinsics, Scale};
use blur_core::estimate::{JointEstimator, MotionBlur, Settings};
use blur_core::image::Region;
use blur_core::motion::COVERAGE_K;
use blur_core::region::Mask;
use blur_core::restore;
use metrology::Measurement;

use crate::map::Map;
use crate::masked::Masked;
use crate::method::Method;
use crate::metric::Metric;
use crate::picture::{Linearize, Picture};
use crate::record::{EvidenceFields, MapFields, Record, RegionSpeed};
use crate::{Error, Result};

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
    /// The calibrated camera.
    pub camera: Option<Intrinsics>,
    /// Distance in metres from the camera to the plane of the motion.
    pub distance_m: Option<Measurement>,
    /// Whether the camera turned in front of a scene at rest.
    pub rotating: bool,
    /// Time in seconds that the sensor takes to read all its rows, for a rolling shutter.
    pub readout_s: Option<f64>,
    /// Picture whose grey is the weight of each pixel.
    pub mask: Option<PathBuf>,
    /// Side in pixels of the tiles of a map of the blur.
    pub map_tile_px: Option<usize>,
    /// Where to write the restored picture.
    pub restore: Option<RestoreTo>,
    /// The folder for the report.
    pub report: Option<PathBuf>,
}

/// Where to write a restored picture, and how to make it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RestoreTo {
    /// A file or, for several inputs, a folder.
    pub path: PathBuf,
    /// The method.
    pub method: restore::Method,
}

/// All that comes of one picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// The measurement.
    pub record: Record,
    /// The blur that it tells of.
    pub blur: MotionBlur,
    /// Column and row of the middle of what was measured.
    pub centre_px: [f64; 2],
    /// The blur over the picture, when a map is asked for.
    pub map: Option<Map>,
    /// The picture's section of the report, when one is asked for.
    pub section: Option<String>,
}

/// An estimator with the options that it serves. Build one for each thread and reuse it.
pub struct Measurer<'a> {
    options: &'a Options,
    method: String,
    estimator: Box<dyn JointEstimator>,
    masked: Option<Masked<'a>>,
}

impl<'a> Measurer<'a> {
    /// A measurer with its own estimator.
    pub fn new(options: &'a Options) -> Self {
        let masked = options.mask.as_deref().map(|path| Masked::new(path, &options.settings));
        Self { options, method: options.method.name(), estimator: options.method.build(&options.settings), masked }
    }

    /// The mask, once a picture has been measured under it.
    pub fn mask(&self) -> Option<&Mask> {
        self.masked.as_ref().and_then(Masked::mask)
    }

    /// The options served.
    pub fn options(&self) -> &'a Options {
        self.options
    }

    /// Measures `picture` and reports it under the name `image`, with everything that the options ask for.
    pub fn measure(&mut self, image: String, picture: &Picture) -> Result<Finding> {
        let (height, width) = picture.luma.dim();
        let region = self.options.roi.unwrap_or(Region { x: 0, y: 0, width, height });
        let view = region.of(picture.luma.view())?;
        let options = self.options;
        let whole = || {
            let start = Instant::now();
            let blur = match &mut self.masked {
                Some(masked) => masked.estimate(view),
                None => self.estimator.estimate(view).map_err(Error::from),
            };
            (blur, start.elapsed().as_secs_f64() * 1e3)
        };
        let tiles = || options.map_tile_px.map(|tile_px| Map::measure(view, tile_px, &options.settings)).transpose();
        let ((blur, time_ms), map) = rayon::join(whole, tiles);
        let (blur, map) = (blur?, map?);

        let metric = Metric::new(self.options, picture)?;
        let centre_px = self.mask().map_or_else(|| centre_of(region), Mask::centroid);
        let place = metric.place(&blur, centre_px)?;
        let (speed, no_speed) = metric.speed(&blur, &place);
        let speed_std_m_s = speed.and_then(|speed| speed.std_m_s);
        let exposure = metric.exposure();
        let origin = (region.x, region.y);
        let record = Record {
            image,
            width,
            height,
            method: self.method.clone(),
            linearized: picture.linearized,
            mask: self.options.mask.as_ref().map(|path| path.display().to_string()),
            angle_deg: blur.angle.deg(),
            angle_std_deg: blur.angle_std_deg,
            direction_deg: blur.direction_deg,
            length_px: blur.length_px,
            length_std_px: blur.length_std_px,
            correlation: blur.correlation,
            status: blur.status.name(),
            reason: blur.status.doubt().map(|doubt| doubt.to_string()),
            acceleration: metric.acceleration(&blur, &place)?,
            evidence: blur.evidence.map(EvidenceFields::from),
            exposure_s: exposure.map(|(exposure, _)| exposure.seconds().value()),
            exposure_source: exposure.map(|(_, source)| source),
            camera: metric.camera(&blur, &place)?,
            speed_m_s: speed.map(|speed| speed.value_m_s),
            speed_std_m_s,
            speed_expanded_m_s: speed.and_then(|speed| speed.expanded_m_s()),
            coverage_k: speed_std_m_s.map(|_| COVERAGE_K),
            map: map.as_ref().map(|map| self.map_fields(map, origin, &metric)).transpose()?,
            readout: metric.readout(&blur, &place, map.as_ref(), origin)?,
            restored: None,
            sharpness_change: None,
            time_ms,
            no_speed,
            note: notes([picture.exif.note.clone(), place.note()]),
        };
        Ok(Finding { record, blur, centre_px, map, section: None })
    }

    /// The fields of a map of the part of the picture whose top left pixel is `origin`.
    fn map_fields(&self, map: &Map, origin: (usize, usize), metric: &Metric<'_>) -> Result<MapFields> {
        let speed = |blur: &MotionBlur, centre| {
            let place = metric.place(blur, centre)?;
            Ok(RegionSpeed { speed: metric.speed(blur, &place).0, rolled: metric.rolled(blur, &place)? })
        };
        MapFields::new(map, self.options.settings.window, origin, self.options.readout_s.is_none(), speed)
    }
}

/// Column and row of the middle of a region.
fn centre_of(region: Region) -> [f64; 2] {
    [region.x as f64 + 0.5 * (region.width as f64 - 1.0), region.y as f64 + 0.5 * (region.height as f64 - 1.0)]
}

/// All that is worth knowing about a picture, in one line.
fn notes<const N: usize>(notes: [Option<String>; N]) -> Option<String> {
    notes.into_iter().flatten().reduce(|all, note| format!("{all}; {note}"))
}
