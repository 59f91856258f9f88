//! Promises of the sample.
#![allow(clippy::unwrap_used)]

use blur_sim::sample::{ANGLE_DEG, LENGTH_PX, SIDE_PX, sample_motion, sample_picture};
use rustfft::{FftPlanner, num_complex::Complex};
use std::f64::consts::TAU;

#[test]
fn sample_is_the_same_on_every_machine() {
    let picture = sample_picture().unwrap();
    assert_eq!(picture.dim(), (SIDE_PX, SIDE_PX));
    // FNV-1a, 64 bit.
    let hash = picture
        .iter()
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
    assert_eq!(hash, 0x04b8_4abf_2152_5c47, "{hash:#018x}");
}

#[test]
fn sample_uses_the_grey_levels_without_much_clipping() {
    let picture = sample_picture().unwrap();
    let clipped = picture.iter().filter(|&&value| value == 0 || value == 255).count();
    assert!(clipped < picture.len() / 1000, "{clipped}");
    let mean = picture.iter().map(|&x| f64::from(x)).sum::<f64>() / picture.len() as f64;
    assert!((90.0..165.0).contains(&mean), "{mean}");
}

#[test]
fn spectrum_of_the_sample_has_the_zeros_of_its_motion() {
    let n = SIDE_PX;
    let picture = sample_picture().unwrap();
    let hann = |i: usize| 0.5 - 0.5 * (TAU * (i as f64 + 0.5) / n as f64).cos();
    let mut rows: Vec<Complex<f64>> = picture
        .indexed_iter()
        .map(|((row, col), &value)| Complex::new((f64::from(value) - 128.0) * hann(row) * hann(col), 0.0))
        .collect();
    let fft = FftPlanner::new().plan_fft_forward(n);
    fft.process(&mut rows);
    let mut columns: Vec<Complex<f64>> = (0..n * n).map(|i| rows[(i % n) * n + i / n]).collect();
    fft.process(&mut columns);
    // Power at s = k / L (zeros) and at s = (k + 1/2) / L (between), near the axis across the motion.
    let (sin, cos) = ANGLE_DEG.to_radians().sin_cos();
    let (mut zero, mut between) = ((0.0, 0.0), (0.0, 0.0));
    for (i, value) in columns.iter().enumerate() {
        let signed = |i: usize| if 2 * i > n { i as f64 - n as f64 } else { i as f64 } / n as f64;
        let (u, v) = (signed(i / n), signed(i % n));
        let cycles = (LENGTH_PX * (u * cos - v * sin)).abs();
        if (0.8..2.2).contains(&cycles) && u.hypot(v) < 0.2 {
            let off = (cycles - cycles.round()).abs();
            let bin = if off < 0.04 { &mut zero } else { &mut between };
            if !(0.04..0.4).contains(&off) {
                *bin = (bin.0 + value.norm_sqr(), bin.1 + 1.0);
            }
        }
    }
    let ratio = (zero.0 / zero.1) / (between.0 / between.1);
    assert!(ratio < 0.08, "{ratio}");
    assert_eq!(sample_motion().unwrap().accel_ratio(), 0.0);
}
