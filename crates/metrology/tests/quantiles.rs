//! Quantiles against goldens of mpmath (`fixtures/metrology/make_quantiles.py`).
#![allow(clippy::unwrap_used, reason = "a golden that cannot be read fails the test")]

use metrology::{chi_squared_quantile, normal_quantile, student_t_quantile};

const GOLDENS: &str = include_str!("../../../fixtures/metrology/quantiles.csv");

/// Largest relative error of one distribution, with the row where it is; at least `rows` rows must have been compared.
fn worst(distribution: &str, rows: usize, quantile: impl Fn(f64, f64) -> f64) -> (f64, String) {
    let mut worst = (0.0, String::new());
    let mut count = 0;
    for row in GOLDENS.lines().skip(1) {
        let cells: Vec<&str> = row.split(',').collect();
        if cells[0] != distribution {
            continue;
        }
        let number = |i: usize| cells[i].parse::<f64>().unwrap();
        let (found, expected) = (quantile(number(1), number(2)), number(3));
        let error = (found / expected - 1.0).abs();
        assert!(error.is_finite(), "{row}: {found}");
        if error > worst.0 {
            worst = (error, format!("{row}: {found}"));
        }
        count += 1;
    }
    assert!(count >= rows, "{count} rows");
    worst
}

#[test]
fn normal_quantiles_are_those_of_mpmath() {
    let (error, row) = worst("normal", 21, |_, p| normal_quantile(p).unwrap());
    assert!(error < 1e-14, "{error:e} at {row}");
}

#[test]
fn student_t_quantiles_are_those_of_mpmath() {
    let (error, row) = worst("t", 400, |dof, p| student_t_quantile(p, dof).unwrap());
    assert!(error < 1e-12, "{error:e} at {row}");
}

#[test]
fn chi_squared_quantiles_are_those_of_mpmath() {
    let (error, row) = worst("chi_squared", 160, |dof, p| chi_squared_quantile(p, dof).unwrap());
    assert!(error < 1e-11, "{error:e} at {row}");
}

#[test]
fn student_t_passes_into_the_normal_distribution() {
    for p in [0.001, 0.3, 0.975] {
        assert_eq!(student_t_quantile(p, f64::INFINITY), normal_quantile(p));
    }
    assert_eq!(student_t_quantile(0.5, 3.0), Ok(0.0));
}

#[test]
fn quantiles_beyond_the_machine_are_an_error() {
    for p in [5e-324, 1e-310, 1e-300, 1e-100, 1e-17, 1.0 - 1e-16] {
        let z = normal_quantile(p).unwrap();
        assert!(z.is_finite() && z.abs() > 8.0 && z.abs() < 39.0, "{p:e}: {z}");
        for dof in [1e-5, 0.01, 0.1, 1.0, 30.0, 1e4, 1e300] {
            match student_t_quantile(p, dof) {
                Ok(t) => assert!(t.is_finite() && t.abs() > 0.999 * z.abs(), "{p:e} {dof}: {t}"),
                Err(error) => assert!(matches!(error, metrology::Error::QuantileOutOfReach { .. }) && dof <= 1.0),
            }
            if dof <= 1e6 {
                assert!(chi_squared_quantile(p, dof).is_ok_and(|x| x >= 0.0) || dof <= 1.0, "{p:e} {dof}");
            }
        }
    }
}

#[test]
fn impossible_probabilities_are_refused() {
    for p in [0.0, 1.0, -0.1, f64::NAN] {
        assert!(normal_quantile(p).is_err() && student_t_quantile(p, 3.0).is_err());
        assert!(chi_squared_quantile(p, 3.0).is_err());
    }
    for dof in [0.0, -1.0, f64::NAN] {
        assert!(student_t_quantile(0.9, dof).is_err() && chi_squared_quantile(0.9, dof).is_err());
    }
}
