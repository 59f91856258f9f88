//! Prints the accuracy tables of all registered methods: synthetic pictures beside the thesis's means, and the real
//! pictures beside their truth.

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

use blur_cli::method::Method;
use blur_cli::picture::{self, Linearize};
use blur_cli::reproduce::shots;
use blur_cli::reproduce::statistics::Summary;
use blur_core::estimate::{AxialAngle, MotionBlur, Settings, Status};
use clap::Parser;
use e2e_tests::data;
use e2e_tests::protocol::{self, LEVELS, Outcome, Plan};

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

/// Errors above these are gross: degrees, pixels.
const GROSS_DEG: f64 = 5.0;
const GROSS_PX: f64 = 5.0;
/// Errors above these are wrong in frames of a phone: degrees, percent of the length.
const PHONE_GROSS_DEG: f64 = 8.0;
const PHONE_GROSS_PERCENT: f64 = 25.0;
/// Means of the thesis's tables 4.1, 4.2, 4.4, 4.5: clean, noisy.
const THESIS_ANGLE: &[(&str, f64, f64)] = &[
    ("dft-radon", 1.00, 17.52),
    ("dft-cepstrum", 1.55, 10.01),
    ("dft-gabor", 0.90, 19.87),
    ("dft-hough", 1.08, 21.75),
    ("dct-radon", 0.66, 1.70),
];
const THESIS_LENGTH: &[(&str, f64, f64)] = &[
    ("autocorrelation", 26.78, 45.78),
    ("dft-cepstrum", 8.04, 39.75),
    ("dft-radon", 11.53, 18.21),
    ("dct-pseudo-cepstrum", 0.99, 7.78),
];

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
    let joint = arguments.joint.as_deref().map_or_else(Method::recommended, Method::named)?;
    let folder = data::folder().ok_or("the tables need the pictures of the data folder")?;
    let mut plan = Plan::full();
    if !arguments.method.is_empty() {
        plan.angle_methods.retain(|method| arguments.method.iter().any(|name| name == method.name));
        plan.length_methods.retain(|method| arguments.method.iter().any(|name| name == method.name));
    }
    plan.angle_length_px = arguments.angle_length;
    plan.length_angle_deg = arguments.length_angle;
    let step = arguments.step.max(1);
    plan.angles_deg = plan.angles_deg.into_iter().step_by(step).collect();
    plan.lengths_px = plan.lengths_px.into_iter().step_by(step).collect();

    if !arguments.real_only {
        let pictures = data::sharp_pictures(&folder)?;
        println!("{} pictures; angles {:?} deg at {} px", pictures.len(), plan.angles_deg, plan.angle_length_px);
        let angles = protocol::run_angles(&plan, &pictures)?;
        let names: Vec<_> = plan.angle_methods.iter().map(|method| method.name).collect();
        print_table("angle, deg", &angles, &names, GROSS_DEG, THESIS_ANGLE);
        println!("\nlengths {:?} px at {} deg", plan.lengths_px, plan.length_angle_deg);
        let lengths = protocol::run_lengths(&plan, &pictures)?;
        let names: Vec<_> = plan.length_methods.iter().map(|method| method.name).collect();
        print_table("length, px", &lengths, &names, GROSS_PX, THESIS_LENGTH);
        if arguments.gross {
            for outcome in angles.iter().filter(|o| o.error.abs() > GROSS_DEG) {
                print_gross(outcome, "deg");
            }
            for outcome in lengths.iter().filter(|o| o.error.abs() > GROSS_PX) {
                print_gross(outcome, "px");
            }
        }
    }
    print_real(&folder, &joint)
}

fn level_name(level: usize) -> String {
    shots::level_name(LEVELS[level])
}

fn print_gross(outcome: &Outcome, unit: &str) {
    let Outcome { method, level, picture, truth, error, ok, .. } = outcome;
    println!(
        "gross: {method:20} {:6} {picture:24} truth {truth:6.1} error {error:+7.1} {unit} ok {ok}",
        level_name(*level)
    );
}

fn print_table(title: &str, outcomes: &[Outcome], names: &[&str], gross: f64, thesis: &[(&str, f64, f64)]) {
    println!(
        "\n{title:20} {:7} {:>5} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>6} {:>5} {:>7} {:>5} {:>5}",
        "level", "n", "mean", "min", "q1", "median", "q3", "max", "gross", "ok", "thesis", "k=1", "k=2"
    );
    for name in names {
        let mean_of = |index: fn(&(&str, f64, f64)) -> f64| thesis.iter().find(|row| row.0 == *name).map(index);
        let noisy: Vec<usize> = (1..LEVELS.len()).collect();
        let mut rows: Vec<(String, Vec<usize>, Option<f64>)> =
            (0..LEVELS.len()).map(|level| (level_name(level), vec![level], None)).collect();
        rows[0].2 = mean_of(|row| row.1);
        rows.push(("noisy".to_owned(), noisy, mean_of(|row| row.2)));
        for (label, levels, thesis_mean) in rows {
            let errors = protocol::errors(outcomes, name, &levels);
            let Some(s) = Summary::of(&errors, gross) else { continue };
            let of_level = || outcomes.iter().filter(|o| o.method == *name && levels.contains(&o.level));
            let ok = of_level().filter(|o| o.ok).count() as f64 / s.n as f64;
            // Attained coverage among the answers called ok that state an uncertainty.
            let coverage = |k: f64| {
                let stated: Vec<_> =
                    of_level().filter(|o| o.ok).filter_map(|o| o.std.map(|std| (o.error, std))).collect();
                if stated.is_empty() {
                    return "-".to_owned();
                }
                let inside = stated.iter().filter(|(error, std)| error.abs() <= k * std).count();
                format!("{:.0}%", 100.0 * inside as f64 / stated.len() as f64)
            };
            println!(
                "{name:20} {label:7} {:5} {:7.3} {:7.3} {:7.3} {:7.3} {:7.3} {:7.2} {:5.1}% {:4.0}% {:>7} {:>5} {:>5}",
                s.n,
                s.mean,
                s.min,
                s.q1,
                s.median,
                s.q3,
                s.max,
                100.0 * s.gross,
                100.0 * ok,
                thesis_mean.map_or_else(|| "-".to_owned(), |mean| format!("{mean:.2}")),
                coverage(1.0),
                coverage(2.0),
            );
        }
    }
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
