//! Promises of the scenes.
#![allow(clippy::unwrap_used)]

use blur_sim::Error;
use blur_sim::scene::{
    Bars, DeadLeaves, FIELD_MEAN, FIELD_STD, PlaneWave, bars, dead_leaves, gaussian_field, plane_waves,
};
use blur_sim::sensor::quantised;
use ndarray::{Array2, Axis};
use proptest::prelude::*;
use rustfft::{FftPlanner, num_complex::Complex};
use std::f64::consts::{PI, TAU};

/// FNV-1a, 64 bit.
fn checksum(picture: &Array2<u8>) -> u64 {
    picture.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// Periodogram of a square picture under a Hann window, `[row frequency][column frequency]`.
fn periodogram(picture: &Array2<f64>) -> Array2<f64> {
    let n = picture.nrows();
    let mean = picture.sum() / picture.len() as f64;
    let hann = |i: usize| 0.5 - 0.5 * (TAU * (i as f64 + 0.5) / n as f64).cos();
    let mut spectrum = Array2::from_shape_fn((n, n), |(row, col)| {
        Complex::new((picture[[row, col]] - mean) * hann(row) * hann(col), 0.0)
    });
    let fft = FftPlanner::new().plan_fft_forward(n);
    for axis in [Axis(0), Axis(1)] {
        for mut lane in spectrum.lanes_mut(axis) {
            let mut line = lane.to_vec();
            fft.process(&mut line);
            lane.iter_mut().zip(line).for_each(|(to, from)| *to = from);
        }
    }
    spectrum.mapv(|x| x.norm_sqr())
}

/// Exponent of the power spectrum: minus the slope of the mean power over rings of equal width in log frequency.
fn spectral_exponent(picture: &Array2<f64>, low: f64, high: f64) -> f64 {
    let n = picture.nrows();
    let rings = 12.0;
    let mut bins = vec![(0.0, 0.0); rings as usize];
    for ((l, k), power) in periodogram(picture).indexed_iter() {
        let signed = |i: usize| if 2 * i > n { i as f64 - n as f64 } else { i as f64 } / n as f64;
        let f = signed(k).hypot(signed(l));
        if f >= low && f < high {
            let bin = &mut bins[((f / low).ln() / (high / low).ln() * rings) as usize];
            *bin = (bin.0 + power, bin.1 + 1.0);
        }
    }
    let step = (high / low).ln() / rings;
    let points: Vec<(f64, f64)> =
        bins.iter().enumerate().map(|(i, (sum, count))| (i as f64 * step, f64::ln(sum / count))).collect();
    let mean_x = points.iter().map(|p| p.0).sum::<f64>() / rings;
    let (mut xy, mut xx) = (0.0, 0.0);
    for (x, y) in points {
        xy += (x - mean_x) * y;
        xx += (x - mean_x) * (x - mean_x);
    }
    -xy / xx
}

#[test]
fn spectrum_of_a_gaussian_field_has_its_exponent() {
    // Rings hold from 50 to 10^5 independent bins: the slope is good to about 0.03.
    for (seed, exponent) in [(1, 0.0), (2, 1.0), (3, 2.0), (4, 2.4), (5, 3.0)] {
        let field = gaussian_field(seed, 512, 512, exponent).unwrap();
        let found = spectral_exponent(&field, 0.015, 0.45);
        assert!((found - exponent).abs() < 0.08, "{exponent}: {found}");
    }
}

#[test]
fn gaussian_field_has_its_mean_and_standard_deviation() {
    for (rows, cols) in [(2, 2), (33, 70), (300, 201)] {
        let field = gaussian_field(9, rows, cols, 2.0).unwrap();
        let mean = field.sum() / field.len() as f64;
        let std = (field.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / field.len() as f64).sqrt();
        assert_eq!(field.dim(), (rows, cols));
        assert!((mean - FIELD_MEAN).abs() < 1e-9 && (std - FIELD_STD).abs() < 1e-9, "{mean} {std}");
    }
}

#[test]
fn gaussian_field_does_not_wrap_around() {
    let field = gaussian_field(5, 200, 240, 2.4).unwrap();
    let step = |a: usize, b: usize| {
        let (a, b) = (field.column(a), field.column(b));
        a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum::<f64>() / 200.0
    };
    assert!(step(0, 239) > 5.0 * step(0, 1), "{} {}", step(0, 239), step(0, 1));
}

#[test]
fn the_same_seed_gives_the_same_picture_on_every_machine() {
    let leaves = dead_leaves(1, 120, 150, &DeadLeaves::default()).unwrap();
    let field = gaussian_field(1, 120, 150, 2.0).unwrap();
    let found = [checksum(&quantised(leaves.view())), checksum(&quantised(field.view()))];
    assert_eq!(found, [0x970a_3a20_c108_ea13, 0x6b89_e8d0_14e6_d6fe], "{found:#018x?}");
}

#[test]
fn another_seed_gives_another_picture() {
    let leaves = |seed| dead_leaves(seed, 40, 40, &DeadLeaves::default()).unwrap();
    let field = |seed| gaussian_field(seed, 40, 40, 2.0).unwrap();
    assert_ne!(leaves(1), leaves(2));
    assert_ne!(field(1), field(2));
}

/// Area common to two discs of radius `r` whose centres are `x` apart.
fn common_area(r: f64, x: f64) -> f64 {
    if x >= 2.0 * r { 0.0 } else { 2.0 * r * r * (x / (2.0 * r)).acos() - 0.5 * x * (4.0 * r * r - x * x).sqrt() }
}

#[test]
fn grey_levels_of_dead_leaves_correlate_as_their_covariogram_says() {
    // Two points see the same leaf with the probability g(x) / (2 g(0) - g(x)), g the mean common area of a leaf and
    // itself moved by x (Matheron 1968; Lee, Mumford & Huang 2001, section 3); only then are their greys related.
    let leaves = DeadLeaves { r_min_px: 5.0, r_max_px: 25.0, grey_min: 0.0, grey_max: 255.0 };
    let g = |x: f64| {
        let steps = 4000;
        let log_ratio = (leaves.r_max_px / leaves.r_min_px).ln();
        // Radii r^-3 dr = r^-2 d(ln r).
        (0..steps)
            .map(|i| leaves.r_min_px * ((f64::from(i) + 0.5) / f64::from(steps) * log_ratio).exp())
            .map(|r| common_area(r, x) / (r * r))
            .sum::<f64>()
    };
    let lags = [4, 8, 12, 20, 30];
    let mut products = [0.0; 5];
    let pictures = 12_u32;
    for seed in 0..u64::from(pictures) {
        let scene = dead_leaves(seed, 400, 400, &leaves).unwrap() - 127.5;
        for (lag, product) in lags.iter().zip(&mut products) {
            let mut sum = 0.0;
            for row in 0..400 {
                for col in 0..400 - lag {
                    sum += scene[[row, col]] * scene[[row, col + lag]];
                }
            }
            *product += sum / (400 * (400 - lag)) as f64;
        }
    }
    // Grey levels are uniform: variance 255^2 / 12.
    let variance = 255.0_f64.powi(2) / 12.0;
    for (lag, product) in lags.iter().zip(products) {
        let truth = g(*lag as f64) / (2.0 * g(0.0) - g(*lag as f64));
        let found = product / f64::from(pictures) / variance;
        assert!((found - truth).abs() < 0.03, "lag {lag}: {found} for {truth}");
    }
}

#[test]
fn dead_leaves_have_sharp_edges_without_aliasing() {
    // An edge of 2 px: some neighbours differ by half the range, and little power is left next to Nyquist.
    let scene = dead_leaves(7, 256, 256, &DeadLeaves::default()).unwrap();
    let power = periodogram(&scene);
    let mean = |low: f64, high: f64| {
        let (mut sum, mut count) = (0.0, 0.0);
        for k in 0..128 {
            let f = k as f64 / 256.0;
            if f >= low && f < high {
                sum += power[[0, k]] + power[[k, 0]];
                count += 2.0;
            }
        }
        sum / count
    };
    // Along a row the power of sharp edges falls as f^-2, from 0.1 to 0.46 to a twentieth, and aliasing fills it up. The
    // edge of 2 px takes it far lower.
    assert!(mean(0.42, 0.5) < 0.005 * mean(0.08, 0.12), "{} {}", mean(0.42, 0.5), mean(0.08, 0.12));
    let steepest = (0..255).map(|col| (scene[[128, col + 1]] - scene[[128, col]]).abs()).fold(0.0, f64::max);
    assert!(steepest > 50.0, "{steepest}");
}

#[test]
fn plane_wave_has_its_frequency_and_phase() {
    let wave = PlaneWave { amplitude: 10.0, u: 0.125, v: 0.25, phase_rad: PI / 3.0 };
    let scene = plane_waves(9, 17, 50.0, &[wave]).unwrap();
    assert!((scene[[0, 0]] - 55.0).abs() < 1e-12);
    assert!((scene[[0, 4]] - 45.0).abs() < 1e-12, "half a period along the columns");
    assert!((scene[[2, 0]] - 45.0).abs() < 1e-12, "half a period along the rows");
    assert!((scene[[8, 16]] - 55.0).abs() < 1e-12, "whole periods");
}

#[test]
fn impossible_scenes_are_refused_with_their_numbers() {
    let usual = DeadLeaves::default();
    assert!(matches!(dead_leaves(1, 0, 5, &usual), Err(Error::Size { rows: 0, cols: 5, .. })));
    assert!(matches!(dead_leaves(1, 5, usize::MAX, &usual), Err(Error::Size { .. })));
    assert!(matches!(gaussian_field(1, 1, 5, 2.0), Err(Error::Size { rows: 1, min: 2, .. })));
    assert!(matches!(gaussian_field(1, usize::MAX, 5, 2.0), Err(Error::Size { .. })));
    for leaves in [
        DeadLeaves { r_min_px: 0.5, ..usual },
        DeadLeaves { r_max_px: 2.0, ..usual },
        DeadLeaves { r_max_px: f64::NAN, ..usual },
        DeadLeaves { grey_min: -1.0, ..usual },
        DeadLeaves { grey_max: 256.0, ..usual },
        DeadLeaves { grey_min: 200.0, grey_max: 100.0, ..usual },
    ] {
        assert!(matches!(dead_leaves(1, 5, 5, &leaves), Err(Error::Parameter { .. })), "{leaves:?}");
    }
    for exponent in [-0.1, 7.0, f64::NAN] {
        assert!(matches!(gaussian_field(1, 5, 5, exponent), Err(Error::Parameter { .. })), "{exponent}");
    }
    let wave = PlaneWave { amplitude: f64::NAN, u: 0.1, v: 0.1, phase_rad: 0.0 };
    assert!(matches!(plane_waves(5, 5, 0.0, &[wave]), Err(Error::NotFinite { row: 0, col: 0, .. })));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn dead_leaves_cover_every_pixel_with_a_grey_between_the_bounds(
        seed: u64, rows in 1_usize..60, cols in 1_usize..60, r_min in 1.0..10.0, ratio in 1.0001..1000.0,
        darkest in 0.0..255.0, share in 0.0..=1.0,
    ) {
        let brightest = darkest + share * (255.0 - darkest);
        let leaves = DeadLeaves { r_min_px: r_min, r_max_px: r_min * ratio, grey_min: darkest, grey_max: brightest };
        let scene = dead_leaves(seed, rows, cols, &leaves).unwrap();
        prop_assert_eq!(scene.dim(), (rows, cols));
        prop_assert!(scene.iter().all(|&grey| grey > darkest - 1e-9 && grey < brightest + 1e-9));
    }
}

#[test]
fn bars_stand_upright_in_bands_with_soft_edges() {
    let print =
        Bars { width_min_px: 6.0, width_max_px: 20.0, height_min_px: 10.0, height_max_px: 30.0, ..Bars::default() };
    let scene = bars(4, 300, 400, &print).unwrap();
    assert_eq!(scene, bars(4, 300, 400, &print).unwrap());
    assert_ne!(scene, bars(5, 300, 400, &print).unwrap());
    assert!(scene.iter().all(|grey| (print.grey_min..=print.grey_max).contains(grey)));
    // An edge between two bars lies in two pixels, which hold a quarter and three quarters of the step.
    let row = scene.row(150).to_vec();
    let changes: Vec<usize> = (1..400).filter(|&col| row[col] != row[col - 1]).collect();
    let edges: Vec<usize> = changes.chunks(3).map(|chunk| chunk[0]).collect();
    assert_eq!(changes.len(), 3 * edges.len());
    for &col in edges.iter().filter(|&&col| col < 396) {
        let step = row[col + 2] - row[col - 1];
        assert!((row[col] - row[col - 1] - 0.25 * step).abs() < 1e-9);
        assert!((row[col + 1] - row[col - 1] - 0.75 * step).abs() < 1e-9);
    }
    // Widths of 6 to 20 pixels, rounded: 13 on the average, whose sum over 30 bars has a standard deviation of 22.
    let widths = edges.windows(2).map(|pair| pair[1] - pair[0]);
    assert!(widths.clone().all(|width| (5..=21).contains(&width)), "{edges:?}");
    assert!((20..42).contains(&edges.len()), "{}", edges.len());
    // Within a band all rows are alike; every 20 rows on the average another band begins.
    let new_rows = (1..300).filter(|&y| scene.row(y) != scene.row(y - 1)).count();
    assert!((3 * 10..=3 * 30).contains(&new_rows) && new_rows % 3 == 0, "{new_rows}");
}

#[test]
fn impossible_bars_are_refused() {
    for print in [
        Bars { width_min_px: 0.5, ..Bars::default() },
        Bars { width_max_px: 1.0, ..Bars::default() },
        Bars { height_min_px: f64::NAN, ..Bars::default() },
        Bars { height_max_px: 2e5, ..Bars::default() },
        Bars { grey_max: 256.0, ..Bars::default() },
    ] {
        assert!(matches!(bars(1, 10, 10, &print), Err(Error::Parameter { .. })), "{print:?}");
    }
    assert!(matches!(bars(1, 0, 10, &Bars::default()), Err(Error::Size { .. })));
}
