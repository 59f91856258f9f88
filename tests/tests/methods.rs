//! Every registered method on dead leaves of known blur.
#![allow(clippy::unwrap_used, reason = "a picture that cannot be made or measured fails the test")]

use std::sync::LazyLock;

use blur_core::estimate::registry::{self, ANGLE, JOINT, LENGTH};
use blur_core::estimate::{AxialAngle, Doubt, JointEstimator, LengthRange, Pair, Settings, Status};
use blur_sim::expose::expose;
use blur_sim::motion::Motion;
use blur_sim::scene::{DeadLeaves, dead_leaves};
use blur_sim::sensor::{Sensor, f32_from_u8};
use ndarray::{Array2, ArrayView2, Axis};

/// Square, lying, standing, odd with a prime.
const SIZES: [(usize, usize); 4] = [(256, 256), (200, 300), (300, 200), (251, 241)];
/// All quadrants, both axes, both diagonals, the seam at 180.
const ANGLES_DEG: [f64; 11] = [0.0, 17.3, 30.0, 45.0, 68.6, 90.0, 112.4, 135.0, 151.9, 170.0, 179.7];
const LENGTHS_PX: [f64; 2] = [21.3, 34.8];

/// A picture and its truth.
struct Shot {
    image: Array2<f32>,
    deg: f64,
    length_px: f64,
}

/// Eight-bit picture of `dim` rows and columns, blurred exactly and cut to what the exposure covers.
fn shot(sensor: Sensor, seed: u64, (rows, columns): (usize, usize), deg: f64, length_px: f64) -> Shot {
    let motion = Motion::uniform(length_px, AxialAngle::from_deg(deg)).unwrap();
    let (lost_rows, lost_columns) = motion.extent_px();
    let scene = dead_leaves(seed, rows + lost_rows, columns + lost_columns, &DeadLeaves::default()).unwrap();
    let exposure = expose(scene.view(), &motion).unwrap();
    let image = f32_from_u8(sensor.record(exposure.view(), seed).unwrap().view());
    assert_eq!(image.dim(), (rows, columns));
    Shot { image, deg, length_px }
}

/// Every size at every angle and length, each of another scene, without noise.
static SHOTS: LazyLock<Vec<Shot>> = LazyLock::new(|| {
    let mut shots = Vec::new();
    for dim in SIZES {
        for deg in ANGLES_DEG {
            for length_px in LENGTHS_PX {
                shots.push(shot(Sensor::ideal(), 1 + shots.len() as u64, dim, deg, length_px));
            }
        }
    }
    shots
});

/// Measures the direction of every shot and fails with the list of those that miss by more than `most_deg(length)`.
fn assert_directions(method: &str, most_deg: impl Fn(f64) -> f64) {
    let mut estimator = registry::angle(method).unwrap().build(&Settings::default());
    let mut misses = Vec::new();
    for Shot { image, deg, length_px } in SHOTS.iter() {
        let found = estimator.estimate(image.view()).unwrap();
        let miss = found.angle.minus_deg(AxialAngle::from_deg(*deg));
        if miss.abs() > most_deg(*length_px) {
            misses.push(format!("{:?} {deg} deg {length_px} px: {miss:+.2} deg {:?}", image.dim(), found.status));
        }
    }
    assert!(misses.is_empty(), "{method} misses by too much:\n{}", misses.join("\n"));
}

/// As [`assert_directions`] for the length along the true direction; the bound is `most_px(length)`.
fn assert_lengths(method: &str, most_px: impl Fn(f64) -> f64) {
    let mut estimator = registry::length(method).unwrap().build(&Settings::default());
    let mut misses = Vec::new();
    for Shot { image, deg, length_px } in SHOTS.iter() {
        let found = estimator.estimate(image.view(), AxialAngle::from_deg(*deg)).unwrap();
        let miss = found.length_px - length_px;
        if miss.abs() > most_px(*length_px) {
            misses.push(format!("{:?} {deg} deg {length_px} px: {miss:+.2} px {:?}", image.dim(), found.status));
        }
    }
    assert!(misses.is_empty(), "{method} misses:\n{}", misses.join("\n"));
}

/// As [`assert_directions`] for a joint method: the bounds are `most_deg(length)` and `most_px(length)`.
fn assert_blurs(method: &str, most_deg: impl Fn(f64) -> f64, most_px: impl Fn(f64) -> f64) {
    let mut estimator = registry::joint(method).unwrap().build(&Settings::default());
    let mut misses = Vec::new();
    for Shot { image, deg, length_px } in SHOTS.iter() {
        let found = estimator.estimate(image.view()).unwrap();
        let off_deg = found.angle.minus_deg(AxialAngle::from_deg(*deg));
        let off_px = found.length_px - length_px;
        if off_deg.abs() > most_deg(*length_px) || off_px.abs() > most_px(*length_px) {
            misses.push(format!(
                "{:?} {deg} deg {length_px} px: {off_deg:+.2} deg {off_px:+.2} px {:?}",
                image.dim(),
                found.status
            ));
        }
    }
    assert!(misses.is_empty(), "{method} misses:\n{}", misses.join("\n"));
}

// A direction wrong by 1 degree moves the end of the longer blur by 0.6 pixels: clean pictures allow no more. The
// methods that place a peak between directions or lags reach a third of that.

#[test]
fn dft_radon_finds_every_direction() {
    assert_directions("dft-radon", |_| 0.33);
}

#[test]
fn dft_cepstrum_finds_every_direction() {
    // A parabola places the trough to a quarter of a pixel on the grid of lags, seen from the origin.
    assert_directions("dft-cepstrum", |length_px| (0.25 / length_px).to_degrees());
}

#[test]
fn dft_gabor_finds_every_direction() {
    assert_directions("dft-gabor", |_| 1.0);
}

#[test]
fn dft_hough_finds_every_direction() {
    assert_directions("dft-hough", |_| 1.0);
}

#[test]
fn dct_radon_finds_every_direction() {
    // The quadrant of a DCT holds the mirror image too; near the axes the two ridges overlap.
    assert_directions("dct-radon", |_| 2.0);
}

#[test]
fn dct_hough_finds_every_direction() {
    // As dct-radon.
    assert_directions("dct-hough", |_| 2.0);
}

#[test]
fn the_cepstra_find_every_length() {
    // One lag of the quarter-pixel grid that both are read from.
    assert_lengths("dct-pseudo-cepstrum", |_| 0.25);
    assert_lengths("dft-cepstrum", |_| 0.25);
}

#[test]
fn autocorrelation_finds_every_length_of_clean_pictures() {
    // Half a lag of its grid of whole pixels.
    assert_lengths("autocorrelation", |_| 0.5);
}

#[test]
fn dft_radon_finds_every_length() {
    // Half the distance of two lengths of its bank, whose ratio is 1.08.
    assert_lengths("dft-radon", |length_px| 0.04 * length_px);
}

#[test]
fn whittle_finds_every_blur() {
    // 0.1 degrees move the end of the longer blur by 0.06 pixels.
    assert_blurs("whittle", |_| 0.1, |_| 0.1);
    assert_lengths("whittle", |_| 0.1);
}

#[test]
fn whittle_finds_lengths_to_a_twentieth_of_a_pixel_and_says_how_well() {
    let mut estimator = registry::joint("whittle").unwrap().build(&Settings::default());
    let (mut misses, mut pulls_deg, mut pulls_px) = (Vec::new(), 0.0, 0.0);
    for Shot { image, deg, length_px } in SHOTS.iter() {
        let found = estimator.estimate(image.view()).unwrap();
        assert_eq!(found.status, Status::Ok, "{:?} {deg} deg {length_px} px", image.dim());
        let off_px = found.length_px - length_px;
        let off_deg = found.angle.minus_deg(AxialAngle::from_deg(*deg));
        if off_px.abs() > 0.05 {
            misses.push(format!("{:?} {deg} deg {length_px} px: {off_px:+.3} px", image.dim()));
        }
        pulls_px += (off_px / found.length_std_px.unwrap()).powi(2);
        pulls_deg += (off_deg / found.angle_std_deg.unwrap()).powi(2);
    }
    // Rounding to 8 bits alone leaves the longer blur uncertain by up to some 0.03 px here: one picture in twenty may
    // miss.
    assert!(20 * misses.len() <= SHOTS.len(), "{}", misses.join("\n"));
    // The mean of n squared normal errors scatters by sqrt(2 / n): four of these above 1, and not below a quarter,
    // which would be intervals of twice the width that is needed.
    let n = SHOTS.len() as f64;
    for mean in [pulls_px / n, pulls_deg / n] {
        assert!((0.25..1.0 + 4.0 * (2.0 / n).sqrt()).contains(&mean), "{mean}");
    }
}

#[test]
fn phase_autocorrelation_finds_every_blur() {
    // A paraboloid places the peak to a quarter of a pixel on the grid of lags, along and across.
    assert_blurs("phase-autocorrelation", |length_px| (0.25 / length_px).to_degrees(), |_| 0.25);
}

#[test]
fn every_method_has_a_bound_here() {
    // A new method must be added above.
    let angles: Vec<_> = ANGLE.iter().map(|method| method.name).collect();
    assert_eq!(angles, ["dft-radon", "dct-radon", "dct-hough", "dft-hough", "dft-cepstrum", "dft-gabor"]);
    let lengths: Vec<_> = LENGTH.iter().map(|method| method.name).collect();
    assert_eq!(lengths, ["dct-pseudo-cepstrum", "autocorrelation", "dft-cepstrum", "dft-radon", "whittle"]);
    let joint: Vec<_> = JOINT.iter().map(|method| method.name).collect();
    assert_eq!(joint, ["whittle", "phase-autocorrelation"]);
}

/// The picture in a mirror that exchanges left and right: a motion at `angle` is then one at `180 - angle`.
fn mirrored(image: &Array2<f32>) -> ArrayView2<'_, f32> {
    let mut view = image.view();
    view.invert_axis(Axis(1));
    view
}

/// The picture turned counter-clockwise by 90 degrees.
fn turned(image: &Array2<f32>) -> ArrayView2<'_, f32> {
    let mut view = image.t();
    view.invert_axis(Axis(0));
    view
}

/// Half a step of the coarsest grid of directions, that of the Hough votes.
const SYMMETRY_DEG: f64 = 0.5;

#[test]
fn the_turned_picture_is_turned_counter_clockwise() {
    // The top right corner goes to the top left.
    let picture = Array2::from_shape_fn((3, 4), |(r, c)| (10 * r + c) as f32);
    assert_eq!(turned(&picture)[[0, 0]], 3.0);
    assert_eq!(turned(&picture).dim(), (4, 3));
}

#[test]
fn a_mirror_turns_the_direction_into_its_complement_to_180() {
    for method in ANGLE {
        let mut estimator = method.build(&Settings::default());
        for Shot { image, deg, .. } in SHOTS.iter() {
            let here = estimator.estimate(image.view()).unwrap().angle;
            let there = estimator.estimate(mirrored(image)).unwrap().angle;
            let expected = AxialAngle::from_deg(180.0 - here.deg());
            let miss = there.distance_deg(expected);
            assert!(miss < SYMMETRY_DEG, "{} {deg} {:?}: {here:?} {there:?}", method.name, image.dim());
        }
    }
}

#[test]
fn a_mirror_keeps_the_length() {
    for method in LENGTH {
        let mut estimator = method.build(&Settings::default());
        for Shot { image, deg, .. } in SHOTS.iter() {
            let here = estimator.estimate(image.view(), AxialAngle::from_deg(*deg)).unwrap().length_px;
            let there = estimator.estimate(mirrored(image), AxialAngle::from_deg(180.0 - deg)).unwrap().length_px;
            // Half a lag of the autocorrelation; at 45 degrees the mirror image is turned onto another canvas.
            assert!((here - there).abs() < 0.5, "{} {deg} {:?}: {here} {there}", method.name, image.dim());
        }
    }
}

#[test]
fn directions_turn_with_the_picture() {
    for method in ANGLE {
        let mut estimator = method.build(&Settings::default());
        for Shot { image, deg, .. } in SHOTS.iter() {
            let here = estimator.estimate(image.view()).unwrap().angle;
            let there = estimator.estimate(turned(image)).unwrap().angle;
            let miss = there.distance_deg(AxialAngle::from_deg(here.deg() + 90.0));
            assert!(miss < SYMMETRY_DEG, "{} {deg} {:?}: {here:?} {there:?}", method.name, image.dim());
        }
    }
}

#[test]
fn lengths_stay_when_the_picture_turns() {
    for method in LENGTH {
        let mut estimator = method.build(&Settings::default());
        for Shot { image, deg, .. } in SHOTS.iter() {
            let here = estimator.estimate(image.view(), AxialAngle::from_deg(*deg)).unwrap().length_px;
            let there = estimator.estimate(turned(image), AxialAngle::from_deg(deg + 90.0)).unwrap().length_px;
            assert!((here - there).abs() < 0.1, "{} {deg} {:?}: {here} {there}", method.name, image.dim());
        }
    }
}

#[test]
fn phase_autocorrelation_calls_wrong_answers_doubtful() {
    let mut estimator = registry::joint("phase-autocorrelation").unwrap().build(&Settings::default());
    let mut doubtful = 0;
    for (seed, psnr_db) in (600..).zip([36.0, 28.0, 20.0, 5.0]) {
        for deg in ANGLES_DEG {
            let sensor = Sensor::ideal().with_psnr_db(psnr_db).unwrap();
            let Shot { image, .. } = shot(sensor, seed, (256, 256), deg, 25.0);
            let found = estimator.estimate(image.view()).unwrap();
            let right =
                found.angle.distance_deg(AxialAngle::from_deg(deg)) < 2.0 && (found.length_px - 25.0).abs() < 1.0;
            assert!(right || found.status != Status::Ok, "{psnr_db} dB {deg}: {found:?}");
            doubtful += u32::from(found.status != Status::Ok);
        }
    }
    // Nobody measures anything at 5 dB.
    assert!(doubtful >= 11, "{doubtful}");
}

#[test]
fn phase_autocorrelation_refuses_the_ends_of_its_range() {
    let Shot { image, .. } = shot(Sensor::ideal(), 610, (256, 256), 0.0, 35.0);
    let measured = |min_px: f64, max_px: f64| {
        let mut settings = Settings::default();
        settings.length_range = Some(LengthRange::new(min_px, max_px).unwrap());
        registry::joint("phase-autocorrelation").unwrap().build(&settings).estimate(image.view()).unwrap()
    };
    for (min_px, max_px) in [(10.0, 35.2), (34.8, 100.0)] {
        let found = measured(min_px, max_px);
        assert!(matches!(found.status.doubt(), Some(Doubt::LengthAtRangeEnd { .. })), "{found:?}");
    }
    assert_eq!(measured(10.0, 100.0).status, Status::Ok);
    // The true length outside: the other lags are no blur.
    assert_ne!(measured(10.0, 25.0).status, Status::Ok);
    assert_ne!(measured(50.0, 100.0).status, Status::Ok);
    // No lag of half the picture or more.
    assert_eq!(measured(200.0, 300.0).status, Status::NoMotionBlur(Doubt::NoPattern));
}

#[test]
fn joint_methods_turn_and_mirror_with_the_picture() {
    for method in JOINT {
        let mut estimator = method.build(&Settings::default());
        for Shot { image, deg, .. } in SHOTS.iter() {
            let here = estimator.estimate(image.view()).unwrap();
            let name = format!("{} {deg} {:?}", method.name, image.dim());
            for (view, expected_deg) in
                [(mirrored(image), 180.0 - here.angle.deg()), (turned(image), here.angle.deg() + 90.0)]
            {
                let there = estimator.estimate(view).unwrap();
                let miss = there.angle.distance_deg(AxialAngle::from_deg(expected_deg));
                assert!(miss < SYMMETRY_DEG, "{name}: {here:?} {there:?}");
                assert!((here.length_px - there.length_px).abs() < 0.1, "{name}: {here:?} {there:?}");
            }
        }
    }
}

#[test]
fn a_pair_finds_direction_and_length() {
    let settings = Settings::default();
    for angle in ANGLE {
        for length in LENGTH {
            let mut pair = Pair::new(angle.build(&settings), length.build(&settings));
            // 7 and the numbers of sizes, angles and lengths have no common factor: every one of each is met.
            for Shot { image, deg, length_px } in SHOTS.iter().step_by(7) {
                let found = pair.estimate(image.view()).unwrap();
                let names = format!("{} + {} {:?} {deg} {length_px}", angle.name, length.name, image.dim());
                assert!(found.angle.distance_deg(AxialAngle::from_deg(*deg)) < 2.0, "{names}: {found:?}");
                // 4 % is the step of the coarsest method, see above.
                assert!((found.length_px - length_px).abs() < 0.04 * length_px, "{names}: {found:?}");
            }
        }
    }
}

#[test]
fn a_pair_says_what_its_methods_say_one_after_the_other() {
    let settings = Settings::default();
    for Shot { image, .. } in SHOTS.iter().step_by(9) {
        let angle = ANGLE[0].build(&settings).estimate(image.view()).unwrap();
        let length = LENGTH[0].build(&settings).estimate(image.view(), angle.angle).unwrap();
        let found = Pair::new(ANGLE[0].build(&settings), LENGTH[0].build(&settings)).estimate(image.view()).unwrap();
        assert_eq!((found.angle, found.angle_std_deg), (angle.angle, angle.std_deg));
        assert_eq!((found.length_px, found.length_std_px), (length.length_px, length.std_px));
        assert_eq!(found.status, angle.status.worse(length.status));
    }
}

#[test]
fn noise_never_costs_more_than_the_answer() {
    // From fair to hopeless, 5 dB being noise of more than half of the grey scale.
    for (seed, psnr_db) in [(501, 36.0), (502, 20.0), (503, 5.0)] {
        for deg in [0.0, 63.0, 90.0, 121.0] {
            let sensor = Sensor::ideal().with_psnr_db(psnr_db).unwrap();
            let Shot { image, .. } = shot(sensor, seed, (201, 160), deg, 25.0);
            for method in ANGLE {
                let found = method.build(&Settings::default()).estimate(image.view()).unwrap();
                assert!((0.0..180.0).contains(&found.angle.deg()), "{} {psnr_db} dB: {found:?}", method.name);
            }
            for method in LENGTH {
                let mut estimator = method.build(&Settings::default());
                let found = estimator.estimate(image.view(), AxialAngle::from_deg(deg)).unwrap();
                // No longer than the picture's diagonal.
                assert!((2.0..257.0).contains(&found.length_px), "{} {psnr_db} dB: {found:?}", method.name);
            }
            for method in JOINT {
                let found = method.build(&Settings::default()).estimate(image.view()).unwrap();
                assert!((0.0..180.0).contains(&found.angle.deg()), "{} {psnr_db} dB: {found:?}", method.name);
                assert!((2.0..257.0).contains(&found.length_px), "{} {psnr_db} dB: {found:?}", method.name);
            }
        }
    }
}
