//! The examples of JCGM 101 and the coverage of intervals, by Monte Carlo with fixed seeds.
#![allow(clippy::unwrap_used, reason = "an example that cannot be computed fails the test")]

use metrology::monte_carlo::{Settings, Termination, adaptive, monte_carlo, validate};
use metrology::{
    Correlation, Coverage, Distribution, Dual, Error, Input, TypeA, coverage_factor, joint, propagate, propagate_joint,
    values_of, welch_satterthwaite,
};

const TRIALS: usize = 1_000_000;

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found}, expected {expected} within {tolerance}");
}

fn sum(q: &[Dual]) -> Dual {
    q.iter().copied().sum()
}

/// Four inputs of one shape around 0 with these standard uncertainties.
fn four(shape: Distribution, stds: [f64; 4]) -> [Input; 4] {
    stds.map(|u| Input::new("x", 0.0, u).unwrap().with_distribution(shape).unwrap())
}

#[test]
fn four_normal_inputs_9_2_2() {
    let inputs = four(Distribution::Normal, [1.0; 4]);
    let independent = Correlation::independent(4);
    let y = monte_carlo(&inputs, &independent, values_of(sum), TRIALS, 11).unwrap();
    near(y.mean(), 0.0, 0.01);
    near(y.std(), 2.0, 0.01);
    // Standard error of an end of the interval: sqrt(p (1 - p) / M) / density = 2 * 0.0027.
    let (low, high) = y.symmetric_interval(0.95).unwrap();
    near(low, -3.92, 0.02);
    near(high, 3.92, 0.02);
}

#[test]
fn four_rectangular_inputs_9_2_3() {
    let inputs = four(Distribution::Rectangular, [1.0; 4]);
    let independent = Correlation::independent(4);
    let y = monte_carlo(&inputs, &independent, values_of(sum), TRIALS, 12).unwrap();
    // Annex E: 2 sqrt(3) (2 - (3/5)^(1/4)) = 3.879.
    let end = 2.0 * 3.0_f64.sqrt() * (2.0 - 0.6_f64.powf(0.25));
    near(end, 3.88, 0.005);
    let symmetric = y.symmetric_interval(0.95).unwrap();
    near(symmetric.0, -end, 0.02);
    near(symmetric.1, end, 0.02);
    let shortest = y.shortest_interval(0.95).unwrap();
    assert!(shortest.1 - shortest.0 <= symmetric.1 - symmetric.0);
    near(shortest.1 - shortest.0, 2.0 * end, 0.03);
    // The GUM's +-3.92 is good enough to two digits of u = 2.0 and not to three.
    let gum = propagate(&inputs, &independent, sum).unwrap();
    let k = Coverage::Probability(0.95).factor(&inputs, &gum).unwrap();
    assert!(validate(&gum, k, (-end, end), 2).unwrap().agrees());
    assert!(!validate(&gum, k, symmetric, 3).unwrap().agrees());
}

#[test]
fn one_dominant_rectangular_input_9_2_4() {
    let inputs = four(Distribution::Rectangular, [1.0, 1.0, 1.0, 10.0]);
    let independent = Correlation::independent(4);
    let y = monte_carlo(&inputs, &independent, values_of(sum), TRIALS, 13).unwrap();
    near(y.std(), 10.1, 0.05);
    let (low, high) = y.symmetric_interval(0.95).unwrap();
    near(low, -17.0, 0.05);
    near(high, 17.0, 0.05);
    // The GUM says 19.9; the rule of the dominant rectangle 1.65 * 10.15 = 16.7, not far from the truth.
    let gum = propagate(&inputs, &independent, sum).unwrap();
    let k = Coverage::Probability(0.95).factor(&inputs, &gum).unwrap();
    near(gum.expanded(k), 19.9, 0.05);
    assert!(!validate(&gum, k, (low, high), 2).unwrap().agrees());
    assert_eq!(Coverage::Dominant.factor(&inputs, &gum), Ok(1.65));
    near(1.65 * gum.std(), 17.0, 0.3);
}

/// JCGM 101 9.3: deviation from nominal mass, mg.
fn mass(q: &[Dual]) -> Dual {
    (q[0] + q[1]) * ((q[2] - 1.2) * (1.0 / q[3] - 1.0 / q[4]) + 1.0) - 1e5
}

#[test]
fn mass_calibration_9_3_is_beyond_first_order() {
    let inputs = [
        Input::new("m_Rc", 1e5, 0.050).unwrap(),
        Input::new("dm_Rc", 1.234, 0.020).unwrap(),
        Input::rectangular("rho_a", 1.20, 0.10).unwrap(),
        Input::rectangular("rho_W", 8e3, 1e3).unwrap(),
        Input::rectangular("rho_R", 8.00e3, 0.05e3).unwrap(),
    ];
    let independent = Correlation::independent(5);
    let gum = propagate(&inputs, &independent, mass).unwrap();
    near(gum.value(), 1.2340, 5e-5);
    near(gum.std(), 0.0539, 5e-5);
    let k = Coverage::Probability(0.95).factor(&inputs, &gum).unwrap();
    near(gum.value() - gum.expanded(k), 1.1285, 1e-4);
    near(gum.value() + gum.expanded(k), 1.3395, 1e-4);
    near(metrology::second_order_std(&inputs, mass).unwrap(), 0.0750, 5e-5);
    // Table 6: 1.2340, 0.0754, [1.0834, 1.3825].
    let y = monte_carlo(&inputs, &independent, values_of(mass), TRIALS, 14).unwrap();
    near(y.mean(), 1.2340, 3e-4);
    near(y.std(), 0.0754, 3e-4);
    let (low, high) = y.symmetric_interval(0.95).unwrap();
    near(low, 1.0834, 1.5e-3);
    near(high, 1.3825, 1.5e-3);
    assert!(!validate(&gum, k, (low, high), 1).unwrap().agrees());
}

#[test]
fn gauge_block_9_5_of_the_supplement() {
    // Table 10, in nm and degC; the result there: 838 nm, u = 36 nm, shortest 99 % interval 745 nm to 932 nm.
    let t = |label: &str, value: f64, std: f64, dof: f64| {
        let input = Input::new(label, value, std).unwrap().with_dof(dof).unwrap();
        input.with_distribution(Distribution::StudentT).unwrap()
    };
    let within = |label: &str, half_width: f64, shape| Input::within(label, 0.0, half_width, shape).unwrap();
    let inputs = [
        t("L_s", 50_000_623.0, 25.0, 18.0),
        t("D", 215.0, 6.0, 24.0),
        t("d_1", 0.0, 4.0, 5.0),
        t("d_2", 0.0, 7.0, 8.0),
        Input::rectangular("alpha_s", 11.5e-6, 2e-6).unwrap(),
        Input::new("theta_0", -0.1, 0.2).unwrap(),
        within("Delta", 0.5, Distribution::Arcsine),
        within("delta_alpha", 1e-6, Distribution::Curvilinear { inexactness: 0.1 }),
        within("delta_theta", 0.050, Distribution::Curvilinear { inexactness: 0.5 }),
    ];
    let model = |q: &[f64]| q[0] + q[1] + q[2] + q[3] - q[0] * (q[7] * (q[5] + q[6]) + q[4] * q[8]) - 5e7;
    let y = monte_carlo(&inputs, &Correlation::independent(9), model, TRIALS, 15).unwrap();
    near(y.mean(), 838.0, 0.5);
    near(y.std(), 36.0, 0.5);
    let (low, high) = y.shortest_interval(0.99).unwrap();
    near(low, 745.0, 2.0);
    near(high, 932.0, 2.0);
}

#[test]
fn the_adaptive_procedure_ends_when_its_digits_are_stable() {
    let inputs = four(Distribution::Normal, [1.0; 4]);
    let independent = Correlation::independent(4);
    let settings = Settings { digits: 2, seed: 1, ..Settings::default() };
    let y = adaptive(&inputs, &independent, values_of(sum), settings).unwrap();
    assert_eq!(y.termination, Termination::Stable);
    assert_eq!(y.tolerance, 0.05);
    assert!(y.scatter.iter().all(|&s| s <= y.tolerance));
    assert_eq!(y.sample.trials() % 10_000, 0);
    near(y.sample.symmetric_interval(0.95).unwrap().1, 3.92, 0.05);
    let hopeless = Settings { digits: 6, max_trials: 30_000, ..settings };
    let y = adaptive(&inputs, &independent, values_of(sum), hopeless).unwrap();
    assert_eq!((y.termination, y.sample.trials()), (Termination::TooManyTrials, 30_000));
    let impossible = Settings { max_trials: 10_000, ..settings };
    assert!(matches!(adaptive(&inputs, &independent, values_of(sum), impossible), Err(Error::TooFew { .. })));
}

#[test]
fn the_same_seed_gives_the_same_trials() {
    let inputs = four(Distribution::StudentT, [1.0; 4]).map(|x| x.with_dof(5.0).unwrap());
    let run = |seed| monte_carlo(&inputs, &Correlation::independent(4), values_of(sum), 1000, seed).unwrap();
    assert_eq!(run(7), run(7));
    assert_ne!(run(7), run(8));
}

#[test]
fn a_model_outside_its_domain_is_an_error() {
    let inputs = [Input::new("x", 0.0, 1.0).unwrap()];
    let root = monte_carlo(&inputs, &Correlation::independent(1), |q| q[0].sqrt(), 100, 1);
    assert!(matches!(root, Err(Error::ModelNotFinite { .. })));
}

/// Share of `TRIALS_OF_COVERAGE` repetitions in which `covers` holds for so many standard normal readings.
fn coverage(readings: usize, seed: u64, covers: impl Fn(&[f64]) -> bool) -> f64 {
    let inputs = vec![Input::new("reading", 0.0, 1.0).unwrap(); readings];
    let indicator = |q: &[f64]| f64::from(u8::from(covers(q)));
    monte_carlo(&inputs, &Correlation::independent(readings), indicator, TRIALS_OF_COVERAGE, seed).unwrap().mean()
}

const TRIALS_OF_COVERAGE: usize = 20_000;
/// Four standard deviations of a binomial proportion of 0.95.
const BOUND: f64 = 4.0 * 0.001_541;

#[test]
fn t_intervals_of_few_readings_cover_95_percent() {
    for n in [2, 3, 4, 10] {
        let k = coverage_factor(0.95, n as f64 - 1.0).unwrap();
        let share = coverage(n, n as u64, |q| TypeA::of(q).is_ok_and(|a| a.mean().abs() <= k * a.std()));
        near(share, 0.95, BOUND);
        // With k = 2 they would not: two readings cover 70 %.
        let share = coverage(n, n as u64, |q| TypeA::of(q).is_ok_and(|a| a.mean().abs() <= 2.0 * a.std()));
        assert!(n > 4 || share < 0.90, "{n}: {share}");
    }
}

#[test]
fn effective_degrees_of_freedom_cover_nearly_95_percent() {
    // The difference of means of 4 and 8 readings of the same scatter: Welch's interval is known to keep its level
    // within about half a per cent here (Wang, J. Am. Stat. Assoc. 66 (1971) 605).
    let share = coverage(12, 5, |q| {
        let (Ok(a), Ok(b)) = (TypeA::of(&q[..4]), TypeA::of(&q[4..])) else { return false };
        let dof = welch_satterthwaite(&[(a.std(), a.dof()), (b.std(), b.dof())]);
        coverage_factor(0.95, dof).is_ok_and(|k| (a.mean() - b.mean()).abs() <= k * a.std().hypot(b.std()))
    });
    near(share, 0.95, BOUND + 0.005);
}

#[test]
fn ellipses_of_simultaneous_readings_cover_95_percent() {
    // Two correlated quantities observed five times; known and estimated covariance.
    let mix = |z: &[f64], k: usize| (z[2 * k], 0.8 * z[2 * k] + 0.6 * z[2 * k + 1]);
    let factor = joint::ellipse_factor_with_dof(0.95, 4.0).unwrap();
    let share = coverage(10, 6, |z| {
        let series: [Vec<f64>; 2] = [(0..5).map(|k| mix(z, k).0).collect(), (0..5).map(|k| mix(z, k).1).collect()];
        let inputs = series.each_ref().map(|s| Input::from_observations("x", s).unwrap());
        let r = metrology::correlation_of_means(&[&series[0], &series[1]]).unwrap();
        propagate_joint(&inputs, &r, |q| [q[0], q[1]]).unwrap().ellipse(0, 1, factor).unwrap().contains([0.0, 0.0])
    });
    near(share, 0.95, BOUND);
    let inputs = [Input::new("a", 0.0, 1.0).unwrap(), Input::new("b", 0.0, 1.0).unwrap()];
    let r = Correlation::from_pairs(2, &[(0, 1, 0.8)]).unwrap();
    let known = propagate_joint(&inputs, &r, |q| [q[0], q[1]]).unwrap();
    let ellipse = known.ellipse(0, 1, joint::ellipse_factor(0.95).unwrap()).unwrap();
    let inside = |q: &[f64]| f64::from(u8::from(ellipse.contains([q[0], q[1]])));
    near(monte_carlo(&inputs, &r, inside, TRIALS_OF_COVERAGE, 9).unwrap().mean(), 0.95, BOUND);
}
