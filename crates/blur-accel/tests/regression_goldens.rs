//! The nineteen regressions against goldens of independent programs (`fixtures/regression/make_predictions.py`).
#![allow(clippy::unwrap_used, clippy::panic, reason = "a golden that cannot be read fails the test")]

use blur_accel::regression::gaussian_process::{GaussianProcess, Hyperparameters, Kernel};
use blur_accel::regression::tree::{Bagging, Cart};
use blur_accel::regression::{Fitted, PRESETS, Preset, Samples};
use linfa::traits::Predict;
use ndarray::{Array1, Array2, Axis};

const DATA: &str = include_str!("../../../fixtures/regression/data.csv");
const GOLDENS: &str = include_str!("../../../fixtures/regression/predictions.csv");

fn data(set: &str) -> (Array2<f64>, Array1<f64>) {
    let rows: Vec<Vec<f64>> = DATA
        .lines()
        .filter_map(|row| row.strip_prefix(set)?.strip_prefix(','))
        .map(|row| row.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    let columns = rows[0].len() - 1;
    let inputs = Array2::from_shape_fn((rows.len(), columns), |(row, column)| rows[row][column]);
    (inputs, rows.iter().map(|row| row[columns]).collect())
}

fn golden(case: &str, quantity: &str) -> Array1<f64> {
    let start = format!("{case},{quantity},");
    let values: Array1<f64> = GOLDENS
        .lines()
        .filter_map(|row| row.strip_prefix(&start))
        .map(|row| row.split(',').nth(1).unwrap().parse().unwrap())
        .collect();
    assert!(!values.is_empty(), "no golden {start}");
    values
}

/// Fails where two lists differ by more than `tolerance`, in m/s² like the targets, whose spread is about 1.
fn agree(what: &str, found: &Array1<f64>, expected: &Array1<f64>, tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let error = (found - expected).mapv(f64::abs).fold(0.0_f64, |a, &b| a.max(b));
    assert!(error <= tolerance, "{what}: {error:e}");
}

fn fitted(name: &str) -> Fitted {
    let (inputs, targets) = data("train");
    Preset::named(name).unwrap().fit(inputs.view(), targets.view(), 1).unwrap()
}

fn predictions_agree(name: &str, tolerance: f64) {
    let found = fitted(name).predict(data("test").0.view());
    agree(name, &found, &golden(name, "prediction"), tolerance);
}

#[test]
fn trees_are_those_of_scikit_learn() {
    for name in ["tree-fine", "tree-medium", "tree-coarse"] {
        predictions_agree(name, 4e-15);
    }
}

#[test]
fn boosted_trees_are_those_of_scikit_learn() {
    predictions_agree("trees-boosted", 4e-15);
}

#[test]
fn bagged_trees_are_those_of_scikit_learn_on_the_same_draws() {
    let (inputs, targets) = data("train");
    let draws: Vec<Vec<usize>> = golden("trees-bagged", "draw")
        .as_slice()
        .unwrap()
        .chunks(inputs.nrows())
        .map(|draw| draw.iter().map(|&row| row as usize).collect())
        .collect();
    assert_eq!(draws.len(), 30);
    let bagging = Bagging { trees: 30, tree: Cart { least_leaf: 8 }, seed: 1 };
    let bagged = bagging.fit_draws(&Samples::new(inputs.view(), targets.view()), &draws).unwrap();
    let found: Array1<f64> = bagged.predict(&data("test").0);
    agree("trees-bagged", &found, &golden("trees-bagged", "prediction"), 4e-15);
}

#[test]
fn support_vector_machines_are_those_of_libsvm() {
    for name in
        ["svm-linear", "svm-quadratic", "svm-cubic", "svm-fine-gaussian", "svm-medium-gaussian", "svm-coarse-gaussian"]
    {
        predictions_agree(name, 1e-5);
    }
}

#[test]
fn linear_models_are_those_of_pivoted_lapack() {
    predictions_agree("linear", 1e-13);
    predictions_agree("linear-interactions", 1e-12);
    for name in ["linear", "linear-interactions"] {
        assert_eq!(terms(&fitted(name)) as f64, golden(name, "coefficients")[0]);
    }
}

#[test]
fn more_terms_than_observations_have_the_basic_solution() {
    let (inputs, targets) = data("train");
    let (inputs, targets) = (inputs.slice_axis(Axis(0), (..24).into()), targets.slice_axis(Axis(0), (..24).into()));
    let model = Preset::named("linear-interactions").unwrap().fit(inputs, targets, 1).unwrap();
    assert_eq!(terms(&model), 24);
    agree("at the training", &model.predict(inputs), &targets.to_owned(), 1e-12);
    let expected = golden("linear-interactions-wide", "prediction");
    agree("linear-interactions-wide", &model.predict(data("test").0.view()), &expected, 1e-11);
}

#[test]
fn robust_regression_is_that_of_numpy() {
    predictions_agree("linear-robust", 1e-12);
}

#[test]
fn stepwise_regression_is_that_of_numpy() {
    assert_eq!(terms(&fitted("linear-stepwise")) as f64, golden("linear-stepwise", "coefficients")[0]);
    predictions_agree("linear-stepwise", 1e-12);
}

fn terms(model: &Fitted) -> usize {
    let Fitted::Linear(model) = model else { panic!("{model:?} is not linear") };
    model.coefficients().count()
}

const KERNELS: [(&str, Kernel); 4] = [
    ("gpr-exponential", Kernel::Exponential),
    ("gpr-matern52", Kernel::Matern52),
    ("gpr-rational-quadratic", Kernel::RationalQuadratic),
    ("gpr-squared-exponential", Kernel::SquaredExponential),
];

#[test]
fn conditioned_processes_are_those_of_scikit_learn_covariances() {
    let (inputs, targets) = data("train");
    let test = data("test").0;
    for (name, kernel) in KERNELS {
        let case = format!("{name}-fixed");
        let parameters = Hyperparameters { length_scale: 1.7, signal_std: 0.9, noise_std: 0.15, exponent: 0.8 };
        let samples = Samples::new(inputs.view(), targets.view());
        let process = GaussianProcess::condition(kernel, parameters, &samples).unwrap();
        let likelihood = Array1::from_elem(1, process.log_likelihood());
        agree(&format!("{case} log-likelihood"), &likelihood, &golden(&case, "log_likelihood"), 3e-10);
        agree(&case, &process.predict(&test), &golden(&case, "prediction"), 1e-12);
        agree(&format!("{case} std"), &process.predict_std(test.view()), &golden(&case, "std"), 1e-12);
    }
}

/// The simplex search of the golden ends where values differ by 1e-11, so within some 1e-6 of the optimum.
#[test]
fn largest_likelihood_is_that_of_a_simplex_search() {
    let test = data("test").0;
    for (name, _) in KERNELS {
        let model = fitted(name);
        let Fitted::GaussianProcess(process) = &model else { panic!("{name}") };
        let likelihood = Array1::from_elem(1, process.log_likelihood());
        // An exponent on its way to infinity leaves a slope: the ends of two searches differ along it.
        let (flat, near) = if name == "gpr-rational-quadratic" { (1e-5, 1e-4) } else { (1e-8, 1e-5) };
        agree(&format!("{name} log-likelihood"), &likelihood, &golden(name, "log_likelihood"), flat);
        let Hyperparameters { length_scale, signal_std, noise_std, .. } = process.hyperparameters();
        let expected = golden(name, "hyperparameter");
        for (found, expected) in [length_scale, signal_std, noise_std].into_iter().zip(&expected) {
            assert!((found / expected - 1.0).abs() < near, "{name}: {found} {expected}");
        }
        agree(name, &model.predict(test.view()), &golden(name, "prediction"), near);
        agree(&format!("{name} std"), &model.predict_std(test.view()).unwrap(), &golden(name, "std"), near);
    }
}

#[test]
fn every_preset_has_a_golden() {
    assert_eq!(PRESETS.len(), 19);
    for preset in PRESETS {
        assert!(golden(preset.name, "prediction").len() == 24);
    }
}
