//! Worked examples of the GUM (JCGM 100:2008). Expected numbers are printed there; a bound is half of the last printed
//! digit, unless the GUM rounded on the way.
#![allow(clippy::unwrap_used, reason = "an example that cannot be computed fails the test")]

use metrology::{
    Budget, Combined, Correlation, Coverage, Dual, Input, TypeA, correlation_of_means, coverage_factor, propagate,
    propagate_joint, propagate_numeric, type_b, values_of, welch_satterthwaite,
};

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found}, expected {expected} within {tolerance}");
}

fn input(label: &str, value: f64, std: f64, dof: f64) -> Input {
    Input::new(label, value, std).unwrap().with_dof(dof).unwrap()
}

#[test]
fn type_a_of_the_twenty_temperatures_of_4_4_3() {
    let t = TypeA::of(&[
        96.90, 98.18, 98.25, 98.61, 99.03, 99.49, 99.56, 99.74, 99.89, 100.07, 100.33, 100.42, 100.68, 100.95, 101.11,
        101.20, 101.57, 101.84, 102.36, 102.72,
    ])
    .unwrap();
    near(t.mean(), 100.145, 5e-4);
    near(t.sample_std(), 1.489, 5e-4);
    near(t.std(), 0.333, 5e-4);
    assert_eq!(t.dof(), 19.0);
}

#[test]
fn type_b_of_4_3() {
    // 4.3.5: a length within 0.04 mm at 50 %; 4.3.7: copper, 0.40e-6 / degC; 4.3.8 is asymmetric and not offered.
    near(type_b::normal_std_from_interval(0.04, 0.5).unwrap(), 0.06, 0.005);
    near(type_b::rectangular_std(0.40e-6).unwrap(), 0.23e-6, 0.005e-6);
    // 4.3.3: 240 ug at three standard deviations.
    assert_eq!(type_b::normal_std(240.0, 3.0).unwrap(), 80.0);
}

#[test]
fn coverage_factors_of_table_g_2() {
    let probabilities = [0.6827, 0.90, 0.95, 0.9545, 0.99, 0.9973];
    let rows = [
        (1.0, [1.84, 6.31, 12.71, 13.97, 63.66, 235.80]),
        (4.0, [1.14, 2.13, 2.78, 2.87, 4.60, 6.62]),
        (10.0, [1.05, 1.81, 2.23, 2.28, 3.17, 3.96]),
        (50.0, [1.01, 1.68, 2.01, 2.05, 2.68, 3.16]),
        (f64::INFINITY, [1.000, 1.645, 1.960, 2.000, 2.576, 3.000]),
    ];
    for (dof, factors) in rows {
        for (p, expected) in probabilities.into_iter().zip(factors) {
            // The GUM computed the columns of 1, 2 and 3 sigma with more digits of p; 235.80 feels the fourth.
            let tolerance = if expected > 200.0 { 0.1 } else { 0.0051 };
            near(coverage_factor(p, dof).unwrap(), expected, tolerance);
        }
    }
}

#[test]
fn ten_resistors_of_one_calibration_add_linearly_5_2_2() {
    let inputs: Vec<Input> = (0..10).map(|i| input(&format!("R{i}"), 1000.0, 0.1, f64::INFINITY)).collect();
    let mut pairs = Vec::new();
    for i in 0..10 {
        pairs.extend((i + 1..10).map(|j| (i, j, 1.0)));
    }
    let together = Correlation::from_pairs(10, &pairs).unwrap();
    let sum = |q: &[Dual]| q.iter().copied().sum::<Dual>();
    near(propagate(&inputs, &together, sum).unwrap().std(), 1.0, 1e-14);
    // "incorrect" if taken as independent, says the GUM: 0.32 ohm.
    near(propagate(&inputs, &Correlation::independent(10), sum).unwrap().std(), 0.32, 0.005);
}

#[test]
fn product_of_three_with_relative_uncertainties_g_4_1() {
    // Relative standard uncertainties 0.25 %, 0.57 % and 0.82 % from 10, 5 and 15 observations.
    let inputs =
        [input("a", 2.0, 2.0 * 0.0025, 9.0), input("b", 3.0, 3.0 * 0.0057, 4.0), input("c", 5.0, 5.0 * 0.0082, 14.0)];
    let y = propagate(&inputs, &Correlation::independent(3), |q| 7.0 * q[0] * q[1] * q[2]).unwrap();
    near(y.std() / y.value(), 0.0103, 0.00005);
    near(y.dof(), 19.0, 0.05);
    let k = Coverage::Probability(0.95).factor(&inputs, &y).unwrap();
    near(k, 2.09, 0.005);
    near(y.expanded(k) / y.value(), 0.022, 0.0005);
}

/// GUM H.1: lengths in nm, temperatures in degC. The comparator's difference is in its three parts (H.1.3.2).
fn end_gauge() -> (Vec<Input>, Combined) {
    let inputs = vec![
        input("ls", 50_000_623.0, 25.0, 18.0).with_unit("nm"),
        // Pooled standard deviation 13 nm from 25 comparisons, five repetitions.
        input("d", 215.0, 13.0 / 5.0_f64.sqrt(), 24.0).with_unit("nm"),
        // +-0.01 um at 95 % from six comparisons; 0.02 um at three sigma, known to 25 %.
        input("d1", 0.0, 10.0 / coverage_factor(0.95, 5.0).unwrap(), 5.0).with_unit("nm"),
        input("d2", 0.0, 20.0 / 3.0, type_b::dof_from_relative_uncertainty(0.25).unwrap()).with_unit("nm"),
        Input::rectangular("alpha_s", 11.5e-6, 2e-6).unwrap().with_unit("1/degC"),
        input("theta_mean", -0.1, 0.2, f64::INFINITY).with_unit("degC"),
        Input::within("Delta", 0.0, 0.5, metrology::Distribution::Arcsine).unwrap().with_unit("degC"),
        Input::rectangular("delta_alpha", 0.0, 1e-6).unwrap().with_dof(50.0).unwrap().with_unit("1/degC"),
        Input::rectangular("delta_theta", 0.0, 0.05).unwrap().with_dof(2.0).unwrap().with_unit("degC"),
    ];
    let length = propagate(&inputs, &Correlation::independent(9), end_gauge_model).unwrap();
    (inputs, length)
}

fn end_gauge_model(q: &[Dual]) -> Dual {
    let [ls, d, d1, d2, alpha, mean, cyclic, d_alpha, d_theta] = q[..] else { return Dual::constant(f64::NAN) };
    ls + d + d1 + d2 - ls * (d_alpha * (mean + cyclic) + alpha * d_theta)
}

#[test]
fn end_gauge_h_1_has_the_table_of_the_gum() {
    let (inputs, length) = end_gauge();
    let budget = Budget::new("l", "nm", &inputs, &length, Coverage::Probability(0.99)).unwrap();
    near(length.value(), 50_000_838.0, 1e-6);
    // Table H.1, columns u(x_i) and |c_i| u(x_i) in nm.
    let stds = [25.0, 5.8, 3.9, 6.7, 1.2e-6, 0.2, 0.35, 0.58e-6, 0.029];
    let contributions = [25.0, 5.8, 3.9, 6.7, 0.0, 0.0, 0.0, 2.9, 16.6];
    for ((row, std), contribution) in budget.rows.iter().zip(stds).zip(contributions) {
        near(row.std, std, 0.05 * std);
        near(row.contribution, contribution, 0.05);
    }
    near(budget.rows[8].sensitivity, -50_000_623.0 * 11.5e-6, 1e-6);
    near(budget.rows.iter().map(|row| row.share).sum::<f64>(), 1.0, 1e-12);
    // H.1.4: u = 32 nm; H.1.6: 16 degrees of freedom, rounded down from 16.7, and U = 2.92 * 32 nm = 93 nm.
    near(length.std(), 32.0, 0.5);
    near(length.dof(), 16.7, 0.1);
    let k = coverage_factor(0.99, length.dof().floor()).unwrap();
    near(k, 2.92, 0.005);
    near(k * length.std(), 93.0, 0.6);
    // H.1.6: the comparator's difference alone has u = 9.7 nm and 25.6 degrees of freedom.
    let difference: Vec<_> = budget.rows[1..4].iter().map(|row| (row.contribution, row.dof)).collect();
    near(difference.iter().map(|(u, _)| u * u).sum::<f64>().sqrt(), 9.7, 0.05);
    near(welch_satterthwaite(&difference), 25.6, 0.4);
}

#[test]
fn second_order_terms_of_the_end_gauge_h_1_7() {
    // "... to increase from 32 nm to 34 nm"; the terms of eq. 10 are 11.7 nm and 1.7 nm.
    let (inputs, length) = end_gauge();
    let second = metrology::second_order_std(&inputs, end_gauge_model).unwrap();
    near(second, 34.0, 0.5);
    near((second.powi(2) - length.std().powi(2)).sqrt(), 11.7_f64.hypot(1.7), 0.15);
}

#[test]
fn numeric_derivatives_give_the_same_end_gauge() {
    let (inputs, exact) = end_gauge();
    let numeric = propagate_numeric(&inputs, &Correlation::independent(9), values_of(end_gauge_model)).unwrap();
    near(numeric.std(), exact.std(), 1e-5);
    near(numeric.dof(), exact.dof(), 1e-5);
}

/// GUM table H.2: voltage in V, current in A, phase in rad, observed five times together.
const VOLTAGE: [f64; 5] = [5.007, 4.994, 5.005, 4.990, 4.999];
const CURRENT: [f64; 5] = [19.663e-3, 19.639e-3, 19.640e-3, 19.685e-3, 19.678e-3];
const PHASE: [f64; 5] = [1.0456, 1.0438, 1.0468, 1.0428, 1.0433];

/// Resistance, reactance, and modulus of the impedance, in ohm (GUM eq. H.7).
fn impedance(q: &[Dual]) -> [Dual; 3] {
    let z = q[0] / q[1];
    [z * q[2].cos(), z * q[2].sin(), z]
}

/// The first approach gives u(X) = 0.2956, which the GUM prints as 0.295, the result of the second one.
const TABLE_H_4: [(f64, f64); 3] = [(127.732, 0.071), (219.847, 0.295), (254.260, 0.236)];
const CORRELATIONS_H_4: [(usize, usize, f64); 3] = [(0, 1, -0.588), (0, 2, -0.485), (1, 2, 0.993)];

#[test]
fn resistance_and_reactance_h_2_from_correlated_means() {
    let inputs = [
        Input::from_observations("V", &VOLTAGE).unwrap(),
        Input::from_observations("I", &CURRENT).unwrap(),
        Input::from_observations("phi", &PHASE).unwrap(),
    ];
    let correlation = correlation_of_means(&[&VOLTAGE, &CURRENT, &PHASE]).unwrap();
    // Table H.2: -0.36, 0.86 and -0.65.
    for (i, j, r) in [(0, 1, -0.36), (0, 2, 0.86), (1, 2, -0.65)] {
        near(correlation.get(i, j), r, 0.0051);
    }
    let joint = propagate_joint(&inputs, &correlation, impedance).unwrap();
    for (output, (value, std)) in joint.outputs().iter().zip(TABLE_H_4) {
        near(output.value(), value, 5e-4);
        near(output.std(), std, 6e-4);
        // Observed together, so they keep their degrees of freedom.
        near(output.dof(), 4.0, 1e-9);
    }
    for (i, j, r) in CORRELATIONS_H_4 {
        near(joint.correlation(i, j).unwrap(), r, 5e-4);
    }
    // Z^2 = R^2 + X^2 ties the three together: a matrix without full rank is accepted.
    assert!(joint.correlations().is_ok());
}

#[test]
fn resistance_and_reactance_h_2_from_each_set_of_observations() {
    let mut series = [[0.0; 5]; 3];
    for k in 0..5 {
        let outputs = impedance(&[VOLTAGE[k], CURRENT[k], PHASE[k]].map(Dual::constant));
        for (series, output) in series.iter_mut().zip(outputs) {
            series[k] = output.value();
        }
    }
    for (series, (value, std)) in series.iter().zip(TABLE_H_4) {
        let a = TypeA::of(series).unwrap();
        near(a.mean(), value, 5e-4);
        near(a.std(), std, 5e-4);
    }
    let correlation = correlation_of_means(&series.each_ref().map(|s| &s[..])).unwrap();
    for (i, j, r) in CORRELATIONS_H_4 {
        near(correlation.get(i, j), r, 5e-4);
    }
}
