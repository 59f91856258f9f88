//! Promises of the likelihood of a part of a picture of any shape.

#![allow(clippy::unwrap_used, clippy::cast_possible_truncation, clippy::cast_precision_loss)]

use blur_core::Error;
use blur_core::estimate::joint::Whittle;
use blur_core::estimate::{JointEstimator, MotionBlur, Settings, Status};
use blur_core::image::Window;
use ndarray::{Array2, ArrayView2};

/// Uniform pixels in `[0, 1)`, the same on every platform (splitmix64).
fn noise(seed: u64, dim: (usize, usize)) -> Array2<f32> {
    let mut state = seed;
    Array2::from_shape_simple_fn(dim, || {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 40) as f32 / (1u32 << 24) as f32
    })
}

/// White noise moved over `steps` pixels along the rows: exactly a uniform blur of that length at whole pixels.
fn moved(seed: u64, (rows, columns): (usize, usize), steps: usize) -> Array2<f32> {
    let scene = noise(seed, (rows, columns + steps));
    Array2::from_shape_fn((rows, columns), |(r, c)| {
        let sum: f32 = (0..steps).map(|i| scene[[r, c + i]]).sum();
        (255.0 * sum / steps as f32).round()
    })
}

fn measure(image: ArrayView2<'_, f32>, weights: ArrayView2<'_, f32>) -> MotionBlur {
    Whittle::new(&Settings::default()).estimate_weighted(image, weights).unwrap()
}

/// An ellipse of these half axes about the middle, its edge a raised cosine.
fn ellipse((rows, columns): (usize, usize), (half_rows, half_columns): (f64, f64)) -> Array2<f32> {
    Array2::from_shape_fn((rows, columns), |(r, c)| {
        let y = (r as f64 + 0.5 - rows as f64 / 2.0) / half_rows;
        let x = (c as f64 + 0.5 - columns as f64 / 2.0) / half_columns;
        let edge = (1.0 - x.hypot(y)).clamp(0.0, 0.5);
        (0.5 - 0.5 * (2.0 * std::f64::consts::PI * edge).cos()) as f32
    })
}

#[test]
fn weights_of_a_hann_window_are_that_window() {
    let mut settings = Settings::default();
    settings.window = Some(Window::Hann);
    for dim in [(128, 128), (96, 160)] {
        let image = moved(3, dim, 11);
        let (rows, columns) = (Window::Hann.weights(dim.0), Window::Hann.weights(dim.1));
        let weights = Array2::from_shape_fn(dim, |(r, c)| rows[r] * columns[c]);
        let windowed = Whittle::new(&settings).estimate(image.view()).unwrap();
        let weighted = measure(image.view(), weights.view());
        // Both round in single precision, and the search stops at a gain of 0.02 in log-likelihood.
        let (stated, other) = (windowed.length_std_px.unwrap(), weighted.length_std_px.unwrap());
        assert!((weighted.length_px - windowed.length_px).abs() < 0.02 * stated, "{windowed:?} {weighted:?}");
        assert!((other / stated - 1.0).abs() < 0.01, "{stated} {other}");
        let turn = weighted.angle.minus_deg(windowed.angle).abs();
        assert!(turn < 0.02 * windowed.angle_std_deg.unwrap(), "{windowed:?} {weighted:?}");
    }
}

#[test]
fn what_has_no_weight_has_no_influence() {
    let image = moved(5, (160, 200), 13);
    let weights = ellipse((160, 200), (60.0, 80.0));
    let mut other = noise(6, (160, 200)).mapv(|value| 255.0 * value);
    for ((out, &pixel), &weight) in other.iter_mut().zip(&image).zip(&weights) {
        if weight > 0.0 {
            *out = pixel;
        }
    }
    assert_eq!(measure(image.view(), weights.view()), measure(other.view(), weights.view()));
}

#[test]
fn a_part_moved_over_a_sharp_background_is_measured_within_its_uncertainty() {
    let dim = (192, 240);
    let weights = ellipse(dim, (80.0, 100.0));
    let (mut length_squares, mut angle_squares, mut count) = (0.0, 0.0, 0.0);
    let mut estimator = Whittle::new(&Settings::default());
    for seed in 0..24_u64 {
        let steps = 7 + (seed as usize * 5) % 17;
        let mut image = noise(100 + seed, dim).mapv(|value| (255.0 * value).round());
        for ((out, &pixel), &weight) in image.iter_mut().zip(&moved(seed, dim, steps)).zip(&weights) {
            if weight > 0.0 {
                *out = pixel;
            }
        }
        let found = estimator.estimate_weighted(image.view(), weights.view()).unwrap();
        assert_eq!(found.status, Status::Ok, "{steps} px: {found:?}");
        let z = (found.length_px - steps as f64) / found.length_std_px.unwrap();
        let turn = (found.angle.deg() + 90.0).rem_euclid(180.0) - 90.0;
        let z_angle = turn / found.angle_std_deg.unwrap();
        assert!(z.abs() < 4.0 && z_angle.abs() < 4.0, "{steps} px: {z} {z_angle} {found:?}");
        length_squares += z * z;
        angle_squares += z_angle * z_angle;
        count += 1.0;
    }
    // The root mean square of 24 standard normal deviations is within this in 99.9 % of all cases.
    for squares in [length_squares, angle_squares] {
        let rms: f64 = f64::sqrt(squares / count);
        assert!((0.5..1.5).contains(&rms), "{rms}");
    }
}

#[test]
fn an_abrupt_edge_is_worse_than_a_soft_one() {
    // The part stands out from its surroundings by far more than its own contrast: nothing of them is under the weights,
    // but the weights' own edge leaks what the moved part shows at low frequencies.
    let dim = (192, 192);
    let soft = ellipse(dim, (90.0, 90.0));
    let hard = soft.mapv(|weight| if weight > 0.0 { 1.0 } else { 0.0 });
    let (mut soft_miss, mut hard_miss) = (0.0, 0.0);
    for seed in 0..8_u64 {
        let mut image = moved(40 + seed, dim, 19);
        // A slope of light over the part, as a lamp makes it.
        for ((r, c), pixel) in image.indexed_iter_mut() {
            *pixel += 0.7 * (r as f32 + 0.5 * c as f32);
        }
        let miss = |found: &MotionBlur| (found.length_px - 19.0).abs();
        soft_miss += miss(&measure(image.view(), soft.view()));
        hard_miss += miss(&measure(image.view(), hard.view()));
    }
    assert!(soft_miss < 0.5 * hard_miss, "{soft_miss} {hard_miss}");
}

#[test]
fn weights_that_cannot_be_used_are_refused() {
    let image = moved(1, (64, 80), 9);
    let refusal = |weights: Array2<f32>| {
        Whittle::new(&Settings::default()).estimate_weighted(image.view(), weights.view()).unwrap_err()
    };
    let expected = Error::WeightSize { width: 80, height: 64, other_width: 64, other_height: 80 };
    assert_eq!(refusal(Array2::ones((80, 64))), expected);
    assert_eq!(refusal(Array2::zeros((64, 80))), Error::NoWeight { width: 80, height: 64 });
    for bad in [-0.1, 1.1, f32::INFINITY] {
        let mut weights = Array2::ones((64, 80));
        weights[[5, 7]] = bad;
        assert_eq!(refusal(weights), Error::Weight { row: 5, column: 7, value: bad });
    }
    let mut weights = Array2::ones((64, 80));
    weights[[0, 1]] = f32::NAN;
    assert!(matches!(refusal(weights), Error::Weight { row: 0, column: 1, .. }));
    let mut narrow = Array2::zeros((64, 80));
    for row in 10..25 {
        narrow.row_mut(row).fill(1.0);
    }
    let error = refusal(narrow);
    assert!(matches!(error, Error::RegionTooNarrow { extent_px, min: 32 } if extent_px == 15.0), "{error}");
    // All of one grey where there is weight.
    let flat = Array2::from_shape_fn((64, 80), |(_, c)| if c < 50 { 7.0 } else { c as f32 });
    let weights = Array2::from_shape_fn((64, 80), |(_, c)| if c < 40 { 1.0 } else { 0.0 });
    let error = Whittle::new(&Settings::default()).estimate_weighted(flat.view(), weights.view()).unwrap_err();
    assert_eq!(error, Error::Constant { value: 7.0 });
}
