//! Promises of displaced exposures.
#![allow(clippy::unwrap_used)]

use blur_core::estimate::AxialAngle;
use blur_sim::Error;
use blur_sim::displaced::Displaced;
use blur_sim::expose::{Blur, Exposer, expose};
use blur_sim::motion::Motion;
use blur_sim::scene::{DeadLeaves, PlaneWave, dead_leaves, plane_waves};
use ndarray::Array2;
use std::f64::consts::TAU;

fn motion(length_px: f64, deg: f64, accel_ratio: f64) -> Motion {
    Motion::new(length_px, AxialAngle::from_deg(deg), accel_ratio).unwrap()
}

fn greatest(difference: &Array2<f64>) -> f64 {
    difference.iter().fold(0.0, |most, x| f64::max(most, x.abs()))
}

#[test]
fn plane_waves_are_turned_by_the_displacement() {
    let waves = [
        PlaneWave { amplitude: 50.0, u: 3.0 / 60.0, v: 5.0 / 45.0, phase_rad: 0.1 },
        PlaneWave { amplitude: 20.0, u: -11.0 / 60.0, v: 17.0 / 45.0, phase_rad: -2.0 },
    ];
    let scene = plane_waves(45, 60, 90.0, &waves).unwrap();
    for (length, deg, r) in [(0.0, 0.0, 0.0), (17.3, 0.0, 0.6), (8.2, 137.3, -1.0)] {
        for (right, down) in [(0.25, 0.0), (-3.7, 11.4), (41.0, -0.5)] {
            let blur = motion(length, deg, r);
            let picture =
                Exposer::new().expose_periodic(scene.view(), &Displaced::new(blur, right, down).unwrap()).unwrap();
            // Content that has moved by (right, down) shows at (x, y) what was at (x - right, y - down).
            let moved = waves.map(|wave| {
                let blurred = wave.exposed(&blur);
                PlaneWave { phase_rad: blurred.phase_rad - TAU * (wave.u * right + wave.v * down), ..blurred }
            });
            let error = greatest(&(picture - plane_waves(45, 60, 90.0, &moved).unwrap()));
            assert!(error < 1e-10, "{length} px at {deg} degrees, r {r}, ({right}, {down}): {error:e}");
        }
    }
}

#[test]
fn whole_pixels_move_the_picture_and_lose_no_known_pixel() {
    let scene = dead_leaves(3, 120, 140, &DeadLeaves::default()).unwrap();
    let still = motion(0.0, 0.0, 0.0);
    let displaced = Displaced::new(still, 5.0, -3.0).unwrap();
    assert_eq!(displaced.extent_px(), (6, 10));
    let picture = expose(scene.view(), &displaced).unwrap();
    // The picture's first pixel stands where the scene's (3, 5) is; five to the right and three up: (6, 0).
    let truth = Array2::from_shape_fn((114, 130), |(row, col)| scene[[row + 6, col]]);
    assert!(greatest(&(picture - truth)) < 1e-10);
}

#[test]
fn a_fraction_of_a_pixel_costs_a_pixel_on_either_side() {
    let displaced = Displaced::new(motion(20.3, 0.0, 0.2), -0.25, 0.0).unwrap();
    assert_eq!(displaced.extent_px(), (0, 23));
}

#[test]
fn impossible_displacements_are_refused() {
    for (right, down) in [(f64::NAN, 0.0), (0.0, f64::INFINITY), (2e6, 0.0)] {
        let refused = Displaced::new(motion(1.0, 0.0, 0.0), right, down);
        assert!(matches!(refused, Err(Error::Parameter { .. })), "({right}, {down})");
    }
}
