//! From frames to records, with what is known of how the frames follow each other.

use blur_core::image::Pixels;
use blur_core::meter::{Configuration, Geometry, Meter};
use blur_core::motion::Exposure;
use blur_core::record::Record;
use blur_picture::{Linearize, Picture};
use metrology::Measurement;

use crate::camera;
use crate::diagnostics::diagnostics;
use crate::frame::{Frame, Samples};
use crate::msg::{CameraInfo, DiagnosticArray, Header, Time, TwistWithCovarianceStamped};
use crate::sequence::{Counts, Event, Sequence};
use crate::twist::twist;
use crate::{Error, Result};

/// How frames are to be measured.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// What to measure; its `linearize` is overruled by [`linearize`](Self::linearize), and exposure and geometry stand
    /// for all frames where they are given.
    pub configuration: Configuration,
    /// When to undo the tone curve of sRGB. `Auto` is off for stored samples and, as for files, on for JPEG.
    pub linearize: Linearize,
    /// Standard uncertainty in seconds of an exposure that a compressed picture tells of itself.
    pub exposure_std_s: f64,
    /// What the `CameraInfo` of the pictures is used for where there is no geometry.
    pub use_of_info: UseOfInfo,
}

/// What a `CameraInfo` is used for.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum UseOfInfo {
    /// Nothing.
    #[default]
    Nothing,
    /// The scale of a motion in a plane at a distance in metres.
    Plane(Measurement),
    /// The angular rate of the camera.
    Rotation,
}

/// Why there is no velocity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Missing {
    /// No exposure was given and the pictures tell none.
    Exposure,
    /// No scale was given, nor what makes one of a camera.
    Scale,
    /// The camera is to be taken from a `CameraInfo`, and none has come.
    CameraInfo,
}

impl Missing {
    /// What to do about it.
    pub fn advice(self) -> &'static str {
        match self {
            Self::Exposure => "no velocities: --exposure is missing and the pictures tell none",
            Self::Scale => "no velocities: --scale is missing, or --distance or --rotating with a camera",
            Self::CameraInfo => {
                "no velocities: no usable CameraInfo has come; name its topic with --camera-info, or use --camera or --scale"
            }
        }
    }
}

/// Measures the frames of one topic, one after the other.
pub struct Observer {
    options: Options,
    topic: String,
    meter: Meter,
    samples: Samples,
    sequence: Sequence,
}

/// What came of one frame.
#[derive(Debug)]
pub struct Observation {
    /// Its stamp, or the time at which it came if it has none.
    pub stamp: Time,
    /// What is out of the ordinary.
    pub events: Vec<Event>,
    /// The record, unless it could not be measured or has been before.
    pub outcome: Option<Result<Record>>,
}

impl Observer {
    /// An observer of the pictures of `topic`.
    ///
    /// # Errors
    /// Those of [`Meter::new`].
    pub fn new(options: Options, topic: &str) -> Result<Self> {
        let mut configuration = options.configuration.clone();
        configuration.linearize = options.linearize == Linearize::On;
        // Frames tell a motion from its opposite where they follow each other.
        configuration.directed = true;
        let meter = Meter::new(configuration)?;
        Ok(Self { options, topic: topic.to_owned(), meter, samples: Samples::default(), sequence: Sequence::default() })
    }

    /// Numbers of frames so far.
    pub fn counts(&self) -> Counts {
        self.sequence.counts()
    }

    /// Whether a `CameraInfo` is of use.
    pub fn wants_info(&self) -> bool {
        self.options.configuration.geometry.is_none() && self.options.use_of_info != UseOfInfo::Nothing
    }

    /// Takes the camera of a `CameraInfo` for the frames to come.
    ///
    /// # Errors
    /// Those of [`camera::intrinsics`]; then the camera stays as it is.
    pub fn learn(&mut self, info: &CameraInfo<'_>) -> Result<()> {
        if !self.wants_info() {
            return Ok(());
        }
        let camera = Box::new(camera::intrinsics(info, camera::is_rectified(&self.topic))?);
        self.meter.set_geometry(match self.options.use_of_info {
            UseOfInfo::Nothing => None,
            UseOfInfo::Plane(distance_m) => Some(Geometry::Plane { camera, distance_m }),
            UseOfInfo::Rotation => Some(Geometry::Rotation { camera }),
        });
        Ok(())
    }

    /// Measures a frame that came at a time in nanoseconds.
    pub fn observe(&mut self, frame: &Frame<'_>, received_ns: i64) -> Observation {
        let stamp = match frame.header().stamp {
            Time { sec: 0, nanosec: 0 } => Time::from_nanoseconds(received_ns),
            stamp => stamp,
        };
        let mut events = Vec::new();
        let outcome = self.measure(frame, stamp, &mut events).transpose();
        Observation { stamp, events, outcome }
    }

    /// A message that came at a time in nanoseconds holds no frame.
    pub fn fail(&mut self, error: Error, received_ns: i64) -> Observation {
        self.sequence.failed();
        Observation { stamp: Time::from_nanoseconds(received_ns), events: Vec::new(), outcome: Some(Err(error)) }
    }

    /// The velocity and the diagnostics of a frame; no velocity where there is no speed.
    pub fn messages<'a>(
        &self,
        header: Header<'a>,
        outcome: &Result<Record>,
        events: &[Event],
    ) -> (Option<TwistWithCovarianceStamped<'a>>, DiagnosticArray<'a>) {
        let geometry = self.meter.configuration().geometry.as_ref();
        let twist = outcome.as_ref().ok().and_then(|record| twist(header, record, geometry));
        (twist, diagnostics(header, &self.topic, outcome.as_ref(), events))
    }

    /// What was missing to make a velocity of the record measured last.
    pub fn missing(&self, record: &Record) -> Option<Missing> {
        if self.meter.configuration().geometry.is_none() {
            Some(if self.wants_info() { Missing::CameraInfo } else { Missing::Scale })
        } else if record.exposure_s.is_none() {
            Some(Missing::Exposure)
        } else {
            None
        }
    }

    fn measure(&mut self, frame: &Frame<'_>, stamp: Time, events: &mut Vec<Event>) -> Result<Option<Record>> {
        let Self { options, meter, samples, sequence, .. } = self;
        let shown = Shown::new(frame, samples, options).inspect_err(|_| sequence.failed())?;
        let step = sequence.next(stamp.nanoseconds(), shown.size());
        *events = step.events;
        if !step.measure {
            return Ok(None);
        }
        if !step.follows {
            meter.reset();
        }
        let record = shown.measure(meter, options.configuration.exposure).inspect_err(|_| sequence.unlink())?;
        Ok(Some(record))
    }
}

/// The picture of a frame.
enum Shown<'a> {
    /// Stored samples.
    Samples(Pixels<'a>),
    /// A decoded file, with the exposure that it tells.
    Decoded(Box<Picture>, Option<Exposure>),
}

impl<'a> Shown<'a> {
    fn new(frame: &'a Frame<'a>, samples: &'a mut Samples, options: &Options) -> Result<Self> {
        match frame {
            Frame::Raw(image) => Ok(Self::Samples(samples.pixels(image)?)),
            Frame::Compressed(image) => {
                let picture = blur_picture::decode(image.data, options.linearize)?;
                let exposure = match picture.exif.exposure_s {
                    Some(seconds) => Some(Exposure::new(Measurement::new(seconds, options.exposure_std_s)?)?),
                    None => None,
                };
                Ok(Self::Decoded(Box::new(picture), exposure))
            }
        }
    }

    /// Width and height in pixels.
    fn size(&self) -> (usize, usize) {
        match self {
            Self::Samples(pixels) => (pixels.width(), pixels.height()),
            Self::Decoded(picture, _) => (picture.luma.ncols(), picture.luma.nrows()),
        }
    }

    fn measure(&self, meter: &mut Meter, exposure: Option<Exposure>) -> Result<Record> {
        match self {
            Self::Samples(pixels) => {
                meter.set_exposure(exposure);
                Ok(meter.measure(pixels)?)
            }
            Self::Decoded(picture, stated) => {
                meter.set_exposure(exposure.or(*stated));
                let mut record = meter.measure_grey(picture.luma.view())?;
                record.linearized = picture.linearized;
                Ok(record)
            }
        }
    }
}
