//! What a fit of a run promises.
#![allow(clippy::unwrap_used)]

mod simulated;

use simulated::{Random, cut_sheet, drawn, edges, run, run_of, time_of};
use slider_host::fit::{EdgeShift, Options, fit, pool};
use slider_host::outcome::Kind;
use slider_host::points::Points;
use slider_host::sheet::Sheet;

const SPEEDS: [f64; 7] = [0.17, 0.23, 0.4, 0.5, 0.67, 1.0, 2.0];
const ACCELERATIONS: [f64; 8] = [0.351, 0.644, 0.942, 1.229, 1.541, 1.863, 2.178, 2.463];

#[test]
fn speed_of_ideal_teeth_is_right_to_a_ten_thousandth() {
    let sheet = Sheet::nominal();
    for v in SPEEDS {
        let points = Points::from_run(&run(&sheet, time_of(v, 0.0)), &sheet).unwrap();
        let fitted = fit(1, &points, &Options::of_degree(1)).unwrap();
        let speed = fitted.outcome.speed_m_s.unwrap();
        assert!((speed.value / v - 1.0).abs() < 1e-4, "{v}: {speed:?}");
        assert!((speed.value - v).abs() < 4.0 * speed.std, "{v}: {speed:?}");
        assert_eq!(fitted.outcome.kind, Kind::Uniform, "{v}: {:?}", fitted.decision);
        assert!(fitted.outcome.warnings.is_empty(), "{v}: {:?}", fitted.outcome.warnings);
        assert!(fitted.outcome.r_squared > 1.0 - 1e-8);
    }
}

#[test]
fn acceleration_from_rest_of_ideal_teeth_is_right_to_a_thousandth() {
    let sheet = Sheet::nominal();
    for a in ACCELERATIONS {
        let points = Points::from_run(&run(&sheet, time_of(0.0, a)), &sheet).unwrap();
        let fitted = fit(1, &points, &Options::of_degree(2)).unwrap();
        let accel = fitted.outcome.accel_m_s2.unwrap();
        assert!((accel.value / a - 1.0).abs() < 1e-3, "{a}: {accel:?}");
        assert!(fitted.outcome.v0_m_s.unwrap().value.abs() < 1e-3);
        assert_eq!(fitted.outcome.kind, Kind::Accelerated, "{a}: {:?}", fitted.decision);
        assert!(fitted.outcome.warnings.is_empty(), "{a}: {:?}", fitted.outcome.warnings);
    }
}

#[test]
fn teeth_seen_narrower_give_the_right_speed_and_the_shift() {
    let sheet = Sheet::nominal();
    let narrower = 0.6e-3;
    let seen: Vec<f64> = sheet
        .positions_m()
        .iter()
        .enumerate()
        .map(|(edge, x)| if edge % 2 == 0 { x + narrower / 2.0 } else { x - narrower / 2.0 })
        .collect();
    let points = Points::from_run(&run_of(edges(&seen, time_of(0.5, 0.0), 0.0, &mut Random(2))), &sheet).unwrap();
    let options = Options { edge_shift: EdgeShift::Fitted, ..Options::of_degree(1) };
    let fitted = fit(1, &points, &options).unwrap();
    let shift = fitted.edge_shift_m.unwrap();
    assert!((shift.value - narrower).abs() < 4.0 * shift.std && shift.std < 1e-6, "{shift:?}");
    assert!((fitted.outcome.speed_m_s.unwrap().value / 0.5 - 1.0).abs() < 1e-4);
    assert_eq!(fitted.outcome.coefficients.len(), 2);
    // Without it the residuals say that something is wrong.
    let without = fit(1, &points, &Options::of_degree(1)).unwrap();
    assert!(without.birge_ratio.unwrap() > 10.0 && without.outcome.warnings[0].contains("times as large"));
}

#[test]
fn a_changed_motion_is_neither() {
    let sheet = cut_sheet(10e-6);
    // Uniform for 40 mm, then braking; a step of speed; a start that ends in uniform motion.
    let braking = |x: f64| if x < 0.04 { x / 0.5 } else { 0.08 + time_of(0.5, -1.5)(x - 0.04) };
    let step = |x: f64| if x < 0.05 { x / 0.5 } else { 0.1 + (x - 0.05) / 0.6 };
    let start = |x: f64| if x < 0.05 { time_of(0.05, 1.0)(x) } else { time_of(0.05, 1.0)(0.05) + (x - 0.05) / 0.32 };
    let motions: [(&str, &dyn Fn(f64) -> f64); 3] = [("braking", &braking), ("step", &step), ("start", &start)];
    for (name, motion) in motions {
        let points = Points::from_run(&run(&drawn(&sheet, &mut Random(3)), motion), &sheet).unwrap();
        let fitted = fit(1, &points, &Options::of_degree(2)).unwrap();
        assert_eq!(fitted.outcome.kind, Kind::Neither, "{name}: {:?}", fitted.decision);
        assert!(fitted.outcome.warnings[0].contains("neither uniform nor"), "{:?}", fitted.outcome.warnings);
    }
}

#[test]
fn an_edge_that_is_off_is_named_and_left_out() {
    let sheet = cut_sheet(5e-6);
    let mut run = run(&sheet, time_of(0.4, 0.0));
    // 0.2 ms are 80 um at this speed.
    run.edges[9].tick += 400;
    let points = Points::from_run(&run, &sheet).unwrap();
    let fitted = fit(1, &points, &Options::of_degree(1)).unwrap();
    assert_eq!(fitted.outcome.outliers, [9], "{:?}", fitted.outliers);
    assert!(fitted.outcome.warnings.iter().any(|warning| warning.contains("last edge of tooth 5")));
    assert!((fitted.outcome.speed_m_s.unwrap().value / 0.4 - 1.0).abs() < 1e-3);
    assert!((fitted.outcome.residuals_m[9] + 80e-6).abs() < 10e-6, "{:?}", fitted.outcome.residuals_m);
    assert_eq!(fitted.outcome.residuals_m.len(), 26);
}

/// Five teeth of the thesis's encoder 5, at its ten speeds (table 8.2).
#[test]
fn five_teeth_of_the_thesis_are_enough_for_its_speeds() {
    let sheet = Sheet::from_toml(include_str!("../../../fixtures/encoder5.toml")).unwrap();
    let mut random = Random(6);
    for v in [0.173, 0.229, 0.324, 0.395, 0.457, 0.500, 0.533, 0.573, 0.591, 0.666] {
        let truth = drawn(&sheet, &mut random);
        let points = Points::from_run(&run(&truth, time_of(v, 0.0)), &sheet).unwrap();
        let fitted = fit(1, &points, &Options::of_degree(1)).unwrap();
        let speed = fitted.outcome.speed_m_s.unwrap();
        assert!((speed.value - v).abs() < 4.0 * speed.std && speed.std < 0.005 * v, "{v}: {speed:?}");
        assert_eq!(points.x_m.len(), 10, "{v}: {:?}", points.warnings);
        assert!(points.warnings.is_empty(), "{v}: {:?}", points.warnings);
    }
}

#[test]
fn a_line_without_uncertainties_is_the_textbook_regression() {
    // Sxx = 10, b1 = Sxy / Sxx, s^2 = SSR / 3 by hand.
    let points = Points::from_csv("t_s,x_m\n0,0.1\n1,1.9\n2,4.1\n3,6.2\n4,7.7\n").unwrap();
    let fitted = fit(7, &points, &Options::of_degree(1)).unwrap();
    let outcome = &fitted.outcome;
    assert!((outcome.coefficients[1] - 1.95).abs() < 1e-12 && (outcome.coefficients[0] - 0.1).abs() < 1e-12);
    // Residuals 0, -0.15, 0.1, 0.25, -0.2.
    let s2: f64 = (0.0225 + 0.01 + 0.0625 + 0.04) / 3.0;
    assert!((outcome.residual_std - s2.sqrt()).abs() < 1e-12);
    let speed = outcome.speed_m_s.unwrap();
    assert!((speed.std - (s2 / 10.0).sqrt()).abs() < 1e-12);
    assert!((speed.coverage_k - 3.182).abs() < 1e-3, "t of 3 degrees of freedom for 95 %");
    assert_eq!((speed.dof, outcome.run), (3.0, 7));
}

#[test]
fn runs_share_the_uncertainty_of_their_sheet() {
    let sheet = Sheet { scale_std: 1e-4, ..cut_sheet(10e-6) };
    let mut random = Random(5);
    let truth = drawn(&sheet, &mut random);
    let options = Options { jitter_std_s: 2e-6, ..Options::of_degree(1) };
    let fit_at = |v: f64, random: &mut Random| {
        let run = run_of(edges(&truth.positions_m(), time_of(v, 0.0), 2e-6, random));
        fit(1, &Points::from_run(&run, &sheet).unwrap(), &options).unwrap()
    };
    let same: Vec<_> = (0..20).map(|_| fit_at(0.5, &mut random)).collect();
    let pooled = pool(&same, 0.95).unwrap();
    let one = same[0].outcome.speed_m_s.unwrap().std;
    assert!(pooled.value.std > 0.95 * one, "twenty runs of one sheet are hardly better than one: {pooled:?} {one:e}");
    assert!((0.6..1.5).contains(&pooled.birge_ratio), "{pooled:?}");
    assert!((pooled.value.value - 0.5).abs() < 4.0 * pooled.value.std);
    // The mean's random part shrinks as it should.
    let random_part = (pooled.value.std.powi(2) - pooled.common_std.powi(2)).sqrt();
    assert!(random_part < pooled.within_std, "{random_part:e} {pooled:?}");
    // Runs that really differ by 1 %.
    let differing: Vec<_> = (0..20)
        .map(|_| {
            let v = 0.5 * (1.0 + 0.01 * random.normal());
            fit_at(v, &mut random)
        })
        .collect();
    let pooled = pool(&differing, 0.95).unwrap();
    assert!((0.0033..0.0075).contains(&pooled.between_std), "0.005 m/s between runs: {pooled:?}");
    assert!(pooled.birge_ratio > 5.0 && pooled.value.dof < 25.0, "{pooled:?}");
}

#[test]
fn what_cannot_be_fitted_is_an_error() {
    let points = Points::from_csv("t_s,x_m\n0,0\n1,1\n").unwrap();
    assert!(fit(1, &points, &Options::of_degree(2)).is_err());
    assert!(fit(1, &points, &Options::of_degree(3)).is_err());
    let bad = Options { jitter_std_s: f64::NAN, ..Options::of_degree(1) };
    assert!(fit(1, &points, &bad).is_err());
    let line = fit(1, &points, &Options::of_degree(1)).unwrap();
    assert!(line.outcome.speed_m_s.unwrap().std.is_nan() && line.outcome.warnings.len() == 1);
    assert!(pool(&[line], 0.95).is_err());
}
