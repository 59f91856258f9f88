//! Principal components against goldens of scikit-learn (`fixtures/reduce/make_pca.py`).
#![allow(clippy::unwrap_used, reason = "a golden that cannot be read fails the test")]

use blur_accel::Error;
use blur_accel::reduce::{Components, Pca};
use ndarray::{Array1, Array2, Axis};

const GOLDENS: &str = include_str!("../../../fixtures/reduce/pca.csv");
const TERMS: usize = 140;

/// The matrix of the golden's script.
fn matrix(rows: usize, columns: usize) -> Array2<f64> {
    let mut state = 20_240_607_u64;
    let mut next = || {
        state = state * 48_271 % 2_147_483_647;
        (state % 65_536) as f64 / 65_536.0 - 0.5
    };
    let left = Array2::from_shape_simple_fn((rows, TERMS), &mut next);
    let right = Array2::from_shape_simple_fn((TERMS, columns), &mut next);
    let scales = Array1::from_shape_fn(TERMS, |term| 0.94_f64.powf(term as f64));
    (left * &scales).dot(&right) + Array1::from_shape_fn(columns, |column| column as f64 / columns as f64)
}

fn golden(case: &str, quantity: &str) -> Array1<f64> {
    let start = format!("{case},{quantity},");
    GOLDENS
        .lines()
        .filter_map(|row| row.strip_prefix(&start))
        .map(|row| row.split(',').nth(1).unwrap().parse().unwrap())
        .collect()
}

/// Largest difference as a share of `of`.
fn error(found: &Array1<f64>, expected: &Array1<f64>, of: f64) -> f64 {
    assert_eq!(found.len(), expected.len());
    assert!(!found.is_empty());
    (found - expected).iter().fold(0.0, |a: f64, b| a.max(b.abs())) / of
}

#[test]
fn components_are_those_of_scikit_learn() {
    for (rows, columns, components) in [(125, 512, 76), (30, 1500, 29), (300, 20, 20)] {
        let case = format!("{rows}x{columns}x{components}");
        let data = matrix(rows, columns);
        let pca = Pca::fit(data.view(), Components::Count(components)).unwrap();
        assert_eq!(pca.components(), components);
        // Singular values are good to rounding times the largest one.
        let largest = golden(&case, "variance")[0];
        let variances = error(pca.variances(), &golden(&case, "variance"), largest);
        let shares = error(&pca.explained_shares(), &golden(&case, "share"), 1.0);
        // Axes of neighbouring variances are as uncertain as rounding over the gap, here some 1e-3 of a variance.
        let first = pca.apply(data.slice_axis(Axis(0), (..4).into())).unwrap();
        let scores = error(&first.iter().copied().collect(), &golden(&case, "score"), largest.sqrt());
        let row = Array2::from_elem((1, columns), 2.0);
        let unseen = pca.apply(row.view()).unwrap().row(0).to_owned();
        let unseen =
            error(&unseen, &golden(&case, "unseen"), golden(&case, "unseen").dot(&golden(&case, "unseen")).sqrt());
        println!("{case}: {variances:.1e} {shares:.1e} {scores:.1e} {unseen:.1e}");
        assert!(variances < 1e-14 && shares < 1e-14, "{case}: {variances:e} {shares:e}");
        assert!(scores < 1e-11 && unseen < 1e-11, "{case}: {scores:e} {unseen:e}");
    }
}

#[test]
fn scores_are_uncorrelated_and_have_the_stated_variances() {
    let data = matrix(125, 512);
    let pca = Pca::fit(data.view(), Components::Count(76)).unwrap();
    let scores = pca.apply(data.view()).unwrap();
    let covariance = scores.t().dot(&scores) / 124.0;
    let expected = Array2::from_diag(pca.variances());
    let worst = (covariance - expected).iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    assert!(worst < 1e-13 * pca.variances()[0], "{worst:e}");
}

#[test]
fn share_takes_the_fewest_components_that_explain_it() {
    let data = matrix(125, 512);
    let shares = golden("125x512x76", "share");
    let expected = (1..=76).find(|&count| shares.iter().take(count).sum::<f64>() >= 0.95);
    let pca = Pca::fit(data.view(), Components::Share(0.95)).unwrap();
    assert_eq!(pca.components(), expected.unwrap());
    // All of the variance needs all dimensions that centred observations have.
    assert_eq!(Pca::fit(data.view(), Components::Share(1.0)).unwrap().components(), 124);
    assert_eq!(Pca::fit(data.view(), Components::Count(500)).unwrap().components(), 124);
}

#[test]
fn observations_without_spread_have_no_shares() {
    let data = Array2::from_elem((6, 4), 3.25);
    for components in [Components::Count(2), Components::Share(0.9)] {
        let pca = Pca::fit(data.view(), components).unwrap();
        assert!(pca.explained_shares().iter().all(|&share| share == 0.0));
        assert!(pca.apply(data.view()).unwrap().iter().all(|&score| score == 0.0));
    }
}

#[test]
fn wrong_data_are_named() {
    let mut data = matrix(10, 5);
    assert!(matches!(Pca::fit(data.view(), Components::Count(0)), Err(Error::Parameter { .. })));
    assert!(matches!(Pca::fit(data.view(), Components::Share(1.5)), Err(Error::Parameter { .. })));
    assert!(matches!(Pca::fit(data.view(), Components::Share(f64::NAN)), Err(Error::Parameter { .. })));
    let one = data.slice_axis(Axis(0), (..1).into());
    assert!(matches!(Pca::fit(one, Components::Count(1)), Err(Error::TooFew { found: 1, .. })));
    data[[3, 2]] = f64::INFINITY;
    assert!(matches!(Pca::fit(data.view(), Components::Count(2)), Err(Error::NotFinite { row: 3, column: 2, .. })));
}

#[test]
fn what_only_rounding_fills_is_no_component() {
    // Three different observations, each several times: two dimensions.
    let data = Array2::from_shape_fn((12, 5), |(row, column)| ((row % 3) * (column + 2) % 7) as f64 + 0.1);
    let pca = Pca::fit(data.view(), Components::Count(76)).unwrap();
    assert_eq!(pca.components(), 2);
    let unseen = Array2::from_elem((1, 4), 0.0);
    assert!(pca.apply(unseen.view()).is_err());
    assert!(Pca::fit(Array2::zeros((3, 0)).view(), Components::Count(1)).is_err());
}
