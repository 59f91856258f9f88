//! What one blurred picture tells of an acceleration, without training and without a sharp picture.
#![allow(clippy::unwrap_used, reason = "a picture that cannot be made or measured fails the test")]

use blur_core::camera::Scale;
use blur_core::estimate::joint::Whittle;
use blur_core::estimate::{AxialAngle, JointEstimator, MotionBlur, Settings, Status};
use blur_core::image::Window;
use blur_core::motion::{AcceleratedPath, Exposure, PathAcceleration};
use blur_core::spectrum::Dft2;
use blur_sim::expose::expose;
use blur_sim::motion::Motion;
use blur_sim::rig::{Design, Rig, Shot, Studio};
use blur_sim::scene::{DeadLeaves, dead_leaves};
use blur_sim::sensor::{Sensor, f32_from_u8};
use metrology::Measurement;
use ndarray::{Array2, ArrayView2};
use num_complex::Complex64;
use rayon::prelude::*;
use std::f64::consts::PI;

fn blind() -> Whittle {
    let mut settings = Settings::default();
    settings.acceleration = true;
    Whittle::new(&settings)
}

/// The acceleration of a result in m/s² with its standard uncertainty, as the rig's scale and exposure have it.
fn metric(rig: &Rig, found: &MotionBlur, ratio: f64, std: f64) -> PathAcceleration {
    let exact = |value| Measurement::exact(value).unwrap();
    let path = AcceleratedPath {
        ratio: Measurement::new(ratio, std).unwrap(),
        length_px: Measurement::new(found.length_px, found.length_std_px.unwrap()).unwrap(),
        correlation: found.acceleration.unwrap().length_correlation,
    };
    let scale = Scale::new(exact(rig.scale_m_per_px)).unwrap();
    PathAcceleration::from_blur(&path, scale, Exposure::new(exact(rig.exposure_s)).unwrap())
}

/// Every shot of the rig measured blindly.
fn measured(rig: &Rig, shots: &[Shot]) -> Vec<MotionBlur> {
    shots
        .par_iter()
        .map_init(
            || (Studio::new(rig).unwrap(), blind()),
            |(studio, blind), shot| blind.estimate(f32_from_u8(studio.picture(shot).unwrap().view()).view()).unwrap(),
        )
        .collect()
}

#[test]
fn the_interval_of_a_blind_estimate_holds() {
    let (mut inside, mut linear, mut total) = (0, 0, 0);
    for psnr_db in [40.0, 30.0] {
        let rig = Rig { psnr_db: Some(psnr_db), ..Rig::default() };
        let shots = rig.shots(Design::RandomRelease, 7).unwrap();
        for (shot, found) in shots.iter().zip(measured(&rig, &shots)).filter(|(_, found)| found.status == Status::Ok) {
            let acceleration = found.acceleration.unwrap();
            let (low, high) = acceleration.interval(2.0);
            let metric = metric(&rig, &found, acceleration.ratio, acceleration.ratio_std);
            total += 1;
            inside += usize::from((low..=high).contains(&shot.accel_ratio));
            linear += usize::from((metric.value_m_s2 - shot.accel_m_s2).abs() <= metric.expanded_m_s2());
        }
    }
    // 95 % of 250 have the standard deviation 3.4: not below 90 nor, a little wary of rough scenes, all.
    for count in [inside, linear] {
        let share = count as f64 / f64::from(total);
        assert!((0.90..=0.99).contains(&share), "{inside} and {linear} of {total}");
    }
    assert!(total >= 240, "{total} of 250 are called ok");
}

#[test]
fn no_uniform_motion_of_the_rig_is_called_accelerated() {
    let rig = Rig::default();
    let mut shots = rig.shots(Design::RandomRelease, 8).unwrap();
    for shot in &mut shots {
        shot.accel_ratio = 0.0;
    }
    let found = measured(&rig, &shots);
    let detected = found.iter().filter(|found| found.acceleration.unwrap().is_detected()).count();
    // Three standard uncertainties of r^2: one in 700 if they were normal.
    assert!(detected <= 2, "{detected} of {}", shots.len());
}

/// Rows of the spectrum on either side of the x axis where scenes stand far above the noise.
const ROWS: usize = 64;

/// `|H|` at the first zero of a uniform blur along x, with its standard uncertainty, from a picture and what it shows:
/// the regression of one spectrum on the other in the column `cycles` of the spectrum. Every row is multiplied by its
/// frequency, which makes the spectrum of a scene about white.
fn mtf_at_the_first_zero(blurred: ArrayView2<'_, f32>, sharp: ArrayView2<'_, f32>, cycles: usize) -> (f64, f64) {
    let (rows, columns) = blurred.dim();
    let (down, across) = (Window::Hann.weights(rows), Window::Hann.weights(columns));
    let mut dft = Dft2::new(rows, columns);
    let mut column = |picture: ArrayView2<'_, f32>| {
        let mean = picture.mean().unwrap();
        *dft.input() =
            Array2::from_shape_fn((rows, columns), |(row, col)| (picture[[row, col]] - mean) * down[row] * across[col]);
        let spectrum = dft.transform();
        let near = (0..=ROWS).chain(rows - ROWS..rows);
        near.map(|row| {
            let frequency = (row.min(rows - row) as f32).hypot(cycles as f32);
            spectrum[[row, cycles]] * frequency
        })
        .map(|value| Complex64::new(f64::from(value.re), f64::from(value.im)))
        .collect::<Vec<_>>()
    };
    let (g, i) = (column(blurred), column(sharp));
    let energy: f64 = i.iter().map(Complex64::norm_sqr).sum();
    let h = g.iter().zip(&i).map(|(g, i)| g * i.conj()).sum::<Complex64>() / energy;
    let rest: f64 = g.iter().zip(&i).map(|(g, i)| (g - h * i).norm_sqr()).sum();
    // The length of a complex number sees one of its two parts, and the window leaves one independent row in two.
    let independent = g.len() as f64 / Window::Hann.variance_factor(rows);
    (h.norm(), (0.5 * rest / energy / independent).sqrt())
}

#[test]
fn the_first_dark_line_is_as_deep_as_the_ratio_says() {
    let (rows, columns, length_px) = (512, 512, 32.0);
    for ratio in [0.1, 0.2, 0.4] {
        let motion = Motion::new(length_px, AxialAngle::from_deg(0.0), ratio).unwrap();
        let (extra_rows, extra_columns) = motion.extent_px();
        let (mut squares, mut count) = (0.0, 0);
        for seed in 1..=8 {
            let scene = dead_leaves(seed, rows + extra_rows, columns + extra_columns, &DeadLeaves::default()).unwrap();
            let sensor = Sensor::ideal().with_psnr_db(40.0).unwrap();
            let blurred =
                f32_from_u8(sensor.record(expose(scene.view(), &motion).unwrap().view(), seed).unwrap().view());
            let still = Array2::from_shape_fn((rows, columns), |(row, col)| {
                scene[[row + extra_rows / 2, col + extra_columns / 2]]
            });
            let sharp = f32_from_u8(sensor.record(still.view(), seed + 100).unwrap().view());

            // To first order |r| / pi; exactly, a little less.
            let theory = ratio / PI;
            let (depth, std) = mtf_at_the_first_zero(blurred.view(), sharp.view(), columns / length_px as usize);
            let excess = (depth - theory).abs() - 0.07 * ratio * ratio * theory;
            assert!(excess <= 3.0 * std, "{ratio}, {seed}: {depth} ± {std}, not {theory}");
            squares += ((depth - theory) / std).powi(2);
            count += 1;

            // And as the power spectrum of the one picture says.
            let found = blind().estimate(blurred.view()).unwrap().acceleration.unwrap();
            let (low, high) = found.interval(3.0);
            assert!((low / PI..=high / PI).contains(&theory), "{ratio}, {seed}: {low} to {high}");
        }
        let scatter = (squares / f64::from(count)).sqrt();
        assert!((0.3..2.0).contains(&scatter), "{ratio}: {scatter} standard uncertainties");
    }
}
