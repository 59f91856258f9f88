//! Rasterised line kernels: exact area weights, moments and symmetries.
#![allow(clippy::unwrap_used, reason = "a kernel that cannot be made fails the test")]

use blur_core::psf::{AcceleratedBlur, MAX_KERNEL_LENGTH_PX, accelerated_line_kernel, line_kernel};
use ndarray::{Array2, Axis, array};
use proptest::prelude::*;

/// Column and row of a pixel, counted from the middle one.
fn centred(kernel: &Array2<f64>) -> impl Iterator<Item = (f64, f64, f64)> + '_ {
    let (rows, columns) = kernel.dim();
    kernel
        .indexed_iter()
        .map(move |((r, c), &weight)| (c as f64 - (columns / 2) as f64, r as f64 - (rows / 2) as f64, weight))
}

/// Sum of the weights times a power of the position along the motion.
fn moment(kernel: &Array2<f64>, angle_deg: f64, power: i32) -> f64 {
    let (sin, cos) = angle_deg.to_radians().sin_cos();
    centred(kernel).map(|(x, y, weight)| weight * (x * cos - y * sin).powi(power)).sum()
}

fn greatest_difference(a: &Array2<f64>, b: &Array2<f64>) -> f64 {
    assert_eq!(a.dim(), b.dim());
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

/// The kernel of the opposite motion: turned by half a turn.
fn half_turn(kernel: &Array2<f64>) -> Array2<f64> {
    let mut turned = kernel.clone();
    turned.invert_axis(Axis(0));
    turned.invert_axis(Axis(1));
    turned
}

/// Turned by a quarter counter-clockwise as seen: the last column becomes the first row.
fn quarter_turn(kernel: &Array2<f64>) -> Array2<f64> {
    let mut turned = kernel.clone().reversed_axes();
    turned.invert_axis(Axis(0));
    turned
}

#[test]
fn lengths_on_an_axis_have_known_weights() {
    assert_eq!(line_kernel(1.0, 0.0).unwrap(), array![[1.0]]);
    assert_eq!(line_kernel(2.0, 0.0).unwrap(), array![[0.25, 0.5, 0.25]]);
    assert!(greatest_difference(&line_kernel(3.0, 0.0).unwrap(), &array![[1.0, 1.0, 1.0]].mapv(|w| w / 3.0)) < 1e-16);
    assert!(greatest_difference(&line_kernel(2.5, 180.0).unwrap(), &array![[0.3, 0.4, 0.3]]) < 1e-16);
    assert!(greatest_difference(&line_kernel(2.5, 90.0).unwrap(), &array![[0.3], [0.4], [0.3]]) < 1e-16);
    for length in [4_u32, 10, 56] {
        // An even length covers half of either end pixel.
        let (kernel, length) = (line_kernel(f64::from(length), 0.0).unwrap(), f64::from(length));
        assert_eq!(kernel.dim(), (1, length as usize + 1));
        for (k, &weight) in kernel.iter().enumerate() {
            let covered = if k == 0 || k == length as usize { 0.5 } else { 1.0 };
            assert!((weight - covered / length).abs() < 1e-15, "{length}: {weight}");
        }
    }
}

#[test]
fn a_diagonal_crosses_pixels_by_their_diagonals() {
    // Length 3 sqrt 2 at 45 degrees is three whole diagonals, rising to the right: up is towards row 0.
    let kernel = line_kernel(3.0 * 2.0_f64.sqrt(), 45.0).unwrap();
    let third = 1.0 / 3.0;
    let expected = array![[0.0, 0.0, third], [0.0, third, 0.0], [third, 0.0, 0.0]];
    assert!(greatest_difference(&kernel, &expected) < 1e-15, "{kernel}");
}

#[test]
fn a_slope_is_clipped_at_both_kinds_of_borders() {
    // Direction (4, 3)/5, length 5: from (-2, 1.5) to (2, -1.5) in column and row. Shares by hand: x = ±0.5 and ±1.5 at
    // p = 3/8, 5/8, 1/8, 7/8; y = ±0.5 at p = 1/2 ± 1/6. Beyond |y| = 1.5 lies nothing.
    let kernel = line_kernel(5.0, 0.75_f64.atan().to_degrees()).unwrap();
    let (eighth, twelfth) = (1.0 / 8.0, 1.0 / 12.0);
    let mut expected = Array2::zeros((3, 5));
    for (r, c, weight) in [
        (2, 0, eighth),
        (2, 1, 1.0 / 3.0 - eighth),
        (1, 1, 3.0 / 8.0 - 1.0 / 3.0),
        (1, 2, 0.25),
        (1, 3, 1.0 / 24.0),
        (0, 3, 2.5 * twelfth),
        (0, 4, eighth),
    ] {
        expected[[r, c]] = weight;
    }
    assert!(greatest_difference(&kernel, &expected) < 1e-15, "{kernel}");
}

#[test]
fn no_motion_is_a_single_one() {
    for angle in [0.0, 33.3, 90.0, -1e9] {
        assert_eq!(line_kernel(0.0, angle).unwrap(), array![[1.0]]);
        assert_eq!(accelerated_line_kernel(0.0, 1.0, angle).unwrap(), array![[1.0]]);
    }
}

#[test]
fn integer_lengths_on_an_axis_have_the_second_moment_of_the_sampled_box() {
    // Poisson's formula for the box of length L seen through a unit pixel: L²/12 + 1/12 - (1/2 pi²) Σ (-1)^{k(L+1)}/k²
    // over k != 0, which is (L² - 1)/12 for odd L and (L² + 2)/12 for even L.
    for length in 1..=80_u32 {
        let l = f64::from(length);
        let pixel = if length % 2 == 1 { -1.0 } else { 2.0 };
        let second = moment(&line_kernel(l, 0.0).unwrap(), 0.0, 2);
        assert!((second - (l * l + pixel) / 12.0).abs() < 1e-12 * l * l, "{length}: {second}");
    }
}

#[test]
fn long_lines_have_the_second_moment_of_line_and_pixel() {
    // Let e = round(p) - p be the rounding along a coordinate p = c tau. E[tau e] = Q(c L/2)/c + O(1/L) with the
    // periodic integral Q of e, Q(x) = 1/24 - (x - round(x))²/2; e itself adds the variance 1/12 of the
    // pixel along the motion.
    let pixel = |x: f64| 1.0 / 24.0 - 0.5 * (x - x.round()).powi(2);
    for (length, angle) in [(1500.3, 33.0), (2200.77, 20.0), (1999.5, 71.3), (3000.0, 118.0)] {
        let (sin, cos) = f64::to_radians(angle).sin_cos();
        let expected =
            length * length / 12.0 + 1.0 / 12.0 + 2.0 * (pixel(0.5 * length * cos) + pixel(0.5 * length * sin));
        let second = moment(&line_kernel(length, angle).unwrap(), angle, 2);
        assert!((second - expected).abs() < 5e-3, "{length} at {angle}: {}", second - expected);
    }
}

#[test]
fn accelerated_weights_are_the_time_spent_in_each_pixel() {
    // On an axis, length 5: the pixel borders are at whole positions on the path.
    for r in [-1.0, -0.4, 0.0, 1e-9, 0.7, 1.0] {
        let kernel = accelerated_line_kernel(5.0, r, 0.0).unwrap();
        let blur = AcceleratedBlur::new(5.0, r).unwrap();
        assert_eq!(kernel.dim(), (1, 5));
        for (k, &weight) in kernel.iter().enumerate() {
            let time = blur.cumulative(k as f64 + 1.0) - blur.cumulative(k as f64);
            assert!((weight - time).abs() < 1e-15, "r = {r}, pixel {k}");
        }
    }
    // From rest, x = 5 t²: sqrt(1/5) of the time in the first pixel, which is the tail of the arrow.
    let from_rest = |angle| accelerated_line_kernel(5.0, 1.0, angle).unwrap();
    let first = 0.2_f64.sqrt();
    for (angle, tail) in [(0.0, [0, 0]), (90.0, [4, 0]), (180.0, [0, 4]), (270.0, [0, 0]), (-90.0, [0, 0])] {
        assert!((from_rest(angle)[tail] - first).abs() < 1e-15, "{angle}");
    }
}

#[test]
fn the_centroid_of_an_accelerated_kernel_lags_by_a_sixth_of_ratio_times_length() {
    // The mean of s(t) = L[(1-r) t + r t²] is L (1/2 - r/6). Each coordinate is rounded to a pixel; with the integral Q
    // of the rounding, at most 1/12, and a monotone density of at most 1/(L (1-|r|)), integration by parts bounds what
    // either rounding adds along the motion by 3/12 of that density.
    for (length, r, angle) in [(900.0_f64, 0.5_f64, 25.0), (1200.5, -0.8, 130.0), (800.0, 0.3, 301.0)] {
        let mean = moment(&accelerated_line_kernel(length, r, angle).unwrap(), angle, 1);
        let bound = 0.5 / (length * (1.0 - r.abs()));
        assert!((mean + r * length / 6.0).abs() < bound, "{length} {r} {angle}: {}", mean + r * length / 6.0);
    }
}

#[test]
fn kernels_out_of_range_are_refused() {
    for length in [-1.0, f64::NAN, f64::INFINITY, MAX_KERNEL_LENGTH_PX * 1.01] {
        assert!(line_kernel(length, 0.0).is_err(), "{length}");
    }
    assert!(line_kernel(3.0, f64::NAN).is_err());
    assert!(accelerated_line_kernel(3.0, 1.1, 0.0).is_err());
    assert!(accelerated_line_kernel(3.0, f64::NAN, 0.0).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn weights_are_shares(length in 0.0..120.0, r in -1.0..=1.0, angle in -720.0..720.0) {
        for kernel in [line_kernel(length, angle).unwrap(), accelerated_line_kernel(length, r, angle).unwrap()] {
            prop_assert!((kernel.sum() - 1.0).abs() < 1e-14, "{}", kernel.sum());
            prop_assert!(kernel.iter().all(|&weight| weight >= 0.0));
        }
    }

    #[test]
    fn kernels_are_odd_and_just_large_enough(length in 0.0..120.0, angle in 0.0..360.0) {
        let kernel = line_kernel(length, angle).unwrap();
        let (rows, columns) = kernel.dim();
        prop_assert!(rows % 2 == 1 && columns % 2 == 1);
        let (sin, cos) = angle.to_radians().sin_cos();
        for (pixels, extent) in [(columns, length * cos.abs()), (rows, length * sin.abs())] {
            // The pixels hold the line, and two fewer would not.
            prop_assert!(pixels as f64 >= extent - 1e-9);
            prop_assert!(pixels == 1 || pixels as f64 - 2.0 < extent);
        }
    }

    #[test]
    fn a_uniform_kernel_is_symmetric_about_its_middle(length in 0.0..120.0, angle in 0.0..360.0) {
        let kernel = line_kernel(length, angle).unwrap();
        prop_assert!(greatest_difference(&kernel, &half_turn(&kernel)) < 1e-14);
        for power in [1, 3] {
            prop_assert!(moment(&kernel, angle, power).abs() < 1e-13 * (1.0 + length.powi(power)));
        }
    }

    #[test]
    fn turning_the_motion_turns_the_kernel(length in 0.0..120.0, r in -1.0..=1.0, angle in 0.0..360.0) {
        let kernel = accelerated_line_kernel(length, r, angle).unwrap();
        let later = accelerated_line_kernel(length, r, angle + 90.0).unwrap();
        prop_assert!(greatest_difference(&quarter_turn(&kernel), &later) < 1e-12);
        // Braking along the opposite arrow is the same streak.
        let backwards = accelerated_line_kernel(length, -r, angle + 180.0).unwrap();
        prop_assert!(greatest_difference(&kernel, &backwards) < 1e-7);
    }

    #[test]
    fn no_pixel_gets_more_than_its_diagonal(length in 2.0..120.0, angle in 0.0..360.0) {
        let kernel = line_kernel(length, angle).unwrap();
        let (sin, cos) = angle.to_radians().sin_cos();
        let longest = 1.0 / sin.abs().max(cos.abs());
        prop_assert!(kernel.iter().all(|&weight| weight * length <= longest + 1e-12));
    }
}
