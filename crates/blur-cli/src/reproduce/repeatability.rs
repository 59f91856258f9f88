//! The table `5.4.4`: how far the speeds of repeated pictures scatter, beside the uncertainty stated with each of them.
//!
//! The pictures are those of table `5.3` at the lower noise: ten shots of one poster at one speed differ by a fraction of a
//! pixel in place, in gain, vignetting and noise. That is repeatability. A stated uncertainty covers more, above all what
//! the scene does to the spectrum, which is the same in all shots of a poster: the spread over shots should be below it, and
//! that over shots and posters about as large.

use blur_sim::rig::Pass;
use blur_sim::rig::belt::SPEEDS_M_S;
use serde::Serialize;

use super::Plan;
use super::answer::{Answer, Measure};
use super::candidates;
use super::report::{Boxplot, Report, Row, TextTable, number};
use super::slider::{self, LEVELS_DB};
use super::statistics::{self, Summary};
use crate::Result;

const TABLE: &str = "5.4.4";

/// The level of all speeds together.
const ALL: &str = "all";

/// What this table alone states, in percent of the true speed.
#[derive(Debug, Clone, Serialize)]
pub struct Details {
    /// Mean signed error.
    pub bias: Option<f64>,
    /// Standard deviation over the shots of one poster at one speed.
    pub repeatability_std: Option<f64>,
    /// That of the means of the posters, less what repeatability adds to it.
    pub between_std: Option<f64>,
    /// That of one shot of any poster.
    pub reproducibility_std: Option<f64>,
    /// Median of the stated standard uncertainties.
    pub std_median: Option<f64>,
    /// Repeatability over that.
    pub repeatability_ratio: Option<f64>,
}

/// Makes the table.
///
/// # Errors
/// When a picture cannot be taken or measured.
pub fn table(plan: &Plan) -> Result<Report> {
    let methods = candidates::candidates(Measure::Speed, plan.only.as_deref())?;
    let passes = slider::speed_passes(plan)?;
    let taken = slider::take(LEVELS_DB[0], Measure::Speed, &passes, &methods, |_| ())?;
    let mut report = Report::default();
    report.notes.push(format!(
        "{} pictures at {} dB, one in {}, seed {}; all in percent of the true speed, of all answers",
        passes.len(),
        LEVELS_DB[0],
        plan.step,
        plan.seed
    ));
    report.notes.push(
        "s(r): over shots of one poster at one speed; s(L): between those; s(R): both; u: stated, median (ISO 5725-2)"
            .to_owned(),
    );
    report
        .notes
        .push("thesis: histograms of ten shots at each speed, called small variation, without figures".to_owned());
    let mut text = TextTable::new(&[
        "speed, %", "level", "n", "mean", "median", "max", "bias", "s(r)", "s(L)", "s(R)", "u", "s(r)/u",
    ]);
    for (index, method) in methods.iter().enumerate() {
        let shots: Vec<(&Pass, &Answer)> =
            passes.iter().zip(&taken).map(|(pass, (answers, ()))| (pass, &answers[index])).collect();
        let mut boxes = Vec::new();
        let speeds = SPEEDS_M_S.iter().enumerate().map(|(number, &speed)| (format!("V{number}"), Some(speed)));
        for (level, speed) in speeds.chain([(ALL.to_owned(), None)]) {
            let own: Vec<(&Pass, &Answer)> =
                shots.iter().copied().filter(|(pass, _)| speed.is_none_or(|speed| pass.speed_m_s == speed)).collect();
            let row = row(method.name(), &level, &own);
            text.push(cells(&row));
            boxes.extend(row.errors.map(|errors| (level, errors)));
            report.push(&row)?;
        }
        report.boxplots.push(Boxplot {
            name: format!("{TABLE}-{}", method.name()),
            title: format!("Table {TABLE}, {}", method.name()),
            axis: format!("absolute error of the {}", Measure::Speed.title()),
            boxes,
        });
    }
    report.text = text;
    report.answers = taken.into_iter().flat_map(|(answers, ())| answers).collect();
    Ok(report)
}

fn row(method: &str, level: &str, shots: &[(&Pass, &Answer)]) -> Row<Details> {
    let errors: Vec<f64> = shots.iter().map(|(_, answer)| answer.summarised_error()).collect();
    let absolute: Vec<f64> = errors.iter().map(|error| error.abs()).collect();
    let same = |a: &(&Pass, &Answer), b: &(&Pass, &Answer)| (a.0.poster, a.0.speed_m_s) == (b.0.poster, b.0.speed_m_s);
    let settings: Vec<Vec<f64>> =
        shots.chunk_by(same).map(|shots| shots.iter().map(|(_, answer)| answer.summarised_error()).collect()).collect();
    let spread = Spread::of(&settings);
    let stds: Vec<f64> = shots.iter().filter_map(|(_, answer)| answer.summarised_std()).collect();
    let std_median = statistics::median(&stds);
    Row {
        table: TABLE,
        method: method.to_owned(),
        level: level.to_owned(),
        quantity: Some(Measure::Speed.field()),
        n: shots.len(),
        n_ok: shots.iter().filter(|(_, answer)| answer.is_ok()).count(),
        errors: Summary::of(&absolute, f64::INFINITY),
        thesis: None,
        details: Details {
            bias: (!errors.is_empty()).then(|| errors.iter().sum::<f64>() / errors.len() as f64),
            repeatability_std: spread.map(|spread| spread.within),
            between_std: spread.map(|spread| spread.between),
            reproducibility_std: spread.map(|spread| spread.within.hypot(spread.between)),
            std_median,
            repeatability_ratio: spread.zip(std_median).map(|(spread, std)| spread.within / std),
        },
    }
}

fn cells(row: &Row<Details>) -> Vec<String> {
    let error = |pick: fn(&Summary) -> f64| number(row.errors.as_ref().map(pick), 3);
    let details = &row.details;
    vec![
        row.method.clone(),
        row.level.clone(),
        row.n.to_string(),
        error(|errors| errors.mean),
        error(|errors| errors.median),
        error(|errors| errors.max),
        number(details.bias, 3),
        number(details.repeatability_std, 3),
        number(details.between_std, 3),
        number(details.reproducibility_std, 3),
        number(details.std_median, 3),
        number(details.repeatability_ratio, 2),
    ]
}

/// Standard deviations within groups and between them.
///
/// *Reference*: ISO 5725-2:2019, 7.4.5 (`s_r`, `s_L`), with a poster at a speed in the place of a laboratory.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Spread {
    within: f64,
    between: f64,
}

impl Spread {
    /// `None` unless there are two groups and one of them has two values.
    fn of(groups: &[Vec<f64>]) -> Option<Self> {
        let values: Vec<f64> = groups.iter().flatten().copied().collect();
        let (n, p) = (values.len() as f64, groups.len() as f64);
        if groups.len() < 2 || values.len() <= groups.len() {
            return None;
        }
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let grand = mean(&values);
        let (mut inside, mut outside, mut squares) = (0.0, 0.0, 0.0);
        for group in groups {
            let (own, size) = (mean(group), group.len() as f64);
            inside += group.iter().map(|value| (value - own).powi(2)).sum::<f64>();
            outside += size * (own - grand).powi(2);
            squares += size * size;
        }
        let within2 = inside / (n - p);
        let size = (n - squares / n) / (p - 1.0);
        let between2 = (outside / (p - 1.0) - within2) / size;
        Some(Self { within: within2.sqrt(), between: between2.max(0.0).sqrt() })
    }
}

#[cfg(test)]
mod tests {
    use blur_sim::rng::Rng;

    use super::*;

    #[test]
    fn spreads_within_and_between_are_told_apart() {
        let mut rng = Rng::new(5, 1);
        let groups: Vec<Vec<f64>> = (0..2000)
            .map(|group| {
                let place = 3.0 * rng.gaussian();
                (0..2 + group % 5).map(|_| place + 0.5 * rng.gaussian()).collect()
            })
            .collect();
        let found = Spread::of(&groups).unwrap();
        // 2000 groups and 6000 degrees of freedom within: five standard errors are 8 % and 5 %.
        assert!((found.within / 0.5 - 1.0).abs() < 0.05 && (found.between / 3.0 - 1.0).abs() < 0.08, "{found:?}");
    }

    #[test]
    fn means_that_differ_by_chance_only_have_no_spread_between() {
        let found = Spread::of(&[vec![-1.0, 1.0], vec![1.0, -1.0]]).unwrap();
        assert_eq!(found, Spread { within: 2.0_f64.sqrt(), between: 0.0 });
        assert_eq!(Spread::of(&[vec![1.0], vec![2.0]]), None);
        assert_eq!(Spread::of(&[vec![1.0, 2.0]]), None);
    }
}
