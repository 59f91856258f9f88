//! After the first picture of a size, measuring allocates nothing.
#![allow(clippy::unwrap_used, reason = "a picture that cannot be made or measured fails the test")]

use allocation_counter::measure;
use blur_core::camera::Scale;
use blur_core::estimate::registry::{ANGLE, JOINT, LENGTH, REFERENCE};
use blur_core::estimate::{AxialAngle, JointEstimator, KnownAngle, Pair, Settings};
use blur_core::image::{Channels, PixelFormat, Pixels, SampleType};
use blur_core::meter::{Configuration, Geometry, Meter};
use blur_core::motion::Exposure;
use blur_core::restore::{LineBlur, Method, Restorer};
use blur_sim::expose::expose_padded;
use blur_sim::motion::Motion;
use blur_sim::rng::Rng;
use blur_sim::scene::{DeadLeaves, dead_leaves};
use metrology::Measurement;
use ndarray::Array2;

/// Square, rectangular both ways, odd, prime, and one large enough for every subsampling.
const SIZES: [(usize, usize); 6] = [(96, 96), (64, 100), (100, 64), (75, 93), (101, 67), (300, 411)];

/// Degrees on both sides of every border between the plans of a method: rows, columns, diagonals, turned or not.
const ANGLES_DEG: [f64; 9] = [0.0, 0.3, 44.9, 45.0, 60.0, 90.0, 134.9, 135.0, 179.9];

/// Pictures of one size that differ in everything that a search could depend on: blurs of several directions, noise
/// alone, one bright pixel, stripes.
fn pictures(dim: (usize, usize)) -> Vec<Array2<f32>> {
    let scene = dead_leaves(7, dim.0, dim.1, &DeadLeaves::default()).unwrap();
    let mut pictures: Vec<_> = [(0.0, 12.0), (37.0, 15.0), (90.0, 20.0), (140.0, 9.0)]
        .into_iter()
        .map(|(deg, length_px)| {
            let motion = Motion::uniform(length_px, AxialAngle::from_deg(deg)).unwrap();
            expose_padded(scene.view(), &motion).unwrap().mapv(|pixel| pixel as f32)
        })
        .collect();
    let mut rng = Rng::new(5, 0);
    pictures.push(Array2::from_shape_simple_fn(dim, || rng.gaussian() as f32));
    let mut bright = Array2::zeros(dim);
    bright[[dim.0 / 2, dim.1 / 3]] = 1.0;
    pictures.push(bright);
    pictures.push(Array2::from_shape_fn(dim, |(r, _)| (r % 5) as f32));
    pictures
}

/// Allocations of one call.
fn allocations<T>(call: impl FnOnce() -> T) -> (T, u64) {
    let mut result = None;
    let info = measure(|| result = Some(call()));
    (result.unwrap(), info.count_total)
}

#[test]
fn the_counter_counts() {
    let (vector, count) = allocations(|| std::hint::black_box(vec![1_u8; 100]));
    assert_eq!((vector.len(), count), (100, 1));
    let (_, count) = allocations(|| std::hint::black_box(3) + 4);
    assert_eq!(count, 0);
    // A method must allocate its plans at first, or the counts below would prove nothing.
    let picture = &pictures((96, 96))[0];
    let mut estimator = ANGLE[0].build(&Settings::default());
    assert!(allocations(|| estimator.estimate(picture.view()).unwrap()).1 > 0);
}

#[test]
fn angle_methods_allocate_only_for_the_first_picture_of_a_size() {
    for dim in SIZES {
        let pictures = pictures(dim);
        for method in ANGLE {
            let mut estimator = method.build(&Settings::default());
            estimator.estimate(pictures[0].view()).unwrap();
            for (i, picture) in pictures.iter().enumerate() {
                let (found, count) = allocations(|| estimator.estimate(picture.view()));
                found.unwrap();
                assert_eq!(count, 0, "{} {dim:?} picture {i}", method.name);
            }
        }
    }
}

#[test]
fn length_methods_allocate_only_for_the_first_picture_of_a_size_whatever_the_angle() {
    for dim in SIZES {
        let pictures = pictures(dim);
        for method in LENGTH {
            for first_deg in [0.0, 90.0] {
                let mut estimator = method.build(&Settings::default());
                estimator.estimate(pictures[0].view(), AxialAngle::from_deg(first_deg)).unwrap();
                for (turn, deg) in ANGLES_DEG.into_iter().enumerate() {
                    // Each angle with other pictures; all of them with all would take minutes.
                    for i in [turn, turn + 3].map(|turn| turn % pictures.len()) {
                        let (found, count) =
                            allocations(|| estimator.estimate(pictures[i].view(), AxialAngle::from_deg(deg)));
                        found.unwrap();
                        assert_eq!(count, 0, "{} {dim:?} picture {i} at {deg} after {first_deg}", method.name);
                    }
                }
            }
        }
    }
}

#[test]
fn joint_methods_allocate_only_for_the_first_picture_of_a_size() {
    for dim in SIZES {
        let pictures = pictures(dim);
        for method in JOINT {
            let mut estimator = method.build(&Settings::default());
            estimator.estimate(pictures[0].view()).unwrap();
            for (i, picture) in pictures.iter().enumerate() {
                let (found, count) = allocations(|| estimator.estimate(picture.view()));
                found.unwrap();
                assert_eq!(count, 0, "{} {dim:?} picture {i}", method.name);
            }
        }
    }
}

#[test]
fn methods_that_have_stills_allocate_only_when_they_are_built() {
    for dim in [(96, 96), (75, 93), (101, 67)] {
        let still = dead_leaves(7, dim.0, dim.1, &DeadLeaves::default()).unwrap().mapv(|pixel| pixel as f32);
        for method in REFERENCE {
            let mut estimator = method.build(&[still.view()], &Settings::default()).unwrap();
            for (i, picture) in pictures(dim).iter().enumerate() {
                let (found, count) = allocations(|| estimator.estimate(picture.view()));
                found.unwrap();
                assert_eq!(count, 0, "{} {dim:?} picture {i}", method.name);
            }
        }
    }
}

#[test]
fn a_meter_on_frames_that_follow_each_other_allocates_only_for_the_first_of_a_size() {
    let measured = |value: f64, std: f64| Measurement::new(value, std).unwrap();
    let mut configuration = Configuration::default();
    (configuration.tracking, configuration.directed) = (true, true);
    configuration.exposure = Some(Exposure::new(measured(0.1, 1e-4)).unwrap());
    configuration.geometry = Some(Geometry::Scale(Scale::new(measured(1e-3, 1e-6)).unwrap()));
    let format = PixelFormat { sample: SampleType::U8, channels: Channels::Bgr };
    let (rows, columns) = (300, 411);
    let row_bytes = 3 * columns + 5;
    let mut meter = Meter::new(configuration).unwrap();
    let mut tracked = 0;
    for (i, picture) in pictures((rows, columns)).iter().enumerate() {
        let mut bytes = vec![0_u8; rows * row_bytes];
        for ((row, column), value) in picture.indexed_iter() {
            bytes[row * row_bytes + 3 * column..][..3].fill(value.clamp(0.0, 255.0) as u8);
        }
        let pixels = Pixels::new(&bytes, columns, rows, row_bytes, format).unwrap();
        // Noise around 0 and one bright pixel are not all pictures any more when they are cut to codes.
        for repetition in 0..3 {
            let (found, count) = allocations(|| meter.measure(&pixels));
            assert!(count == 0 || (i, repetition) == (0, 0), "picture {i}: {count} allocations");
            tracked += u32::from(found.is_ok_and(|record| record.tracked));
        }
    }
    assert!(tracked >= 6, "only {tracked} frames were tracked");
}

#[test]
fn pairs_allocate_only_for_the_first_picture_of_a_size() {
    let settings = Settings::default();
    for dim in SIZES {
        let pictures = pictures(dim);
        // Every method in a pair; that each alone allocates nothing is counted above.
        let pairs = ANGLE.iter().enumerate().map(|(i, angle)| (angle, &LENGTH[i % LENGTH.len()]));
        for (angle, length) in pairs {
            let mut pair = Pair::new(angle.build(&settings), length.build(&settings));
            pair.estimate(pictures[0].view()).unwrap();
            for (i, picture) in pictures.iter().enumerate() {
                let (found, count) = allocations(|| pair.estimate(picture.view()));
                found.unwrap();
                assert_eq!(count, 0, "{} + {} {dim:?} picture {i}", angle.name, length.name);
            }
        }
    }
}

#[test]
fn a_known_angle_allocates_nothing_at_all() {
    let mut pair = Pair::new(Box::new(KnownAngle(AxialAngle::from_deg(30.0))), LENGTH[0].build(&Settings::default()));
    let pictures = pictures((75, 93));
    pair.estimate(pictures[0].view()).unwrap();
    for picture in &pictures {
        let (found, count) = allocations(|| pair.estimate(picture.view()));
        found.unwrap();
        assert_eq!(count, 0);
    }
}

#[test]
fn restoring_allocates_only_for_the_first_channel() {
    for dim in [(96, 96), (75, 93), (101, 67)] {
        let pictures = pictures(dim);
        let blur = LineBlur::uniform(12.5, 37.0).unwrap();
        let mut scene = Array2::zeros(dim);
        for method in [Method::Wiener, Method::RichardsonLucy, Method::SlidingDct] {
            let mut restorer = Restorer::new(dim, &blur, method).unwrap();
            // The first channel is learnt from.
            let (first, count) = allocations(|| restorer.restore(pictures[0].view(), scene.view_mut()));
            first.unwrap();
            assert!(count > 0, "{method:?} {dim:?}");
            for (i, picture) in pictures.iter().enumerate() {
                let (restored, count) = allocations(|| restorer.restore(picture.view(), scene.view_mut()));
                restored.unwrap();
                assert_eq!(count, 0, "{method:?} {dim:?} picture {i}");
            }
        }
    }
}

#[test]
fn a_refused_picture_allocates_nothing() {
    let picture = Array2::from_elem((64, 64), 1.0_f32);
    let mut estimator = ANGLE[0].build(&Settings::default());
    let (found, count) = allocations(|| estimator.estimate(picture.view()));
    found.unwrap_err();
    assert_eq!(count, 0);
}
