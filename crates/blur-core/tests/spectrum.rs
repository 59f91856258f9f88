//! `Dct2`, `Dft2` and its inverse against naive transforms that follow the definitions term by term, in `f64`.
//!
//! The naive transforms are proved first, on pairs that are known on paper.

use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

use blur_core::spectrum::{Dct2, Dft2, InverseDft2};
use ndarray::Array2;
use rustfft::num_complex::{Complex32, Complex64};

/// Rows and columns: powers of two, odd, prime, rectangular both ways, and the degenerate ones.
const SIZES: [(usize, usize); 17] = [
    (32, 32),
    (33, 37),
    (31, 48),
    (48, 31),
    (64, 47),
    (128, 97),
    (97, 128),
    (101, 103),
    (60, 90),
    (512, 360),
    (211, 509),
    (2, 3),
    (3, 2),
    (1, 5),
    (5, 1),
    (1, 1),
    (2, 2),
];

/// Relative to the rms coefficient. The module promises 1e-6 at all sizes in use; these sizes reach 2.8e-7 at worst.
const MOST_RMS_ERROR: f64 = 4e-7;

/// Numbers in [-1, 1) from `SplitMix64` (Steele, Lea & Flood 2014).
fn random_picture(seed: u64, (rows, columns): (usize, usize)) -> Array2<f32> {
    let mut state = seed;
    Array2::from_shape_simple_fn((rows, columns), || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1_u32 << 23) as f32 - 1.0
    })
}

/// `C_m cos(pi (2 i + 1) m / 2 n)`, the factors of thesis eq. 4.8.
fn dct_factor(m: usize, i: usize, n: usize) -> f64 {
    let c = if m == 0 { FRAC_1_SQRT_2 } else { 1.0 };
    // The angle modulo its period 4 n in integers: large products would lose digits.
    c * (PI * ((2 * i + 1) * m % (4 * n)) as f64 / (2 * n) as f64).cos()
}

/// Thesis eq. 4.8, one axis after the other.
fn naive_dct(picture: &Array2<f64>) -> Array2<f64> {
    let (rows, columns) = picture.dim();
    let along_row = Array2::from_shape_fn((columns, columns), |(i, n)| dct_factor(n, i, columns));
    let along_column = Array2::from_shape_fn((rows, rows), |(m, i)| dct_factor(m, i, rows));
    along_column.dot(picture).dot(&along_row) * (2.0 / ((rows * columns) as f64).sqrt())
}

/// `exp(-2 pi i k j / n)`.
fn dft_factor(k: usize, j: usize, n: usize) -> Complex64 {
    Complex64::from_polar(1.0, -TAU * (k * j % n) as f64 / n as f64)
}

/// The whole spectrum, `rows` x `columns`, without a factor.
fn naive_dft(picture: &Array2<f64>) -> Array2<Complex64> {
    let (rows, columns) = picture.dim();
    let along_row = Array2::from_shape_fn((columns, columns), |(i, k)| dft_factor(k, i, columns));
    let along_column = Array2::from_shape_fn((rows, rows), |(j, i)| dft_factor(j, i, rows));
    along_column.dot(&picture.mapv(Complex64::from)).dot(&along_row)
}

fn fast_dct(transform: &mut Dct2, picture: &Array2<f32>) -> Array2<f32> {
    transform.input().assign(picture);
    transform.transform().to_owned()
}

fn fast_dft(transform: &mut Dft2, picture: &Array2<f32>) -> Array2<Complex64> {
    transform.input().assign(picture);
    transform.transform().mapv(|x| Complex64::new(f64::from(x.re), f64::from(x.im)))
}

fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    let (mut sum, mut n) = (0.0, 0);
    for value in values {
        sum += value * value;
        n += 1;
    }
    (sum / f64::from(n)).sqrt()
}

fn assert_all_near(found: &Array2<f64>, expected: &Array2<f64>, tolerance: f64) {
    assert_eq!(found.dim(), expected.dim());
    for (index, value) in found.indexed_iter() {
        assert!((value - expected[index]).abs() < tolerance, "{index:?}: {value}, expected {}", expected[index]);
    }
}

mod naive {
    use super::*;

    #[test]
    fn dct_is_the_double_sum_of_its_definition() {
        for dim in [(4, 4), (5, 3), (1, 7), (6, 1)] {
            let picture = random_picture(3, dim).mapv(f64::from);
            let (rows, columns) = dim;
            let double_sum = Array2::from_shape_fn(dim, |(m, n)| {
                let c = |k: usize| if k == 0 { 1.0 / 2.0_f64.sqrt() } else { 1.0 };
                let mut sum = 0.0;
                for ((x, y), g) in picture.indexed_iter() {
                    sum += g
                        * (PI * (2.0 * x as f64 + 1.0) * m as f64 / (2.0 * rows as f64)).cos()
                        * (PI * (2.0 * y as f64 + 1.0) * n as f64 / (2.0 * columns as f64)).cos();
                }
                2.0 / ((rows * columns) as f64).sqrt() * c(m) * c(n) * sum
            });
            assert_all_near(&naive_dct(&picture), &double_sum, 1e-12);
        }
    }

    #[test]
    fn dct_of_a_constant_is_its_first_coefficient() {
        // Orthonormal: 7 in M N pixels has the norm 7 sqrt(M N), all of it at [0, 0].
        let mut expected = Array2::zeros((6, 9));
        expected[[0, 0]] = 7.0 * 54.0_f64.sqrt();
        assert_all_near(&naive_dct(&Array2::from_elem((6, 9), 7.0)), &expected, 1e-12);
    }

    #[test]
    fn dct_of_a_basis_function_is_one_coefficient() {
        for (m, n) in [(0, 1), (3, 0), (2, 5), (6, 10)] {
            let (rows, columns) = (7, 11);
            let basis = Array2::from_shape_fn((rows, columns), |(i, j)| {
                2.0 / 77.0_f64.sqrt() * dct_factor(m, i, rows) * dct_factor(n, j, columns)
            });
            let mut expected = Array2::zeros((rows, columns));
            expected[[m, n]] = 1.0;
            assert_all_near(&naive_dct(&basis), &expected, 1e-13);
        }
    }

    #[test]
    fn dct_of_a_delta_is_the_basis_at_its_place() {
        let mut delta = Array2::zeros((4, 5));
        delta[[2, 1]] = 1.0;
        // By hand at [1, 2]: 2/sqrt 20 cos(5 pi / 8) cos(3 pi / 5); at [0, 0]: 1/sqrt 20.
        let found = naive_dct(&delta);
        let by_hand = 2.0 / 20.0_f64.sqrt() * (5.0 * PI / 8.0).cos() * (6.0 * PI / 10.0).cos();
        assert!((found[[1, 2]] - by_hand).abs() < 1e-14);
        assert!((found[[0, 0]] - 1.0 / 20.0_f64.sqrt()).abs() < 1e-14);
    }

    #[test]
    fn dct_keeps_the_norm() {
        let picture = random_picture(5, (13, 22)).mapv(f64::from);
        let ratio = rms(naive_dct(&picture)) / rms(picture);
        assert!((ratio - 1.0).abs() < 1e-13, "{ratio}");
    }

    #[test]
    fn dft_of_a_shifted_delta_is_a_wave_of_modulus_one() {
        let (rows, columns) = (8, 5);
        let mut delta = Array2::zeros((rows, columns));
        delta[[3, 2]] = 1.0;
        for ((j, k), value) in naive_dft(&delta).indexed_iter() {
            let phase = -TAU * (3.0 * j as f64 / rows as f64 + 2.0 * k as f64 / columns as f64);
            assert!((value - Complex64::from_polar(1.0, phase)).norm() < 1e-13, "[{j}, {k}]");
        }
    }

    #[test]
    fn dft_of_a_constant_is_its_sum_and_of_a_cosine_two_halves() {
        let (rows, columns) = (6, 10);
        let picture = Array2::from_shape_fn((rows, columns), |(i, j)| {
            2.0 + 3.0 * (TAU * (i as f64 / rows as f64 + 4.0 * j as f64 / columns as f64)).cos()
        });
        for ((j, k), value) in naive_dft(&picture).indexed_iter() {
            let expected = match (j, k) {
                (0, 0) => 120.0,
                (1, 4) | (5, 6) => 90.0,
                _ => 0.0,
            };
            assert!((value - Complex64::from(expected)).norm() < 1e-11, "[{j}, {k}]: {value}");
        }
    }

    #[test]
    fn dft_keeps_the_norm_times_the_root_of_the_pixels() {
        let picture = random_picture(6, (9, 14)).mapv(f64::from);
        let ratio = rms(naive_dft(&picture).iter().map(|x| x.norm())) / rms(picture) / 126.0_f64.sqrt();
        assert!((ratio - 1.0).abs() < 1e-13, "{ratio}");
    }
}

#[test]
fn dct_is_exact_to_rounding_at_every_kind_of_size() {
    for dim in SIZES {
        let picture = random_picture(11, dim);
        let exact = naive_dct(&picture.mapv(f64::from));
        let fast = fast_dct(&mut Dct2::new(dim.0, dim.1), &picture);
        assert_eq!(fast.dim(), dim);
        let error = rms(fast.iter().zip(&exact).map(|(&a, b)| f64::from(a) - b)) / rms(exact.iter().copied());
        println!("dct {dim:?} {error:.1e}");
        assert!(error < MOST_RMS_ERROR, "{dim:?}: {error:e}");
    }
}

#[test]
fn dft_is_exact_to_rounding_at_every_kind_of_size() {
    for dim in SIZES {
        let picture = random_picture(12, dim);
        let exact = naive_dft(&picture.mapv(f64::from));
        let fast = fast_dft(&mut Dft2::new(dim.0, dim.1), &picture);
        assert_eq!(fast.dim(), (dim.0, dim.1 / 2 + 1));
        let error =
            rms(fast.indexed_iter().map(|(index, a)| (a - exact[index]).norm())) / rms(exact.iter().map(|x| x.norm()));
        println!("dft {dim:?} {error:.1e}");
        assert!(error < MOST_RMS_ERROR, "{dim:?}: {error:e}");
    }
}

#[test]
fn the_half_that_a_dft_leaves_out_is_its_conjugate() {
    for dim in [(32, 32), (33, 37), (31, 48)] {
        let (rows, columns) = dim;
        let picture = random_picture(13, dim);
        let exact = naive_dft(&picture.mapv(f64::from));
        let half = fast_dft(&mut Dft2::new(rows, columns), &picture);
        let scale = rms(exact.iter().map(|x| x.norm()));
        for ((j, k), value) in exact.indexed_iter().filter(|((_, k), _)| *k > columns / 2) {
            let mirrored = half[[(rows - j) % rows, columns - k]].conj();
            assert!((mirrored - value).norm() < 1e-5 * scale, "{dim:?} [{j}, {k}]");
        }
    }
}

#[test]
fn the_inverse_dft_is_exact_to_rounding_at_every_kind_of_size() {
    for dim in SIZES {
        let (rows, columns) = dim;
        let mut inverse = InverseDft2::new(rows, columns);
        assert_eq!(inverse.dim(), dim);
        let picture = random_picture(15, dim).mapv(f64::from);
        let exact = naive_dft(&picture);
        // Twice: the first transform destroys what it was given.
        for _ in 0..2 {
            for ((j, k), value) in inverse.input().indexed_iter_mut() {
                *value = Complex32::new(exact[[j, k]].re as f32, exact[[j, k]].im as f32);
            }
            let back = inverse.transform();
            assert_eq!(back.dim(), dim);
            let error = rms(back.iter().zip(&picture).map(|(&a, b)| f64::from(a) - b)) / rms(picture.iter().copied());
            assert!(error < MOST_RMS_ERROR, "{dim:?}: {error:e}");
        }
    }
}

#[test]
fn dct_has_the_orthonormal_scale() {
    for dim in SIZES {
        let (rows, columns) = dim;
        let mut transform = Dct2::new(rows, columns);
        // A constant 1 has only the coefficient [0, 0] = 2/sqrt(M N) C_0 C_0 M N = sqrt(M N).
        let constant = fast_dct(&mut transform, &Array2::ones(dim));
        let expected = ((rows * columns) as f64).sqrt();
        assert!((f64::from(constant[[0, 0]]) / expected - 1.0).abs() < 1e-6, "{dim:?}: {}", constant[[0, 0]]);
        // And the norm of any picture is that of its coefficients.
        let picture = random_picture(14, dim);
        let norms = rms(fast_dct(&mut transform, &picture).iter().map(|&x| f64::from(x)))
            / rms(picture.iter().map(|&x| f64::from(x)));
        assert!((norms - 1.0).abs() < 1e-6, "{dim:?}: {norms}");
    }
    // Both factors C at once: one pixel at the corner of 2 x 2 gives 1/2 everywhere but for cos(pi / 4) sqrt 2 = 1.
    let mut corner = Array2::zeros((2, 2));
    corner[[0, 0]] = 1.0;
    for coefficient in fast_dct(&mut Dct2::new(2, 2), &corner) {
        assert!((coefficient - 0.5).abs() < 1e-7, "{coefficient}");
    }
}

#[test]
fn dft_has_no_factor() {
    for dim in SIZES {
        let spectrum = fast_dft(&mut Dft2::new(dim.0, dim.1), &Array2::ones(dim));
        let pixels = (dim.0 * dim.1) as f64;
        assert!((spectrum[[0, 0]].re / pixels - 1.0).abs() < 1e-6, "{dim:?}: {}", spectrum[[0, 0]]);
    }
}

#[test]
fn a_plan_gives_every_picture_the_answer_of_a_new_plan() {
    for dim in [(32, 32), (33, 37), (64, 47), (1, 5)] {
        let (mut dct, mut dft) = (Dct2::new(dim.0, dim.1), Dft2::new(dim.0, dim.1));
        for seed in [21, 22, 23, 21] {
            let picture = random_picture(seed, dim);
            assert_eq!(fast_dct(&mut dct, &picture), fast_dct(&mut Dct2::new(dim.0, dim.1), &picture), "{dim:?}");
            assert_eq!(fast_dft(&mut dft, &picture), fast_dft(&mut Dft2::new(dim.0, dim.1), &picture), "{dim:?}");
        }
        assert_eq!((dct.dim(), dft.dim()), (dim, dim));
    }
}
