//! Promises of the disk of a lens out of focus.
#![allow(clippy::unwrap_used)]

use std::f64::consts::PI;

use blur_core::psf::DiskBlur;

/// The transform of the disk's chords, `(4 / (pi D²)) ∫ 2 sqrt(D²/4 - x²) cos(2 pi rho x) dx`, with `x = D/2 sin t`. The
/// integrand is smooth and periodic in `t`, where the trapezoidal rule converges faster than any power.
fn by_quadrature(diameter: f64, rho: f64) -> f64 {
    let n = 2000;
    let sum: f64 = (0..n)
        .map(|i| {
            let t = PI * f64::from(i) / f64::from(n);
            t.cos().powi(2) * (PI * diameter * rho * t.sin()).cos()
        })
        .sum();
    2.0 * sum / f64::from(n)
}

#[test]
fn transfer_is_the_transform_of_the_disk() {
    for diameter in [0.3, 4.0, 17.3, 40.0] {
        let disk = DiskBlur::new(diameter).unwrap();
        for i in 0..=700 {
            let rho = f64::from(i) * 1e-3;
            let (found, expected) = (disk.transfer(rho), by_quadrature(diameter, rho));
            assert!((found - expected).abs() < 2e-14, "D {diameter}, rho {rho}: {found} for {expected}");
        }
    }
}

#[test]
fn zeros_are_those_of_the_first_bessel_function() {
    // Abramowitz and Stegun, table 9.5; more digits from NIST DLMF 10.21.
    for zero in [3.831_705_970_207_512, 7.015_586_669_815_619, 10.173_468_135_062_722] {
        let disk = DiskBlur::new(23.0).unwrap();
        assert!(disk.transfer(zero / (PI * 23.0)).abs() < 1e-15, "{zero}");
    }
    // Airy's first dark ring, 1.22 of the inverse diameter; bright again beyond the second.
    let disk = DiskBlur::new(1.0).unwrap();
    assert!(disk.transfer(1.21) > 0.0 && disk.transfer(1.23) < 0.0 && disk.transfer(2.24) > 0.0);
}

#[test]
fn a_disk_holds_all_the_light_and_is_even() {
    let disk = DiskBlur::new(8.0).unwrap();
    assert_eq!(disk.transfer(0.0), 1.0);
    assert!((disk.transfer(1e-10) - 1.0).abs() < 1e-15);
    assert_eq!(disk.transfer(-0.13), disk.transfer(0.13));
    assert_eq!((disk.transfer(f64::INFINITY), disk.transfer(f64::NAN).is_nan()), (0.0, true));
    let light = disk.psf(3.9) * PI * 16.0;
    assert!((light - 1.0).abs() < 1e-15);
    assert_eq!((disk.psf(4.1), disk.psf(-1.0)), (0.0, disk.psf(0.0)));
}

#[test]
fn diameters_that_are_none_are_refused() {
    for diameter in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(DiskBlur::new(diameter).unwrap_err().to_string().contains("disk diameter"));
    }
}
