//! The PSF extracted from exactly blurred pictures is that of the motion.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::f64::consts::PI;

use blur_accel::Error;
use blur_accel::homomorphic::{HomomorphicPsf, Prototype, Variant};
use blur_core::estimate::AxialAngle;
use blur_core::psf::{AcceleratedBlur, sinc};
use blur_sim::expose::expose;
use blur_sim::motion::Motion;
use blur_sim::scene::{DeadLeaves, dead_leaves};
use blur_sim::sensor::Sensor;
use ndarray::{Array2, ArrayView2, Axis, Slice};

const SIDE: usize = 512;
/// Room for the longest motion and for pictures that begin elsewhere.
const WIDTH: usize = SIDE + 100;

fn scene(seed: u64) -> Array2<f64> {
    dead_leaves(seed, SIDE, WIDTH, &DeadLeaves { r_min_px: 3.0, r_max_px: 60.0, grey_min: 40.0, grey_max: 215.0 })
        .unwrap()
}

/// The picture of `scene` that begins at column `left`, as the camera stores it.
fn record(light: ArrayView2<'_, f64>, left: usize, psnr_db: Option<f64>, seed: u64) -> Array2<f32> {
    let light = light.slice_axis(Axis(1), Slice::from(left..left + SIDE));
    match psnr_db {
        None => light.mapv(|light| light as f32),
        Some(psnr_db) => Sensor::ideal().with_psnr_db(psnr_db).unwrap().record(light, seed).unwrap().mapv(f32::from),
    }
}

/// Backgrounds and the blurred picture, which begins half the path further on, as behind a trigger.
fn pictures(seed: u64, motion: &Motion, psnr_db: Option<f64>) -> (Vec<Array2<f32>>, Array2<f32>) {
    let scene = scene(seed);
    let lost = motion.extent_px().1;
    let stills = (0..5).map(|k| record(scene.view(), lost, psnr_db, 100 + k)).collect();
    let blurred = expose(scene.view(), motion).unwrap();
    (stills, record(blurred.view(), 0, psnr_db, 7))
}

fn prototype(variant: Variant, stills: &[Array2<f32>]) -> Prototype {
    let views: Vec<_> = stills.iter().map(Array2::view).collect();
    Prototype::new(variant, &views).unwrap()
}

/// The transfer function of a zero-phase PSF, computed from the definition, at `u` cycles per pixel.
fn transform(psf: &[f64], u: f64) -> f64 {
    psf[0] + 2.0 * psf.iter().enumerate().skip(1).map(|(lag, h)| h * (2.0 * PI * u * lag as f64).cos()).sum::<f64>()
}

fn motion(length_px: f64, ratio: f64) -> Motion {
    Motion::new(length_px, AxialAngle::from_deg(0.0), ratio).unwrap()
}

/// Root mean square deviation of the transform of the PSF from `truth`, over the bins up to 0.2 cycles per pixel.
fn rms_error(psf: &[f64], truth: impl Fn(f64) -> f64) -> f64 {
    let bins = 1..=SIDE / 5;
    let count = bins.clone().count() as f64;
    let squares = bins.map(|k| k as f64 / SIDE as f64).map(|u| (transform(psf, u) - truth(u).abs()).powi(2));
    (squares.sum::<f64>() / count).sqrt()
}

#[test]
fn the_transform_of_the_psf_is_the_modulus_of_the_transfer_function() {
    // Measured: 0.019, 0.022, 0.055 and, by coefficients that change with a shift, 0.11 at most.
    for (variant, psnr_db, bound) in [
        (Variant::Dft, None, 0.025),
        (Variant::Dft, Some(40.0), 0.03),
        (Variant::Dft, Some(30.0), 0.07),
        (Variant::Dct, Some(40.0), 0.15),
    ] {
        let mut extractor = HomomorphicPsf::new(variant, SIDE, SIDE);
        for (seed, length, ratio) in [(1, 24.3, 0.0), (2, 35.7, 0.0), (3, 52.0, 0.0), (4, 24.3, 0.3), (5, 48.5, 0.7)] {
            let (stills, blurred) = pictures(seed, &motion(length, ratio), psnr_db);
            let psf = extractor.extract(blurred.view(), &prototype(variant, &stills)).unwrap();
            let error = if ratio == 0.0 {
                rms_error(psf, |u| sinc(length * u))
            } else {
                let exact = AcceleratedBlur::new(length, ratio).unwrap();
                rms_error(psf, |u| exact.mtf(u))
            };
            assert!(error < bound, "{variant:?} {psnr_db:?} dB, {length} px, r = {ratio}: {error}");
        }
    }
}

#[test]
fn an_acceleration_fills_the_first_zero_by_its_ratio_over_pi() {
    // At 32 px the zero 1/L is bin 16. The noise fills it by itself by 0.024.
    let mut extractor = HomomorphicPsf::new(Variant::Dft, SIDE, SIDE);
    for ratio in [0.0, 0.3, 0.6, -0.6] {
        let mut sum = 0.0;
        for seed in 1..=4 {
            let (stills, blurred) = pictures(seed, &motion(32.0, ratio), Some(40.0));
            extractor.extract(blurred.view(), &prototype(Variant::Dft, &stills)).unwrap();
            sum += extractor.mtf()[16];
        }
        let (found, theory) = (sum / 4.0, ratio.abs() / PI);
        assert!((found - theory).abs() < 0.03, "r = {ratio}: {found}, in theory {theory}");
    }
}

#[test]
fn the_sum_over_all_lags_is_1() {
    let (stills, blurred) = pictures(1, &motion(20.0, 0.2), Some(40.0));
    for variant in [Variant::Dft, Variant::Dct] {
        let mut extractor = HomomorphicPsf::new(variant, SIDE, SIDE);
        let psf = extractor.extract(blurred.view(), &prototype(variant, &stills)).unwrap();
        // The cosine transform's lags go twice as far; beyond those given there is next to nothing.
        let ends = psf[0] + psf[SIDE / 2];
        let sum = 2.0 * psf.iter().sum::<f64>() - ends;
        let slack = if variant == Variant::Dft { 1e-12 } else { 0.1 };
        assert!((sum - 1.0).abs() < slack, "{variant:?}: {sum}");
    }
}

#[test]
fn the_psf_of_any_size_is_the_inverse_transform_of_the_transfer_function() {
    for (rows, columns) in [(61, 75), (64, 97), (48, 32), (33, 100)] {
        let scene = dead_leaves(1, rows, columns + 20, &DeadLeaves::default()).unwrap();
        let blurred = expose(scene.view(), &motion(9.5, 0.2)).unwrap();
        let cut = |light: &Array2<f64>| light.slice_axis(Axis(1), Slice::from(0..columns)).mapv(|light| light as f32);
        let (still, blurred) = (cut(&scene), cut(&blurred));
        let mut extractor = HomomorphicPsf::new(Variant::Dft, rows, columns);
        let psf = extractor.extract(blurred.view(), &prototype(Variant::Dft, &[still])).unwrap().to_vec();
        assert_eq!(psf.len(), columns / 2 + 1);
        for (k, &mtf) in extractor.mtf().iter().enumerate() {
            let turn = |lag: usize| (2.0 * PI * (k * lag) as f64 / columns as f64).cos();
            // In an even period the last lag is its own mirror image.
            let sides = |lag: usize| if lag == 0 || 2 * lag == columns { 1.0 } else { 2.0 };
            let sum: f64 = psf.iter().enumerate().map(|(lag, h)| sides(lag) * h * turn(lag)).sum();
            assert!((sum - mtf).abs() < 1e-12, "{rows}x{columns}, bin {k}: {sum} {mtf}");
        }
    }
}

#[test]
fn gain_offset_and_vignetting_hardly_matter() {
    let (stills, blurred) = pictures(2, &motion(30.0, 0.4), Some(40.0));
    let scene = prototype(Variant::Dft, &stills);
    let mut extractor = HomomorphicPsf::new(Variant::Dft, SIDE, SIDE);
    let plain = extractor.extract(blurred.view(), &scene).unwrap().to_vec();
    let linear = blurred.mapv(|value| 0.7 * value + 11.0);
    let same = extractor.extract(linear.view(), &scene).unwrap();
    // Single precision of the transform.
    assert!(plain.iter().zip(same).all(|(a, b)| (a - b).abs() < 1e-5));
    let vignetted = Array2::from_shape_fn(blurred.dim(), |(row, column)| {
        let offset = |i: usize| (i as f32 - 255.5) / 255.5;
        blurred[[row, column]] * (1.0 - 0.05 * (offset(row).powi(2) + offset(column).powi(2)))
    });
    let close = extractor.extract(vignetted.view(), &scene).unwrap();
    let change = plain.iter().zip(close).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    // The highest value of this PSF is about 1/30; a tenth of the light is missing in the corners.
    assert!(change < 0.001, "{change}");
}

#[test]
fn where_the_backgrounds_carry_no_signal_nothing_is_made_up() {
    // A scene without any detail finer than 8 px, with noise of 30 dB: above 0.25 cycles per pixel there is only noise,
    // and the ratio of two noises is about 1.
    let coarse = DeadLeaves { r_min_px: 40.0, r_max_px: 80.0, grey_min: 100.0, grey_max: 130.0 };
    let scene = dead_leaves(3, SIDE, WIDTH, &coarse).unwrap();
    let smooth = expose(scene.view(), &Motion::uniform(16.0, AxialAngle::from_deg(0.0)).unwrap()).unwrap();
    let stills: Vec<_> = (0..5).map(|k| record(smooth.view(), 0, Some(30.0), k)).collect();
    let blurred = record(smooth.view(), 0, Some(30.0), 9);
    let mut extractor = HomomorphicPsf::new(Variant::Dft, SIDE, SIDE);
    extractor.extract(blurred.view(), &prototype(Variant::Dft, &stills)).unwrap();
    let high = &extractor.mtf()[SIDE / 4..];
    let mean = high.iter().sum::<f64>() / high.len() as f64;
    assert!(mean < 0.2, "{mean}");
}

#[test]
fn results_are_bit_for_bit_the_same_on_every_run_and_after_other_pictures() {
    let (stills, blurred) = pictures(1, &motion(20.0, 0.2), Some(40.0));
    let scene = prototype(Variant::Dft, &stills);
    let mut extractor = HomomorphicPsf::new(Variant::Dft, SIDE, SIDE);
    let first = extractor.extract(blurred.view(), &scene).unwrap().to_vec();
    extractor.extract(stills[0].view(), &scene).unwrap();
    assert_eq!(extractor.extract(blurred.view(), &scene).unwrap(), first);
}

#[test]
fn backgrounds_that_cannot_serve_are_refused() {
    let good = scene(1).mapv(|light| light as f32);
    let refused = |backgrounds: &[ArrayView2<'_, f32>]| Prototype::new(Variant::Dft, backgrounds).unwrap_err();
    assert!(matches!(refused(&[]), Error::TooFew { found: 0, .. }));
    let narrow = good.slice_axis(Axis(1), Slice::from(0..100));
    let error = refused(&[good.view(), narrow]);
    assert_eq!(error.to_string(), "background 2: the picture is 100x512 pixels; 612x512 are expected");
    let flat = Array2::from_elem(good.dim(), 7.0);
    assert!(refused(&[good.view(), flat.view()]).to_string().starts_with("background 2: all pixels have the value 7"));
    let mut broken = good.clone();
    broken[[3, 4]] = f32::NAN;
    assert!(refused(&[broken.view()]).to_string().starts_with("background 1: the pixel at row 3, column 4 is NaN"));
}

#[test]
fn pictures_that_do_not_fit_the_backgrounds_are_refused() {
    let (stills, blurred) = pictures(1, &motion(20.0, 0.0), None);
    let scene = prototype(Variant::Dft, &stills);
    let mut extractor = HomomorphicPsf::new(Variant::Dft, SIDE, SIDE);
    let small = blurred.slice_axis(Axis(0), Slice::from(0..200));
    let error = extractor.extract(small, &scene).unwrap_err();
    assert_eq!(error.to_string(), "the picture is 512x200 pixels; 512x512 are expected");
    let flat = Array2::from_elem(blurred.dim(), 0.0);
    assert!(matches!(extractor.extract(flat.view(), &scene), Err(Error::Picture(_))));
    let other = prototype(Variant::Dct, &stills);
    assert!(matches!(extractor.extract(blurred.view(), &other), Err(Error::OtherVariant { .. })));
    let mut wrong = HomomorphicPsf::new(Variant::Dft, SIDE, 256);
    assert!(matches!(wrong.extract(blurred.view(), &scene), Err(Error::PictureSize { .. })));
}

#[test]
fn pictures_of_extreme_but_finite_pixels_give_numbers() {
    let (stills, mut blurred) = pictures(1, &motion(20.0, 0.0), None);
    let scene = prototype(Variant::Dft, &stills);
    let mut extractor = HomomorphicPsf::new(Variant::Dft, SIDE, SIDE);
    blurred[[100, 100]] = f32::MAX;
    let psf = extractor.extract(blurred.view(), &scene).unwrap();
    assert!(psf.iter().all(|value| value.is_finite()));
}
