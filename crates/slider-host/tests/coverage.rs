//! Intervals cover, and tests err, as often as they say: 10,000 simulated runs each.
//!
//! A share p of n runs scatters by `sqrt(p (1 - p) / n)`: 0.22 % for 95 % and 0.10 % for 1 % of 10,000. The bounds are four
//! of these and more away.
#![allow(clippy::unwrap_used)]

mod simulated;

use simulated::{Random, cut_sheet, drawn, edges, run_of, time_of};
use slider_host::fit::{EdgeShift, Options, fit};
use slider_host::outcome::{Kind, Value};
use slider_host::points::{Points, Positions};
use slider_host::sheet::Sheet;

const RUNS: u64 = 10_000;
const JITTER_S: f64 = 2e-6;

#[derive(Debug, Default)]
struct Count {
    covered: u64,
    uniform: u64,
    accelerated: u64,
    neither: u64,
    with_outliers: u64,
}

impl Count {
    fn add(&mut self, truth: f64, value: Value, kind: Kind, outliers: usize) {
        self.covered += u64::from((value.value - truth).abs() <= value.expanded);
        match kind {
            Kind::Uniform => self.uniform += 1,
            Kind::Accelerated => self.accelerated += 1,
            Kind::Neither => self.neither += 1,
        }
        self.with_outliers += u64::from(outliers > 0);
    }

    fn share(count: u64) -> f64 {
        count as f64 / RUNS as f64
    }

    fn check(&self, called_wrong: u64, alarm: f64) {
        println!("{self:?}");
        let covered = Self::share(self.covered);
        assert!((0.94..=0.96).contains(&covered), "{covered}");
        // The significance of the test, from half to one and a half times.
        let wrong = Self::share(called_wrong) / alarm;
        assert!((0.5..1.5).contains(&wrong), "{wrong} of {alarm}");
        // Significance 0.001.
        assert!(Self::share(self.with_outliers) < 0.0025);
    }
}

/// As a caliper knows it.
fn measured() -> Sheet {
    Sheet { scale_std: 2e-4, ..cut_sheet(15e-6) }
}

/// Every run has a sheet of its own: the widths are drawn with their uncertainties and with their common scale.
fn simulate(sheet: &Sheet, degree: u8, edge_shift: EdgeShift, motion: impl Fn(&mut Random) -> (f64, f64)) -> Count {
    let options = Options { jitter_std_s: JITTER_S, edge_shift, ..Options::of_degree(degree) };
    let mut random = Random(8);
    let mut count = Count::default();
    for _ in 0..RUNS {
        let (v0, a) = motion(&mut random);
        let truth = drawn(sheet, &mut random);
        let run = run_of(edges(&truth.positions_m(), time_of(v0, a), JITTER_S, &mut random));
        let points = Points::from_run(&run, sheet).unwrap();
        let fitted = fit(1, &points, &options).unwrap();
        let outcome = &fitted.outcome;
        let (truth, value) = if degree == 1 { (v0, outcome.speed_m_s) } else { (a, outcome.accel_m_s2) };
        count.add(truth, value.unwrap(), outcome.kind, outcome.outliers.len());
    }
    count
}

#[test]
fn speed_is_covered_by_95_percent_and_uniform_motion_missed_by_1() {
    let count = simulate(&measured(), 1, EdgeShift::None, |random| (0.17 + 1.83 * random.uniform(), 0.0));
    count.check(count.accelerated + count.neither, 0.01);
}

#[test]
fn acceleration_is_covered_by_95_percent_and_called_neither_by_half_a_percent() {
    let count = simulate(&measured(), 2, EdgeShift::None, |random| (0.02, 0.35 + 2.11 * random.uniform()));
    count.check(count.neither, 0.005);
    // It is far above its uncertainty.
    assert_eq!(count.uniform, 0);
}

/// Of an exact sheet only the times are uncertain, and they count by the speed.
#[test]
fn speed_over_an_exact_sheet_with_a_fitted_shift_is_covered_by_95_percent() {
    let count = simulate(&Sheet::nominal(), 1, EdgeShift::Fitted, |random| (0.17 + 1.83 * random.uniform(), 0.0));
    count.check(count.accelerated + count.neither, 0.01);
}

#[test]
fn points_without_uncertainties_are_covered_by_95_percent() {
    let mut random = Random(9);
    let mut count = Count::default();
    let t_s: Vec<f64> = (0..12).map(|i| f64::from(i) * 0.02).collect();
    for _ in 0..RUNS {
        let x_m = t_s.iter().map(|t| 0.5 * t + 20e-6 * random.normal()).collect();
        let time_std_s = vec![0.0; t_s.len()];
        let points = Points { t_s: t_s.clone(), x_m, time_std_s, positions: Positions::Unknown, warnings: Vec::new() };
        let outcome = fit(1, &points, &Options::of_degree(1)).unwrap().outcome;
        count.add(0.5, outcome.speed_m_s.unwrap(), outcome.kind, outcome.outliers.len());
    }
    count.check(count.accelerated + count.neither, 0.01);
}

/// The residuals of a generalised fit are not those of an ordinary one: the first edge, which is exact, holds the curve.
#[test]
fn residuals_scatter_as_much_as_is_expected_of_each() {
    let sheet = measured();
    // With a fitted shift the last residual would be expected within a micrometre, where terms of second order show: times
    // depend on the true widths, which biases the speed by some 1e-5 of itself, a hundredth of its uncertainty.
    for (degree, v0, a) in [(1, 0.5, 0.0), (2, 0.2, 1.2)] {
        let options = Options { jitter_std_s: JITTER_S, outlier_significance: 0.0, ..Options::of_degree(degree) };
        let runs = 2000;
        let mut squares = vec![0.0; 26];
        for seed in 0..runs {
            let mut random = Random(seed);
            let positions = drawn(&sheet, &mut random).positions_m();
            let run = run_of(edges(&positions, time_of(v0, a), JITTER_S, &mut random));
            let outcome = fit(1, &Points::from_run(&run, &sheet).unwrap(), &options).unwrap().outcome;
            for (i, square) in squares.iter_mut().enumerate() {
                *square += (outcome.residuals_m[i] / outcome.residual_stds_m[i]).powi(2);
            }
        }
        for (i, square) in squares.iter().enumerate() {
            // A mean of 2000 squares of standard normals scatters by sqrt(2 / 2000) = 0.032; four of these.
            let mean = square / runs as f64;
            assert!((mean - 1.0).abs() < 0.13, "degree {degree}, edge {i}: {mean}");
        }
    }
}
