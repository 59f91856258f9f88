//! The uniform and the accelerated blur against adaptive quadrature of the integrals that define them.

use std::f64::consts::PI;

use blur_core::psf::{AcceleratedBlur, UniformBlur, fresnel, spherical_bessel};
use proptest::prelude::*;
use rustfft::num_complex::Complex64;

const RATIOS: [f64; 22] = [
    0.0,
    1e-15,
    -1e-15,
    1e-12,
    -1e-12,
    1e-9,
    1e-6,
    -1e-6,
    1e-3,
    -1e-3,
    1e-2,
    0.03,
    -0.1,
    0.25,
    0.5,
    -0.5,
    0.9,
    -0.99,
    0.999_999,
    -0.999_999_999,
    1.0,
    -1.0,
];

/// Frequencies in cycles per path, on both sides of every change of form, and to beyond 60.
fn frequencies() -> Vec<f64> {
    let mut z = vec![0.0, 1e-12, 1e-9, 1e-6, 1e-3, 0.01, 0.1, 0.2, 0.249_999, 0.25, 0.250_001, 0.3, 0.5, 1.0];
    z.extend((0..80).map(|k| 0.77 * f64::from(k) + 0.013));
    z.extend([100.0, 1000.0]);
    z
}

/// A few roundings, and that of the phase `2 pi z`.
fn bound(z: f64) -> f64 {
    2e-14 + 2e-16 * z.abs()
}

/// Gauss-Kronrod 7-15 on `[a, b]`, halved until both rules agree to `tolerance`.
fn adaptive(f: &impl Fn(f64) -> Complex64, a: f64, b: f64, tolerance: f64) -> Complex64 {
    // QUADPACK, dqk15: node, Kronrod weight, Gauss weight.
    const RULE: [(f64, f64, f64); 8] = [
        (0.991_455_371_120_812_6, 0.022_935_322_010_529_224, 0.0),
        (0.949_107_912_342_758_5, 0.063_092_092_629_978_55, 0.129_484_966_168_869_7),
        (0.864_864_423_359_769_1, 0.104_790_010_322_250_18, 0.0),
        (0.741_531_185_599_394_4, 0.140_653_259_715_525_92, 0.279_705_391_489_276_64),
        (0.586_087_235_467_691_1, 0.169_004_726_639_267_9, 0.0),
        (0.405_845_151_377_397_2, 0.190_350_578_064_785_4, 0.381_830_050_505_118_9),
        (0.207_784_955_007_898_47, 0.204_432_940_075_298_9, 0.0),
        (0.0, 0.209_482_141_084_727_82, 0.417_959_183_673_469_4),
    ];
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    let (mut kronrod, mut gauss) = (Complex64::ZERO, Complex64::ZERO);
    for (x, k, g) in RULE {
        let pair = if x == 0.0 { f(middle) } else { f(middle - half * x) + f(middle + half * x) };
        kronrod += pair * (k * half);
        gauss += pair * (g * half);
    }
    if (kronrod - gauss).norm() < tolerance || half < 1e-6 {
        kronrod
    } else {
        adaptive(f, a, middle, 0.5 * tolerance) + adaptive(f, middle, b, 0.5 * tolerance)
    }
}

/// `∫ e^{-2 pi i z [(1-r) t + r t²]} dt` over the exposure: free of the singularity that the PSF has at `|r| = 1`.
fn time_integral(z: f64, r: f64) -> Complex64 {
    let integrand = |t: f64| Complex64::from_polar(1.0, -2.0 * PI * z * ((1.0 - r) * t + r * t * t));
    let panels = 4 + z.abs() as u32;
    let edge = |k: u32| f64::from(k) / f64::from(panels);
    (0..panels).map(|k| adaptive(&integrand, edge(k), edge(k + 1), 1e-15)).sum()
}

fn real(f: impl Fn(f64) -> f64, a: f64, b: f64) -> f64 {
    adaptive(&|x| Complex64::new(f(x), 0.0), a, b, 1e-14).re
}

#[test]
fn accelerated_transfer_is_its_defining_integral() {
    let length = 0.37;
    for r in RATIOS {
        let blur = AcceleratedBlur::new(length, r).unwrap();
        for z in frequencies().into_iter().flat_map(|z| [z, -z]) {
            let error = (blur.transfer(z / length) - time_integral(z, r)).norm();
            assert!(error < bound(z), "r = {r}, z = {z}: off by {error:e}");
        }
    }
}

#[test]
fn accelerated_cosine_and_sine_transforms_are_their_defining_integrals() {
    let length = 55.0;
    for r in RATIOS {
        let blur = AcceleratedBlur::new(length, r).unwrap();
        for z in frequencies().into_iter().flat_map(|z| [z, -z]) {
            let omega = 2.0 * PI * z / length;
            let found = Complex64::new(blur.cosine_transform(omega), -blur.sine_transform(omega));
            let error = (found - time_integral(z, r)).norm();
            assert!(error < bound(z), "r = {r}, z = {z}: off by {error:e}");
        }
    }
}

#[test]
fn fresnel_and_bessel_forms_agree() {
    for r in RATIOS {
        let blur = AcceleratedBlur::new(1.0, r).unwrap();
        for u in frequencies() {
            let omega = 2.0 * PI * u;
            let by_fresnel = Complex64::new(blur.cosine_transform(omega), -blur.sine_transform(omega));
            assert!((blur.transfer(u) - by_fresnel).norm() < bound(u), "r = {r}, u = {u}");
        }
    }
}

#[test]
fn accelerated_psf_is_the_density_of_the_time() {
    let length = 12.5;
    for r in RATIOS {
        let blur = AcceleratedBlur::new(length, r).unwrap();
        let position = |t: f64| length * ((1.0 - r) * t + r * t * t);
        for k in 0..=20 {
            let t = f64::from(k) / 20.0;
            // At |r| = 1 the position has no first derivative left at one end: the time is known to sqrt(rounding).
            let bound = if (0.01..0.99).contains(&t) { 1e-14 } else { 1e-7 };
            assert!((blur.cumulative(position(t)) - t).abs() < bound, "r = {r}, t = {t}");
        }
        // Between 2 % and 98 % of the time the density is smooth for every ratio.
        let (a, b) = (position(0.02), position(0.98));
        let time = real(|s| blur.psf(s), a, b);
        assert!((time - 0.96).abs() < 1e-12, "r = {r}: {time}");
        assert_eq!((blur.psf(-0.1), blur.psf(length * 1.01)), (0.0, 0.0));
        assert_eq!((blur.cumulative(-1.0), blur.cumulative(2.0 * length)), (0.0, 1.0));
    }
}

#[test]
fn a_resting_end_of_the_path_has_infinite_density() {
    assert_eq!(AcceleratedBlur::new(3.0, 1.0).unwrap().psf(0.0), f64::INFINITY);
    assert_eq!(AcceleratedBlur::new(3.0, -1.0).unwrap().psf(3.0), f64::INFINITY);
}

#[test]
fn accelerated_psf_is_equation_3_18() {
    for (v0, a, t) in [(2.0, 3.0, 0.7), (5.0, -1.1, 1.3), (0.0, 4.0, 0.5), (1.0, 0.0, 2.0), (3.0, -1.5, 2.0)] {
        let x = v0 * t + 0.5 * a * t * t;
        let by_time = AcceleratedBlur::from_exposure(v0, a, t).unwrap();
        let by_path = AcceleratedBlur::from_path(v0, a, x).unwrap();
        assert!((by_time.length() - x).abs() < 1e-14, "{v0} {a} {t}");
        assert!((by_time.ratio() - a * t * t / (2.0 * x)).abs() < 1e-14, "{v0} {a} {t}");
        assert!((by_path.ratio() - by_time.ratio()).abs() < 1e-7, "{v0} {a} {t}");
        for share in [0.1, 0.4, 0.9] {
            let s = share * x;
            let density = 1.0 / (t * (v0 * v0 + 2.0 * a * s).sqrt());
            assert!((by_time.psf(s) / density - 1.0).abs() < 1e-12, "{v0} {a} {t} at {s}");
        }
    }
}

#[test]
fn accelerated_transfer_is_equation_3_23_corrected() {
    // The sums of equations 3.21-3.23 started at n = 0, each with the root of its own K, divided by L(0).
    let (v0, a, x) = (0.6, 2.0, 0.5);
    let blur = AcceleratedBlur::from_path(v0, a, x).unwrap();
    let k1 = PI * v0 * v0 / a;
    let k2 = k1 + 2.0 * PI * x;
    for u in [0.3, 1.0, 2.7, 9.0] {
        let sum = |k: f64| -> Complex64 {
            (0..60).map(|n| Complex64::new(spherical_bessel(2 * n, u * k), -spherical_bessel(2 * n + 1, u * k))).sum()
        };
        let value =
            Complex64::from_polar(1.0, u * k1) * (sum(k2) * k2.sqrt() - sum(k1) * k1.sqrt()) / (k2.sqrt() - k1.sqrt());
        assert!((blur.transfer(u) - value).norm() < 1e-13, "{u}");
    }
}

#[test]
fn accelerated_cosine_transform_is_equation_3_56_corrected() {
    let (v, a, length) = (1.5, 7.0, 0.5);
    let blur = AcceleratedBlur::from_path(v, a, length).unwrap();
    let end = f64::sqrt(v * v + 2.0 * a * length);
    let duration = (end - v) / a;
    for omega in [2.0, 10.0, 45.0, 300.0] {
        let integrals = |speed: f64| fresnel(speed * (omega / (PI * a)).sqrt());
        let (first, last) = (integrals(v), integrals(end));
        let phase = omega * v * v / (2.0 * a);
        let value = (PI * a / omega).sqrt() / a
            * (phase.cos() * (last.cosine - first.cosine) + phase.sin() * (last.sine - first.sine));
        assert!((duration * blur.cosine_transform(omega) - value).abs() < 1e-13, "{omega}");
        let integral = real(|s| (omega * s).cos() / (v * v + 2.0 * a * s).sqrt(), 0.0, length);
        assert!((duration * blur.cosine_transform(omega) - integral).abs() < 1e-12, "{omega}");
    }
}

#[test]
fn the_l0_of_the_thesis_is_ten_times_its_own_formula() {
    // R = 0.001 mm, a = 1000 mm/s², T = 0.5 s, x = 0.05 mm.
    let (v0, a, t, x) = (1.0, 1000.0, 0.5, 0.05);
    let k1 = PI * v0 * v0 / a;
    let k2 = k1 + 2.0 * PI * x;
    assert!((k1 - 0.003_141_5).abs() < 1e-7 && (k2 - 0.317_30).abs() < 1e-5);
    let l0 = (k2.sqrt() - k1.sqrt()) / (t * f64::sqrt(PI * a));
    assert!((l0 - 0.018_099_8).abs() < 5e-8, "{l0}");
    // It is the share of T in which x is covered, and the integral of equation 3.18 before normalisation.
    let passage = (f64::sqrt(v0 * v0 + 2.0 * a * x) - v0) / a;
    assert!((l0 - passage / t).abs() < 1e-15);
    let density = AcceleratedBlur::from_path(v0, a, x).unwrap();
    let ratio = 1.0 / (t * f64::sqrt(v0 * v0 + 2.0 * a * 0.02)) / density.psf(0.02);
    assert!((ratio - l0).abs() < 1e-15, "{ratio}");
}

#[test]
fn without_acceleration_the_blur_is_uniform() {
    let uniform = UniformBlur::new(20.0).unwrap();
    for r in [0.0, 1e-14, -1e-14] {
        let blur = AcceleratedBlur::new(20.0, r).unwrap();
        for k in 0..200 {
            let u = 0.017 * f64::from(k);
            assert!((blur.transfer(u) - uniform.transfer(u)).norm() < 2e-14, "r = {r}, u = {u}");
            let omega = 2.0 * PI * u;
            assert!((blur.cosine_transform(omega) - uniform.cosine_transform(omega)).abs() < 2e-14, "r = {r}, u = {u}");
            let s = 0.1 * f64::from(k);
            assert!((blur.psf(s) - uniform.psf(s)).abs() < 1e-14, "r = {r}, s = {s}");
        }
    }
}

#[test]
fn the_first_zero_of_the_sinc_rises_to_the_ratio_over_pi() {
    for r in [1e-9, 1e-4, 0.01, 0.1, 0.3] {
        for signed in [r, -r] {
            let height = AcceleratedBlur::new(7.0, signed).unwrap().mtf(1.0 / 7.0);
            // The next term in the brackets is +0.0016 r^4; 3e-16 is what a height of any size is known to.
            let series = r / PI * (1.0 - (10.5 / (PI * PI) - 1.0) * r * r);
            assert!((height - series).abs() < 1e-3 * r.powi(5) + 3e-16, "{r}: {height} and {series}");
        }
    }
    // First order only: from rest it is |C(2) - i S(2)| / 2 instead of 1/pi.
    let rest = AcceleratedBlur::new(7.0, 1.0).unwrap().mtf(1.0 / 7.0);
    assert!((rest - 0.5 * fresnel(2.0).cosine.hypot(fresnel(2.0).sine)).abs() < 1e-15);
    assert!((rest * PI - 0.937_656).abs() < 1e-6, "{rest}");
}

#[test]
fn uniform_transforms_are_their_defining_integrals() {
    let length = 0.5;
    let blur = UniformBlur::new(length).unwrap();
    assert!((real(|s| blur.psf(s), 0.0, length) - 1.0).abs() < 1e-15);
    for k in 0..100 {
        let u = 1.2 * f64::from(k) + 0.1;
        assert!((blur.transfer(u) - time_integral(u * length, 0.0)).norm() < 1e-14, "{u}");
        assert!((blur.mtf(u) - time_integral(u * length, 0.0).norm()).abs() < 1e-14, "{u}");
        let omega = 2.0 * PI * u;
        let one_sided = real(|x| (omega * x).cos() / length, 0.0, length);
        assert!((blur.cosine_transform(omega) - one_sided).abs() < 1e-13, "{omega}");
        let gate = real(|x| 2.0 * (omega * x).cos() / length, 0.0, 0.5 * length);
        assert!((blur.gate_transform(omega) - gate).abs() < 1e-13, "{omega}");
    }
    assert_eq!((blur.transfer(0.0), blur.cosine_transform(0.0), blur.gate_transform(0.0)), (Complex64::ONE, 1.0, 1.0));
    assert_eq!((blur.psf(0.2), blur.psf(-0.1), blur.psf(0.6)), (2.0, 0.0, 0.0));
}

#[test]
fn uniform_zeros_are_where_the_transforms_vanish() {
    let blur = UniformBlur::new(22.7).unwrap();
    for (n, ((u, gate), cosine)) in (1..60).zip(blur.mtf_zeros().zip(blur.gate_zeros()).zip(blur.cosine_zeros())) {
        // Equation 4.7.
        assert!((2.0 * PI * f64::from(n) / gate - 22.7).abs() < 1e-13);
        assert!(blur.mtf(u) < 1e-15 && blur.gate_transform(gate).abs() < 1e-15);
        assert!(blur.cosine_transform(cosine).abs() < 1e-15);
    }
}

#[test]
fn extreme_frequencies_give_numbers() {
    for r in [-1.0, -1e-300, 0.0, 1e-300, 1e-20, 1e-8, 0.3, 1.0] {
        let blur = AcceleratedBlur::new(1.0, r).unwrap();
        for u in [5e-324, 1e-300, 1e5, 1e15, 1e300, f64::MAX] {
            assert!(blur.mtf(u) <= 1.0 + 1e-14, "r = {r}, u = {u}: {}", blur.mtf(u));
            assert!(blur.cosine_transform(u).abs() <= 1.0 + 1e-14, "r = {r}, u = {u}");
        }
        assert_eq!((blur.mtf(f64::INFINITY), blur.transfer(0.0)), (0.0, Complex64::ONE));
        assert!(blur.mtf(f64::NAN).is_nan() && blur.psf(f64::NAN).is_nan() && blur.cumulative(f64::NAN).is_nan());
    }
    let blur = UniformBlur::new(1.0).unwrap();
    assert_eq!(blur.mtf(f64::INFINITY), 0.0);
    assert_eq!(blur.transfer(f64::NEG_INFINITY), Complex64::ZERO);
    assert!(blur.transfer(f64::NAN).re.is_nan() && blur.psf(f64::NAN).is_nan());
}

#[test]
fn impossible_motions_are_refused() {
    for length in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(UniformBlur::new(length).is_err() && AcceleratedBlur::new(length, 0.1).is_err(), "{length}");
    }
    for r in [1.01, -1.01, f64::NAN] {
        assert!(AcceleratedBlur::new(1.0, r).is_err(), "{r}");
    }
    let turning = AcceleratedBlur::from_exposure(1.0, -2.0, 1.0).unwrap_err();
    assert!(turning.to_string().contains("turn back"), "{turning}");
    for (v0, a, last) in [
        (-1.0, 5.0, 1.0),
        (0.0, 0.0, 1.0),
        (1.0, -1.0, 0.6),
        (f64::NAN, 1.0, 1.0),
        (1.0, f64::INFINITY, 1.0),
        (1.0, 1.0, 0.0),
    ] {
        assert!(AcceleratedBlur::from_path(v0, a, last).is_err(), "path {v0} {a} {last}");
        assert!(AcceleratedBlur::from_exposure(v0, a, 2.0 * last).is_err(), "exposure {v0} {a} {last}");
    }
}

#[test]
fn rounding_does_not_refuse_a_motion_that_just_stops() {
    // 0.1 * 3 > 0.3 in double precision.
    assert_eq!(AcceleratedBlur::from_exposure(0.3, -0.1, 3.0).unwrap().ratio(), -1.0);
    assert_eq!(AcceleratedBlur::from_path(0.3, -0.1, 0.45).unwrap().ratio(), -1.0);
    assert_eq!(AcceleratedBlur::from_path(0.0, 9.81, 0.1).unwrap().ratio(), 1.0);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn an_mtf_does_not_know_the_sign_of_the_acceleration(length in 0.1..300.0, r in 0.0..=1.0, z in -70.0..70.0) {
        let speeding = AcceleratedBlur::new(length, r).unwrap();
        let braking = AcceleratedBlur::new(length, -r).unwrap();
        prop_assert!((speeding.mtf(z / length) - braking.mtf(z / length)).abs() < 1e-14);
        prop_assert!(speeding.mtf(z / length) <= 1.0 + 1e-14);
        // The picture of one is the mirror picture of the other.
        prop_assert!((speeding.psf(0.3 * length) / braking.psf(0.7 * length) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn any_accelerated_transfer_is_its_defining_integral(r in -1.0..=1.0, z in -70.0..70.0) {
        let blur = AcceleratedBlur::new(1.0, r).unwrap();
        prop_assert!((blur.transfer(z) - time_integral(z, r)).norm() < bound(z));
        let cosine = blur.cosine_transform(2.0 * PI * z);
        prop_assert!((cosine - time_integral(z, r).re).abs() < bound(z));
    }
}
