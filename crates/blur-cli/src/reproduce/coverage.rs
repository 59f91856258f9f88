//! The table `coverage`: are the errors small, and are they as large as the method says?
//!
//! Photographs are blurred exactly by motions drawn at random, directions uniform over the half circle and lengths
//! log-uniform over [`LENGTHS_PX`]; of what the exposure covers the centre square of at most 512 px is kept, noise is
//! added at each of [`LEVELS`], and the picture rounded to 8 bit and clipped. The draws go round the pictures, with a
//! fresh motion each time; the levels of one draw share its motion and have noise of their own. Nothing that was
//! measured is left out.

use blur_core::estimate::AxialAngle;
use blur_sim::expose::Exposer;
use blur_sim::motion::Motion;
use blur_sim::rng::Rng;
use ndarray::Array2;
use serde::Serialize;

use super::outcome::{GROSS_DEG, GROSS_SHARE, Outcome};
use super::pictures::{self, Sharp};
use super::report::{Boxplot, Quantity, Report, Row, TextTable, number, percent};
use super::shots::{self, LEVELS, level_name};
use super::statistics::{self, ELLIPSE_95, Interval, Summary};
use super::{Plan, ask_all, simulating};
use crate::{Error, Result};

/// Shortest and longest blur in pixels.
pub const LENGTHS_PX: (f64, f64) = (6.0, 90.0);

/// Least side of a picture that is measured.
pub const LEAST_SIDE_PX: usize = 64;

/// Pictures of next to nothing but one grey: no method has anything to see in them.
pub const LEFT_OUT: [&str; 3] = ["moon.png", "page.png", "text.png"];

/// Stream of the motions, one for each draw, apart from those of scenes and noise.
const STREAM: u64 = 0x9e70_0001_0000_0000;

/// One picture with its motion.
struct Case<'a> {
    sharp: &'a Sharp,
    motion: Motion,
    seed: u64,
}

/// What this table alone states of a level.
#[derive(Debug, Clone, Serialize)]
pub struct Details {
    /// Share of the answers called `ok`.
    pub ok: Option<Interval>,
    /// Share of gross errors among those.
    pub gross_ok: Option<Interval>,
    /// Share of gross errors among all answers.
    pub gross_all: Option<Interval>,
    /// Mean signed error of the answers called `ok`.
    pub bias: Option<f64>,
    /// Median of their stated standard uncertainties.
    pub std_median: Option<f64>,
    /// Share of their errors within one stated standard uncertainty; 68.3 % would be right.
    pub coverage_k1: Option<Interval>,
    /// Within two; 95.4 % would be right.
    pub coverage_k2: Option<Interval>,
    /// Share of them whose stated 95 % ellipse of angle and length holds the truth.
    pub coverage_ellipse: Option<Interval>,
}

/// Makes the table.
///
/// # Errors
/// When there are no pictures, or one of them cannot be read, exposed or measured.
pub fn table(plan: &Plan) -> Result<Report> {
    let mut sharp = pictures::sharp_pictures(&plan.images)?;
    sharp.retain(|picture| !LEFT_OUT.contains(&picture.name.as_str()));
    let mut report = Report::default();
    let cases = cases(plan, &sharp, &mut report.notes)?;
    report.notes.push(format!(
        "{}: {} pictures of {} sources at each level; L log-uniform in {} to {} px, any angle; gross: more than \
         {GROSS_DEG} deg or {:.0} %",
        plan.method.name(),
        cases.len(),
        sharp.len(),
        LENGTHS_PX.0,
        LENGTHS_PX.1,
        100.0 * GROSS_SHARE,
    ));
    report.notes.push("errors, stated uncertainties (u) and coverage are of the answers called ok".to_owned());
    let answers = ask_all(&cases, &plan.method, Exposer::new, |judge, exposer, case| {
        let name = &case.sharp.name;
        let shots = shots::shots(exposer, case.sharp.luma.view(), &case.motion, &LEVELS, case.seed)
            .map_err(simulating(name))?;
        let levels = LEVELS.iter().map(|&level| level_name(level));
        let ask = |(shot, level): (&Array2<f32>, String)| judge.ask(shot.view(), name, &level, Some(&case.motion));
        shots.iter().zip(levels).map(ask).collect::<Result<Vec<_>>>()
    })?;
    report.outcomes = answers.into_iter().flatten().collect();
    summarise(plan, &mut report)?;
    Ok(report)
}

/// The draws of the plan, less those that would leave too little of their picture, which `notes` names.
fn cases<'a>(plan: &Plan, sharp: &'a [Sharp], notes: &mut Vec<String>) -> Result<Vec<Case<'a>>> {
    let mut cases = Vec::new();
    // The first draws and not every n-th one, which would come back to the same few pictures.
    for (draw, sharp) in sharp.iter().cycle().take(plan.share_of(plan.per_level)).enumerate() {
        let draw = draw as u64;
        let motion = motion(plan.seed, draw).map_err(simulating(&sharp.name))?;
        if shots::leaves(LEAST_SIDE_PX, sharp.luma.dim(), &motion) {
            cases.push(Case { sharp, motion, seed: plan.seed.wrapping_mul(1_000_003).wrapping_add(draw) });
        } else {
            let (length, angle) = (motion.length_px(), motion.angle().deg());
            notes.push(format!(
                "{}: skipped, {length:.1} px at {angle:.1} deg leave less than {LEAST_SIDE_PX} px of it",
                sharp.name
            ));
        }
    }
    if cases.is_empty() { Err(Error::NoSharpPicture) } else { Ok(cases) }
}

/// The motion of one draw.
fn motion(seed: u64, draw: u64) -> blur_sim::Result<Motion> {
    let mut rng = Rng::new(seed, STREAM + draw);
    let (shortest, longest) = LENGTHS_PX;
    let length_px = shortest * (longest / shortest).powf(rng.uniform());
    Motion::uniform(length_px, AxialAngle::from_deg(rng.uniform_in(0.0, 180.0)))
}

fn summarise(plan: &Plan, report: &mut Report) -> Result<()> {
    let mut text = TextTable::new(&[
        "level",
        "quantity",
        "n",
        "ok %",
        "gross of ok %",
        "gross of all %",
        "median",
        "p90",
        "bias",
        "u",
        "k=1 %",
        "k=2 %",
        "95 % ellipse",
    ]);
    for quantity in Quantity::ALL {
        let mut boxes = Vec::new();
        for level in LEVELS.map(level_name) {
            let outcomes: Vec<&Outcome> = report.outcomes.iter().filter(|outcome| outcome.level == level).collect();
            let row = row(plan.method.name(), level.clone(), quantity, &outcomes);
            text.push(cells(&row, quantity));
            boxes.extend(row.errors.map(|errors| (level, errors)));
            report.push(&row)?;
        }
        report.boxplots.push(Boxplot {
            name: format!("coverage-{}", quantity.field()),
            title: format!("{}: errors of the answers called ok", plan.method.name()),
            axis: format!("absolute error of the {}", quantity.title()),
            boxes,
        });
    }
    report.text = text;
    Ok(())
}

fn row(method: String, level: String, quantity: Quantity, outcomes: &[&Outcome]) -> Row<Details> {
    let ok: Vec<&Outcome> = outcomes.iter().copied().filter(|outcome| outcome.is_ok()).collect();
    let errors: Vec<f64> = ok.iter().filter_map(|outcome| quantity.error(outcome)).collect();
    let absolute: Vec<f64> = errors.iter().map(|error| error.abs()).collect();
    let stds: Vec<f64> = ok.iter().filter_map(|outcome| quantity.std(outcome)).collect();
    let gross = |outcomes: &[&Outcome]| {
        statistics::share(outcomes.iter().filter(|outcome| outcome.is_gross()).count(), outcomes.len())
    };
    // Of the answers that state an uncertainty.
    let covered = |k: f64| {
        let hits = ok.iter().filter_map(|outcome| Some(quantity.error(outcome)?.abs() <= k * quantity.std(outcome)?));
        share_of(hits)
    };
    let details = Details {
        ok: statistics::share(ok.len(), outcomes.len()),
        gross_ok: gross(&ok),
        gross_all: gross(outcomes),
        bias: (!errors.is_empty()).then(|| errors.iter().sum::<f64>() / errors.len() as f64),
        std_median: statistics::median(&stds),
        coverage_k1: covered(1.0),
        coverage_k2: covered(2.0),
        coverage_ellipse: share_of(
            ok.iter().filter_map(|outcome| outcome.squared_distance()).map(|square| square <= ELLIPSE_95),
        ),
    };
    Row {
        table: "coverage",
        method,
        level,
        quantity: Some(quantity.field()),
        n: outcomes.len(),
        n_ok: ok.len(),
        errors: Summary::of(&absolute, f64::INFINITY),
        thesis: None,
        details,
    }
}

fn share_of(hits: impl Iterator<Item = bool>) -> Option<Interval> {
    let (mut inside, mut n) = (0, 0);
    for hit in hits {
        inside += usize::from(hit);
        n += 1;
    }
    statistics::share(inside, n)
}

fn cells(row: &Row<Details>, quantity: Quantity) -> Vec<String> {
    let details = &row.details;
    vec![
        row.level.clone(),
        quantity.title().to_owned(),
        row.n.to_string(),
        percent(details.ok),
        percent(details.gross_ok),
        percent(details.gross_all),
        number(row.errors.map(|errors| errors.median), 3),
        number(row.errors.map(|errors| errors.p90), 3),
        number(details.bias, 3),
        number(details.std_median, 3),
        percent(details.coverage_k1),
        percent(details.coverage_k2),
        percent(details.coverage_ellipse),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::outcome::tests::outcome;
    use super::*;

    #[test]
    fn motions_fill_the_ranges_and_repeat() {
        let motions: Vec<Motion> = (0..2000).map(|draw| motion(7, draw).unwrap()).collect();
        assert_eq!(motions[3], motion(7, 3).unwrap());
        assert_ne!(motions[3], motion(8, 3).unwrap());
        assert!(motions.iter().all(|m| (6.0..90.0).contains(&m.length_px())));
        // The geometric mean of the range divides the lengths into halves, 90 degrees the angles; 2000 tell to 2.2 % (2
        // s).
        let share = |of: &dyn Fn(&Motion) -> bool| motions.iter().filter(|m| of(m)).count() as f64 / 2000.0;
        assert!((share(&|m| m.length_px() < (6.0_f64 * 90.0).sqrt()) - 0.5).abs() < 0.035);
        assert!((share(&|m| m.angle().deg() < 90.0) - 0.5).abs() < 0.035);
    }

    #[test]
    fn a_level_counts_what_it_says() {
        // Errors of 0.5, 1.5, 2.5 and a gross 8 px at u = 1 px; a fifth answer is not trusted and gross.
        let mut outcomes: Vec<Outcome> = [0.5, -1.5, 2.5, 8.0, 19.0].map(|error| outcome(0.0, error)).to_vec();
        outcomes[4].status = "low_confidence";
        let outcomes: Vec<&Outcome> = outcomes.iter().collect();
        let row = row("m".to_owned(), "clean".to_owned(), Quantity::Length, &outcomes);
        assert_eq!((row.n, row.n_ok), (5, 4));
        let value = |share: Option<Interval>| share.unwrap().value;
        let details = &row.details;
        assert_eq!((value(details.ok), value(details.gross_ok), value(details.gross_all)), (0.8, 0.25, 0.4));
        assert_eq!((value(details.coverage_k1), value(details.coverage_k2)), (0.25, 0.5));
        assert_eq!((details.bias, details.std_median, details.coverage_ellipse), (Some(9.5 / 4.0), Some(1.0), None));
        assert_eq!(row.errors.map(|errors| errors.median), Some(2.0));
    }

    #[test]
    fn a_level_without_a_trusted_answer_states_no_errors() {
        let mut doubtful = outcome(0.0, 1.0);
        doubtful.status = "no_motion_blur";
        let row = row("m".to_owned(), "20 dB".to_owned(), Quantity::Angle, &[&doubtful]);
        assert_eq!((row.n, row.n_ok, row.errors), (1, 0, None));
        assert!(row.details.gross_ok.is_none() && row.details.bias.is_none() && row.details.coverage_k1.is_none());
    }
}
