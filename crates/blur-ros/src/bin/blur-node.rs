//! Measures motion blur in the pictures of a topic of ROS 2, live: `blur-node --help`.

use std::env;
use std::io::{self, Write};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use blur_core::camera::Scale;
use blur_core::meter::{Configuration, Geometry};
use blur_core::motion::Exposure;
use blur_picture::Linearize;
use blur_ros::frame::FrameKind;
use blur_ros::node::{Node, Note, Settings};
use blur_ros::observer::{Options, UseOfInfo};
use blur_ros::{Result, diagnostics};
use blur_stream::Limits;
use clap::error::ErrorKind;
use clap::{CommandFactory, Parser};
use metrology::Measurement;
use signal_hook::consts::{SIGINT, SIGTERM};

/// How often the signals and the clock are looked at.
const TICK: Duration = Duration::from_millis(100);

/// Measures motion blur in the pictures of a ROS 2 topic, live over Zenoh as rmw_zenoh speaks it, and publishes velocities
/// (/blur/twist) and diagnostics (/diagnostics). No installation of ROS is needed.
#[derive(Parser)]
#[command(name = "blur-node", version, max_term_width = 110)]
#[expect(
    clippy::doc_markdown,
    reason = "the documentation of the options is the help, where names stand as they are typed"
)]
#[expect(clippy::struct_excessive_bools, reason = "options that are given or not")]
struct Args {
    /// Topic with the pictures
    #[arg(long, value_name = "TOPIC", default_value = "/camera/image_raw")]
    topic: String,

    /// The pictures are compressed (sensor_msgs/msg/CompressedImage)
    #[arg(long)]
    compressed: bool,

    /// Topic with the calibration of the camera [default: camera_info beside the pictures]
    #[arg(long, value_name = "TOPIC")]
    camera_info: Option<String>,

    /// Domain of ROS [default: ROS_DOMAIN_ID of the environment, or 0]
    #[arg(long, value_name = "N")]
    domain: Option<u32>,

    /// Name of the node
    #[arg(long, value_name = "NAME", default_value = "blur_node")]
    name: String,

    /// Router or peer to connect to [default: tcp/127.0.0.1:7447 unless --listen is given]
    #[arg(long, value_name = "ENDPOINT")]
    connect: Vec<String>,

    /// Where to listen for peers [default: tcp/127.0.0.1:0]
    #[arg(long, value_name = "ENDPOINT")]
    listen: Vec<String>,

    /// Exposure time in seconds
    #[arg(long, value_name = "SECONDS")]
    exposure_s: Option<f64>,

    /// Standard uncertainty of the exposure time in seconds
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0)]
    exposure_std_s: f64,

    /// Size of one pixel in the scene in metres
    #[arg(long, value_name = "METRES")]
    scale_m_per_px: Option<f64>,

    /// Standard uncertainty of the scale in metres
    #[arg(long, value_name = "METRES", default_value_t = 0.0, requires = "scale_m_per_px")]
    scale_std_m_per_px: f64,

    /// Distance in metres from the camera to the plane of the motion; the camera comes from its CameraInfo
    #[arg(long, value_name = "METRES", conflicts_with = "scale_m_per_px")]
    distance_m: Option<f64>,

    /// Standard uncertainty of the distance in metres
    #[arg(long, value_name = "METRES", default_value_t = 0.0, requires = "distance_m")]
    distance_std_m: f64,

    /// The camera turns and the scene stands still; the camera comes from its CameraInfo
    #[arg(long, conflicts_with_all = ["scale_m_per_px", "distance_m"])]
    rotating: bool,

    /// The samples follow the sRGB tone curve: undo it
    #[arg(long)]
    linearize: bool,

    /// Start each frame from the result of the one before
    #[arg(long)]
    tracking: bool,

    /// Frames that may wait; then the oldest is dropped
    #[arg(long, value_name = "FRAMES", default_value_t = 2)]
    queue: usize,

    /// A frame that has waited so many seconds when its turn comes is dropped
    #[arg(long, value_name = "SECONDS")]
    deadline_s: Option<f64>,

    /// Seconds between reports of the latency
    #[arg(long, value_name = "SECONDS", default_value_t = 5.0)]
    report_s: f64,

    /// End after so many seconds [default: at SIGINT or SIGTERM]
    #[arg(long, value_name = "SECONDS")]
    duration_s: Option<f64>,
}

fn main() -> ExitCode {
    let args = Args::parse();
    let settings = match args.settings() {
        Ok(settings) => settings,
        Err(error) => {
            let message = diagnostics::one_line(&error);
            Args::command().error(ErrorKind::ValueValidation, message).exit()
        }
    };
    match run(&args, &settings) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            complain(&diagnostics::one_line(&error));
            ExitCode::FAILURE
        }
    }
}

fn run(args: &Args, settings: &Settings) -> Result<()> {
    let is_asked_to_end = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        if let Err(error) = signal_hook::flag::register(signal, Arc::clone(&is_asked_to_end)) {
            complain(&format!("signal {signal} will end the program at once: {error}"));
        }
    }
    let (node, notes) = Node::start(settings)?;
    complain(&format!("measuring {}", args.topic));
    let start = Instant::now();
    let end = args.duration_s.and_then(duration);
    let every = duration(args.report_s).unwrap_or(Duration::MAX);
    let mut reported = start;
    while !is_asked_to_end.load(Ordering::Relaxed) && end.is_none_or(|end| start.elapsed() < end) {
        if !tell_next(&notes) {
            break;
        }
        if reported.elapsed() >= every {
            reported = Instant::now();
            node.publish_report()?;
            complain(&node.report().to_string());
        }
    }
    let (report, counts) = node.stop()?;
    complain(&report.to_string());
    complain(&counts.to_string());
    Ok(())
}

/// Waits for a note and tells it; `false` when the worker has ended.
fn tell_next(notes: &Receiver<Note>) -> bool {
    match notes.recv_timeout(TICK) {
        Ok(Note::Event { stamp, event }) => complain(&format!("{}.{:09}: {event}", stamp.sec, stamp.nanosec)),
        Ok(Note::Frame { stamp, error }) => {
            complain(&format!("{}.{:09}: {}", stamp.sec, stamp.nanosec, diagnostics::one_line(&error)));
        }
        Ok(Note::Missing(missing)) => complain(missing.advice()),
        Ok(Note::Failure(error)) => complain(&diagnostics::one_line(&error)),
        Ok(_) | Err(RecvTimeoutError::Timeout) => {}
        Err(RecvTimeoutError::Disconnected) => return false,
    }
    true
}

impl Args {
    /// What is refused here is a mistake on the command line.
    fn settings(&self) -> Result<Settings> {
        let mut configuration = Configuration::default();
        configuration.tracking = self.tracking;
        if let Some(seconds) = self.exposure_s {
            configuration.exposure = Some(Exposure::new(Measurement::new(seconds, self.exposure_std_s)?)?);
        }
        if let Some(m_per_px) = self.scale_m_per_px {
            let scale = Scale::new(Measurement::new(m_per_px, self.scale_std_m_per_px)?)?;
            configuration.geometry = Some(Geometry::Scale(scale));
        }
        let use_of_info = match self.distance_m {
            _ if self.rotating => UseOfInfo::Rotation,
            Some(distance) => UseOfInfo::Plane(Measurement::new(distance, self.distance_std_m)?),
            None => UseOfInfo::Nothing,
        };
        let linearize = if self.linearize { Linearize::On } else { Linearize::Auto };
        let usual =
            |given: &[String], usual: &str| if given.is_empty() { vec![usual.to_owned()] } else { given.to_vec() };
        let connect =
            if self.listen.is_empty() { usual(&self.connect, "tcp/127.0.0.1:7447") } else { self.connect.clone() };
        Ok(Settings {
            domain: self.domain.or_else(domain_of_environment).unwrap_or_default(),
            name: self.name.clone(),
            topic: self.topic.clone(),
            kind: if self.compressed { FrameKind::Compressed } else { FrameKind::Raw },
            info_topic: self.camera_info.clone(),
            connect,
            listen: usual(&self.listen, "tcp/127.0.0.1:0"),
            limits: Limits { capacity: self.queue, deadline: self.deadline_s.and_then(duration) },
            options: Options { configuration, linearize, exposure_std_s: self.exposure_std_s, use_of_info },
        })
    }
}

fn domain_of_environment() -> Option<u32> {
    env::var("ROS_DOMAIN_ID").ok()?.parse().ok()
}

/// A time of so many seconds; `None` for one that cannot be.
fn duration(seconds: f64) -> Option<Duration> {
    Duration::try_from_secs_f64(seconds).ok()
}

fn complain(message: &str) {
    // A closed standard error leaves nobody to tell.
    let _ = writeln!(io::stderr(), "blur-node: {message}");
}
