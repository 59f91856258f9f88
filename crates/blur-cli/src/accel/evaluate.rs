//! Every regression, the baseline and physics on the same pictures.

use blur_accel::reduce::Components;
use blur_accel::regression::{Preset, ThesisRow};
use blur_accel::validate::{Comparison, Folds, Metrics, Recipe, Validation, coverage, cross_validate, length_alone};
use blur_core::motion::COVERAGE_K;
use ndarray::Array1;

use super::study::{Physical, Study};
use crate::Result;

/// How one method does on the pictures of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Name on the command line and in JSON.
    pub name: &'static str,
    /// Name for people.
    pub title: &'static str,
    /// What kind of method it is.
    pub kind: Kind,
    /// What the thesis states.
    pub thesis: Option<ThesisRow>,
    /// Pictures that it has an answer for.
    pub n: usize,
    /// Errors in m/s²; `None` where it answers too few pictures.
    pub metrics: Option<Metrics>,
    /// Share of the pictures within two stated standard uncertainties, where it states any.
    pub coverage: Option<f64>,
    /// Whether it does better than the blur length alone.
    pub comparison: Option<Comparison>,
    /// Answers and truth in m/s², with the stated standard uncertainty.
    pub points: Vec<Point>,
    /// Wall-clock time of all trainings in seconds, and pictures predicted in a second from their PSFs.
    pub speed: Option<(f64, f64)>,
}

/// An answer beside the truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// True acceleration in m/s².
    pub truth_m_s2: f64,
    /// The answer in m/s².
    pub answer_m_s2: f64,
    /// Its standard uncertainty in m/s².
    pub std_m_s2: Option<f64>,
    /// Whether the answer claims an acceleration at all; `None` for what always does.
    pub detected: Option<bool>,
}

/// Kinds of methods.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Knows the length of the blur and nothing else.
    Baseline,
    /// Learnt from pictures.
    Regression,
    /// Physics of one picture, without a sign.
    Blind,
    /// Physics of a picture and the stills of its scene, with the sign.
    Reference,
}

/// How the regressions are validated.
#[derive(Clone, Copy)]
pub struct Options<'a> {
    /// The regressions.
    pub presets: &'a [&'static Preset],
    /// Principal components.
    pub components: Components,
    /// Seed of all that is drawn.
    pub seed: u64,
}

/// Judges the baseline, the regressions in their order and, where camera and exposure are known, physics.
///
/// # Errors
/// Those of [`cross_validate`].
pub fn evaluate(study: &Study, folds: &Folds, options: &Options<'_>) -> Result<Vec<Line>> {
    let targets = study.targets.view();
    let baseline = length_alone(study.lengths_px.view(), targets, folds)?;
    let mut lines = vec![learnt("length-only", "Blur length alone", Kind::Baseline, None, study, &baseline, None)?];
    for preset in options.presets {
        let recipe = Recipe { components: options.components, preset };
        let validation = cross_validate(recipe, study.inputs.view(), targets, folds, options.seed)?;
        let comparison = Comparison::of(&validation, &baseline, targets, folds)?;
        let thesis = Some(preset.thesis);
        lines.push(learnt(preset.name, preset.title, Kind::Regression, thesis, study, &validation, Some(comparison))?);
    }
    for (name, title, kind, answers) in [
        ("blind", "Physics, blind", Kind::Blind, &study.blind),
        ("reference", "Physics, reference", Kind::Reference, &study.reference),
    ] {
        if answers.iter().any(Option::is_some) {
            lines.push(physical(name, title, kind, study, answers, &baseline, folds)?);
        }
    }
    Ok(lines)
}

fn learnt(
    name: &'static str,
    title: &'static str,
    kind: Kind,
    thesis: Option<ThesisRow>,
    study: &Study,
    validation: &Validation,
    comparison: Option<Comparison>,
) -> Result<Line> {
    let Validation { predictions, std, metrics, training_s, predictions_per_s } = validation;
    let covered = match std {
        Some(std) => Some(coverage(predictions.view(), std.view(), study.targets.view(), COVERAGE_K)?),
        None => None,
    };
    let point = |row: usize| Point {
        truth_m_s2: study.targets[row],
        answer_m_s2: predictions[row],
        std_m_s2: std.as_ref().map(|std| std[row]),
        detected: None,
    };
    Ok(Line {
        name,
        title,
        kind,
        thesis,
        n: study.len(),
        metrics: Some(*metrics),
        coverage: covered,
        comparison,
        points: (0..study.len()).map(point).collect(),
        speed: Some((*training_s, *predictions_per_s)),
    })
}

fn physical(
    name: &'static str,
    title: &'static str,
    kind: Kind,
    study: &Study,
    answers: &[Option<Physical>],
    baseline: &Validation,
    folds: &Folds,
) -> Result<Line> {
    let points: Vec<Point> = answers
        .iter()
        .zip(&study.targets)
        .filter_map(|(answer, &truth_m_s2)| {
            answer.map(|Physical { acceleration, detected }| Point {
                // What has no sign is held against what has none.
                truth_m_s2: if kind == Kind::Blind { truth_m_s2.abs() } else { truth_m_s2 },
                answer_m_s2: acceleration.value_m_s2,
                std_m_s2: Some(acceleration.std_m_s2),
                detected: Some(detected),
            })
        })
        .collect();
    let column = |value: fn(&Point) -> f64| points.iter().map(value).collect::<Array1<f64>>();
    let (values, truths) = (column(|point| point.answer_m_s2), column(|point| point.truth_m_s2));
    let std = column(|point| point.std_m_s2.unwrap_or(f64::NAN));
    let metrics = Metrics::of(values.view(), truths.view()).ok();
    let covered = coverage(values.view(), std.view(), truths.view(), COVERAGE_K).ok();
    // Only with an answer for every picture, sign and all, the two can be compared.
    let alike =
        points.len() == study.len() && (kind != Kind::Blind || study.targets.iter().all(|&target| target >= 0.0));
    let comparison = match metrics.filter(|_| alike) {
        Some(metrics) => {
            let own = Validation { predictions: values, std: None, metrics, training_s: 0.0, predictions_per_s: 0.0 };
            Some(Comparison::of(&own, baseline, truths.view(), folds)?)
        }
        None => None,
    };
    let n = points.len();
    Ok(Line { name, title, kind, thesis: None, n, metrics, coverage: covered, comparison, points, speed: None })
}

impl Line {
    /// Share of the answers of `reference` with the sign of the truth: the others state none, or have only seen one.
    pub fn right_sign(&self) -> Option<f64> {
        let signed = || self.points.iter().filter(|point| point.truth_m_s2 != 0.0);
        (self.kind == Kind::Reference && signed().next().is_some()).then(|| {
            let right = signed().filter(|point| point.answer_m_s2 * point.truth_m_s2 > 0.0);
            right.count() as f64 / signed().count() as f64
        })
    }

    /// How many answers claim an acceleration; `None` for a method that always does.
    pub fn detected(&self) -> Option<usize> {
        self.points.iter().map(|point| point.detected.map(usize::from)).sum()
    }
}
