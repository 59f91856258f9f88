//! Frames that follow each other: tracking and the direction of the motion.
#![allow(clippy::unwrap_used, reason = "a frame that cannot be made or measured fails the test")]

use blur_core::estimate::joint::{Tracker, Whittle};
use blur_core::estimate::{AxialAngle, JointEstimator, MotionBlur, Settings, Status};
use blur_core::meter::{Configuration, Meter};
use blur_sim::defocus::Defocus;
use blur_sim::expose::expose_padded;
use blur_sim::motion::Motion;
use blur_sim::scene::{DeadLeaves, dead_leaves};
use blur_sim::sensor::{Sensor, f32_from_u8};
use ndarray::{Array2, ArrayView2, Axis, Slice};

/// Rows and columns of a frame.
const FRAME: (usize, usize) = (360, 480);
/// Side of the scene that the frames are cut from.
const SCENE: usize = 900;

fn scene(seed: u64) -> Array2<f64> {
    dead_leaves(seed, SCENE, SCENE, &DeadLeaves::default()).unwrap()
}

fn blurred(scene: &Array2<f64>, length_px: f64, deg: f64) -> Array2<f64> {
    expose_padded(scene.view(), &Motion::uniform(length_px, AxialAngle::from_deg(deg)).unwrap()).unwrap()
}

/// The frame that a sensor sees of an exposed scene whose content has moved by so many pixels right and down.
fn frame(exposed: &Array2<f64>, right: f64, down: f64, seed: u64) -> Array2<f32> {
    let (rows, columns) = FRAME;
    let cut = |all: usize, size: usize, moved: f64| {
        let start = ((all - size) as f64 / 2.0 - moved).round() as usize;
        Slice::from(start..start + size)
    };
    let (height, width) = exposed.dim();
    let part =
        exposed.slice_axis(Axis(0), cut(height, rows, down)).slice_axis(Axis(1), cut(width, columns, right)).to_owned();
    let sensor = Sensor::ideal().with_psnr_db(36.0).unwrap();
    f32_from_u8(sensor.record(part.view(), seed).unwrap().view())
}

/// Whether two results are one within a fraction of the uncertainty that both state.
fn agree(tracked: &MotionBlur, searched: &MotionBlur) -> bool {
    let (length_std, angle_std) = (searched.length_std_px.unwrap(), searched.angle_std_deg.unwrap());
    (tracked.length_px - searched.length_px).abs() < 0.2 * length_std
        && tracked.angle.distance_deg(searched.angle) < 0.2 * angle_std
        && (tracked.length_std_px.unwrap() / length_std - 1.0).abs() < 0.2
        && tracked.status == searched.status
}

#[test]
fn a_motion_is_followed_to_the_result_of_the_search() {
    let mut tracker = Tracker::new(&Settings::default());
    let mut whittle = Whittle::new(&Settings::default());
    let (mut followed, mut frames) = (0, 0);
    for seed in 0..3 {
        let scene = scene(seed);
        tracker.reset();
        for k in 0_u64..6 {
            // Speed and direction change from frame to frame, as those of a hand or a vehicle do.
            let (length_px, deg) = (18.0 + 1.1 * k as f64, 30.0 + 40.0 * seed as f64 + 2.0 * k as f64);
            let picture = frame(&blurred(&scene, length_px, deg), 7.0 * k as f64, 0.0, k);
            let found = tracker.estimate(picture.view()).unwrap();
            let searched = whittle.estimate(picture.view()).unwrap();
            assert_eq!(searched.status, Status::Ok, "scene {seed}, frame {k}");
            assert!(agree(&found.blur, &searched), "scene {seed}, frame {k}: {:?} {searched:?}", found.blur);
            frames += u32::from(k > 0);
            followed += u32::from(found.tracked);
        }
    }
    assert!(followed >= frames - 1, "{followed} of {frames} frames were followed");
}

#[test]
fn a_blur_that_jumps_is_searched_again() {
    let sharp = scene(7);
    let exposures = [
        blurred(&sharp, 20.0, 30.0),
        blurred(&sharp, 40.0, 30.0),
        blurred(&sharp, 20.0, 30.0),
        blurred(&sharp, 20.0, 100.0),
        blurred(&sharp, 10.0, 100.0),
        blurred(&sharp, 30.0, 100.0),
        expose_padded(sharp.view(), &Defocus::new(24.0).unwrap()).unwrap(),
        blurred(&sharp, 30.0, 100.0),
        sharp.clone(),
    ];
    let mut tracker = Tracker::new(&Settings::default());
    let mut whittle = Whittle::new(&Settings::default());
    for (k, exposure) in exposures.iter().enumerate() {
        let picture = frame(exposure, 0.0, 0.0, k as u64);
        let found = tracker.estimate(picture.view()).unwrap();
        let searched = whittle.estimate(picture.view()).unwrap();
        assert!(!found.tracked, "frame {k}");
        assert_eq!(found.blur, searched, "frame {k}");
    }
}

#[test]
fn a_frame_of_another_size_is_searched() {
    let picture = frame(&blurred(&scene(1), 20.0, 30.0), 0.0, 0.0, 1);
    let part = picture.slice_axis(Axis(0), Slice::from(0..300));
    let mut tracker = Tracker::new(&Settings::default());
    let mut tracked = |view: ArrayView2<'_, f32>| tracker.estimate(view).unwrap().tracked;
    assert!(!tracked(picture.view()));
    assert!(tracked(picture.view()));
    assert!(!tracked(part));
    assert!(tracked(part));
    assert!(!tracked(picture.view()));
}

fn directed() -> Meter {
    let mut configuration = Configuration::default();
    configuration.directed = true;
    Meter::new(configuration).unwrap()
}

#[test]
fn the_frame_before_tells_the_direction() {
    for (seed, deg) in [(1, 0.0), (2, 37.0), (3, 90.0), (4, 143.0)] {
        let scene = scene(seed);
        for length_px in [8.0, 25.0] {
            let exposed = blurred(&scene, length_px, deg);
            let (sin, cos) = f64::to_radians(deg).sin_cos();
            // The exposure is from all to a quarter of the time between frames.
            for (gap, sign) in [(1.0, 1.0), (2.0, -1.0), (4.0, 1.0), (4.0, -1.0)] {
                let mut meter = directed();
                let step = sign * gap * length_px;
                for k in 0_u64..3 {
                    let moved = (k as f64 - 1.0) * step;
                    let picture = frame(&exposed, moved * cos, -moved * sin, 10 * seed + k);
                    let record = meter.measure_grey(picture.view()).unwrap();
                    if k == 0 {
                        assert_eq!(record.direction_deg, None);
                        continue;
                    }
                    let is_forward = record.direction_deg.map(|direction| {
                        let off = f64::to_radians(direction - deg).cos();
                        assert!(off.abs() > 0.99, "{direction} along {deg}");
                        off > 0.0
                    });
                    assert_eq!(is_forward, Some(sign > 0.0), "{deg} deg, {length_px} px, step {step}, frame {k}");
                }
            }
        }
    }
}

#[test]
fn without_a_displacement_there_is_no_direction() {
    let exposed = blurred(&scene(5), 20.0, 30.0);
    let other = blurred(&scene(6), 20.0, 30.0);
    let mut meter = directed();
    let mut direction = |picture: &Array2<f32>| meter.measure_grey(picture.view()).unwrap().direction_deg;
    let still = frame(&exposed, 0.0, 0.0, 1);
    assert_eq!(direction(&still), None);
    // The same place again, another scene, and a displacement that is not the blur's.
    assert_eq!(direction(&frame(&exposed, 0.0, 0.0, 2)), None);
    assert_eq!(direction(&frame(&other, 0.0, 0.0, 3)), None);
    assert_eq!(direction(&still), None);
    assert_eq!(direction(&frame(&exposed, 20.0, 35.0, 4)), None);
    meter.reset();
    let moved = frame(&exposed, 20.0 + 17.0, 35.0 - 10.0, 5);
    assert_eq!(meter.measure_grey(moved.view()).unwrap().direction_deg, None);
}
