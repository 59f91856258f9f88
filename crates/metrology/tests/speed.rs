//! The speed of a blurred object, and the speed of the slider as the thesis calibrates it.
#![allow(clippy::unwrap_used, reason = "a budget that cannot be computed fails the test")]

use metrology::monte_carlo::{Settings, Termination, adaptive, validate};
use metrology::{Budget, Correlation, Coverage, Dual, Input, Measurement, coverage, propagate, type_b, values_of};

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found}, expected {expected} within {tolerance}");
}

/// L = 23.40(20) px from ten pictures, s = 0.4120(15) mm/px, T = 1/60 s within 20 us.
fn blur() -> [Input; 3] {
    let length: Measurement = "23.40(20)".parse().unwrap();
    let scale: Measurement = "0.4120(15)e-3".parse().unwrap();
    [
        Input::from(length).with_label("L").with_unit("px").with_dof(9.0).unwrap(),
        Input::from(scale).with_label("s").with_unit("m/px"),
        Input::new("T", 1.0 / 60.0, 2e-5).unwrap().with_unit("s"),
    ]
}

fn speed(q: &[Dual]) -> Dual {
    q[0] * q[1] / q[2]
}

#[test]
fn speed_of_a_blur_has_the_uncertainty_computed_by_hand() {
    // Relative variances: (0.20/23.40)^2 + (0.0015/0.4120)^2 + (60 * 2e-5)^2 = 7.30514e-5 + 1.32552e-5 + 1.44e-6
    // = 8.77466e-5, the root of it 0.93673 % of 0.578448 m/s.
    let inputs = blur();
    let v = propagate(&inputs, &Correlation::independent(3), speed).unwrap();
    near(v.value(), 0.578_448, 1e-12);
    near(v.std(), 0.005_418_5, 5e-8);
    // 9 (8.77466 / 7.30514)^2 = 12.99
    near(v.dof(), 13.0, 0.05);
    let k = Coverage::Probability(0.95).factor(&inputs, &v).unwrap();
    near(k, 2.161, 5e-4);
    assert_eq!(v.measurement().unwrap().to_string(), "0.5784(54)");
}

#[test]
fn the_budget_of_a_speed_reads_well() {
    let inputs = blur();
    let v = propagate(&inputs, &Correlation::independent(3), speed).unwrap();
    let budget = Budget::new("v", "m/s", &inputs, &v, Coverage::Probability(0.95)).unwrap();
    let text = "\
quantity   estimate  unit          u  distribution  dof  sensitivity  contribution   share
------------------------------------------------------------------------------------------
L             23.40  px         0.20  normal          9      0.02472        0.0049  83.3 %
s         0.0004120  m/px  0.0000015  normal        inf         1404        0.0021  15.1 %
T          0.016667  s      0.000020  normal        inf       -34.71       0.00069   1.6 %
------------------------------------------------------------------------------------------
v = 0.578 m/s, U = 0.012 m/s (k = 2.16: 95 %, Student's t), u = 0.0054 m/s, dof = 13
";
    assert_eq!(budget.to_text(), text);
    let markdown = "\
| quantity | estimate | unit | u | distribution | dof | sensitivity | contribution | share |
| --- | ---: | --- | ---: | --- | ---: | ---: | ---: | ---: |
| L | 23.40 | px | 0.20 | normal | 9 | 0.02472 | 0.0049 | 83.3 % |
";
    assert!(budget.to_markdown().starts_with(markdown), "{}", budget.to_markdown());
}

#[test]
fn the_budget_in_json_has_every_digit_and_no_infinity() {
    let inputs = blur();
    let v = propagate(&inputs, &Correlation::independent(3), speed).unwrap();
    let budget = Budget::new("v", "m/s", &inputs, &v, Coverage::Factor(2.0)).unwrap();
    let json = serde_json::to_value(&budget).unwrap();
    assert_eq!(json["std"], v.std());
    assert_eq!(json["expanded"], 2.0 * v.std());
    assert_eq!(json["rows"][0]["dof"], 9.0);
    assert_eq!(json["rows"][1]["dof"], serde_json::Value::Null);
    assert_eq!(json["rows"][2]["distribution"], "normal");
    assert_eq!(json["probability"], serde_json::Value::Null);
    assert_eq!(serde_json::to_value(&inputs[0]).unwrap()["value"], 23.40);
}

#[test]
fn a_budget_of_very_large_and_very_small_numbers_stays_readable() {
    let inputs = [
        Input::new("c", 299_792_458.0, 0.0).unwrap(),
        Input::new("G", 6.674_30e-11, 1.5e-15).unwrap(),
        Input::new("M", 5.972_2e24, 6e20).unwrap(),
        Input::new("a|b", 1e-30, 3.0).unwrap(),
    ];
    let y = propagate(&inputs, &Correlation::independent(4), |q| q[0] * q[1] * q[2] + q[3]).unwrap();
    let budget = Budget::new("y", "", &inputs, &y, Coverage::Probability(0.9973)).unwrap();
    let text = budget.to_text();
    assert!(text.contains(" 299792458 ") && text.contains("6.67430e-11  ") && text.contains("1.5e-15"), "{text}");
    assert!(text.contains("5.97220e24") && text.contains("99.73 %"), "{text}");
    assert!(text.lines().all(|line| line.len() < 140), "{text}");
    assert!(budget.to_markdown().contains("a\\|b"));
}

#[test]
fn monte_carlo_confirms_the_first_order_speed() {
    let mut inputs = blur();
    inputs[0] = inputs[0].clone().with_dof(f64::INFINITY).unwrap();
    let v = propagate(&inputs, &Correlation::independent(3), speed).unwrap();
    let settings = Settings { digits: 2, seed: 4, ..Settings::default() };
    let trials = adaptive(&inputs, &Correlation::independent(3), values_of(speed), settings).unwrap();
    assert_eq!(trials.termination, Termination::Stable);
    near(trials.sample.mean(), v.value(), trials.tolerance);
    near(trials.sample.std(), v.std(), trials.tolerance);
    let interval = trials.sample.symmetric_interval(0.95).unwrap();
    let k = Coverage::Probability(0.95).factor(&inputs, &v).unwrap();
    let validation = validate(&v, k, interval, 2).unwrap();
    assert!(validation.agrees(), "{validation:?}");
}

#[test]
fn calibration_of_the_thesis_takes_the_factor_of_a_rectangle_where_time_dominates() {
    // v = x / t with the calibration tooth of 25.2 mm; a timer of class 1 % that reads 50 ms.
    let dominated = |distance_std: f64| {
        let time_std = type_b::accuracy_class_std(1.0, 0.050).unwrap();
        let inputs = [
            Input::new("x", 25.2e-3, distance_std).unwrap(),
            Input::new("t", 0.050, time_std).unwrap().with_distribution(metrology::Distribution::Rectangular).unwrap(),
        ];
        let v = propagate(&inputs, &Correlation::independent(2), |q| q[0] / q[1]).unwrap();
        let shapes = inputs.each_ref().map(Input::distribution);
        let d = coverage::dominance(v.contributions(), &shapes).unwrap();
        // Thesis eq. 8.12 to 8.14 with C_x = 1/t and C_t = -x/t^2.
        near(d.ratio, (distance_std / 0.050) / (25.2e-3 / 0.0025 * time_std), 1e-12);
        Coverage::Dominant.factor(&inputs, &v).unwrap()
    };
    assert_eq!(dominated(0.02e-3), 1.65);
    assert_eq!(dominated(0.03e-3), 2.0);
}
