//! The command line of `estimate`.

use std::fmt::Write;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use blur_cli::bag::{self, BagOptions};
use blur_cli::measure::{Options, RestoreTo};
use blur_cli::method::Method;
use blur_cli::picture::Linearize;
use blur_cli::{Error, Result, camera, stills, units};
use blur_core::camera::Scale;
use blur_core::estimate::{AxialAngle, LengthRange, Settings, registry};
use blur_core::image::{Region, Window};
use blur_core::motion::Exposure;
use blur_core::restore;
use clap::{Parser, ValueEnum};
use metrology::Measurement;

/// Measures motion blur: the direction and length of the blur in a photograph and, with exposure and scale, the speed.
#[derive(Parser)]
#[command(
    name = "estimate",
    version,
    after_help = "Methods, units, exit statuses and examples: estimate --help",
    after_long_help = guide(),
    max_term_width = 110
)]
#[expect(
    clippy::doc_markdown,
    reason = "the documentation of the options is the help, where names stand as they are typed"
)]
#[expect(clippy::struct_excessive_bools, reason = "options that are given or not")]
pub(crate) struct Args {
    /// Pictures (PNG, JPEG, TIFF), folders of pictures, or patterns such as 'run*.png', or one bag of ROS 2 (MCAP); the
    /// built-in sample if none is given
    #[arg(value_name = "IMAGE|DIR|GLOB|BAG")]
    pub(crate) inputs: Vec<PathBuf>,

    /// Method that finds angle and length together, or a pair ANGLE+LENGTH
    #[arg(long, value_name = "NAME", help_heading = "Method", value_parser = method, conflicts_with_all = ["angle", "length", "known_angle"])]
    method: Option<String>,

    /// Method that finds the angle
    #[arg(long, value_name = "NAME", help_heading = "Method", value_parser = angle, conflicts_with = "known_angle")]
    angle: Option<String>,

    /// Method that finds the length along the angle
    #[arg(long, value_name = "NAME", help_heading = "Method", value_parser = length)]
    length: Option<String>,

    /// The angle is known, for instance from a rail: measure only the length along it
    #[arg(long, value_name = "DEG", help_heading = "Method", value_parser = units::degrees, allow_negative_numbers = true)]
    known_angle: Option<f64>,

    /// Sharp pictures of the same scene with the camera at rest where the shutter opens (files, folders, patterns; name
    /// the blurred pictures first): the direction becomes an arrow, the acceleration gets its sign
    #[arg(
        long,
        value_name = "SHARP",
        help_heading = "Method",
        num_args = 1..,
        requires = "inputs",
        conflicts_with_all = ["angle", "length", "known_angle"]
    )]
    reference: Vec<PathBuf>,

    /// Also look for an acceleration: its ratio r = a T / (2 v), with uncertainty and detection limit; without sign
    /// unless there is a --reference
    #[arg(long, help_heading = "Method")]
    accel: bool,

    /// Measure only this part of each picture: left column, top row, width, height in pixels
    #[arg(long, value_name = "X,Y,W,H", help_heading = "Picture", value_parser = units::region)]
    roi: Option<Region>,

    /// Taper laid over the picture before its transform [default: the method's own]
    #[arg(long, value_name = "WINDOW", help_heading = "Picture")]
    window: Option<WindowName>,

    /// Shortest and longest blur length to look for, in pixels
    #[arg(long, value_name = "MIN,MAX", help_heading = "Picture", value_parser = units::length_range)]
    range: Option<LengthRange>,

    /// Undo the sRGB tone curve first; auto: for JPEG files
    #[arg(long, value_name = "WHEN", help_heading = "Picture", default_value = "auto")]
    linearize: LinearizeWhen,

    /// Exposure time, for instance 100ms or 1/250s [default: from the EXIF data of each picture]
    #[arg(long, value_name = "TIME", help_heading = "Speed", value_parser = units::seconds)]
    exposure: Option<f64>,

    /// Standard uncertainty of the exposure time [default: none, the time is taken as exact]
    #[arg(long, value_name = "TIME", help_heading = "Speed", value_parser = units::seconds)]
    exposure_u: Option<f64>,

    /// Size of one pixel in the scene, for instance 0.7789mm/px
    #[arg(long, value_name = "SCALE", help_heading = "Speed", value_parser = units::metres_per_pixel)]
    scale: Option<f64>,

    /// Standard uncertainty of the scale [default: none, the scale is taken as exact]
    #[arg(long, value_name = "SCALE", help_heading = "Speed", value_parser = units::metres_per_pixel, requires = "scale")]
    scale_u: Option<f64>,

    /// Camera file of the program calibrate, instead of --scale; with --distance
    #[arg(long, value_name = "CAMERA.json", help_heading = "Speed", conflicts_with = "scale")]
    camera: Option<PathBuf>,

    /// Distance from the camera to the plane of the motion, for instance 1.21m; with --camera, or the CameraInfo of a bag
    #[arg(long, value_name = "LENGTH", help_heading = "Speed", value_parser = units::metres)]
    distance: Option<f64>,

    /// Standard uncertainty of the distance [default: none, the distance is taken as exact]
    #[arg(long, value_name = "LENGTH", help_heading = "Speed", value_parser = units::metres, requires = "distance")]
    distance_u: Option<f64>,

    /// The camera turned and the scene stood still: report the angular rate; the focal length comes from --camera, the
    /// CameraInfo of a bag or, roughly, from the EXIF data
    #[arg(long, help_heading = "Speed", conflicts_with_all = ["scale", "distance"])]
    rotating: bool,

    /// Time that the sensor takes to read all its rows (rolling shutter), for instance 20ms
    #[arg(long, value_name = "TIME", help_heading = "Speed", value_parser = units::seconds)]
    readout: Option<f64>,

    /// Also measure the blur in half-overlapping tiles of this many pixels, and find what stands still and what moves
    #[arg(long, value_name = "TILE", help_heading = "Picture")]
    map: Option<NonZeroUsize>,

    /// Measure only where this picture is white; grey counts in part
    #[arg(long, value_name = "MASK", help_heading = "Picture", conflicts_with = "roi")]
    mask: Option<PathBuf>,

    /// Write the picture without its blur; for several inputs name a folder
    #[arg(long, value_name = "OUT.png", help_heading = "Output")]
    restore: Option<PathBuf>,

    /// How to restore [default: wiener]
    #[arg(long, value_name = "NAME", help_heading = "Output", requires = "restore")]
    restore_method: Option<RestoreName>,

    /// Write report.html with all figures into this folder
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    report: Option<PathBuf>,

    /// Topic with the pictures of a bag [default: the only one]
    #[arg(long, value_name = "TOPIC", help_heading = "Bag of ROS 2")]
    topic: Option<String>,

    /// Topic with the calibration of the camera of a bag [default: camera_info beside the pictures]
    #[arg(long, value_name = "TOPIC", help_heading = "Bag of ROS 2")]
    camera_info: Option<String>,

    /// Start each frame of a bag from the result of the one before
    #[arg(long, help_heading = "Bag of ROS 2")]
    tracking: bool,

    /// Write velocities (/blur/twist) and diagnostics (/diagnostics) into this bag
    #[arg(short, long, value_name = "OUT.mcap", help_heading = "Bag of ROS 2")]
    output: Option<PathBuf>,

    /// One JSON object a line on standard output, in the order of the inputs
    #[arg(long, help_heading = "Output")]
    pub(crate) json: bool,

    /// Pictures to work on at a time [default: one for each processor]
    #[arg(long, value_name = "N", help_heading = "Output")]
    pub(crate) jobs: Option<NonZeroUsize>,
}

#[derive(Clone, Copy, ValueEnum)]
enum WindowName {
    None,
    Hann,
}

#[derive(Clone, Copy, ValueEnum)]
enum LinearizeWhen {
    Auto,
    On,
    Off,
}

#[derive(Clone, Copy, ValueEnum)]
enum RestoreName {
    Wiener,
    RichardsonLucy,
    SlidingDct,
}

impl Args {
    /// The bag to be measured, if there is one. Options that go with another kind of input are refused.
    pub(crate) fn bag(&self) -> Result<Option<(&Path, BagOptions)>> {
        let options = BagOptions {
            topic: self.topic.clone(),
            info_topic: self.camera_info.clone(),
            output: self.output.clone(),
            tracking: self.tracking,
        };
        if let Some(path) = bag::among(&self.inputs)? {
            return Ok(Some((path, options)));
        }
        for (option, is_given) in [
            ("--topic", options.topic.is_some()),
            ("--camera-info", options.info_topic.is_some()),
            ("--output", options.output.is_some()),
            ("--tracking", options.tracking),
        ] {
            if is_given {
                return Err(Error::OnlyForBags { option });
            }
        }
        if self.distance.is_some() && self.camera.is_none() {
            return Err(Error::DistanceAlone);
        }
        Ok(None)
    }

    /// The options of a run. What is refused here is a mistake on the command line.
    pub(crate) fn options(&self) -> Result<Options> {
        let linearize = match self.linearize {
            LinearizeWhen::Auto => Linearize::Auto,
            LinearizeWhen::On => Linearize::On,
            LinearizeWhen::Off => Linearize::Off,
        };
        let mut settings = Settings::default();
        settings.acceleration = self.accel;
        settings.length_range = self.range;
        settings.window = self.window.map(|window| match window {
            WindowName::None => Window::None,
            WindowName::Hann => Window::Hann,
        });
        let length = self.length.as_deref();
        let method = match (&self.method, &self.angle, self.known_angle) {
            (name, _, _) if !self.reference.is_empty() => {
                stills::method(name.as_deref(), &self.reference, self.roi, linearize, &settings)?
            }
            (Some(name), _, _) => Method::named(name)?,
            (None, _, Some(deg)) => Method::known_angle(AxialAngle::from_deg(deg), length)?,
            (None, None, None) if length.is_none() => Method::recommended(),
            (None, angle, None) => Method::pair(angle.as_deref(), length)?,
        };
        if self.accel {
            method.check_acceleration()?;
        }
        if self.mask.is_some() {
            method.check_mask()?;
        }
        let exposure_std_s = self.exposure_u.unwrap_or(0.0);
        if let Some(seconds) = self.exposure {
            Exposure::new(Measurement::new(seconds, exposure_std_s)?)?;
        }
        let scale = match self.scale {
            Some(m_per_px) => Some(Scale::new(Measurement::new(m_per_px, self.scale_u.unwrap_or(0.0))?)?),
            None => None,
        };
        let distance_m = match self.distance {
            Some(metres) => Some(Measurement::new(metres, self.distance_u.unwrap_or(0.0))?),
            None => None,
        };
        let restore = self.restore.clone().map(|path| RestoreTo {
            path,
            method: match self.restore_method {
                None => restore::Method::default(),
                Some(RestoreName::Wiener) => restore::Method::Wiener,
                Some(RestoreName::RichardsonLucy) => restore::Method::RichardsonLucy,
                Some(RestoreName::SlidingDct) => restore::Method::SlidingDct,
            },
        });
        Ok(Options {
            method,
            settings,
            roi: self.roi,
            linearize,
            exposure_s: self.exposure,
            exposure_std_s,
            scale,
            camera: self.camera.as_deref().map(camera::file::read).transpose()?,
            distance_m,
            rotating: self.rotating,
            readout_s: self.readout,
            mask: self.mask.clone(),
            map_tile_px: self.map.map(NonZeroUsize::get),
            restore,
            report: self.report.clone(),
        })
    }
}

fn method(name: &str) -> Result<String> {
    match Method::named(name) {
        // Whether there are any is seen when all options are known.
        Ok(_) | Err(Error::NeedsStills { .. }) => Ok(name.to_owned()),
        Err(error) => Err(error),
    }
}

fn angle(name: &str) -> Result<String> {
    registry::angle(name)?;
    Ok(name.to_owned())
}

fn length(name: &str) -> Result<String> {
    registry::length(name)?;
    Ok(name.to_owned())
}

/// The part of the help that explains; the lists of methods come from the registry.
fn guide() -> String {
    let mut text = String::new();
    list(&mut text, "Methods for --method", registry::JOINT.iter().map(|m| (m.name, m.summary)));
    list(&mut text, "Methods for --method with --reference", registry::REFERENCE.iter().map(|m| (m.name, m.summary)));
    list(&mut text, "Methods for --angle", registry::ANGLE.iter().map(|m| (m.name, m.summary)));
    list(&mut text, "Methods for --length", registry::LENGTH.iter().map(|m| (m.name, m.summary)));
    // Writing to a String cannot fail.
    let _ = writeln!(text, "Without any of these options: {}.\n", Method::recommended().name());
    text.push_str(EXPLANATION);
    text
}

fn list(text: &mut String, title: &str, methods: impl Iterator<Item = (&'static str, &'static str)>) {
    let mut methods = methods.peekable();
    if methods.peek().is_some() {
        let _ = writeln!(text, "{title}:");
        for (name, summary) in methods {
            let _ = writeln!(text, "  {name:<22} {summary}");
        }
        text.push('\n');
    }
}

// Lines of at most 78 characters keep their shape on a terminal of 80.
const EXPLANATION: &str = "\
What is measured:
  angle   axis of the motion in the upright picture (EXIF orientation applied),
          in degrees counter-clockwise from the right, from 0 up to but not
          including 180; one picture cannot tell a motion from its opposite
  length  distance in pixels that a point of the scene moved across the
          picture during the exposure
  speed   scale * length / exposure, in m/s; with --camera and --distance the
          scale is that of the middle of the region along the blur, for a motion
          parallel to the sensor at that distance along the optical axis
  ratio   with --accel, how strongly the motion accelerated: 0 for a uniform
          motion, 1 for one that starts or ends at rest; one picture cannot
          tell speeding up from slowing down; with exposure and scale also
          the acceleration 2 * ratio * speed / exposure, in m/s2
  With --camera (a file of the program calibrate) also angle and length in a
  picture without distortion and with square pixels; angle and length stay those
  of the picture. One of another size but the same shape is taken as resampled.
  With --rotating also
  rate    angular rate of the camera in rad/s before a scene that stands still,
          about an axis perpendicular to the ray through the middle of the
          region; from --camera or, to 3 or 5 % at best, from EXIF data
  With --reference also
  direction  where the content of the picture moved, from 0 up to 360, when one
          end of its path is where the sharp pictures show it; the ratio then
          has a sign, negative where the motion slows down along the direction
          or, where that is not known, along the angle
  status  ok, low_confidence (with the reason) or no_motion_blur (no speed)
  After ± stands one standard uncertainty or, where (k = 2) follows, the
  expanded uncertainty. A method that states no uncertainty of the length
  gives a speed without one.

Units:
  time    s, ms, us, also as a fraction: 0.1s  100ms  1/250s  250us
  scale   m/px, cm/px, mm/px, um/px: 0.7789mm/px  1e-3m/px
  A number without a unit is refused.

Pictures:
  Known by their content, not by their name. A folder stands for the .png,
  .jpg, .jpeg, .tif and .tiff files directly in it, sorted by name. Colours
  become luma (BT.601, 0 to 255; 16 bit values are scaled to it, floats stay
  as they are, alpha is ignored) or, linearized, luminance (BT.709 of the
  decoded sRGB light).

Bags of ROS 2:
  An MCAP file, or the folder of a rosbag2 with metadata.yaml. The pictures of
  one topic (sensor_msgs Image with mono, rgb or bgr of 8 or 16 bits or 32FC1,
  CompressedImage) are measured in their order; frames out of order, missing
  or of another size start anew. Stored samples are taken as linear without
  --linearize on, JPEG as for files. --output writes a bag with the velocity
  (/blur/twist, in the optical frame: x right, y down) where there is a speed,
  and with every field of each record (/diagnostics).

JSON fields (--json), absent when not computed:
  image width height method linearized angle_deg angle_std_deg direction_deg
  length_px length_std_px correlation status reason accel_ratio
  accel_ratio_std accel_ratio_limit accel_detected accel_m_s2
  accel_std_m_s2 accel_expanded_m_s2 accel_limit_m_s2 gain_per_bin
  rival_share incoherent_share misfit band_cycles_per_px exposure_s
  exposure_source angle_undistorted_deg length_undistorted_px focal_length_px
  focal_length_std_px focal_length_source scale_m_per_px scale_std_m_per_px
  angular_rate_rad_s angular_rate_std_rad_s angular_rate_expanded_rad_s
  speed_m_s speed_std_m_s speed_expanded_m_s coverage_k map readout restored
  sharpness_change time_ms
  accel_ratio_limit and accel_limit_m_s2 are the least ratio and acceleration
  that count as detected.
  gain_per_bin is the gain in log-likelihood over no blur for each bin of
  signal, rival_share the evidence for the best other blur relative to this
  one, incoherent_share the share of light that does not follow the motion,
  misfit the mean squared residual of the spectrum (1: as expected), and
  band_cycles_per_px the highest frequency used.
  restored is the file of --restore, and sharpness_change the gain in the
  logarithm of the kurtosis of the derivative along the motion from undoing the
  blur: below 0 the picture became no sharper, and the blur may be wrong.
  map holds tile_px step_px window tiles regions still_share unknown_share
  readout_ignored (true without --readout); its tiles and regions hold the
  blur under the names above, regions also label kind area_px centroid_x
  centroid_y and the speed. Positions are pixels of the whole picture.
  readout holds readout_s rows_run and the speeds if the content moved down or
  up the rows as stored: speed_down_m_s speed_down_expanded_m_s speed_up_m_s
  speed_up_expanded_m_s; regions of a map hold them too. rows_run says which
  way down is in the upright picture: down, up, left or right. It supposes that
  the picture shows all rows of the sensor. With --map also the change of the
  speed from the first row to the last, from the tiles that are ok:
  change_px_s2 change_std_px_s2 change_tiles change_m_s2 change_std_m_s2
  change_expanded_m_s2 change_significance significant, or change_reason.
  time_ms is the time of the estimator alone, without reading the file.
  A picture that failed gives image and error.

Exit status:
  0  every input was measured
  1  some input failed; the others are reported all the same
  2  the command line is wrong

Examples:
  estimate                                   try it on the built-in sample
  estimate photo.jpg                         direction and length
  estimate --roi 400,300,512,512 photo.jpg   a moving object in a still scene
  estimate --exposure 100ms --exposure-u 0.1ms \\
           --scale 0.7789mm/px --scale-u 0.002mm/px slider.png
  estimate --json --jobs 4 'run1/*.png' run2 > results.jsonl
  estimate --accel blurred/ --reference still1.png still2.png
  estimate --known-angle 0 --range 10,80 rail.tif
  estimate run.mcap --topic /camera/image_raw --exposure 10ms \\
           --distance 2m -o velocities.mcap";
