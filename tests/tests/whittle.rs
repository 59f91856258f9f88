//! The likelihood of the whole spectrum on dead leaves: what must hold whatever the picture.
#![allow(clippy::unwrap_used, reason = "a picture that cannot be made or measured fails the test")]

use blur_core::estimate::joint::Whittle;
use blur_core::estimate::{AxialAngle, Doubt, JointEstimator, LengthRange, MotionBlur, Settings, Status};
use blur_sim::defocus::Defocus;
use blur_sim::expose::{Blur, expose};
use blur_sim::motion::Motion;
use blur_sim::scene::{DeadLeaves, dead_leaves};
use blur_sim::sensor::{Sensor, f32_from_u8};
use ndarray::{Array2, ArrayView2, Axis, Slice};

/// Eight-bit picture of `dim` rows and columns, blurred exactly, with noise of this PSNR.
fn picture(seed: u64, (rows, columns): (usize, usize), blur: &impl Blur, psnr_db: f64) -> Array2<f32> {
    let (lost_rows, lost_columns) = blur.extent_px();
    let scene = dead_leaves(seed, rows + lost_rows, columns + lost_columns, &DeadLeaves::default()).unwrap();
    let exposure = expose(scene.view(), blur).unwrap();
    let sensor = Sensor::ideal().with_psnr_db(psnr_db).unwrap();
    f32_from_u8(sensor.record(exposure.view(), seed).unwrap().view())
}

fn motion(length_px: f64, deg: f64) -> Motion {
    Motion::uniform(length_px, AxialAngle::from_deg(deg)).unwrap()
}

fn measured(picture: ArrayView2<'_, f32>, settings: &Settings) -> MotionBlur {
    Whittle::new(settings).estimate(picture).unwrap()
}

/// Whether `found` is this blur within `sigmas` of its standard uncertainties.
fn is_within(found: &MotionBlur, length_px: f64, deg: f64, sigmas: f64) -> bool {
    let off_deg = found.angle.minus_deg(AxialAngle::from_deg(deg));
    found.length_std_px.is_some_and(|std| (found.length_px - length_px).abs() <= sigmas * std)
        && found.angle_std_deg.is_some_and(|std| off_deg.abs() <= sigmas * std)
}

#[test]
fn odd_prime_tiny_and_wide_pictures_get_an_honest_answer() {
    let sizes = [(32, 32), (33, 47), (61, 64), (127, 131), (251, 241), (64, 400), (400, 64), (97, 769)];
    let mut trusted = 0;
    for (seed, dim) in sizes.into_iter().enumerate() {
        for deg in [0.0, 40.0, 90.0] {
            let length_px = 9.3;
            let picture = picture(seed as u64 + 1, dim, &motion(length_px, deg), 40.0);
            let found = measured(picture.view(), &Settings::default());
            if found.status == Status::Ok {
                trusted += 1;
                // Uncertainty to four standard deviations, and half a per cent and a tenth of a degree besides.
                let off_deg = found.angle.distance_deg(AxialAngle::from_deg(deg));
                let (length_std_px, angle_std_deg) = (found.length_std_px.unwrap(), found.angle_std_deg.unwrap());
                let off_px = (found.length_px - length_px).abs();
                assert!(off_px < 4.0 * length_std_px + 0.005 * length_px, "{dim:?} {deg} deg: {found:?}");
                assert!(off_deg < 4.0 * angle_std_deg + 0.1, "{dim:?} {deg} deg: {found:?}");
            } else {
                assert!(found.status.doubt().is_some());
            }
        }
    }
    // Nine of these pictures have more than 15 000 pixels.
    assert!(trusted >= 9, "{trusted}");
}

#[test]
fn pictures_without_contrast_or_with_holes_are_refused() {
    let mut estimator = Whittle::new(&Settings::default());
    assert!(estimator.estimate(Array2::from_elem((64, 64), 7.0).view()).is_err());
    let mut holed = picture(1, (64, 64), &motion(9.0, 20.0), 40.0);
    for hole in [f32::NAN, f32::INFINITY] {
        holed[[20, 30]] = hole;
        assert!(estimator.estimate(holed.view()).is_err(), "{hole}");
    }
    assert!(estimator.estimate(Array2::from_shape_fn((8, 8), |(r, c)| (r * c) as f32).view()).is_err());
}

#[test]
fn brightness_and_contrast_do_not_matter() {
    let picture = picture(3, (192, 256), &motion(17.0, 62.0), 40.0);
    let here = measured(picture.view(), &Settings::default());
    let there = measured(picture.mapv(|x| 3.0 * x + 10.0).view(), &Settings::default());
    // The same to single precision, a small part of the uncertainty.
    assert!(is_within(&there, here.length_px, here.angle.deg(), 0.05), "{here:?} {there:?}");
    assert_eq!(here.status, there.status);
}

#[test]
fn turned_and_mirrored_pictures_have_turned_and_mirrored_blurs() {
    for (seed, deg) in [(4, 0.0), (5, 27.0), (6, 118.0)] {
        let picture = picture(seed, (192, 256), &motion(17.0, deg), 40.0);
        let here = measured(picture.view(), &Settings::default());
        assert_eq!(here.status, Status::Ok, "{deg} deg: {here:?}");
        assert!(is_within(&here, 17.0, deg, 4.0), "{deg} deg: {here:?}");
        // Counter-clockwise by a right angle: the top right corner goes to the top left.
        let mut turned = picture.t();
        turned.invert_axis(Axis(0));
        let mut mirrored = picture.view();
        mirrored.invert_axis(Axis(1));
        let found_deg = here.angle.deg();
        // A transposition mirrors at the diagonal that falls to the right.
        for (other, expected_deg) in
            [(turned, found_deg + 90.0), (mirrored, -found_deg), (picture.t(), -90.0 - found_deg)]
        {
            let there = measured(other, &Settings::default());
            // The data are the same; the search sees them on other grids, and bins on an axis fall to either side.
            assert!(is_within(&there, here.length_px, expected_deg, 1.0), "{deg} deg: {here:?} {there:?}");
            assert_eq!(there.status, Status::Ok, "{deg} deg: {there:?}");
        }
    }
}

#[test]
fn a_shifted_view_of_the_scene_has_the_same_blur() {
    let whole = picture(7, (224, 288), &motion(17.0, 27.0), 40.0);
    for (row, column) in [(0, 0), (32, 0), (0, 32), (13, 21)] {
        let view = whole.slice_axis(Axis(0), Slice::from(row..row + 192));
        let found = measured(view.slice_axis(Axis(1), Slice::from(column..column + 256)), &Settings::default());
        assert!(is_within(&found, 17.0, 27.0, 4.0), "{row} {column}: {found:?}");
        assert_eq!(found.status, Status::Ok, "{row} {column}: {found:?}");
    }
}

#[test]
fn an_acceleration_is_detected_and_its_absence_is_not() {
    let mut settings = Settings::default();
    settings.acceleration = true;
    let measure = |seed: u64, ratio: f64| {
        let motion = Motion::new(40.0, AxialAngle::from_deg(31.0), ratio).unwrap();
        measured(picture(seed, (512, 512), &motion, 40.0).view(), &settings).acceleration.unwrap()
    };
    let mut falsely = 0;
    for seed in 11..16 {
        let strong = measure(seed, 0.8);
        let none = measure(seed, 0.0);
        assert!(strong.is_detected(), "{seed}: {strong:?}");
        assert!((strong.ratio - 0.8).abs() <= 3.0 * strong.ratio_std, "{seed}: {strong:?}");
        falsely += usize::from(none.is_detected());
    }
    assert!(falsely == 0, "{falsely} of 5");
}

#[test]
fn a_defocused_picture_is_never_trusted() {
    for diameter_px in [6.0, 12.0, 25.0] {
        for seed in 21..24 {
            let picture = picture(seed, (256, 320), &Defocus::new(diameter_px).unwrap(), 40.0);
            let found = measured(picture.view(), &Settings::default());
            assert_ne!(found.status, Status::Ok, "{diameter_px} px: {found:?}");
        }
    }
}

#[test]
fn a_sharp_picture_is_never_trusted() {
    for seed in 31..41 {
        let found = measured(picture(seed, (256, 320), &motion(0.0, 0.0), 40.0).view(), &Settings::default());
        assert_ne!(found.status, Status::Ok, "{seed}: {found:?}");
    }
}

#[test]
fn a_length_at_the_end_of_the_range_is_refused() {
    let picture = picture(41, (256, 320), &motion(20.0, 27.0), 40.0);
    for (min_px, max_px) in [(4.0, 20.05), (19.95, 60.0)] {
        let mut settings = Settings::default();
        settings.length_range = Some(LengthRange::new(min_px, max_px).unwrap());
        let found = measured(picture.view(), &settings);
        assert_ne!(found.status, Status::Ok, "{found:?}");
        if (found.length_px - 20.0).abs() < 1.0 {
            let doubt = found.status.doubt();
            assert!(matches!(doubt, Some(Doubt::LengthAtRangeEnd { .. })), "{found:?}");
        }
    }
}
