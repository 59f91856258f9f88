//! What the default method may be trusted with: errors, uncertainties and refusals on pictures of known truth.
#![allow(clippy::unwrap_used, reason = "a picture that cannot be read or measured fails the test")]

use std::sync::LazyLock;

use blur_cli::method::Method;
use blur_cli::picture::{self, Linearize};
use blur_cli::reproduce::outcome::Outcome;
use blur_cli::reproduce::{Plan, Table};
use blur_core::estimate::{AxialAngle, MotionBlur, Settings, Status};
use e2e_tests::data;

fn outcomes(table: &str) -> Option<Vec<Outcome>> {
    let plan = Plan {
        images: data::folder()?,
        method: Method::recommended(),
        only: None,
        per_level: 216,
        fields: 30,
        step: 1,
        // Not the seed of the published tables.
        seed: 2,
    };
    Some(Table::named(table).unwrap().make(&plan).unwrap().outcomes)
}

/// Photographs blurred at any angle by 6 to 90 px, measured once for all tests.
static BLURRED: LazyLock<Option<Vec<Outcome>>> = LazyLock::new(|| outcomes("coverage"));

fn of_level<'a>(outcomes: &'a [Outcome], level: &str) -> Vec<&'a Outcome> {
    outcomes.iter().filter(|outcome| outcome.level == level).collect()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn share(part: usize, whole: usize) -> f64 {
    part as f64 / whole as f64
}

#[test]
fn answers_called_ok_are_right() {
    let Some(outcomes) = &*BLURRED else { return };
    // Level, then median errors in degrees and pixels, gross errors among the answers called ok, answers called ok.
    for (level, deg, px, gross, ok) in [
        ("clean", 0.02, 0.02, 0.005, 0.98),
        ("36 dB", 0.075, 0.08, 0.01, 0.96),
        ("28 dB", 0.17, 0.22, 0.02, 0.94),
        ("20 dB", 0.35, 0.45, 0.03, 0.80),
    ] {
        let all = of_level(outcomes, level);
        assert_eq!(all.len(), 216);
        let trusted: Vec<_> = all.iter().filter(|outcome| outcome.is_ok()).collect();
        let angle = median(trusted.iter().map(|outcome| outcome.angle_error_deg.unwrap().abs()).collect());
        let length = median(trusted.iter().map(|outcome| outcome.length_error_px.unwrap().abs()).collect());
        let wrong = share(trusted.iter().filter(|outcome| outcome.is_gross()).count(), trusted.len());
        let called = share(trusted.len(), all.len());
        println!("{level}: median {angle:.4} deg {length:.4} px, gross {wrong:.4}, ok {called:.3}");
        // A share of 216 pictures scatters by 2 or 3 %, a median by a tenth.
        assert!(angle <= deg && length <= px, "{level}: {angle} deg, {length} px");
        assert!(wrong <= gross, "{level}: {wrong} of the answers called ok are grossly wrong");
        assert!(called >= ok - 0.03, "{level}: {called} called ok");
    }
}

#[test]
fn two_standard_uncertainties_cover_nineteen_of_twenty_errors() {
    let Some(outcomes) = &*BLURRED else { return };
    for level in ["clean", "36 dB", "28 dB", "20 dB"] {
        let trusted: Vec<_> = of_level(outcomes, level).into_iter().filter(|outcome| outcome.is_ok()).collect();
        let covered = |error: fn(&Outcome) -> f64, std: fn(&Outcome) -> f64| {
            share(trusted.iter().filter(|outcome| error(outcome).abs() <= 2.0 * std(outcome)).count(), trusted.len())
        };
        let angle = covered(|o| o.angle_error_deg.unwrap(), |o| o.angle_std_deg.unwrap());
        let length = covered(|o| o.length_error_px.unwrap(), |o| o.length_std_px.unwrap());
        println!("{level}: k = 2 covers {angle:.3} of the angles, {length:.3} of the lengths");
        // The binomial scatter of 216 cases about 0.954 is 0.014.
        assert!((0.90..=0.995).contains(&angle) && (0.90..=0.995).contains(&length), "{level}: {angle}, {length}");
    }
}

#[test]
fn pictures_without_motion_are_never_called_ok() {
    let Some(outcomes) = outcomes("negatives") else { return };
    assert!(outcomes.len() >= 60);
    let wrong: Vec<_> = outcomes.iter().filter(|outcome| outcome.is_ok()).map(|outcome| &outcome.image).collect();
    assert!(wrong.is_empty(), "{wrong:?}");
}

fn photograph(path: &std::path::Path) -> MotionBlur {
    let picture = picture::read(path, Linearize::Auto).unwrap();
    let mut estimator = Method::recommended().build(&Settings::default());
    estimator.estimate(picture.luma.view()).unwrap()
}

#[test]
fn real_photographs_are_measured_as_a_person_measures_them() {
    let Some(folder) = data::folder() else { return };
    // OpenCV's sample sets 86 degrees (y down) and 31 pixels by hand.
    let text = photograph(&folder.join("real_photos/text_motion.jpg"));
    assert!(text.status == Status::Ok && text.angle.distance_deg(AxialAngle::from_deg(94.0)) < 1.0, "{text:?}");
    assert!((text.length_px - 31.0).abs() < 1.0, "{text:?}");
    // The round face of the clock became longer by its width minus its height, at 0 to 3 degrees.
    let clock = photograph(&folder.join("real_photos/clock_motion.png"));
    assert!(clock.status == Status::Ok && (0.5..=3.0).contains(&clock.angle.deg()), "{clock:?}");
    assert!((35.0..=37.0).contains(&clock.length_px), "{clock:?}");
    let defocus = photograph(&folder.join("real_photos/text_defocus.jpg"));
    assert_ne!(defocus.status, Status::Ok, "{defocus:?}");
}

#[test]
fn frames_of_a_hand_held_phone_agree_with_its_gyroscope() {
    let Some(folder) = data::folder() else { return };
    let frames = data::phone_frames(&folder).unwrap();
    let (mut degrees, mut percents) = (Vec::new(), Vec::new());
    for frame in &frames {
        let found = photograph(&frame.path);
        if found.status != Status::Ok {
            continue;
        }
        let angle = found.angle.distance_deg(AxialAngle::from_deg(frame.angle_deg));
        let length = 100.0 * (found.length_px / frame.length_px - 1.0).abs();
        assert!(angle <= 8.0 && length <= 25.0, "{:?} off by {angle} deg, {length} %", frame.path);
        degrees.push(angle);
        percents.push(length);
    }
    let ok = degrees.len();
    let (angle, length) = (median(degrees), median(percents));
    println!("{ok} of {} ok, median {angle:.2} deg, {length:.1} %", frames.len());
    // The gyroscope's own error is 1 degree and some percent.
    assert!(share(ok, frames.len()) >= 0.75 && angle <= 1.5 && length <= 4.5, "{ok}, {angle} deg, {length} %");
}
