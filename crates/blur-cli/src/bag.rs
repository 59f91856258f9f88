//! Bags of ROS 2: the pictures of one topic, measured one after the other.

use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use blur_core::meter::{Configuration, Geometry};
use blur_core::motion::Exposure;
use blur_core::record::{Record, Value};
use blur_ros::bag::{self, Task};
use blur_ros::msg::Time;
use blur_ros::observer::{self, UseOfInfo};
use metrology::Measurement;
use serde::ser::{Serialize, SerializeMap, Serializer};

use crate::measure::Options;
use crate::text::with_uncertainty;
use crate::{Error, Result};

/// What only bags have.
#[derive(Debug, Clone, Default)]
pub struct BagOptions {
    /// The topic with the pictures; `None`: the only one.
    pub topic: Option<String>,
    /// The topic with the calibration of the camera; `None`: the one beside the pictures.
    pub info_topic: Option<String>,
    /// Where velocities and diagnostics go.
    pub output: Option<PathBuf>,
    /// Whether a fit may start from the result of the frame before.
    pub tracking: bool,
}

/// The bag among the inputs, which must be alone.
///
/// # Errors
/// [`Error::BagAmongOthers`].
pub fn among(inputs: &[PathBuf]) -> Result<Option<&Path>> {
    // A file that is called a bag is read as one, to say what is wrong with it.
    let is_bag = |path: &Path| bag::is_bag(path) || (path.is_file() && path.extension().is_some_and(|e| e == "mcap"));
    match inputs.iter().find(|input| is_bag(input)) {
        Some(_) if inputs.len() > 1 => Err(Error::BagAmongOthers { inputs: inputs.len() }),
        found => Ok(found.map(PathBuf::as_path)),
    }
}

/// The bag at `path` with what is to be measured in it.
///
/// # Errors
/// [`Error::NotForBags`] for what only pictures have, and those of [`blur_ros::bag`].
pub fn task(path: &Path, options: &Options, bag_options: &BagOptions) -> Result<Task> {
    for (option, is_given) in [
        ("--roi", options.roi.is_some()),
        ("--mask", options.mask.is_some()),
        ("--map", options.map_tile_px.is_some()),
        ("--restore", options.restore.is_some()),
        ("--report", options.report.is_some()),
        ("--readout", options.readout_s.is_some()),
    ] {
        if is_given {
            return Err(Error::NotForBags { option });
        }
    }
    let mut configuration = Configuration::default();
    configuration.method =
        options.method.choice().ok_or(Error::NotForBags { option: "--reference or --known-angle" })?;
    configuration.settings = options.settings;
    configuration.tracking = bag_options.tracking;
    configuration.exposure = match options.exposure_s {
        Some(seconds) => Some(Exposure::new(Measurement::new(seconds, options.exposure_std_s)?)?),
        None => None,
    };
    let camera = options.camera.clone().map(Box::new);
    configuration.geometry = match (options.scale, camera, options.distance_m) {
        (Some(scale), _, _) => Some(Geometry::Scale(scale)),
        (None, Some(camera), _) if options.rotating => Some(Geometry::Rotation { camera }),
        (None, Some(camera), Some(distance_m)) => Some(Geometry::Plane { camera, distance_m }),
        (None, _, _) => None,
    };
    let use_of_info = match options.distance_m {
        _ if options.rotating => UseOfInfo::Rotation,
        Some(distance_m) => UseOfInfo::Plane(distance_m),
        None => UseOfInfo::Nothing,
    };
    let files = bag::files(path)?;
    let (topic, kind) = bag::image_topic(&bag::topics(&files)?, bag_options.topic.as_deref())?;
    let options = observer::Options {
        configuration,
        linearize: options.linearize,
        exposure_std_s: options.exposure_std_s,
        use_of_info,
    };
    let BagOptions { info_topic, output, .. } = bag_options.clone();
    Ok(Task { files, topic, kind, info_topic, options, output })
}

/// The name of a frame in results: `run.mcap:/camera/image_raw@12.034000000`.
pub fn name(path: &Path, topic: &str, stamp: Time) -> String {
    format!("{}:{topic}@{}.{:09}", path.display(), stamp.sec, stamp.nanosec)
}

/// A record under the name of its picture, as one JSON object.
struct Line<'a> {
    image: &'a str,
    record: &'a Record,
}

impl Serialize for Line<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("image", self.image)?;
        for (name, value) in self.record.fields() {
            match value {
                Value::Count(count) => map.serialize_entry(name, &count)?,
                Value::Number(number) => map.serialize_entry(name, &number)?,
                Value::Flag(flag) => map.serialize_entry(name, &flag)?,
                Value::Text(text) => map.serialize_entry(name, &text)?,
            }
        }
        map.end()
    }
}

/// Writes the record of a frame as one JSON object on a line of its own.
///
/// # Errors
/// Those of `out`.
pub fn write_json(out: &mut impl Write, image: &str, record: &Record) -> io::Result<()> {
    serde_json::to_writer(&mut *out, &Line { image, record })?;
    out.write_all(b"\n")
}

/// A record on one line for people; after `±` stands one standard uncertainty.
pub fn line(image: &str, record: &Record) -> String {
    let angle = with_uncertainty(record.angle_deg, record.angle_std_deg, 1);
    let length = with_uncertainty(record.length_px, record.length_std_px, 1);
    let mut text = format!("{image}  angle {angle} deg  length {length} px");
    for (what, value, std, unit) in [
        ("direction", record.direction_deg, record.angle_std_deg, "deg"),
        ("speed", record.speed_m_s, record.speed_std_m_s, "m/s"),
        ("rate", record.angular_rate_rad_s, record.angular_rate_std_rad_s, "rad/s"),
    ] {
        if let Some(value) = value {
            // Writing to a String cannot fail.
            let _ = write!(text, "  {what} {} {unit}", with_uncertainty(value, std, 4));
        }
    }
    let _ = write!(text, "  {}", record.status.name());
    if let Some(doubt) = record.status.doubt() {
        let _ = write!(text, ": {doubt}");
    }
    text
}
