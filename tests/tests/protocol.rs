//! The two methods of the thesis on its own protocol, against the means that it publishes, and on real photographs.
//!
//! The pictures are not part of the project; without them these tests say that they skipped.
//! With them they take three minutes of one processor.
#![allow(clippy::unwrap_used, reason = "a picture that cannot be read or measured fails the test")]

use std::path::Path;
use std::sync::LazyLock;

use blur_cli::picture::{self, Linearize};
use blur_cli::reproduce::answer::{Answer, Measure};
use blur_cli::reproduce::candidates::{Candidate, candidates};
use blur_cli::reproduce::protocol::{self, Protocol};
use blur_cli::reproduce::shots::LEVELS;
use blur_core::estimate::registry::{ANGLE, LENGTH};
use blur_core::estimate::{AxialAngle, JointEstimator, MotionBlur, Pair, Settings, Status};
use e2e_tests::data::{self, Sharp};

const CLEAN: [&str; 1] = ["clean"];
const NOISY: [&str; 3] = ["36 dB", "28 dB", "20 dB"];

/// The methods of the thesis that the project improves upon, and the default ones.
const ANGLE_METHODS: [&str; 2] = ["dct-radon", "dft-radon"];
const LENGTH_METHODS: [&str; 1] = ["dct-pseudo-cepstrum"];

const SEED: u64 = 20_180_101;

fn methods(measure: Measure, names: &[&str]) -> Vec<Candidate> {
    names.iter().flat_map(|name| candidates(measure, Some(name)).unwrap()).collect()
}

/// All pictures; `None` where there is no data.
fn pictures() -> Option<Vec<Sharp>> {
    Some(data::sharp_pictures(&data::folder()?).unwrap())
}

/// Every angle of every picture, measured once for all tests: all directions in steps of 7 degrees, at 55 px.
static ANGLES: LazyLock<Option<Vec<Answer>>> = LazyLock::new(|| {
    let pictures = pictures()?;
    let protocol = Protocol::angles((0..=179).step_by(7).map(f64::from), 55.0).unwrap();
    let protocol = Protocol { seed: SEED, ..protocol };
    let answers = protocol.run(&pictures, &methods(Measure::Angle, &ANGLE_METHODS)).unwrap().answers;
    assert_eq!(answers.len(), 2 * LEVELS.len() * protocol.motions.len() * pictures.len());
    Some(answers)
});

/// Every length of every picture: 5 to 95 px in steps of 5, at 0 degrees.
static LENGTHS: LazyLock<Option<Vec<Answer>>> = LazyLock::new(|| {
    let pictures = pictures()?;
    let protocol = Protocol::lengths((5..=95).step_by(5).map(f64::from), 0.0).unwrap();
    // Noise of its own: the seeds of the angles end far below.
    let protocol = Protocol { seed: SEED + 1000 * 1009, ..protocol };
    let answers = protocol.run(&pictures, &methods(Measure::Length, &LENGTH_METHODS)).unwrap().answers;
    assert_eq!(answers.len(), LEVELS.len() * protocol.motions.len() * pictures.len());
    Some(answers)
});

fn mean_error(answers: &[Answer], method: &str, levels: &[&str]) -> f64 {
    let errors = protocol::errors(answers, method, levels);
    errors.iter().sum::<f64>() / errors.len() as f64
}

/// Share of the answers called `ok` whose error is within two of their standard uncertainties.
fn coverage(answers: &[Answer], method: &str, level: &str) -> f64 {
    let levels = [level];
    let ok = protocol::of(answers, method, &levels).filter(|answer| answer.is_ok());
    let stated: Vec<bool> = ok.map(|answer| answer.covers(2.0).unwrap()).collect();
    stated.iter().filter(|&&inside| inside).count() as f64 / stated.len() as f64
}

#[test]
fn the_levels_are_clean_36_28_and_20_db() {
    assert_eq!(LEVELS, [None, Some(36.0), Some(28.0), Some(20.0)]);
}

#[test]
fn dct_radon_is_at_least_as_good_as_the_thesis_says() {
    let Some(outcomes) = &*ANGLES else { return };
    let (clean, noisy) = (mean_error(outcomes, "dct-radon", &CLEAN), mean_error(outcomes, "dct-radon", &NOISY));
    println!("dct-radon: clean {clean:.3} deg, noisy {noisy:.3} deg");
    // Thesis tables 4.1 and 4.2.
    assert!(clean <= 0.66, "{clean}");
    assert!(noisy <= 1.70, "{noisy}");
}

#[test]
fn dct_pseudo_cepstrum_is_at_least_as_good_as_the_thesis_says() {
    let Some(outcomes) = &*LENGTHS else { return };
    let method = "dct-pseudo-cepstrum";
    let (clean, noisy) = (mean_error(outcomes, method, &CLEAN), mean_error(outcomes, method, &NOISY));
    println!("{method}: clean {clean:.3} px, noisy {noisy:.3} px");
    // Thesis tables 4.4 and 4.5.
    assert!(clean <= 0.99, "{clean}");
    assert!(noisy <= 7.78, "{noisy}");
}

#[test]
fn two_standard_uncertainties_of_the_default_methods_cover_nine_of_ten_errors_down_to_28_db() {
    let (Some(angles), Some(lengths)) = (&*ANGLES, &*LENGTHS) else { return };
    // A normal error would be covered in 95 of 100 cases. At 20 dB the intervals are too short, as the docs say.
    for level in ["clean", "36 dB", "28 dB"] {
        let (angle, length) = (coverage(angles, "dft-radon", level), coverage(lengths, "dct-pseudo-cepstrum", level));
        println!("level {level}: angle {angle:.3}, length {length:.3}");
        assert!(angle >= 0.90 && length >= 0.90, "level {level}: angle {angle}, length {length}");
    }
}

/// The default methods on a real photograph.
fn photograph(folder: &Path, name: &str) -> MotionBlur {
    let picture = picture::read(&folder.join("real_photos").join(name), Linearize::Auto).unwrap();
    let settings = Settings::default();
    let mut pair = Pair::new(ANGLE[0].build(&settings), LENGTH[0].build(&settings));
    let found = pair.estimate(picture.luma.view()).unwrap();
    println!("{name}: {found:?}");
    found
}

#[test]
fn moved_text_is_measured_as_a_person_measures_it() {
    let Some(folder) = data::folder() else { return };
    // OpenCV's sample sets 86 degrees (y down) and 31 pixels by hand.
    let found = photograph(&folder, "text_motion.jpg");
    assert!(found.angle.distance_deg(AxialAngle::from_deg(94.0)) < 2.0, "{found:?}");
    assert!((found.length_px - 31.0).abs() < 2.0, "{found:?}");
}

#[test]
fn the_direction_of_a_moved_clock_is_horizontal() {
    let Some(folder) = data::folder() else { return };
    // The axes of the ellipse that the round face became lie at 0 to 3 degrees.
    let found = photograph(&folder, "clock_motion.png");
    assert!(found.angle.distance_deg(AxialAngle::from_deg(1.5)) < 1.5 + 5.0, "{found:?}");
}

#[test]
fn text_out_of_focus_is_not_called_moved() {
    let Some(folder) = data::folder() else { return };
    let found = photograph(&folder, "text_defocus.jpg");
    assert_ne!(found.status, Status::Ok, "{found:?}");
}
