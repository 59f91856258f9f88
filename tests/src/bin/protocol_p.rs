//! Prints the accuracy tables of all registered methods: synthetic pictures beside the thesis's means, and the real
//! pictures beside their truth.

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

use blur_cli::method::Method;
use blur_cli::picture::{self, Linearize};
use blur_cli::reproduce::answer::Answer;
use blur_cli::reproduce::candidates::{Candidate, candidates};
use blur_cli::reproduce::protocol::{self, Protocol};
use blur_cli::reproduce::shots::{LEVELS, level_name};
use blur_cli::reproduce::statistics::{self, Summary};
use blur_cli::reproduce::thesis;
use blur_core::estimate::{AxialAngle, MotionBlur, Settings, Status};
use clap::Parser;
use e2e_tests::data;

/// Accuracy of the registered methods on synthetic and real pictures.
#[derive(Debug, Parser)]
struct Arguments {
    /// Only these methods, by name.
    #[arg(long)]
    method: Vec<String>,
    /// Every n-th angle and length only.
    #[arg(long, default_value_t = 1)]
    step: usize,
    /// Blur length of the angle experiments in pixels.
    #[arg(long, value_name = "PX", default_value_t = 55.0)]
    angle_length: f64,
    /// Angle of the length experiments in degrees; it is given to the methods.
    #[arg(long, value_name = "DEG", default_value_t = 0.0)]
    length_angle: f64,
    /// Method of the real pictures [default: that of the program]
    #[arg(long, value_name = "NAME|ANGLE+LENGTH")]
    joint: Option<String>,
    /// Only the real pictures.
    #[arg(long)]
    real_only: bool,
    /// Also list every gross error.
    #[arg(long)]
    gross: bool,
}

/// Errors above these are wrong in frames of a phone: degrees, percent of the length.
const PHONE_GROSS_DEG: f64 = 8.0;
const PHONE_GROSS_PERCENT: f64 = 25.0;
/// Steps between the angles in degrees, over all directions, and between the lengths in pixels.
const ANGLE_STEP: usize = 7;
const LENGTH_STEP: usize = 5;
/// Seed of the noise.
const SEED: u64 = 20_180_101;

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("protocol-p: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let joint = arguments.joint.as_deref().map_or_else(|| Ok(Method::recommended()), Method::named)?;
    let folder = data::folder().ok_or("the tables need the pictures of the data folder")?;
    if !arguments.real_only {
        let pictures = data::sharp_pictures(&folder)?;
        let steps =
            |first: u32, last: u32, step: usize| (first..=last).step_by(step * arguments.step.max(1)).map(f64::from);
        let angles = Protocol::angles(steps(0, 179, ANGLE_STEP), arguments.angle_length)?;
        let title = format!("angles of {} pictures at {} px", pictures.len(), arguments.angle_length);
        let thesis = ["4.1", "4.2"];
        print_protocol(&title, &Protocol { seed: SEED, ..angles }, &pictures, thesis, arguments)?;
        let lengths = Protocol::lengths(steps(5, 95, LENGTH_STEP), arguments.length_angle)?;
        // Seeds of their own: far beyond those of the angles.
        let seed = SEED.wrapping_add(1000 * 1009);
        let title = format!("lengths at {} deg", arguments.length_angle);
        let thesis = ["4.4", "4.5"];
        print_protocol(&title, &Protocol { seed, ..lengths }, &pictures, thesis, arguments)?;
    }
    print_real(&folder, &joint)
}

fn print_protocol(
    title: &str,
    protocol: &Protocol,
    pictures: &[data::Sharp],
    [clean, noisy]: [&str; 2],
    arguments: &Arguments,
) -> Result<(), Box<dyn Error>> {
    let mut methods = candidates(protocol.measure, None)?;
    if !arguments.method.is_empty() {
        methods.retain(|method| arguments.method.iter().any(|name| name == method.name()));
    }
    let answers = protocol.run(pictures, &methods)?.answers;
    println!(
        "\n{title}\n{:24} {:7} {:>5} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>6} {:>5} {:>7} {:>5} {:>5}",
        protocol.measure.title(),
        "level",
        "n",
        "mean",
        "min",
        "q1",
        "median",
        "q3",
        "max",
        "gross",
        "ok",
        "thesis",
        "k=1",
        "k=2"
    );
    let levels = LEVELS.map(level_name);
    for method in methods.iter().map(Candidate::name) {
        for (index, level) in levels.iter().enumerate() {
            let thesis = if index == 0 { thesis::errors(clean, method) } else { None };
            print_row(&answers, method, level, std::slice::from_ref(level), thesis);
        }
        print_row(&answers, method, "noisy", &levels[1..], thesis::errors(noisy, method));
    }
    if arguments.gross {
        answers.iter().filter(|answer| answer.is_gross()).for_each(|answer| println!("{answer}"));
    }
    Ok(())
}

fn print_row(answers: &[Answer], method: &str, name: &str, levels: &[String], thesis: Option<thesis::Figures>) {
    let Some(s) = Summary::of(&protocol::errors(answers, method, levels), f64::INFINITY) else { return };
    let own: Vec<&Answer> = protocol::of(answers, method, levels).collect();
    let percent = |hits: usize, n: usize| {
        statistics::share(hits, n).map_or_else(|| "-".to_owned(), |share| format!("{:.0}%", 100.0 * share.value))
    };
    let ok: Vec<&&Answer> = own.iter().filter(|answer| answer.is_ok()).collect();
    // Attained coverage among the answers called ok that state an uncertainty.
    let coverage = |k: f64| {
        let stated: Vec<bool> = ok.iter().filter_map(|answer| answer.covers(k)).collect();
        percent(stated.iter().filter(|&&inside| inside).count(), stated.len())
    };
    println!(
        "{method:24} {name:7} {:5} {:7.3} {:7.3} {:7.3} {:7.3} {:7.3} {:7.2} {:>6} {:>5} {:>7} {:>5} {:>5}",
        s.n,
        s.mean,
        s.min,
        s.q1,
        s.median,
        s.q3,
        s.max,
        percent(own.iter().filter(|answer| answer.is_gross()).count(), own.len()),
        percent(ok.len(), own.len()),
        thesis.map_or_else(|| "-".to_owned(), |figures| format!("{:.2}", figures.mean)),
        coverage(1.0),
        coverage(2.0),
    );
}

/// What a frame of `real_phone` was measured to be, beside its truth.
struct Frame {
    scene: String,
    off_deg: f64,
    off_percent: f64,
    ok: bool,
}

fn print_real(folder: &Path, method: &Method) -> Result<(), Box<dyn Error>> {
    println!("\nreal pictures by {}", method.name());
    println!("{:32} {:>16} {:>9} {:>16} {:>9}  status", "picture", "deg", "truth", "px", "truth");
    let mut estimator = method.build(&Settings::default());
    let mut show = |path: &Path, deg: &str, px: &str| -> Result<MotionBlur, Box<dyn Error>> {
        let picture = picture::read(path, Linearize::Auto)?;
        let found = estimator.estimate(picture.luma.view())?;
        let reason = found.status.doubt().map_or_else(String::new, |doubt| format!(": {doubt}"));
        println!(
            "{:32} {:>16} {deg:>9} {:>16} {px:>9}  {}{reason}",
            file_name(path),
            with_std(found.angle.deg(), found.angle_std_deg),
            with_std(found.length_px, found.length_std_px),
            found.status.name()
        );
        Ok(found)
    };
    for (name, deg, px) in [
        ("text_motion.jpg", "94", "31"),
        ("clock_motion.png", "0-3", "35-37"),
        ("text_defocus.jpg", "-", "-"),
        ("mbm_Car_T_E_Selectin_Frame_1.png", "0", "-"),
    ] {
        show(&folder.join("real_photos").join(name), deg, px)?;
    }
    let mut frames = Vec::new();
    for frame in data::phone_frames(folder)? {
        let found = show(&frame.path, &format!("{:.1}", frame.angle_deg), &format!("{:.1}", frame.length_px))?;
        let name = file_name(&frame.path);
        frames.push(Frame {
            scene: name.split_once('_').map_or(name.as_str(), |(scene, _)| scene).to_owned(),
            off_deg: found.angle.distance_deg(AxialAngle::from_deg(frame.angle_deg)),
            off_percent: 100.0 * (found.length_px / frame.length_px - 1.0).abs(),
            ok: found.status == Status::Ok,
        });
    }
    print_phone(&frames);
    Ok(())
}

fn file_name(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

fn with_std(value: f64, std: Option<f64>) -> String {
    std.map_or_else(|| format!("{value:.2}"), |std| format!("{value:.2} ± {std:.2}"))
}

/// Medians of the frames of `real_phone`, scene by scene and together.
fn print_phone(frames: &[Frame]) {
    println!("\nreal_phone: median errors; wrong ones are off by {PHONE_GROSS_DEG} deg or {PHONE_GROSS_PERCENT} %");
    println!(
        "{:12} {:>4} {:>8} {:>8} {:>6} {:>4} {:>8} {:>8} {:>9}",
        "scene", "n", "deg", "%", "wrong", "ok", "deg, ok", "%, ok", "wrong ok"
    );
    let mut scenes: Vec<&str> = frames.iter().map(|frame| frame.scene.as_str()).collect();
    scenes.sort_unstable();
    scenes.dedup();
    for scene in scenes {
        print_scene(scene, &frames.iter().filter(|frame| frame.scene == scene).collect::<Vec<_>>());
    }
    print_scene("all", &frames.iter().collect::<Vec<_>>());
}

fn print_scene(scene: &str, frames: &[&Frame]) {
    let ok: Vec<&Frame> = frames.iter().copied().filter(|frame| frame.ok).collect();
    let median = |frames: &[&Frame], error: fn(&Frame) -> f64| {
        let errors: Vec<f64> = frames.iter().map(|frame| error(frame)).collect();
        Summary::of(&errors, f64::INFINITY).map_or_else(|| "-".to_owned(), |s| format!("{:.1}", s.median))
    };
    let wrong = |frames: &[&Frame]| {
        frames.iter().filter(|f| !(f.off_deg <= PHONE_GROSS_DEG && f.off_percent <= PHONE_GROSS_PERCENT)).count()
    };
    println!(
        "{scene:12} {:4} {:>8} {:>8} {:6} {:4} {:>8} {:>8} {:9}",
        frames.len(),
        median(frames, |f| f.off_deg),
        median(frames, |f| f.off_percent),
        wrong(frames),
        ok.len(),
        median(&ok, |f| f.off_deg),
        median(&ok, |f| f.off_percent),
        wrong(&ok)
    );
}
