//! Propagation against the GUM Tree Calculator (`fixtures/metrology/make_gtc.py`).
#![allow(clippy::unwrap_used, reason = "a golden that cannot be read fails the test")]

use metrology::{Combined, Correlation, Input, correlation_of_means, coverage_factor, propagate, propagate_joint};

const GOLDENS: &str = include_str!("../../../fixtures/metrology/gtc.csv");

#[track_caller]
fn golden(case: &str, quantity: &str) -> f64 {
    let row = GOLDENS.lines().find_map(|row| row.strip_prefix(&format!("{case},{quantity},")));
    row.unwrap().parse().unwrap()
}

#[track_caller]
fn same(found: f64, case: &str, quantity: &str, tolerance: f64) {
    let expected = golden(case, quantity);
    let scale = if expected == 0.0 { 1.0 } else { expected.abs() };
    assert!((found - expected).abs() <= tolerance * scale, "{case} {quantity}: {found}, GTC says {expected}");
}

#[track_caller]
fn same_output(y: &Combined, case: &str, name: &str) {
    same(y.value(), case, name, 1e-14);
    same(y.std(), case, &format!("u({name})"), 1e-12);
    same(y.dof(), case, &format!("dof({name})"), 1e-10);
    for (i, u) in y.contributions().iter().enumerate() {
        // GTC gives magnitudes.
        same(u.abs(), case, &format!("u_{i}({name})"), 1e-12);
    }
    // GTC's own quantile is good to some 1e-12.
    same(coverage_factor(0.95, y.dof()).unwrap(), case, &format!("k_0.95({name})"), 1e-10);
    same(coverage_factor(0.99, y.dof()).unwrap(), case, &format!("k_0.99({name})"), 1e-10);
}

fn input(value: f64, std: f64, dof: f64) -> Input {
    Input::new("x", value, std).unwrap().with_dof(dof).unwrap()
}

#[test]
fn speed_of_a_blur_as_gtc_has_it() {
    let x =
        [input(23.40, 0.20, 9.0), input(0.4120e-3, 0.0015e-3, f64::INFINITY), input(1.0 / 60.0, 2e-5, f64::INFINITY)];
    same_output(&propagate(&x, &Correlation::independent(3), |q| q[0] * q[1] / q[2]).unwrap(), "speed", "v");
}

#[test]
fn a_curved_model_as_gtc_has_it() {
    let x = [input(1.2, 0.05, 4.0), input(-0.7, 0.02, 7.5), input(3.1, 0.11, 12.0), input(0.4, 0.03, f64::INFINITY)];
    let model = |q: &[metrology::Dual]| q[0].exp() * q[1].sin() + q[2].sqrt() / q[3].powi(2);
    same_output(&propagate(&x, &Correlation::independent(4), model).unwrap(), "curved", "y");
}

#[test]
fn simultaneous_observations_as_gtc_has_them() {
    let voltage = [5.007, 4.994, 5.005, 4.990, 4.999];
    let current = [19.663e-3, 19.639e-3, 19.640e-3, 19.685e-3, 19.678e-3];
    let phase = [1.0456, 1.0438, 1.0468, 1.0428, 1.0433];
    let x = [&voltage, &current, &phase].map(|series| Input::from_observations("x", series).unwrap());
    let r = correlation_of_means(&[&voltage, &current, &phase]).unwrap();
    let joint = propagate_joint(&x, &r, |q| {
        let z = q[0] / q[1];
        [z * q[2].cos(), z * q[2].sin(), z]
    })
    .unwrap();
    for (y, name) in joint.outputs().iter().zip(["R", "X", "Z"]) {
        same_output(y, "impedance", name);
    }
    for (i, j, names) in [(0, 1, "R X"), (0, 2, "R Z"), (1, 2, "X Z")] {
        same(joint.correlation(i, j).unwrap(), "impedance", &format!("r({names})"), 1e-12);
    }
}

#[test]
fn an_ensemble_beside_an_independent_input_as_gtc_has_it() {
    let x = [input(10.0, 0.3, 5.0), input(20.0, 0.4, 5.0), input(2.0, 0.1, 3.0)];
    let r = Correlation::from_pairs(3, &[(0, 1, 0.6)]).unwrap();
    same_output(&propagate(&x, &r, |q| q[0] * q[2] + q[1]).unwrap(), "ensemble", "y");
}
