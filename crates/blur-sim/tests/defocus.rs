//! Promises of a scene out of focus.
#![allow(clippy::unwrap_used)]

use blur_sim::Error;
use blur_sim::defocus::Defocus;
use blur_sim::expose::{Exposer, expose};
use blur_sim::scene::{PlaneWave, gaussian_field, plane_waves};
use ndarray::Array2;
use std::f64::consts::PI;

/// Means over the disk by rings: the midpoint rule in `r²`, in which a disk is uniform, and about the centre.
fn mean_over_disk(diameter: f64, at: impl Fn(f64, f64) -> f64) -> f64 {
    let (rings, spokes) = (400, 64);
    let mut sum = 0.0;
    for ring in 0..rings {
        let r = 0.5 * diameter * ((f64::from(ring) + 0.5) / f64::from(rings)).sqrt();
        for spoke in 0..spokes {
            let (sin, cos) = (2.0 * PI * f64::from(spoke) / f64::from(spokes)).sin_cos();
            sum += at(r * cos, r * sin);
        }
    }
    sum / f64::from(rings * spokes)
}

#[test]
fn each_pixel_is_the_mean_over_its_disk() {
    // A bell of 5 px in the middle: its samples say all about it.
    let scene_at = |x: f64, y: f64| 80.0 + 150.0 * (-0.5 * ((x - 61.0).powi(2) + (y - 49.5).powi(2)) / 25.0).exp();
    let scene = Array2::from_shape_fn((100, 123), |(row, col)| scene_at(col as f64, row as f64));
    for diameter in [3.0, 14.4] {
        let picture = expose(scene.view(), &Defocus::new(diameter).unwrap()).unwrap();
        let lost = diameter.ceil() as usize;
        assert_eq!(picture.dim(), (100 - lost, 123 - lost));
        for ((row, col), value) in picture.indexed_iter().step_by(97) {
            let (x, y) = ((col + lost / 2) as f64, (row + lost / 2) as f64);
            let mean = mean_over_disk(diameter, |dx, dy| scene_at(x + dx, y + dy));
            // The midpoint rule errs by h² f'' / 24 with h = D² / (4 400).
            assert!((value - mean).abs() < 2e-4, "{diameter} px, row {row}, column {col}: {value} for {mean}");
        }
    }
}

#[test]
fn waves_of_one_wavelength_fade_alike_in_every_direction() {
    let mut exposer = Exposer::new();
    let disk = Defocus::new(20.0).unwrap();
    // J1 vanishes at pi D rho = 3.8317: a wavelength of 16.4 px is all but lost.
    let amplitudes: Vec<f64> = [(5.0, 0.0), (3.0, 4.0), (0.0, -5.0), (-4.0, 3.0)]
        .map(|(i, j)| PlaneWave { amplitude: 50.0, u: i / 82.0, v: j / 82.0, phase_rad: 0.3 })
        .iter()
        .map(|wave| {
            let scene = plane_waves(82, 82, 100.0, &[*wave]).unwrap();
            let picture = exposer.expose_periodic(scene.view(), &disk).unwrap();
            picture.iter().fold(0.0, |most: f64, value| most.max((value - 100.0).abs()))
        })
        .collect();
    for amplitude in &amplitudes {
        // 5/82 cycles per pixel: pi D rho = 3.83121; the slope of 2 J1(x)/x there is -0.2102, so 50 x 1.04e-4.
        assert!((amplitude - 5.2e-3).abs() < 2e-4, "{amplitudes:?}");
    }
}

#[test]
fn disks_that_cannot_be_are_refused() {
    for diameter in [0.0, -3.0, f64::NAN, 1e7] {
        assert!(matches!(Defocus::new(diameter), Err(Error::Parameter { .. })), "{diameter}");
    }
    let scene = gaussian_field(1, 20, 40, 2.0).unwrap();
    let refused = expose(scene.view(), &Defocus::new(20.0).unwrap()).unwrap_err();
    assert_eq!(refused, Error::BlurTooLong { blur_rows: 20, blur_cols: 20, rows: 20, cols: 40 });
}
