//! The command line of `estimate`.

use std::fmt::Write;
use std::num::NonZeroUsize;
use std::path::PathBuf;

use blur_cli::measure::Options;
use blur_cli::method::Method;
use blur_cli::picture::Linearize;
use blur_cli::{Error, Result, stills, units};
use blur_core::camera::Scale;
use blur_core::estimate::{AxialAngle, LengthRange, Settings, registry};
use blur_core::image::{Region, Window};
use blur_core::motion::Exposure;
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
pub(crate) struct Args {
    /// Pictures (PNG, JPEG, TIFF), folders of pictures, or patterns such as 'run*.png'; the built-in sample if none
    /// is given
    #[arg(value_name = "IMAGE|DIR|GLOB")]
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

impl Args {
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
            (None, None, None) if length.is_none() => Method::recommended()?,
            (None, angle, None) => Method::pair(angle.as_deref(), length)?,
        };
        if self.accel {
            method.check_acceleration()?;
        }
        let exposure_std_s = self.exposure_u.unwrap_or(0.0);
        if let Some(seconds) = self.exposure {
            Exposure::new(Measurement::new(seconds, exposure_std_s)?)?;
        }
        let scale = match self.scale {
            Some(m_per_px) => Some(Scale::new(Measurement::new(m_per_px, self.scale_u.unwrap_or(0.0))?)?),
            None => None,
        };
        Ok(Options { method, settings, roi: self.roi, linearize, exposure_s: self.exposure, exposure_std_s, scale })
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
    if let Ok(method) = Method::recommended() {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "Without any of these options: {}.\n", method.name());
    }
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
  speed   scale * length / exposure, in m/s
  ratio   with --accel, how strongly the motion accelerated: 0 for a uniform
          motion, 1 for one that starts or ends at rest; one picture cannot
          tell speeding up from slowing down; with exposure and scale also
          the acceleration 2 * ratio * speed / exposure, in m/s2
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

JSON fields (--json), absent when not computed:
  image width height method linearized angle_deg angle_std_deg direction_deg
  length_px length_std_px correlation status reason accel_ratio
  accel_ratio_std accel_ratio_limit accel_detected accel_m_s2
  accel_std_m_s2 accel_expanded_m_s2 accel_limit_m_s2 gain_per_bin
  rival_share incoherent_share misfit band_cycles_per_px exposure_s
  exposure_source speed_m_s speed_std_m_s speed_expanded_m_s coverage_k time_ms
  accel_ratio_limit and accel_limit_m_s2 are the least ratio and acceleration
  that count as detected.
  gain_per_bin is the gain in log-likelihood over no blur for each bin of
  signal, rival_share the evidence for the best other blur relative to this
  one, incoherent_share the share of light that does not follow the motion,
  misfit the mean squared residual of the spectrum (1: as expected), and
  band_cycles_per_px the highest frequency used.
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
  estimate --known-angle 0 --range 10,80 rail.tif";
