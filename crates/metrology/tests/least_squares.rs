//! Least squares: against 50-digit arithmetic, against formulas, and what must hold for any data.

#![allow(clippy::unwrap_used)]

use metrology::Error;
use metrology::least_squares::{Design, generalised, ordinary, weighted};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;

/// `fixtures/least_squares/generalised.csv`, remade by the script beside it.
const GOLDEN: &str = include_str!("../../../fixtures/least_squares/generalised.csv");

fn golden(case: &str, quantity: &str) -> Vec<f64> {
    let cells = GOLDEN.lines().map(|line| line.split(',').collect::<Vec<_>>());
    cells.filter(|cells| cells[0] == case && cells[1] == quantity).map(|cells| cells[3].parse().unwrap()).collect()
}

/// Covariance of sums of independent widths, with a variance of every edge.
fn chain(width_var: &[f64], edge_var: &[f64]) -> DMatrix<f64> {
    DMatrix::from_fn(edge_var.len(), edge_var.len(), |i, j| {
        width_var[..i.min(j)].iter().sum::<f64>() + if i == j { edge_var[i] } else { 0.0 }
    })
}

#[test]
fn correlated_data_are_fitted_as_with_fifty_digits() {
    for case in ["definite", "exact_first"] {
        let t = golden(case, "t");
        let covariance = chain(&golden(case, "width_var"), &golden(case, "edge_var"));
        let fit = generalised(&Design::polynomial(&t, 2), &golden(case, "y"), &covariance).unwrap();
        let close = |found: f64, wanted: f64, scale: f64| {
            assert!((found - wanted).abs() <= 1e-10 * scale, "{case}: {found:e} is not {wanted:e}");
        };
        for (found, &wanted) in fit.coefficients.iter().zip(&golden(case, "b")) {
            close(*found, wanted, wanted.abs().max(1e-6));
        }
        let covariance = golden(case, "cov");
        for (index, &wanted) in covariance.iter().enumerate() {
            let (i, j) = (index / 3, index % 3);
            close(fit.covariance_prior[(i, j)], wanted, (covariance[4 * i] * covariance[4 * j]).sqrt() + 1e-30);
        }
        close(fit.chi2, golden(case, "chi2")[0], fit.chi2);
        for (found, wanted) in fit.residuals.iter().zip(golden(case, "residual")) {
            close(*found, wanted, 1e-5);
        }
        assert_eq!(fit.dof, t.len() - 3);
    }
}

#[test]
fn mean_of_two_correlated_values_is_the_formula() {
    // b = [y1 (u2^2 - c) + y2 (u1^2 - c)] / (u1^2 + u2^2 - 2c), var = (u1^2 u2^2 - c^2) / (u1^2 + u2^2 - 2c).
    let (y, u1, u2, c): (_, f64, f64, f64) = ([10.0, 10.4], 0.1, 0.3, 0.02);
    let covariance = DMatrix::from_row_slice(2, 2, &[u1 * u1, c, c, u2 * u2]);
    let fit = generalised(&Design::polynomial(&[0.0; 2], 0), &y, &covariance).unwrap();
    let both = u1 * u1 + u2 * u2 - 2.0 * c;
    let mean = (y[0] * (u2 * u2 - c) + y[1] * (u1 * u1 - c)) / both;
    assert!((fit.coefficients[0] - mean).abs() < 1e-13);
    assert!((fit.covariance_prior[(0, 0)] - ((u1 * u2).powi(2) - c * c) / both).abs() < 1e-15);
}

#[test]
fn exactly_known_data_are_met_and_the_others_adjusted() {
    // Two exact points determine a line; the third has 1 degree of freedom left to disagree.
    let covariance = DMatrix::from_diagonal(&DVector::from_column_slice(&[0.0, 0.0, 0.25]));
    let design = Design::polynomial(&[0.0, 1.0, 2.0], 1);
    let fit = generalised(&design, &[1.0, 3.0, 6.0], &covariance).unwrap();
    assert!((fit.coefficients[0] - 1.0).abs() < 1e-14 && (fit.coefficients[1] - 2.0).abs() < 1e-14);
    assert!((fit.chi2 - 4.0).abs() < 1e-12, "(6 - 5)^2 / 0.25, not {}", fit.chi2);
    assert_eq!(fit.dof, 1);
    assert!(fit.covariance_prior.amax() < 1e-15);
}

#[test]
fn exact_data_that_contradict_each_other_are_an_error() {
    let design = Design::polynomial(&[0.0, 1.0, 1.0], 1);
    let covariance = DMatrix::from_diagonal(&DVector::from_column_slice(&[1.0, 0.0, 0.0]));
    let agree = generalised(&design, &[1.0, 2.0, 2.0], &covariance).unwrap();
    assert!((agree.coefficients[1] - 1.0).abs() < 1e-13);
    let contradict = generalised(&design, &[1.0, 2.0, 3.0], &covariance);
    assert!(matches!(contradict, Err(Error::Contradiction { .. })), "{contradict:?}");
}

#[test]
fn a_dependent_column_is_named() {
    let t: [f64; 4] = [0.0, 1.0, 2.0, 3.0];
    let design = Design::from(DMatrix::from_fn(4, 3, |i, j| [1.0, t[i], 2.0 * t[i] - 5.0][j]));
    let y = [1.0, 2.0, 3.0, 5.0];
    assert!(matches!(ordinary(&design, &y), Err(Error::RankDeficient { column: 0..=2 })));
    assert!(matches!(generalised(&design, &y, &DMatrix::identity(4, 4)), Err(Error::RankDeficient { .. })));
    let empty = Design::from(DMatrix::from_fn(4, 2, |i, j| if j == 0 { t[i] } else { 0.0 }));
    assert_eq!(ordinary(&empty, &y), Err(Error::RankDeficient { column: 1 }));
}

#[test]
fn arguments_that_do_not_fit_are_errors() {
    let design = Design::polynomial(&[0.0, 1.0, 2.0], 1);
    assert!(matches!(ordinary(&design, &[1.0]), Err(Error::Shape { expected: 3, found: 1, .. })));
    assert!(matches!(ordinary(&design, &[1.0, f64::NAN, 2.0]), Err(Error::NotFinite { index: 1, .. })));
    assert!(matches!(weighted(&design, &[1.0; 3], &[1.0, 0.0, 1.0]), Err(Error::Weight { index: 1, .. })));
    let few = Design::polynomial(&[0.0, 1.0], 2);
    assert_eq!(ordinary(&few, &[1.0, 2.0]), Err(Error::TooFewPoints { points: 2, coefficients: 3 }));
    assert!(generalised(&design, &[1.0; 3], &DMatrix::identity(2, 2)).is_err());
}

proptest! {
    #[test]
    fn weights_are_a_diagonal_covariance(
        y in prop::collection::vec(-1e3..1e3, 8),
        std in prop::collection::vec(1e-3..1e3, 8),
    ) {
        let t: Vec<f64> = (0..8).map(f64::from).collect();
        let design = Design::polynomial(&t, 2);
        let variances: Vec<f64> = std.iter().map(|std: &f64| std * std).collect();
        let weights: Vec<f64> = variances.iter().map(|variance| 1.0 / variance).collect();
        let by_weight = weighted(&design, &y, &weights).unwrap();
        let by_covariance =
            generalised(&design, &y, &DMatrix::from_diagonal(&DVector::from_column_slice(&variances))).unwrap();
        let std = by_weight.std_errors_prior();
        for j in 0..3 {
            let difference = (by_weight.coefficients[j] - by_covariance.coefficients[j]).abs();
            prop_assert!(difference <= 1e-8 * (std[j] + by_weight.coefficients[j].abs()), "{difference:e}");
        }
        prop_assert!((by_weight.chi2 - by_covariance.chi2).abs() <= 1e-8 * (1.0 + by_weight.chi2));
        // The trace of the hat matrix is the number of coefficients.
        prop_assert!((by_weight.leverage.sum() - 3.0).abs() < 1e-9);
        prop_assert!((&by_weight.gain - &by_covariance.gain).amax() <= 1e-7 * by_weight.gain.amax());
    }

    #[test]
    fn weighted_residuals_are_orthogonal_to_the_columns(
        y in prop::collection::vec(-1e3..1e3, 9),
        width_var in prop::collection::vec(0.0..1.0, 8),
        edge_var in prop::collection::vec(0.1..1.0, 9),
    ) {
        let t: Vec<f64> = (0..9).map(f64::from).collect();
        let design = Design::polynomial(&t, 2);
        let covariance = chain(&width_var, &edge_var);
        let fit = generalised(&design, &y, &covariance).unwrap();
        let white = covariance.lu().solve(&fit.residuals).unwrap();
        for j in 0..3 {
            let column = design.rounded().column(j);
            prop_assert!(column.dot(&white).abs() <= 1e-8 * column.norm() * white.norm().max(1e-9));
        }
        prop_assert!((fit.residuals.dot(&white) - fit.chi2).abs() <= 1e-8 * (1.0 + fit.chi2));
        let by_gain = &fit.gain * DVector::from_column_slice(&y);
        prop_assert!((by_gain - &fit.coefficients).amax() <= 1e-9 * fit.coefficients.amax().max(1.0));
    }
}
