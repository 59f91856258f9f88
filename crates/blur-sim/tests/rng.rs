//! Promises of the random numbers.

use blur_sim::Error;
use blur_sim::rng::Rng;
use proptest::prelude::*;

/// Mean, variance, skewness and excess kurtosis.
fn moments(values: &[f64]) -> [f64; 4] {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let central = |k: i32| values.iter().map(|x| (x - mean).powi(k)).sum::<f64>() / n;
    let variance = central(2);
    [mean, variance, central(3) / variance.powf(1.5), central(4) / (variance * variance) - 3.0]
}

#[test]
fn uniform_numbers_are_those_of_chacha8() {
    // tests/golden/chacha8.py
    let golden: [(u64, u64, [u64; 3]); 4] = [
        (0x0, 0x0, [0x0017_f29a_2665_b1dc, 0x0007_4e70_eeb4_db4b, 0x0007_a8df_e218_287d]),
        (0x1, 0x0, [0x001d_ee5d_5e89_1516, 0x0011_4677_52eb_334a, 0x0001_8800_e9dc_491e]),
        (0x1, 0x7, [0xc6d2_16bc_6205, 0x0001_9f85_adff_2303, 0x001f_7238_8fa2_55df]),
        (u64::MAX, 0x5ce0_0001, [0x0016_0963_c813_279c, 0x0009_bd88_d84e_145a, 0x001a_712d_1129_2514]),
    ];
    for (seed, stream, outputs) in golden {
        let mut rng = Rng::new(seed, stream);
        for output in outputs {
            assert_eq!(rng.uniform(), output as f64 / 2_f64.powi(53), "seed {seed}, stream {stream}");
        }
    }
}

#[test]
fn uniform_numbers_fill_the_unit_interval_evenly() {
    let mut rng = Rng::new(11, 0);
    let n = 100_000;
    let mut bins = [0_u32; 50];
    for _ in 0..n {
        bins[(rng.uniform() * 50.0) as usize] += 1;
    }
    let expected = f64::from(n) / 50.0;
    let chi2: f64 = bins.iter().map(|&count| (f64::from(count) - expected).powi(2) / expected).sum();
    // Chi-square of 49 degrees of freedom: mean 49, standard deviation 9.9; five of them either way.
    assert!((8.0..99.0).contains(&chi2), "{chi2}");
}

#[test]
fn gaussian_numbers_have_the_moments_of_a_gaussian() {
    let mut rng = Rng::new(3, 0);
    let values: Vec<f64> = (0..400_000).map(|_| rng.gaussian()).collect();
    let [mean, variance, skewness, kurtosis] = moments(&values);
    // Five standard errors: 1, 2, 6 and 24 over n for the squares.
    let error = |square: f64| 5.0 * (square / 400_000.0).sqrt();
    assert!(mean.abs() < error(1.0), "{mean}");
    assert!((variance - 1.0).abs() < error(2.0), "{variance}");
    assert!(skewness.abs() < error(6.0), "{skewness}");
    assert!(kurtosis.abs() < error(24.0), "{kurtosis}");
}

#[test]
fn gaussian_numbers_follow_the_normal_distribution_function() {
    let mut rng = Rng::new(4, 0);
    let n = 100_000;
    let mut values: Vec<f64> = (0..n).map(|_| rng.gaussian()).collect();
    values.sort_by(f64::total_cmp);
    let distance = values
        .iter()
        .enumerate()
        .map(|(i, x)| ((i as f64 + 0.5) / f64::from(n) - 0.5 * libm::erfc(-x / std::f64::consts::SQRT_2)).abs())
        .fold(0.0, f64::max);
    // Kolmogorov: the distance exceeds 2.2 / sqrt(n) once in 10^4.
    assert!(distance < 2.2 / f64::from(n).sqrt(), "{distance}");
}

#[test]
fn poisson_counts_have_poisson_probabilities() {
    for mean in [0.05, 0.7, 3.0, 9.99, 10.0, 17.3, 60.0] {
        let mut rng = Rng::new(5, 0);
        let n = 200_000;
        let mut counts = vec![0_u32; 400];
        for _ in 0..n {
            counts[rng.poisson(mean).unwrap() as usize] += 1;
        }
        let (mut chi2, mut freedom) = (0.0, -1.0);
        for (k, &count) in counts.iter().enumerate() {
            let expected = f64::from(n) * (k as f64 * mean.ln() - mean - libm::lgamma(k as f64 + 1.0)).exp();
            if expected > 10.0 {
                chi2 += (f64::from(count) - expected).powi(2) / expected;
                freedom += 1.0;
            }
        }
        assert!(chi2 < freedom + 5.0 * (2.0_f64 * freedom).sqrt() + 8.0, "mean {mean}: {chi2} for {freedom}");
    }
}

#[test]
fn poisson_counts_have_equal_mean_and_variance_at_any_scale() {
    for mean in [9.9, 10.1, 250.0, 1e4, 1e7] {
        let mut rng = Rng::new(6, 0);
        let values: Vec<f64> = (0..100_000).map(|_| rng.poisson(mean).unwrap() as f64).collect();
        let [found, variance, ..] = moments(&values);
        assert!((found - mean).abs() < 5.0 * (mean / 1e5).sqrt(), "mean {mean}: {found}");
        // The variance of the sample variance is (2 + 1/mean) mean^2 / n.
        assert!((variance / mean - 1.0).abs() < 5.0 * ((2.0 + 1.0 / mean) / 1e5).sqrt(), "mean {mean}: {variance}");
    }
}

#[test]
fn a_mean_of_zero_counts_nothing_and_a_wrong_one_is_refused() {
    let mut rng = Rng::new(1, 0);
    assert_eq!(rng.poisson(0.0).unwrap(), 0);
    for mean in [-1.0, f64::NAN, f64::INFINITY, 1e13] {
        assert!(matches!(rng.poisson(mean), Err(Error::Parameter { .. })), "{mean}");
    }
}

proptest! {
    #[test]
    fn uniform_numbers_stay_in_their_interval(seed: u64, stream: u64, low in -1e6..1e6, width in 0.0..1e6) {
        let mut rng = Rng::new(seed, stream);
        for _ in 0..50 {
            let x = rng.uniform_in(low, low + width);
            prop_assert!(x >= low && x <= low + width);
            prop_assert!((0.0..1.0).contains(&rng.uniform()));
        }
    }

    #[test]
    fn streams_of_a_seed_differ(seed: u64, stream in 0..u64::MAX) {
        prop_assert_ne!(Rng::new(seed, stream).uniform(), Rng::new(seed, stream + 1).uniform());
    }

    #[test]
    fn poisson_counts_of_any_mean_lie_near_it(seed: u64, log_mean in -20.0..27.6) {
        let mean = f64::exp(log_mean);
        let count = Rng::new(seed, 0).poisson(mean).unwrap() as f64;
        prop_assert!((count - mean).abs() <= 12.0 * mean.sqrt() + 12.0, "{mean} {count}");
    }
}
