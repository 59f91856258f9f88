//! The special functions against mpmath (`fixtures/psf/make_special.py`) and against printed tables.
#![allow(clippy::unwrap_used, reason = "a golden that cannot be read fails the test")]

use blur_core::psf::{fresnel, fresnel_auxiliary, sinc, spherical_bessel, spherical_bessel_sums};

/// Function, order, argument, value.
fn goldens() -> Vec<(String, u32, f64, f64)> {
    include_str!("../../../fixtures/psf/special.csv")
        .lines()
        .skip(1)
        .map(|line| {
            let field: Vec<&str> = line.split(',').collect();
            (field[0].to_owned(), field[1].parse().unwrap(), field[2].parse().unwrap(), field[3].parse().unwrap())
        })
        .collect()
}

#[test]
fn fresnel_integrals_are_right_to_two_units_in_the_fifteenth_digit() {
    let mut seen = 0;
    for (name, _, x, truth) in goldens() {
        let value = match name.as_str() {
            "S" => fresnel(x).sine,
            "C" => fresnel(x).cosine,
            "f" => fresnel_auxiliary(x).f,
            "g" => fresnel_auxiliary(x).g,
            _ => continue,
        };
        assert!((value - truth).abs() < 2e-15, "{name}({x}) = {value}, not {truth}");
        seen += 1;
    }
    assert_eq!(seen, 72);
}

#[test]
fn small_auxiliary_functions_keep_their_relative_accuracy() {
    for (name, _, x, truth) in goldens().into_iter().filter(|golden| golden.2 > 3.0) {
        // g is the small part of a complex number of modulus f, and is exact to the rounding of that.
        let (value, bound) = match name.as_str() {
            "f" => (fresnel_auxiliary(x).f, 2e-15 * truth),
            "g" => (fresnel_auxiliary(x).g, 2e-15 * fresnel_auxiliary(x).f),
            _ => continue,
        };
        assert!((value - truth).abs() < bound, "{name}({x}) = {value}, not {truth}");
    }
}

#[test]
fn fresnel_integrals_agree_with_table_7_7_of_abramowitz_and_stegun() {
    for (x, cosine, sine) in
        [(0.5, 0.492_344_2, 0.064_732_4), (1.0, 0.779_893_4, 0.438_259_1), (2.0, 0.488_253_4, 0.343_415_7)]
    {
        assert!((fresnel(x).cosine - cosine).abs() < 0.6e-7, "C({x})");
        assert!((fresnel(x).sine - sine).abs() < 0.6e-7, "S({x})");
    }
}

#[test]
fn fresnel_integrals_are_odd_and_end_at_one_half() {
    assert_eq!(fresnel(-1.3).sine, -fresnel(1.3).sine);
    assert_eq!(fresnel(-7.0).cosine, -fresnel(7.0).cosine);
    for x in [1e9, 1e200, f64::INFINITY] {
        assert!((fresnel(x).cosine - 0.5).abs() < 1e-9 && (fresnel(x).sine - 0.5).abs() < 1e-9, "{x}");
    }
    assert!(fresnel(f64::NAN).cosine.is_nan() && fresnel_auxiliary(-1.0).f.is_nan());
}

#[test]
fn auxiliary_functions_join_where_their_forms_change() {
    for seam in [1.7_f64, 1e4] {
        let (below, above) = (fresnel_auxiliary(seam.next_down()), fresnel_auxiliary(seam));
        assert!((below.f / above.f - 1.0).abs() < 1e-14, "f at {seam}");
        assert!((below.g - above.g).abs() < 1e-14 * above.f, "g at {seam}");
    }
}

#[test]
fn spherical_bessel_functions_are_right_to_fourteen_digits() {
    let mut seen = 0;
    for (_, n, x, truth) in goldens().into_iter().filter(|golden| golden.0 == "j") {
        let value = spherical_bessel(n, x);
        // Near a zero the neighbouring order sets the scale; for x > n that is at least the envelope 1/x.
        let scale = if x > f64::from(n) { truth.abs().max(1.0 / x) } else { truth.abs() };
        assert!((value - truth).abs() < 3e-14 * scale, "j_{n}({x}) = {value:e}, not {truth:e}");
        seen += 1;
    }
    assert!(seen > 150, "{seen}");
}

#[test]
fn spherical_bessel_functions_agree_with_table_10_1_of_abramowitz_and_stegun() {
    for (n, x, value) in
        [(0, 1.0, 0.841_470_98), (1, 1.0, 0.301_168_68), (2, 1.0, 0.062_035_052), (2, 10.0, 0.077_942_194)]
    {
        assert!((spherical_bessel(n, x) - value).abs() < 1e-8, "j_{n}({x})");
    }
}

#[test]
fn squares_of_spherical_bessel_functions_sum_to_one() {
    // Abramowitz and Stegun 10.1.50: the sum of (2n+1) j_n(x)² over all n is 1.
    for x in [0.1, 1.0, 2.0, 6.5, 20.0, 77.7] {
        let sum: f64 = (0..150).map(|n| (2.0 * f64::from(n) + 1.0) * spherical_bessel(n, x).powi(2)).sum();
        assert!((sum - 1.0).abs() < 1e-14, "{x}: {sum}");
    }
}

#[test]
fn sums_of_spherical_bessel_functions_are_the_fresnel_type_integral() {
    let mut seen = 0;
    for (name, _, x, truth) in goldens() {
        let value = match name.as_str() {
            "even" => spherical_bessel_sums(x).even,
            "odd" => spherical_bessel_sums(x).odd,
            _ => continue,
        };
        assert!((value - truth).abs() < 5e-15, "{name} sum at {x} = {value}, not {truth}");
        seen += 1;
    }
    assert_eq!(seen, 24);
}

#[test]
fn sums_of_spherical_bessel_functions_start_at_order_zero() {
    for x in [0.3, 3.0, 12.0] {
        let sums = spherical_bessel_sums(x);
        let even: f64 = (0..30).map(|k| spherical_bessel(2 * k, x)).sum();
        let odd: f64 = (0..30).map(|k| spherical_bessel(2 * k + 1, x)).sum();
        assert!((sums.even - even).abs() < 1e-14 && (sums.odd - odd).abs() < 1e-14, "{x}");
    }
}

#[test]
fn odd_orders_are_odd_functions_and_extremes_are_finite() {
    assert_eq!(spherical_bessel(3, -2.5), -spherical_bessel(3, 2.5));
    assert_eq!(spherical_bessel(4, -2.5), spherical_bessel(4, 2.5));
    assert_eq!((spherical_bessel(0, 0.0), spherical_bessel(1, 0.0)), (1.0, 0.0));
    assert_eq!(spherical_bessel(3000, 1.0), 0.0);
    assert_eq!(spherical_bessel(2, f64::INFINITY), 0.0);
    assert!(spherical_bessel(2, f64::NAN).is_nan());
    assert!(spherical_bessel_sums(-1.0).even.is_nan());
}

#[test]
fn sinc_is_one_at_zero_and_exactly_zero_at_other_integers() {
    assert_eq!(sinc(0.0), 1.0);
    assert_eq!(sinc(1e-200), 1.0);
    for n in [1.0, -2.0, 3.0, 1e6, f64::INFINITY] {
        assert_eq!(sinc(n), 0.0, "{n}");
    }
    assert!((sinc(0.5) - 2.0 / std::f64::consts::PI).abs() < 2e-16);
    assert!((sinc(-1.5) + 2.0 / (3.0 * std::f64::consts::PI)).abs() < 2e-16);
    assert!(sinc(f64::NAN).is_nan());
}
