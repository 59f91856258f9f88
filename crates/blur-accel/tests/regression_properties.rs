//! What must hold of the regressions whatever the data.
#![allow(clippy::unwrap_used, reason = "a failure to fit fails the test")]

use blur_accel::Error;
use blur_accel::regression::{Fitted, MeanOnly, PRESETS, Preset, Samples};
use blur_sim::rng::Rng;
use linfa::traits::{Fit, Predict};
use ndarray::{Array1, Array2, Axis, array};
use proptest::prelude::*;

const ROWS: usize = 60;
const COLUMNS: usize = 5;

fn data(seed: u64) -> (Array2<f64>, Array1<f64>) {
    let mut rng = Rng::new(seed, 0);
    let inputs = Array2::from_shape_simple_fn((ROWS, COLUMNS), || rng.gaussian());
    let targets = inputs
        .rows()
        .into_iter()
        .map(|row| row[0].tanh() + 0.5 * row[1] - 0.4 * row[0] * row[2] + 0.1 * rng.gaussian())
        .collect();
    (inputs, targets)
}

fn fit(preset: &Preset, inputs: &Array2<f64>, targets: &Array1<f64>) -> Fitted {
    preset.fit(inputs.view(), targets.view(), 7).unwrap()
}

fn largest_difference(a: &Array1<f64>, b: &Array1<f64>) -> f64 {
    (a - b).iter().fold(0.0, |worst, difference| worst.max(difference.abs()))
}

#[test]
fn models_come_back_from_json_as_they_were() {
    let (inputs, targets) = data(1);
    let unseen = data(2).0;
    let mean = Fitted::Mean(MeanOnly.fit(&Samples::new(inputs.view(), targets.view())).unwrap());
    for model in PRESETS.iter().map(|preset| fit(preset, &inputs, &targets)).chain([mean]) {
        let text = serde_json::to_string(&model).unwrap();
        let back: Fitted = serde_json::from_str(&text).unwrap();
        assert_eq!(model, back);
        // Equal to the last bit: no tolerance, and no difference between zeros.
        let bits = |values: Array1<f64>| values.mapv(f64::to_bits);
        assert_eq!(bits(model.predict(unseen.view())), bits(back.predict(unseen.view())), "{text}");
        assert_eq!(model.predict_std(unseen.view()).map(bits), back.predict_std(unseen.view()).map(bits));
        assert_eq!(back.columns(), COLUMNS);
    }
}

#[test]
fn file_of_an_impossible_process_is_refused() {
    let (inputs, targets) = data(1);
    let text = serde_json::to_string(&fit(Preset::named("gpr-matern52").unwrap(), &inputs, &targets)).unwrap();
    let found: f64 = {
        let start = text.find("\"length_scale\":").unwrap() + 15;
        text[start..start + text[start..].find(',').unwrap()].parse().unwrap()
    };
    let broken = text.replace(&found.to_string(), "0.0");
    assert_ne!(text, broken);
    assert!(serde_json::from_str::<Fitted>(&broken).is_err());
}

#[test]
fn fits_repeat_to_the_last_bit() {
    let (inputs, targets) = data(3);
    for preset in PRESETS {
        assert_eq!(fit(preset, &inputs, &targets), fit(preset, &inputs, &targets), "{}", preset.name);
    }
    let bagged = Preset::named("trees-bagged").unwrap();
    assert_ne!(fit(bagged, &inputs, &targets), bagged.fit(inputs.view(), targets.view(), 8).unwrap());
}

/// All but the bagged trees, whose draws go by row.
#[test]
fn order_of_the_observations_does_not_matter() {
    let (inputs, targets) = data(4);
    let unseen = data(5).0;
    let reversed: Vec<usize> = (0..ROWS).rev().collect();
    let (other, other_targets) = (inputs.select(Axis(0), &reversed), targets.select(Axis(0), &reversed));
    for preset in PRESETS.iter().filter(|preset| preset.name != "trees-bagged") {
        let one = fit(preset, &inputs, &targets).predict(unseen.view());
        let two = fit(preset, &other, &other_targets).predict(unseen.view());
        // What is solved is good to rounding; what is searched for, to where the search ends.
        let searched = preset.name.starts_with("svm") || preset.name.starts_with("gpr");
        let tolerance = if searched { 1e-4 } else { 1e-11 };
        let difference = largest_difference(&one, &two);
        assert!(difference < tolerance, "{}: {difference:e}", preset.name);
    }
}

#[test]
fn units_of_the_target_do_not_matter() {
    let (inputs, targets) = data(6);
    let unseen = data(7).0;
    for preset in PRESETS {
        let metres = fit(preset, &inputs, &targets);
        let millimetres = fit(preset, &inputs, &targets.mapv(|target| 1000.0 * target));
        let difference = largest_difference(
            &metres.predict(unseen.view()),
            &millimetres.predict(unseen.view()).mapv(|prediction| prediction / 1000.0),
        );
        let searched = preset.name.starts_with("svm") || preset.name.starts_with("gpr");
        assert!(difference < if searched { 1e-4 } else { 1e-11 }, "{}: {difference:e}", preset.name);
    }
}

#[test]
fn noiseless_plane_is_found_by_all_linear_models() {
    let (inputs, _) = data(8);
    let plane = |row: ndarray::ArrayView1<'_, f64>| 1.0 + row[0] - 2.0 * row[3];
    let targets: Array1<f64> = inputs.rows().into_iter().map(plane).collect();
    let unseen = data(9).0;
    let expected: Array1<f64> = unseen.rows().into_iter().map(plane).collect();
    for name in ["linear", "linear-interactions", "linear-robust", "linear-stepwise"] {
        let found = fit(Preset::named(name).unwrap(), &inputs, &targets).predict(unseen.view());
        assert!(largest_difference(&found, &expected) < 1e-12, "{name}");
    }
}

#[test]
fn robust_regression_ignores_what_least_squares_follows() {
    let (inputs, _) = data(10);
    let mut rng = Rng::new(10, 1);
    let mut targets: Array1<f64> = inputs.rows().into_iter().map(|row| row[0] + 0.01 * rng.gaussian()).collect();
    for row in [3, 20, 41] {
        targets[row] += 30.0;
    }
    let unseen = data(11).0;
    let error = |name: &str| {
        let found = fit(Preset::named(name).unwrap(), &inputs, &targets).predict(unseen.view());
        largest_difference(&found, &unseen.column(0).to_owned())
    };
    // Six coefficients, each uncertain by about 0.01/√57, at inputs of up to some 3.
    assert!(error("linear-robust") < 0.05, "{}", error("linear-robust"));
    assert!(error("linear") > 1.0, "{}", error("linear"));
}

#[test]
fn process_is_certain_where_it_was_told_and_ignorant_far_away() {
    let (inputs, targets) = data(12);
    let far = Array2::from_elem((1, COLUMNS), 1e3);
    for name in ["gpr-exponential", "gpr-matern52", "gpr-rational-quadratic", "gpr-squared-exponential"] {
        let model = fit(Preset::named(name).unwrap(), &inputs, &targets);
        let Fitted::GaussianProcess(process) = &model else { unreachable!() };
        let parameters = process.hyperparameters();
        let near = model.predict_std(inputs.view()).unwrap();
        assert!(near.iter().all(|&std| std >= parameters.noise_std));
        if name == "gpr-rational-quadratic" {
            // Its correlation decays by a power, and may not be gone.
            continue;
        }
        let std = model.predict_std(far.view()).unwrap()[0];
        // Signal and noise, and on top the constant, which is no better known than one observation of the signal.
        let least = parameters.signal_std.hypot(parameters.noise_std);
        assert!(std > least && std < 2.0 * least, "{name}: {std} {least}");
        assert!((model.predict(far.view())[0] - process.constant()).abs() < 1e-12);
        assert!(near.iter().all(|&near| near < std));
    }
}

#[test]
fn close_observations_keep_their_distance() {
    // At an observation of the training an exponential process has a kink: a distance of rounding would be seen at 1e-8.
    let (inputs, targets) = data(13);
    let moved = &inputs * 1.0 + 100.0;
    let preset = Preset::named("gpr-exponential").unwrap();
    let here = fit(preset, &inputs, &targets).predict(inputs.view());
    let there = fit(preset, &moved, &targets).predict(moved.view());
    // Shifted inputs are rounded by 1e-14, and the search ends elsewhere by 1e-6.
    assert!(largest_difference(&here, &there) < 1e-5, "{:e}", largest_difference(&here, &there));
}

#[test]
fn predictions_do_not_depend_on_their_company() {
    let (inputs, targets) = data(14);
    let many = data(15).0;
    for preset in PRESETS {
        let model = fit(preset, &inputs, &targets);
        let together = model.predict(many.view());
        for (row, &expected) in many.axis_chunks_iter(Axis(0), 1).zip(&together) {
            assert!((model.predict(row)[0] - expected).abs() < 1e-12, "{}", preset.name);
        }
        // linfa's own way to ask.
        let array: Array1<f64> = Predict::predict(&model, &many);
        assert_eq!(array, together);
    }
}

#[test]
fn wrong_samples_are_named() {
    let (inputs, targets) = data(16);
    let mut bad = inputs.clone();
    bad[[4, 2]] = f64::NAN;
    let mut bad_targets = targets.clone();
    bad_targets[9] = f64::INFINITY;
    for preset in PRESETS {
        let of = |inputs: &Array2<f64>, targets: &Array1<f64>| preset.fit(inputs.view(), targets.view(), 1);
        assert!(matches!(of(&bad, &targets), Err(Error::NotFinite { row: 4, column: 2, .. })), "{}", preset.name);
        assert!(matches!(of(&inputs, &bad_targets), Err(Error::NotFinite { row: 9, .. })), "{}", preset.name);
        let short = targets.slice_axis(Axis(0), (..50).into()).to_owned();
        assert!(matches!(of(&inputs, &short), Err(Error::Size { found: 50, expected: 60, .. })));
        assert!(matches!(of(&array![[1.0, 2.0]], &array![1.0]), Err(Error::TooFew { found: 1, .. })));
        assert!(of(&Array2::zeros((3, 0)), &array![1.0, 2.0, 3.0]).is_err());
    }
    assert!(matches!(Preset::named("forest"), Err(Error::UnknownRegression { .. })));
}

/// Nothing is learnt from nothing, and nothing fails on it.
#[test]
fn samples_without_information_give_their_mean() {
    let (inputs, _) = data(17);
    let constant = Array1::from_elem(ROWS, 2.5);
    let same = Array2::from_elem((ROWS, COLUMNS), 1.0);
    let targets = data(17).1;
    let mean = targets.mean().unwrap();
    for preset in PRESETS {
        let found = fit(preset, &inputs, &constant).predict(inputs.view());
        // A support vector machine is content with anything within its tolerance, 0.1/1.349.
        let tolerance = if preset.name.starts_with("svm") { 0.0742 } else { 1e-9 };
        assert!(found.iter().all(|prediction| (prediction - 2.5).abs() < tolerance), "{}: {found}", preset.name);
        let found = fit(preset, &same, &targets).predict(same.view());
        // Those that minimise other than squares, and the draws, have other means.
        let other = ["linear-robust", "trees-bagged"].contains(&preset.name) || preset.name.starts_with("svm");
        let tolerance = if other { targets.std(1.0) } else { 1e-9 };
        assert!(found.iter().all(|prediction| (prediction - mean).abs() < tolerance), "{}: {found}", preset.name);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// A threshold between two values is between them on any increasing scale; powers of two and their sums are exact.
    #[test]
    fn trees_do_not_see_the_scales_of_the_inputs(seed in 0_u64..1000, power in -20_i32..20) {
        let (inputs, targets) = data(seed);
        let scaled = &inputs * 2.0_f64.powi(power);
        for name in ["tree-fine", "tree-medium", "tree-coarse", "trees-boosted", "trees-bagged"] {
            let preset = Preset::named(name).unwrap();
            let plain = fit(preset, &inputs, &targets).predict(inputs.view());
            let other = fit(preset, &scaled, &targets).predict(scaled.view());
            prop_assert_eq!(plain, other, "{}", name);
        }
    }

    /// Leaves are means: no tree predicts beyond what it has seen.
    #[test]
    fn trees_stay_within_their_targets(seed in 0_u64..1000) {
        let (inputs, targets) = data(seed);
        let (least, most) = targets.iter().fold((f64::MAX, f64::MIN), |(a, b), &y| (a.min(y), b.max(y)));
        let far = inputs.mapv(|x| 50.0 * x);
        for name in ["tree-fine", "trees-bagged"] {
            let found = fit(Preset::named(name).unwrap(), &inputs, &targets).predict(far.view());
            prop_assert!(found.iter().all(|&prediction| prediction >= least && prediction <= most));
        }
    }

    /// What is left of the targets is orthogonal to every column: the normal equations.
    #[test]
    fn residuals_of_least_squares_are_orthogonal(seed in 0_u64..1000) {
        let (inputs, targets) = data(seed);
        let residuals = &targets - &fit(Preset::named("linear").unwrap(), &inputs, &targets).predict(inputs.view());
        prop_assert!(residuals.sum().abs() < 1e-12);
        for column in inputs.columns() {
            prop_assert!(column.dot(&residuals).abs() < 1e-12);
        }
    }
}
