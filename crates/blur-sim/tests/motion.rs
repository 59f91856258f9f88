//! Promises of the motion and its transfer function.
#![allow(clippy::unwrap_used)]

mod quadrature;

use blur_core::estimate::AxialAngle;
use blur_sim::Error;
use blur_sim::motion::Motion;
use proptest::prelude::*;
use quadrature::gauss_legendre;
use std::f64::consts::PI;

fn motion(length_px: f64, deg: f64, accel_ratio: f64) -> Motion {
    Motion::new(length_px, AxialAngle::from_deg(deg), accel_ratio).unwrap()
}

/// Real and imaginary part of the defining integral, in panels of less than a cycle each.
fn integral(motion: &Motion, s: f64) -> (f64, f64) {
    let nodes = gauss_legendre(20);
    let panels = (2.0 * motion.length_px() * s.abs()).ceil() + 1.0;
    let (mut re, mut im) = (0.0, 0.0);
    for panel in 0..panels as usize {
        for &(node, weight) in &nodes {
            let t = (panel as f64 + node) / panels;
            let phase = -2.0 * PI * s * motion.centred_displacement_px(t);
            re += weight / panels * phase.cos();
            im += weight / panels * phase.sin();
        }
    }
    (re, im)
}

#[test]
fn transfer_of_a_uniform_motion_is_sinc() {
    let blur = motion(24.5, 30.0, 0.0);
    for s in [-0.49_f64, -0.3, 1e-9, 1e-5, 1e-3, 0.02, 0.1, 0.333, 0.5] {
        let x = PI * 24.5 * s;
        let found = blur.transfer(s);
        assert!((found.re - x.sin() / x).abs() < 1e-14, "{s}: {found}");
        assert_eq!(found.im, 0.0);
    }
    assert_eq!(blur.transfer(0.0).re, 1.0);
    assert!(blur.transfer(1.0 / 24.5).norm() < 1e-15);
}

#[test]
fn first_zero_fills_up_in_proportion_to_the_acceleration() {
    // To first order |H(1/L)| = |r| / pi; what follows is of relative order r^2.
    for r in [1e-7, 1e-4, 1e-2, 0.03_f64] {
        let found = motion(37.0, 0.0, r).transfer(1.0 / 37.0).norm();
        assert!((found * PI / r - 1.0).abs() < r * r + 1e-7, "{r}: {found}");
    }
}

#[test]
fn start_from_rest_gives_the_tabulated_fresnel_integrals() {
    // With r = 1 and s = 1/L the integral of exp(-2 pi i t^2) is (C(2) - i S(2)) / 2, turned by half a cycle;
    // C(2) and S(2) from Abramowitz & Stegun, table 7.7, more digits from NIST DLMF 7.2.
    let found = motion(10.0, 0.0, 1.0).transfer(0.1);
    assert!((found.re + 0.5 * 0.488_253_406_075_340_75).abs() < 1e-14, "{found}");
    assert!((found.im - 0.5 * 0.343_415_678_363_698_24).abs() < 1e-14, "{found}");
}

#[test]
fn transfer_is_the_integral_over_the_path() {
    for r in [-1.0, -0.5, -1e-3, 0.0, 1e-12, 1e-9, 1e-6, 1e-5, 1e-3, 0.03, 0.3, 0.7, 0.999_999, 1.0] {
        for cycles in [-50.3, -2.0, -1e-3, 1e-7, 1e-4, 3.1e-3, 3.2e-3, 0.05, 0.5, 0.99, 1.0, 1.7, 7.77, 31.0, 200.1] {
            let blur = motion(20.0, 0.0, r);
            let (found, (re, im)) = (blur.transfer(cycles / 20.0), integral(&blur, cycles / 20.0));
            let error = (found.re - re).hypot(found.im - im);
            assert!(error < 1e-12, "r {r}, {cycles} cycles: {error:e}");
        }
    }
}

#[test]
fn direction_is_counter_clockwise_as_seen() {
    let half = 0.5_f64.sqrt();
    for (deg, x, y) in [(0.0, 1.0, 0.0), (45.0, half, -half), (90.0, 0.0, -1.0), (135.0, -half, -half)] {
        let (dx, dy) = motion(1.0, deg, 0.0).direction();
        assert!((dx - x).abs() < 1e-15 && (dy - y).abs() < 1e-15, "{deg}: {dx} {dy}");
    }
    // s = u cos(angle) - v sin(angle)
    let s = motion(1.0, 30.0, 0.0).frequency_along(0.2, 0.1);
    assert!((s - (0.2 * 0.75_f64.sqrt() - 0.05)).abs() < 1e-15, "{s}");
}

#[test]
fn extent_is_the_box_around_the_path() {
    for (length, deg, extent) in [
        (0.0, 12.0, (0, 0)),
        (20.0, 0.0, (0, 20)),
        (20.0, 90.0, (20, 0)),
        (20.5, 90.0, (21, 0)),
        (20.0, 30.0, (10, 18)),
        (24.5, 30.0, (13, 22)),
        (10.0, 137.3, (7, 8)),
    ] {
        assert_eq!(motion(length, deg, 0.0).extent_px(), extent, "{length} px at {deg} degrees");
    }
}

#[test]
fn impossible_motions_are_refused_with_their_numbers() {
    let along = AxialAngle::from_deg(0.0);
    for length in [-1.0, f64::NAN, f64::INFINITY, 1e7] {
        assert!(matches!(Motion::uniform(length, along), Err(Error::Parameter { .. })), "{length}");
    }
    for value in [-1.01, 1.01] {
        let refused = Motion::new(5.0, along, value).unwrap_err();
        assert_eq!(refused, Error::Parameter { name: "acceleration ratio", value, expected: "-1 to 1" });
    }
    assert!(Motion::new(5.0, along, f64::NAN).is_err());
}

proptest! {
    #[test]
    fn opposite_accelerations_have_the_same_magnitude(length in 0.0..200.0, r in -1.0..=1.0, s in -0.7..0.7) {
        let (there, back) = (motion(length, 0.0, r).transfer(s), motion(length, 0.0, -r).transfer(s));
        prop_assert!((there.norm() - back.norm()).abs() < 1e-14);
        prop_assert!((there - back.conj()).norm() < 1e-14);
    }

    #[test]
    fn transfer_of_a_real_path_is_hermitian_and_at_most_one(length in 0.0..200.0, r in -1.0..=1.0, s in 0.0..0.7_f64) {
        let blur = motion(length, 0.0, r);
        prop_assert!((blur.transfer(-s) - blur.transfer(s).conj()).norm() < 1e-14);
        prop_assert!(blur.transfer(s).norm() <= 1.0 + 1e-12);
    }

    #[test]
    fn transfer_is_the_integral_over_any_path(length in 0.0..100.0, r in -1.0..=1.0, s in -0.7..0.7) {
        let blur = motion(length, 0.0, r);
        let (re, im) = integral(&blur, s);
        prop_assert!((blur.transfer(s).re - re).hypot(blur.transfer(s).im - im) < 1e-12);
    }

    #[test]
    fn motion_never_reverses(r in -1.0..=1.0, t in 0.0..1.0, step in 0.0..1.0) {
        let blur = motion(10.0, 0.0, r);
        let later = t + step * (1.0 - t);
        prop_assert!(blur.centred_displacement_px(later) >= blur.centred_displacement_px(t) - 1e-13);
        let path = blur.centred_displacement_px(1.0) - blur.centred_displacement_px(0.0);
        prop_assert!((path - 10.0).abs() < 1e-13);
    }
}
