//! Promises of the sensor.
#![allow(clippy::unwrap_used)]

use blur_sim::Error;
use blur_sim::sensor::{
    Sensor, Tone, f32_from_u8, linear_from_srgb, psnr_db_from_sigma, quantised, sigma_from_psnr_db, srgb_from_linear,
};
use ndarray::{Array2, array};
use proptest::prelude::*;

const SIDE: usize = 300;

fn grey(level: f64) -> Array2<f64> {
    Array2::from_elem((SIDE, SIDE), level)
}

fn mean_and_variance(picture: &Array2<f64>) -> (f64, f64) {
    let n = picture.len() as f64;
    let mean = picture.sum() / n;
    (mean, picture.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / n)
}

/// Relative standard error of a variance from `SIDE x SIDE` nearly Gaussian numbers, five times.
fn tolerance() -> f64 {
    5.0 * (2.0 / (SIDE * SIDE) as f64).sqrt()
}

#[test]
fn psnr_is_attained_with_the_rounding_on_top() {
    for psnr_db in [20.0, 30.0, 36.0, 45.0] {
        let picture = Sensor::ideal().with_psnr_db(psnr_db).unwrap().record(grey(127.3).view(), 3).unwrap();
        let error = picture.mapv(f64::from) - 127.3;
        let mean_square = error.iter().map(|x| x * x).sum::<f64>() / error.len() as f64;
        // Rounding is uniform over a level, variance 1/12, once the noise spans some levels.
        let sigma2 = (255.0 * 10_f64.powf(-psnr_db / 20.0)).powi(2);
        let truth = sigma2 + 1.0 / 12.0;
        assert!((mean_square / truth - 1.0).abs() < tolerance(), "{psnr_db} dB: {mean_square} for {truth}");
    }
    let before = Sensor::ideal().with_psnr_db(50.0).unwrap().code_values(grey(10.0).view(), 3).unwrap();
    let found = psnr_db_from_sigma(mean_and_variance(&before).1.sqrt());
    assert!((found - 50.0).abs() < 0.1, "{found} dB");
}

#[test]
fn psnr_of_twenty_db_is_a_tenth_of_the_peak() {
    assert!((sigma_from_psnr_db(20.0) - 25.5).abs() < 1e-12);
    assert!((psnr_db_from_sigma(2.55) - 40.0).abs() < 1e-12);
}

#[test]
fn additive_noise_is_white() {
    let noise = Sensor::ideal().with_psnr_db(30.0).unwrap().code_values(grey(0.0).view(), 8).unwrap();
    let (_, variance) = mean_and_variance(&noise);
    for (down, across) in [(0, 1), (1, 0), (1, 1), (0, 2), (3, 5)] {
        let mut sum = 0.0;
        for row in 0..SIDE - down {
            for col in 0..SIDE - across {
                sum += noise[[row, col]] * noise[[row + down, col + across]];
            }
        }
        let correlation = sum / variance / ((SIDE - down) * (SIDE - across)) as f64;
        assert!(correlation.abs() < 5.0 / SIDE as f64, "{down} {across}: {correlation}");
    }
}

#[test]
fn shot_noise_has_the_variance_of_the_photons() {
    // N photons have the variance N: 255^2 / N^2 levels each.
    for (photons, level) in [(1000.0, 100.0), (20_000.0, 200.0), (50.0, 10.0)] {
        let sensor = Sensor::ideal().with_photons_at_peak(photons).unwrap();
        let (mean, variance) = mean_and_variance(&sensor.code_values(grey(level).view(), 2).unwrap());
        let truth = level * 255.0 / photons;
        assert!((variance / truth - 1.0).abs() < 1.3 * tolerance(), "{photons} photons: {variance} for {truth}");
        assert!((mean - level).abs() < 5.0 * truth.sqrt() / SIDE as f64, "{photons} photons: {mean}");
    }
}

#[test]
fn gain_comes_after_the_shot_noise_and_before_the_additive_noise() {
    let sensor = Sensor::ideal().with_photons_at_peak(2000.0).unwrap().with_gain(4.0).unwrap();
    let (mean, shot) = mean_and_variance(&sensor.code_values(grey(40.0).view(), 2).unwrap());
    let truth = 16.0 * 40.0 * 255.0 / 2000.0;
    assert!((mean - 160.0).abs() < 0.1 && (shot / truth - 1.0).abs() < tolerance(), "{mean} {shot} for {truth}");
    let sensor = Sensor::ideal().with_gain(4.0).unwrap().with_psnr_db(30.0).unwrap();
    let (_, additive) = mean_and_variance(&sensor.code_values(grey(40.0).view(), 2).unwrap());
    let truth = sigma_from_psnr_db(30.0).powi(2);
    assert!((additive / truth - 1.0).abs() < tolerance(), "{additive} for {truth}");
}

#[test]
fn srgb_curve_meets_its_published_points() {
    // IEC 61966-2-1: 18 % grey is code 118, half the code is 21.4 % of the light.
    assert_eq!(srgb_from_linear(0.0), 0.0);
    assert!((srgb_from_linear(1.0) - 1.0).abs() < 1e-15);
    assert!((linear_from_srgb(0.5) - 0.214_041_140_482_232_55).abs() < 1e-12);
    assert_eq!((255.0 * srgb_from_linear(0.18)).round(), 118.0);
    let picture = Sensor::ideal().with_tone(Tone::Srgb).record(grey(0.18 * 255.0).view(), 1).unwrap();
    assert_eq!(picture[[0, 0]], 118);
}

#[test]
fn code_values_are_rounded_and_clipped() {
    let exposure = array![[-1e300, -0.6, 0.49, 0.5, 1.5], [254.4, 254.5, 255.4, 256.0, 1e300]];
    let expected = array![[0, 0, 0, 1, 2], [254, 255, 255, 255, 255]];
    assert_eq!(Sensor::ideal().record(exposure.view(), 1).unwrap(), expected);
    assert_eq!(quantised(array![[f64::NAN]].view()), array![[0]]);
    assert_eq!(f32_from_u8(expected.view())[[1, 1]], 255.0_f32);
}

#[test]
fn noise_of_one_seed_is_the_same_and_of_another_is_not() {
    let sensor = Sensor::ideal().with_photons_at_peak(500.0).unwrap().with_psnr_db(30.0).unwrap();
    let record = |seed| sensor.record(grey(90.0).view(), seed).unwrap();
    assert_eq!(record(1), record(1));
    assert_ne!(record(1), record(2));
}

#[test]
fn additive_noise_of_a_seed_does_not_depend_on_the_light() {
    let sensor = Sensor::ideal().with_psnr_db(30.0).unwrap();
    let noise = |level| sensor.code_values(grey(level).view(), 4).unwrap() - level;
    assert!((noise(0.0) - noise(128.0)).iter().all(|x: &f64| x.abs() < 1e-12));
}

#[test]
fn impossible_sensors_and_exposures_are_refused() {
    for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(Sensor::ideal().with_photons_at_peak(wrong), Err(Error::Parameter { .. })), "{wrong}");
        assert!(matches!(Sensor::ideal().with_gain(wrong), Err(Error::Parameter { .. })), "{wrong}");
    }
    for wrong in [-50.0, 201.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(Sensor::ideal().with_psnr_db(wrong), Err(Error::Parameter { .. })), "{wrong}");
    }
    let refused = Sensor::ideal().record(array![[1.0, 2.0], [f64::NEG_INFINITY, 3.0]].view(), 1).unwrap_err();
    assert_eq!(refused, Error::NotFinite { row: 1, col: 0, value: f64::NEG_INFINITY });
    let photons = Sensor::ideal().with_photons_at_peak(1000.0).unwrap();
    assert!(matches!(photons.record(array![[1e300]].view(), 1), Err(Error::Parameter { .. })));
}

proptest! {
    #[test]
    fn srgb_curve_and_its_inverse_undo_each_other(light in 0.0..1.0) {
        // The two published pieces join to 1e-7 only.
        prop_assert!((linear_from_srgb(srgb_from_linear(light)) - light).abs() < 1e-7);
    }

    #[test]
    fn tone_curve_keeps_the_order_of_light(a in -0.2..1.2, b in -0.2..1.2) {
        prop_assert_eq!(a < b, srgb_from_linear(a) < srgb_from_linear(b));
    }

    #[test]
    fn any_finite_exposure_is_recorded(values in proptest::collection::vec(-1e9..1e9, 12), seed: u64) {
        let exposure = Array2::from_shape_vec((3, 4), values).unwrap();
        let sensor = Sensor::ideal().with_photons_at_peak(10.0).unwrap().with_tone(Tone::Srgb).with_psnr_db(10.0);
        prop_assert_eq!(sensor.unwrap().record(exposure.view(), seed).unwrap().dim(), (3, 4));
    }
}
