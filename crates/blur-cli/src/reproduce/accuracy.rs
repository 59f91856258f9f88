//! Errors of several methods beside what the thesis states.

use serde::Serialize;

use super::answer::{Answer, Measure};
use super::candidates::Candidate;
use super::protocol;
use super::report::{Boxplot, Report, Row, TextTable, number, percent};
use super::statistics::{self, Interval, Summary};
use super::thesis::{self, Figures};
use crate::Result;

/// What these tables state beside the errors, which are of all answers whatever their status.
#[derive(Debug, Clone, Serialize)]
pub struct Details {
    /// Share of gross errors.
    pub gross: Option<Interval>,
    /// Share of the answers called `ok`.
    pub ok: Option<Interval>,
    /// Mean absolute error of those.
    pub mean_ok: Option<f64>,
    /// Mean signed error of all.
    pub bias: Option<f64>,
    /// Median of the standard uncertainties stated with the answers called `ok`.
    pub std_median: Option<f64>,
    /// Share of those whose error is within two of them; 95.4 % would be right.
    pub coverage_k2: Option<Interval>,
    /// The thesis's figures besides its mean: `thesis_min`, `thesis_q1`, `thesis_q3`, `thesis_max`.
    #[serde(flatten)]
    pub thesis: Option<Figures>,
}

/// Levels of noise that make one row.
#[derive(Debug)]
pub(super) struct Group {
    pub(super) name: String,
    pub(super) levels: Vec<String>,
    /// Whether the thesis's figures are of these levels.
    pub(super) has_thesis: bool,
}

/// Adds a row for every method and group, and a boxplot for every group.
pub(super) fn summarise(
    report: &mut Report,
    table: &'static str,
    measure: Measure,
    methods: &[Candidate],
    groups: &[Group],
) -> Result<()> {
    let mut text = TextTable::new(&[
        measure.title(),
        "level",
        "n",
        "mean",
        "median",
        "min",
        "q1",
        "q3",
        "max",
        "gross %",
        "ok %",
        "mean ok",
        "k=2 %",
        "thesis",
        "min / q1 / q3 / max",
    ]);
    let mut boxes: Vec<Vec<(String, Summary)>> = groups.iter().map(|_| Vec::new()).collect();
    for method in methods.iter().map(Candidate::name) {
        for (group, boxes) in groups.iter().zip(&mut boxes) {
            let answers: Vec<&Answer> = protocol::of(&report.answers, method, &group.levels).collect();
            let thesis = if group.has_thesis { thesis::errors(table, method) } else { None };
            let row = row(table, measure, method, &group.name, &answers, thesis);
            text.push(cells(&row));
            boxes.extend(row.errors.map(|errors| (method.to_owned(), errors)));
            report.push(&row)?;
        }
    }
    for (group, boxes) in groups.iter().zip(boxes) {
        report.boxplots.push(Boxplot {
            name: format!("{table}-{}", group.name.replace(' ', "")),
            title: format!("Table {table}, {}", group.name),
            axis: format!("absolute error of the {}", measure.title()),
            boxes,
        });
    }
    report.text = text;
    Ok(())
}

fn row(
    table: &'static str,
    measure: Measure,
    method: &str,
    level: &str,
    answers: &[&Answer],
    thesis: Option<Figures>,
) -> Row<Details> {
    let n = answers.len();
    let errors: Vec<f64> = answers.iter().map(|answer| answer.summarised_error()).collect();
    let absolute: Vec<f64> = errors.iter().map(|error| error.abs()).collect();
    let ok: Vec<&Answer> = answers.iter().copied().filter(|answer| answer.is_ok()).collect();
    let absolute_ok: Vec<f64> = ok.iter().map(|answer| answer.summarised_error().abs()).collect();
    let stds: Vec<f64> = ok.iter().filter_map(|answer| answer.summarised_std()).collect();
    let covered: Vec<bool> = ok.iter().filter_map(|answer| answer.covers(2.0)).collect();
    Row {
        table,
        method: method.to_owned(),
        level: level.to_owned(),
        quantity: Some(measure.field()),
        n,
        n_ok: ok.len(),
        // Gross errors are counted picture by picture.
        errors: Summary::of(&absolute, f64::INFINITY),
        thesis: thesis.map(|figures| figures.mean),
        details: Details {
            gross: statistics::share(answers.iter().filter(|answer| answer.is_gross()).count(), n),
            ok: statistics::share(ok.len(), n),
            mean_ok: Summary::of(&absolute_ok, f64::INFINITY).map(|errors| errors.mean),
            bias: (n > 0).then(|| errors.iter().sum::<f64>() / n as f64),
            std_median: statistics::median(&stds),
            coverage_k2: statistics::share(covered.iter().filter(|&&covered| covered).count(), covered.len()),
            thesis,
        },
    }
}

fn cells(row: &Row<Details>) -> Vec<String> {
    let error = |pick: fn(&Summary) -> f64| number(row.errors.as_ref().map(pick), 3);
    let share = |share: Option<Interval>| number(share.map(|share| 100.0 * share.value), 1);
    let details = &row.details;
    vec![
        row.method.clone(),
        row.level.clone(),
        row.n.to_string(),
        error(|errors| errors.mean),
        error(|errors| errors.median),
        error(|errors| errors.min),
        error(|errors| errors.q1),
        error(|errors| errors.q3),
        error(|errors| errors.max),
        share(details.gross),
        share(details.ok),
        number(details.mean_ok, 3),
        percent(details.coverage_k2),
        number(row.thesis, 2),
        details.thesis.map_or_else(
            || "-".to_owned(),
            |Figures { min, q1, q3, max, .. }| format!("{min:.2} / {q1:.2} / {q3:.2} / {max:.2}"),
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::answer::tests::answer;
    use super::*;

    #[test]
    fn a_row_counts_all_answers_and_covers_those_called_ok() {
        let mut answers = [0.5, -1.5, 3.0, 50.0].map(|error| answer(Measure::Angle, 30.0, 30.0 + error));
        answers[3].status = "low_confidence";
        let of: Vec<&Answer> = answers.iter().collect();
        let row = row("4.1", Measure::Angle, "dct-radon", "clean", &of, thesis::errors("4.1", "dct-radon"));
        let errors = row.errors.unwrap();
        assert_eq!((row.n, row.n_ok, errors.mean, errors.max), (4, 3, 13.75, 50.0));
        assert_eq!((row.details.gross.unwrap().value, row.details.bias), (0.25, Some(13.0)));
        assert_eq!(row.details.mean_ok, Some(5.0 / 3.0));
        // Uncertainties are 1: two of three errors are within 2.
        assert!((row.details.coverage_k2.unwrap().value - 2.0 / 3.0).abs() < 1e-12);
        let json = serde_json::to_value(&row).unwrap();
        assert_eq!((&json["thesis"], &json["thesis_q3"]), (&0.66.into(), &0.71.into()));
    }
}
