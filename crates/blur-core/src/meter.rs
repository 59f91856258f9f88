//! From the pixels of a picture to its record: what every program and every binding calls.

use std::fmt;

use metrology::{Measurement, combined_std};
use ndarray::ArrayView2;

use crate::camera::{IdealBlur, Intrinsics, LocalBlur, Scale};
use crate::estimate::joint::{Tracked, Tracker};
use crate::estimate::registry::{self, Choice};
use crate::estimate::{Heading, JointEstimator, MotionBlur, Settings, Status};
use crate::image::{Grey, Pixels};
use crate::motion::{AcceleratedPath, Exposure, PathAcceleration, Speed};
use crate::record::Record;
use crate::{Error, Result};

/// What to measure and how. The default measures direction and length with the recommended method.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Configuration {
    /// The method.
    pub method: Choice,
    /// Its settings.
    pub settings: Settings,
    /// Whether integer samples follow the sRGB tone curve, which is then undone: motion mixes light.
    pub linearize: bool,
    /// Whether pictures are frames that follow each other, so that a fit may start from the result of the frame before; it
    /// goes back to the search when the evidence drops.
    pub tracking: bool,
    /// Whether pictures are frames that follow each other, so that the displacement since the frame before tells a motion
    /// from its opposite.
    pub directed: bool,
    /// The exposure of every picture; without it there is no speed.
    pub exposure: Option<Exposure>,
    /// What turns pixels into metres or radians; without it there is no speed.
    pub geometry: Option<Geometry>,
}

/// What turns the pixels of a blur into metres or radians.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum Geometry {
    /// The motion is in a plane of this scale.
    Scale(Scale),
    /// A calibrated camera sees a motion in a plane at a distance in metres, parallel to its sensor.
    Plane {
        /// The camera.
        camera: Box<Intrinsics>,
        /// Distance in metres.
        distance_m: Measurement,
    },
    /// A calibrated camera turns in front of a scene at rest.
    Rotation {
        /// The camera.
        camera: Box<Intrinsics>,
    },
}

/// Measures pictures one after the other: [`Configuration`] in, [`Record`]s out.
///
/// Plans and buffers are made with the first picture of a size; after that nothing is allocated. Build one for each thread
/// and keep it.
///
/// ```
/// use blur_core::meter::{Configuration, Meter};
/// use ndarray::Array2;
///
/// let mut meter = Meter::new(Configuration::default())?;
/// let picture = Array2::from_shape_fn((64, 64), |(row, column)| ((row * 7 + column * 13) % 31) as f32);
/// let record = meter.measure_grey(picture.view())?;
/// assert_eq!((record.width, record.height), (64, 64));
/// # Ok::<(), blur_core::Error>(())
/// ```
pub struct Meter {
    configuration: Configuration,
    estimator: Estimator,
    heading: Option<Heading>,
    grey: Grey,
}

/// Each picture by itself, or from the one before.
enum Estimator {
    Single(Box<dyn JointEstimator>),
    Tracking(Box<Tracker>),
}

impl fmt::Debug for Meter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Meter").field("configuration", &self.configuration).finish_non_exhaustive()
    }
}

impl Meter {
    /// A meter that serves a configuration.
    ///
    /// # Errors
    /// [`Error::NoTracking`] when frames are to be tracked by a method that cannot.
    pub fn new(configuration: Configuration) -> Result<Self> {
        let method = configuration.method;
        let estimator = if configuration.tracking {
            let name = method.to_string();
            if !registry::TRACKING.contains(&name.as_str()) {
                return Err(Error::NoTracking { method: name, known: registry::TRACKING.join(" ") });
            }
            Estimator::Tracking(Box::new(Tracker::new(&configuration.settings)))
        } else {
            Estimator::Single(method.build(&configuration.settings))
        };
        let heading = configuration.directed.then(Heading::new);
        Ok(Self { grey: Grey::new(configuration.linearize), estimator, heading, configuration })
    }

    /// The configuration served.
    pub fn configuration(&self) -> &Configuration {
        &self.configuration
    }

    /// Takes another exposure for the pictures to come, such as one that their file tells.
    pub fn set_exposure(&mut self, exposure: Option<Exposure>) {
        self.configuration.exposure = exposure;
    }

    /// Takes another geometry for the pictures to come, such as one that their camera tells.
    pub fn set_geometry(&mut self, geometry: Option<Geometry>) {
        self.configuration.geometry = geometry;
    }

    /// Forgets the frame before: the next picture does not follow it.
    pub fn reset(&mut self) {
        if let Estimator::Tracking(tracker) = &mut self.estimator {
            tracker.reset();
        }
        if let Some(heading) = &mut self.heading {
            heading.reset();
        }
    }

    /// Measures a picture of stored samples.
    ///
    /// # Errors
    /// Those of [`JointEstimator::estimate`], and those of a camera for pictures of another shape than its own.
    pub fn measure(&mut self, pixels: &Pixels<'_>) -> Result<Record> {
        let image = self.grey.convert(pixels).view();
        let mut record = self.estimator.record(&self.configuration, self.heading.as_mut(), image)?;
        record.linearized = self.configuration.linearize && pixels.format().sample.is_integer();
        Ok(record)
    }

    /// Measures a picture of grey values, rows x columns with row 0 at the top, on any linear scale. They are not copied.
    ///
    /// # Errors
    /// As [`measure`](Self::measure).
    pub fn measure_grey(&mut self, image: ArrayView2<'_, f32>) -> Result<Record> {
        self.estimator.record(&self.configuration, self.heading.as_mut(), image)
    }
}

impl Estimator {
    fn record(
        &mut self,
        configuration: &Configuration,
        heading: Option<&mut Heading>,
        image: ArrayView2<'_, f32>,
    ) -> Result<Record> {
        let found = match self {
            Self::Single(estimator) => estimator.estimate(image).map(|blur| Tracked { blur, tracked: false }),
            Self::Tracking(tracker) => tracker.estimate(image),
        };
        let Tracked { mut blur, tracked } = match found {
            Ok(found) => found,
            Err(error) => {
                // What cannot be measured is no frame to compare the next one with.
                if let Some(heading) = heading {
                    heading.reset();
                }
                return Err(error);
            }
        };
        if let Some(heading) = heading {
            let has_motion = !matches!(blur.status, Status::NoMotionBlur(_));
            let since = heading.next(image, has_motion.then_some((blur.angle, blur.length_px)));
            blur.direction_deg = blur.direction_deg.or(since);
        }
        Ok(Record { tracked, ..record(configuration, &blur, image.dim())? })
    }
}

/// The record of a blur, with speed and acceleration as far as exposure and geometry are known.
fn record(configuration: &Configuration, blur: &MotionBlur, dim: (usize, usize)) -> Result<Record> {
    let mut record = Record::of_blur(blur, dim, configuration.method);
    let exposure = configuration.exposure;
    record.exposure_s = exposure.map(|exposure| exposure.seconds().value());
    let Some(geometry) = configuration.geometry.as_ref() else { return Ok(record) };
    if matches!(blur.status, Status::NoMotionBlur(_)) {
        return Ok(record);
    }
    let scale = match geometry {
        Geometry::Scale(scale) => *scale,
        Geometry::Plane { camera, distance_m } => {
            let scale = ideal(camera, blur, dim)?.scale(*distance_m)?;
            record.scale_m_per_px = Some(scale.m_per_px().value());
            record.scale_std_m_per_px = Some(scale.m_per_px().std());
            scale
        }
        Geometry::Rotation { camera } => {
            if let Some(exposure) = exposure {
                let turn_rad = ideal(camera, blur, dim)?.turn_rad()?;
                set_rate(&mut record, turn_rad, exposure);
            }
            return Ok(record);
        }
    };
    let Some(exposure) = exposure else { return Ok(record) };
    let speed = Speed::from_blur(blur.length_px, blur.length_std_px, scale, exposure);
    record.speed_m_s = Some(speed.value_m_s);
    record.speed_std_m_s = speed.std_m_s;
    if let (Some(found), Some(ratio), Some(ratio_std)) = (blur.acceleration, record.accel_ratio, record.accel_ratio_std)
    {
        let path = AcceleratedPath {
            ratio: Measurement::new(ratio, ratio_std)?,
            length_px: Measurement::new(blur.length_px, blur.length_std_px.unwrap_or(0.0))?,
            correlation: found.signed.map_or(found.length_correlation, |signed| signed.length_correlation),
        };
        let acceleration = PathAcceleration::from_blur(&path, scale, exposure);
        record.accel_m_s2 = Some(acceleration.value_m_s2);
        record.accel_std_m_s2 = Some(acceleration.std_m_s2);
    }
    Ok(record)
}

/// The blur in the middle of a picture without the camera's distortion.
fn ideal(camera: &Intrinsics, blur: &MotionBlur, (height, width): (usize, usize)) -> Result<IdealBlur> {
    camera.resized(width, height)?.ideal_blur(LocalBlur {
        centre_px: [0.5 * (width as f64 - 1.0), 0.5 * (height as f64 - 1.0)],
        angle: blur.angle,
        angle_std_deg: blur.angle_std_deg.unwrap_or(0.0),
        length_px: blur.length_px,
        length_std_px: blur.length_std_px.unwrap_or(0.0),
        correlation: blur.correlation.unwrap_or(0.0),
    })
}

/// The rate `turn / T`. It is as certain as the blur length, so there is no uncertainty where that has none.
fn set_rate(record: &mut Record, turn_rad: Measurement, exposure: Exposure) {
    let seconds = exposure.seconds();
    let value = turn_rad.value() / seconds.value();
    let std = combined_std([(1.0 / seconds.value(), turn_rad.std()), (value / seconds.value(), seconds.std())]);
    record.angular_rate_rad_s = Some(value);
    record.angular_rate_std_rad_s = record.length_std_px.map(|_| std);
}
