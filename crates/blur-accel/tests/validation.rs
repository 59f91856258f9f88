//! Cross-validation: what is left out is not learnt from, and figures are those of their definitions.
#![allow(clippy::unwrap_used, reason = "a failure to fit fails the test")]

use blur_accel::Error;
use blur_accel::reduce::Components;
use blur_accel::regression::{PRESETS, Preset};
use blur_accel::validate::{Comparison, Folds, Metrics, Recipe, Validation, coverage, cross_validate, length_alone};
use blur_sim::rng::Rng;
use ndarray::{Array1, Array2, array};

fn gaussian(rows: usize, columns: usize, seed: u64) -> Array2<f64> {
    let mut rng = Rng::new(seed, 0);
    Array2::from_shape_simple_fn((rows, columns), || rng.gaussian())
}

fn recipe(name: &str, components: usize) -> Recipe {
    Recipe { components: Components::Count(components), preset: Preset::named(name).unwrap() }
}

/// Predictions with errors of their own, as if they had been validated.
fn validation(targets: &Array1<f64>, errors: &Array1<f64>) -> Validation {
    let predictions = targets + errors;
    let metrics = Metrics::of(predictions.view(), targets.view()).unwrap();
    Validation { predictions, std: None, metrics, training_s: 0.0, predictions_per_s: 0.0 }
}

#[test]
fn metrics_are_those_of_their_definitions() {
    // Errors 1, -1, 2, 0: sum of squares 6, of magnitudes 4; the targets vary by 20 about their mean of 4.
    let targets = array![1.0, 3.0, 5.0, 7.0];
    let metrics = Metrics::of(array![2.0, 2.0, 7.0, 7.0].view(), targets.view()).unwrap();
    assert_eq!(metrics, Metrics { rmse: 1.5_f64.sqrt(), r_squared: 1.0 - 6.0 / 20.0, mse: 1.5, mae: 1.0 });
}

#[test]
fn coverage_counts_what_lies_within() {
    let (targets, predictions) = (array![0.0, 0.0, 0.0, 0.0], array![0.1, -0.2, 0.3, -0.4]);
    let std = array![0.1, 0.1, 0.1, 0.3];
    assert_eq!(coverage(predictions.view(), std.view(), targets.view(), 2.0).unwrap(), 0.75);
    assert_eq!(coverage(predictions.view(), std.view(), targets.view(), 1.0).unwrap(), 0.25);
}

#[test]
fn every_observation_is_left_out_once() {
    for (observations, count) in [(125, 5), (17, 4), (9, 9)] {
        let folds = Folds::random(observations, count, 3).unwrap();
        let mut seen: Vec<usize> = folds.tests().flatten().copied().collect();
        seen.sort_unstable();
        assert_eq!(seen, (0..observations).collect::<Vec<_>>());
        let sizes: Vec<usize> = folds.tests().map(<[usize]>::len).collect();
        assert!(sizes.iter().max().unwrap() - sizes.iter().min().unwrap() <= 1, "{sizes:?}");
        for (training, test) in folds.splits() {
            assert_eq!(training.len() + test.len(), observations);
            assert!(training.iter().all(|row| !test.contains(row)));
        }
    }
    assert_eq!(Folds::random(50, 5, 3).unwrap(), Folds::random(50, 5, 3).unwrap());
    assert_ne!(Folds::random(50, 5, 3).unwrap(), Folds::random(50, 5, 4).unwrap());
}

#[test]
fn groups_are_left_out_whole() {
    let posters = ["a", "b", "c", "d", "e", "f", "g"];
    let groups: Vec<&str> = (0..70).map(|row| posters[(row * row) % 7]).collect();
    let present = posters.iter().filter(|poster| groups.contains(poster)).count();
    let folds = Folds::grouped(&groups, 3, 1).unwrap();
    assert_eq!(folds.count(), 3);
    for (training, test) in folds.splits() {
        assert!(!test.is_empty());
        assert!(test.iter().all(|&out| training.iter().all(|&row| groups[row] != groups[out])));
    }
    let alone = Folds::grouped(&groups, present, 1).unwrap();
    assert!(alone.tests().all(|test| test.iter().all(|&row| groups[row] == groups[test[0]])));
}

#[test]
fn predictions_do_not_know_their_own_target() {
    let inputs = gaussian(40, 30, 1);
    let targets: Array1<f64> = inputs.column(0).mapv(|x| x + 1.0);
    let folds = Folds::random(40, 5, 2).unwrap();
    let test: Vec<usize> = folds.tests().next().unwrap().to_vec();
    for name in ["linear", "gpr-matern52", "trees-bagged"] {
        let of = |inputs: &Array2<f64>, targets: &Array1<f64>| {
            cross_validate(recipe(name, 10), inputs.view(), targets.view(), &folds, 1).unwrap().predictions
        };
        let before = of(&inputs, &targets);
        // Whatever happens to the targets of a fold, and to one of its pictures, its other predictions stay.
        let (mut moved, mut moved_targets) = (inputs.clone(), targets.clone());
        for &row in &test {
            moved_targets[row] += 5.0;
        }
        moved.row_mut(test[0]).mapv_inplace(|x| 10.0 * x - 3.0);
        let after = of(&moved, &moved_targets);
        for &row in &test[1..] {
            assert_eq!(before[row], after[row], "{name}");
        }
        assert_ne!(before, after, "{name}");
    }
}

#[test]
fn nothing_is_explained_where_there_is_nothing_to_learn() {
    // 60 columns and 100 observations of pure noise: components or scales that had seen the left-out observations, or
    // targets that leaked, would explain some of it. The mean of 10 runs would reach 0.1 only by three of its deviations.
    let mut sum = 0.0;
    for seed in 0..10 {
        let (inputs, targets) = (gaussian(100, 60, seed), gaussian(100, 1, 100 + seed).column(0).to_owned());
        let folds = Folds::random(100, 5, seed).unwrap();
        let found = cross_validate(recipe("gpr-matern52", 20), inputs.view(), targets.view(), &folds, 1).unwrap();
        sum += found.metrics.r_squared;
    }
    assert!(sum / 10.0 < 0.1, "{}", sum / 10.0);
}

#[test]
fn stated_deviations_cover_what_they_say() {
    // A smooth function with Gaussian noise, which is what the process assumes: 95.4 % within two deviations, of which
    // the count of 400 has a standard deviation of 1.1 %; three of them and what the hyperparameters are uncertain by.
    let inputs = gaussian(400, 3, 5);
    let noise = gaussian(400, 1, 6).column(0).to_owned();
    let targets: Array1<f64> =
        inputs.rows().into_iter().zip(&noise).map(|(row, noise)| row[0].sin() + 0.5 * row[1] + 0.2 * noise).collect();
    let folds = Folds::random(400, 5, 7).unwrap();
    let found = cross_validate(recipe("gpr-squared-exponential", 3), inputs.view(), targets.view(), &folds, 1).unwrap();
    let share = coverage(found.predictions.view(), found.std.unwrap().view(), targets.view(), 2.0).unwrap();
    assert!((share - 0.954).abs() < 0.04, "{share}");
    assert!(found.metrics.rmse > 0.19 && found.metrics.rmse < 0.24, "{:?}", found.metrics);
}

#[test]
fn length_alone_is_a_parabola() {
    let lengths = Array1::from_shape_fn(50, |row| 20.0 + 3.0 * row as f64);
    let targets = lengths.mapv(|length| 0.2 + 1e-2 * length + 7e-5 * length * length);
    let folds = Folds::random(50, 5, 1).unwrap();
    let found = length_alone(lengths.view(), targets.view(), &folds).unwrap();
    // The targets reach 5; rounding grows with the condition number of the parabola, below 100 on its own scale.
    assert!(found.metrics.rmse < 1e-13, "{:e}", found.metrics.rmse);
}

#[test]
fn model_beats_length_only_where_it_knows_more() {
    let mut rng = Rng::new(4, 0);
    let rows = 120;
    let inputs = gaussian(rows, 6, 8);
    let lengths = Array1::from_shape_simple_fn(rows, || 50.0 + 10.0 * rng.gaussian());
    let folds = Folds::random(rows, 5, 1).unwrap();
    // The acceleration is in the inputs and not in the length, and then the other way round.
    let noise = gaussian(rows, 1, 9).column(0).to_owned() * 0.1;
    let of_inputs = &inputs.column(0) + &noise;
    let of_length = lengths.mapv(|length| (length - 50.0) / 10.0) + &noise;
    for (targets, expected) in [(&of_inputs, true), (&of_length, false)] {
        let model = cross_validate(recipe("linear", 6), inputs.view(), targets.view(), &folds, 1).unwrap();
        let baseline = length_alone(lengths.view(), targets.view(), &folds).unwrap();
        let comparison = Comparison::of(&model, &baseline, targets.view(), &folds).unwrap();
        assert_eq!(comparison.beats(), expected, "{comparison:?}");
        assert_eq!(comparison.gain > 0.0, expected, "{comparison:?}");
        assert_eq!(comparison.dof, 4.0);
    }
}

#[test]
fn comparison_is_that_of_its_formula() {
    // Two folds of two; squared errors of the baseline less the model's: (4 - 1, 1 - 0), (9 - 4, 4 - 1).
    let groups = [0, 0, 1, 1];
    let folds = Folds::grouped(&groups, 2, 1).unwrap();
    let targets = array![0.0, 1.0, 2.0, 3.0];
    let model = validation(&targets, &array![1.0, 0.0, 2.0, -1.0]);
    let baseline = validation(&targets, &array![-2.0, 1.0, 3.0, 2.0]);
    let found = Comparison::of(&model, &baseline, targets.view(), &folds).unwrap();
    // Fold means 2 and 4: mean 3, s = √2, times √(1/2 + 1/1); t of 95 % and one degree of freedom is tan(0.45 π).
    let std = 3.0_f64.sqrt();
    assert_eq!(found.gain, 3.0);
    assert!((found.gain_std - std).abs() < 1e-14);
    assert!((found.least_gain - (3.0 - std * (0.45 * std::f64::consts::PI).tan())).abs() < 1e-12);
    assert!(!found.beats());
}

#[test]
fn equals_seldom_beat_each_other() {
    // Two models with errors alike in size: one is said to be better in at most the 5 % that the test allows. The
    // correction for overlapping trainings, absent here, makes it rarer still.
    let (rows, runs) = (125, 1000);
    let folds = Folds::random(rows, 5, 1).unwrap();
    let targets = gaussian(rows, 1, 1).column(0).to_owned();
    let wins = (0..runs)
        .filter(|&run| {
            let errors = gaussian(rows, 2, 10 + run);
            let one = validation(&targets, &errors.column(0).to_owned());
            let other = validation(&targets, &errors.column(1).to_owned());
            Comparison::of(&one, &other, targets.view(), &folds).unwrap().beats()
        })
        .count();
    // The t of 4 degrees is exceeded by 1.5 times less: 2.13 · 1.5 = 3.2, which is 1.6 %; three deviations above.
    assert!((5..30).contains(&wins), "{wins} of {runs}");
}

#[test]
fn wrong_data_are_named() {
    let (inputs, mut targets) = (gaussian(20, 4, 1), gaussian(20, 1, 2).column(0).to_owned());
    let folds = Folds::random(20, 5, 1).unwrap();
    let fails = |inputs: &Array2<f64>, targets: &Array1<f64>, folds: &Folds| {
        cross_validate(recipe("linear", 3), inputs.view(), targets.view(), folds, 1).unwrap_err()
    };
    assert!(matches!(Folds::random(4, 5, 1), Err(Error::TooFew { found: 4, needed: 5, .. })));
    assert!(matches!(Folds::random(20, 1, 1), Err(Error::Parameter { .. })));
    assert!(matches!(Folds::grouped(&[1, 1, 2, 2], 3, 1), Err(Error::TooFew { found: 2, needed: 3, .. })));
    let more = Folds::random(21, 5, 1).unwrap();
    assert!(matches!(fails(&inputs, &targets, &more), Error::Size { found: 21, expected: 20, .. }));
    let short = gaussian(19, 1, 2).column(0).to_owned();
    assert!(matches!(fails(&inputs, &short, &folds), Error::Size { found: 19, expected: 20, .. }));
    targets[7] = f64::NAN;
    assert!(matches!(fails(&inputs, &targets, &folds), Error::NotFinite { row: 7, .. }));
    let same = Array1::from_elem(20, 1.0);
    assert!(matches!(fails(&inputs, &same, &folds), Error::Parameter { .. }));
}

#[test]
fn every_preset_can_be_validated_at_the_size_of_the_thesis() {
    let scales = Array1::from_shape_fn(76, |column| 0.95_f64.powf(column as f64));
    let inputs = gaussian(125, 76, 11) * &scales;
    let noise = gaussian(125, 1, 12).column(0).to_owned();
    let targets = &inputs.column(0) * 0.5 + &inputs.column(1) * &inputs.column(2) * 0.3 + noise * 0.1;
    let folds = Folds::random(125, 5, 1).unwrap();
    for preset in PRESETS {
        let recipe = Recipe { components: Components::default(), preset };
        let found = cross_validate(recipe, inputs.view(), targets.view(), &folds, 1).unwrap();
        println!("{:25} {:?} {:.3} s {:.0} /s", preset.name, found.metrics, found.training_s, found.predictions_per_s);
        assert!(found.predictions.iter().all(|prediction| prediction.is_finite()), "{}", preset.name);
        assert_eq!(found.std.is_some(), preset.name.starts_with("gpr"));
    }
}
