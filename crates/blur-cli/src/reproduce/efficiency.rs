//! The table `efficiency`: how near do the errors come to the Cramér-Rao bound?
//!
//! The scenes are Gaussian random fields whose power falls as `f^-2.4`, for which the bound is known. They have a mean
//! of 127.5 and a standard deviation of 40, so that less than two pixels in a thousand are clipped, before the blur;
//! they are larger than the picture all around, blurred exactly, cut, recorded with noise and rounded to 8 bit, whose
//! variance of 1/12 counts as noise. The angles are drawn at random.
//!
//! The level of a field is its own, since most of its variance is in its longest waves: every error is divided by the
//! bound of its own picture, and the root mean square of these ratios is stated.

use std::f64::consts::TAU;

use blur_core::estimate::AxialAngle;
use blur_core::image::Window;
use blur_sim::expose::expose;
use blur_sim::motion::Motion;
use blur_sim::rng::Rng;
use blur_sim::scene::gaussian_field;
use blur_sim::sensor::sigma_from_psnr_db;
use ndarray::{Array2, ArrayView2};
use serde::Serialize;

use super::cramer_rao::{Bound, PowerLaw, cramer_rao};
use super::outcome::Outcome;
use super::report::{Boxplot, Quantity, Report, Row, TextTable, number};
use super::shots::{SIDE_PX, centre_square, level_name, record};
use super::statistics::{self, Interval, Summary};
use super::{Plan, ask_all, simulating};
use crate::{Error, Result};

/// Exponent of the power spectra.
pub const EXPONENT: f64 = 2.4;

/// Blur lengths in pixels.
pub const LENGTHS_PX: [f64; 2] = [20.0, 60.0];

/// PSNR in dB, peak 255.
pub const PSNRS_DB: [f64; 2] = [40.0, 30.0];

/// The window of the bound that the errors are divided by.
pub const WINDOW: Window = Window::Tukey { taper: 0.25 };

/// Pixels of the field around the picture beyond the reach of the blur.
const MARGIN_PX: usize = 32;

/// Variance of rounding to integers.
const ROUNDING_VARIANCE: f64 = 1.0 / 12.0;

/// Stream of the angles, one for each field, apart from those of scenes and noise.
const STREAM: u64 = 0x9e70_0002_0000_0000;

/// One field with its motion and noise.
struct Case {
    name: String,
    level: String,
    motion: Motion,
    psnr_db: f64,
    seed: u64,
}

/// What this table alone states of a cell.
#[derive(Debug, Clone, Serialize)]
pub struct Details {
    /// Root mean square error of the answers called `ok`, with its 95 % interval.
    pub rmse_ok: Option<Interval>,
    /// Root mean square error of all answers.
    pub rmse_all: Option<Interval>,
    /// Root mean square of the bounds without a window: no method can do better.
    pub bound: Option<f64>,
    /// Root mean square of the bounds under [`WINDOW`].
    pub bound_windowed: Option<f64>,
    /// Root mean square of error over windowed bound, of the answers called `ok`.
    pub ratio_ok: Option<Interval>,
    /// The same of all answers.
    pub ratio_all: Option<Interval>,
    /// Median of the stated standard uncertainties of the answers called `ok`.
    pub std_median: Option<f64>,
}

/// The two bounds of one picture.
#[derive(Clone, Copy)]
struct Bounds {
    plain: Bound,
    windowed: Bound,
}

/// Makes the table.
///
/// # Errors
/// When a field cannot be exposed or measured.
pub fn table(plan: &Plan) -> Result<Report> {
    let cases = cases(plan)?;
    let mut report = Report::default();
    report.notes.push(format!(
        "{}: {} Gaussian fields of power f^-{EXPONENT}, {SIDE_PX}x{SIDE_PX}, random angles",
        plan.method.name(),
        cases.len()
    ));
    report.notes.push(
        "bound: Cramér-Rao without a window, and under a Tukey window of 0.25; ratio: rms of error over the latter \
         (95 % interval)"
            .to_owned(),
    );
    let answers = ask_all(
        &cases,
        &plan.method,
        || (),
        |judge, (), case| {
            let (shot, bounds) = shot(case)?;
            Ok(Answer { outcome: judge.ask(shot.view(), &case.name, &case.level, Some(&case.motion))?, bounds })
        },
    )?;
    summarise(plan, &answers, &mut report)?;
    report.outcomes = answers.into_iter().map(|answer| answer.outcome).collect();
    Ok(report)
}

/// What was said of one picture, and what can be known from it.
struct Answer {
    outcome: Outcome,
    bounds: Option<Bounds>,
}

fn level(length_px: f64, psnr_db: f64) -> String {
    format!("{}, {length_px:.0} px", level_name(Some(psnr_db)))
}

/// All cells, as (length, PSNR).
fn cells() -> impl Iterator<Item = (f64, f64)> {
    PSNRS_DB.into_iter().flat_map(|psnr_db| LENGTHS_PX.into_iter().map(move |length_px| (length_px, psnr_db)))
}

fn cases(plan: &Plan) -> Result<Vec<Case>> {
    let mut cases = Vec::new();
    for (cell, (length_px, psnr_db)) in cells().enumerate() {
        for field in 0..plan.share_of(plan.fields) {
            let index = (cell * plan.fields + field) as u64;
            let angle = AxialAngle::from_deg(Rng::new(plan.seed, STREAM + index).uniform_in(0.0, 180.0));
            let name = format!("field {field}");
            let motion = Motion::uniform(length_px, angle).map_err(simulating(&name))?;
            let seed = plan.seed.wrapping_mul(1_000_003).wrapping_add(index);
            cases.push(Case { name, level: level(length_px, psnr_db), motion, psnr_db, seed });
        }
    }
    if cases.is_empty() { Err(Error::NoSharpPicture) } else { Ok(cases) }
}

/// The picture of a case, and what can be known from it.
fn shot(case: &Case) -> Result<(Array2<f32>, Option<Bounds>)> {
    let refused = simulating(&case.name);
    let (lost_rows, lost_cols) = case.motion.extent_px();
    let border = 2 * MARGIN_PX;
    let (rows, cols) = (SIDE_PX + lost_rows + border, SIDE_PX + lost_cols + border);
    let field = gaussian_field(case.seed, rows, cols, EXPONENT).map_err(&refused)?;
    let exposure = expose(field.view(), &case.motion).map_err(&refused)?;
    let inner = centre_square(exposure.view(), SIDE_PX);
    let picture = record(inner, Some(case.psnr_db), case.seed).map_err(&refused)?;
    let scene = PowerLaw {
        amplitude: amplitude(field.view(), EXPONENT),
        exponent: EXPONENT,
        noise_variance: sigma_from_psnr_db(case.psnr_db).powi(2) + ROUNDING_VARIANCE,
    };
    let bound = |window| cramer_rao((SIDE_PX, SIDE_PX), &scene, case.motion.angle(), case.motion.length_px(), window);
    let bounds = bound(None).zip(bound(Some(WINDOW))).map(|(plain, windowed)| Bounds { plain, windowed });
    Ok((picture, bounds))
}

/// The power at one cycle per pixel of a field whose power falls as `f^-exponent`.
///
/// The Laplacian of the field weighs the powers by `(4 - 2 cos 2 pi u - 2 cos 2 pi v)²`: what is left is made of the
/// many short waves, so that its mean square is known to a fraction of a percent, while the variance of the field is in
/// a few long ones.
fn amplitude(field: ArrayView2<'_, f64>, exponent: f64) -> f64 {
    let (rows, cols) = field.dim();
    let (inner_rows, inner_cols) = (1..rows - 1, 1..cols - 1);
    let (mut sum, mut count) = (0.0, 0.0);
    for row in inner_rows {
        for col in inner_cols.clone() {
            let around = field[[row - 1, col]] + field[[row + 1, col]] + field[[row, col - 1]] + field[[row, col + 1]];
            sum += (4.0 * field[[row, col]] - around).powi(2);
            count += 1.0;
        }
    }
    // The midpoint rule over the whole plane of frequencies, by one quadrant.
    let n = 400;
    let mut weight = 0.0;
    for i in 0..n {
        let u = (f64::from(i) + 0.5) / f64::from(2 * n);
        for j in 0..n {
            let v = (f64::from(j) + 0.5) / f64::from(2 * n);
            let laplacian = 4.0 - 2.0 * (TAU * u).cos() - 2.0 * (TAU * v).cos();
            weight += laplacian * laplacian * u.hypot(v).powf(-exponent) / f64::from(n * n);
        }
    }
    sum / count / weight
}

fn summarise(plan: &Plan, answers: &[Answer], report: &mut Report) -> Result<()> {
    let mut text = TextTable::new(&[
        "level",
        "quantity",
        "n",
        "ok",
        "rmse of ok",
        "rmse of all",
        "median",
        "u",
        "bound",
        "windowed",
        "ratio of ok",
        "ratio of all",
    ]);
    for quantity in Quantity::ALL {
        let mut boxes = Vec::new();
        for (length_px, psnr_db) in cells() {
            let level = level(length_px, psnr_db);
            let answers: Vec<&Answer> = answers.iter().filter(|answer| answer.outcome.level == level).collect();
            let row = row(plan.method.name(), level.clone(), quantity, &answers);
            text.push(line(&row, quantity));
            boxes.extend(row.errors.map(|errors| (level, errors)));
            report.push(&row)?;
        }
        report.boxplots.push(Boxplot {
            name: format!("efficiency-{}", quantity.field()),
            title: format!("{}: errors on Gaussian fields, answers called ok", plan.method.name()),
            axis: format!("absolute error of the {}", quantity.title()),
            boxes,
        });
    }
    report.text = text;
    Ok(())
}

/// The bound of one quantity.
fn std_of(bound: &Bound, quantity: Quantity) -> f64 {
    match quantity {
        Quantity::Angle => bound.angle_std_deg,
        Quantity::Length => bound.length_std_px,
    }
}

fn row(method: String, level: String, quantity: Quantity, answers: &[&Answer]) -> Row<Details> {
    let ok: Vec<&Answer> = answers.iter().copied().filter(|answer| answer.outcome.is_ok()).collect();
    let errors = |answers: &[&Answer]| -> Vec<f64> {
        answers.iter().filter_map(|answer| quantity.error(&answer.outcome)).collect()
    };
    let ratios = |answers: &[&Answer]| -> Vec<f64> {
        let ratio = |answer: &&Answer| {
            Some(quantity.error(&answer.outcome)? / std_of(&answer.bounds.as_ref()?.windowed, quantity))
        };
        answers.iter().filter_map(ratio).collect()
    };
    let bound = |of: fn(&Bounds) -> &Bound| {
        let bounds = answers.iter().filter_map(|answer| answer.bounds.as_ref());
        let stds: Vec<f64> = bounds.map(|bounds| std_of(of(bounds), quantity)).collect();
        statistics::rms(&stds).map(|rms| rms.value)
    };
    let absolute: Vec<f64> = errors(&ok).iter().map(|error| error.abs()).collect();
    let stds: Vec<f64> = ok.iter().filter_map(|answer| quantity.std(&answer.outcome)).collect();
    let details = Details {
        rmse_ok: statistics::rms(&errors(&ok)),
        rmse_all: statistics::rms(&errors(answers)),
        bound: bound(|bounds| &bounds.plain),
        bound_windowed: bound(|bounds| &bounds.windowed),
        ratio_ok: statistics::rms(&ratios(&ok)),
        ratio_all: statistics::rms(&ratios(answers)),
        std_median: statistics::median(&stds),
    };
    Row {
        table: "efficiency",
        method,
        level,
        quantity: Some(quantity.field()),
        n: answers.len(),
        n_ok: ok.len(),
        errors: Summary::of(&absolute, f64::INFINITY),
        thesis: None,
        details,
    }
}

fn line(row: &Row<Details>, quantity: Quantity) -> Vec<String> {
    let details = &row.details;
    let value = |interval: Option<Interval>| number(interval.map(|interval| interval.value), 4);
    let ratio = |interval: Option<Interval>| {
        interval
            .map_or_else(|| "-".to_owned(), |Interval { value, low, high }| format!("{value:.2} ({low:.2}-{high:.2})"))
    };
    vec![
        row.level.clone(),
        quantity.title().to_owned(),
        row.n.to_string(),
        row.n_ok.to_string(),
        value(details.rmse_ok),
        value(details.rmse_all),
        number(row.errors.map(|errors| errors.median), 4),
        number(details.std_median, 4),
        number(details.bound, 4),
        number(details.bound_windowed, 4),
        ratio(details.ratio_ok),
        ratio(details.ratio_all),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::outcome::tests::outcome;
    use super::*;

    #[test]
    fn the_amplitude_is_the_power_of_the_field() {
        // White noise of variance 40² has that power at every frequency; 300² pixels tell the mean square to 1 %.
        let white = gaussian_field(3, 300, 300, 0.0).unwrap();
        assert!((amplitude(white.view(), 0.0) / 1600.0 - 1.0).abs() < 0.02);
        // Differences along the rows weigh the same law otherwise: mean square A ∫ (2 - 2 cos 2 pi u) f^-2.4.
        let field = gaussian_field(4, 600, 600, EXPONENT).unwrap();
        let differences = field.windows([1, 2]).into_iter().map(|pair| (pair[[0, 1]] - pair[[0, 0]]).powi(2));
        let found = differences.sum::<f64>() / (600.0 * 599.0);
        let (n, mut weight) = (1500, 0.0);
        for i in 0..n {
            let u = (f64::from(i) + 0.5) / f64::from(2 * n);
            for j in 0..n {
                let v = (f64::from(j) + 0.5) / f64::from(2 * n);
                weight += (2.0 - 2.0 * (TAU * u).cos()) * u.hypot(v).powf(-EXPONENT) / f64::from(n * n);
            }
        }
        let expected = amplitude(field.view(), EXPONENT) * weight;
        assert!((found / expected - 1.0).abs() < 0.03, "{found} for {expected}");
    }

    #[test]
    fn errors_are_counted_in_bounds() {
        let bound = |length_std_px| Bound { angle_std_deg: 1.0, length_std_px, correlation: 0.0 };
        let answer = |error, length_std_px| Answer {
            outcome: outcome(0.0, error),
            bounds: Some(Bounds { plain: bound(0.5 * length_std_px), windowed: bound(length_std_px) }),
        };
        let mut answers = [answer(0.3, 0.1), answer(-0.2, 0.1), answer(5.0, 0.1)];
        answers[2].outcome.status = "low_confidence";
        let answers: Vec<&Answer> = answers.iter().collect();
        let row = row("m".to_owned(), "l".to_owned(), Quantity::Length, &answers);
        let value = |interval: Option<Interval>| interval.unwrap().value;
        assert!((value(row.details.ratio_ok) - 6.5_f64.sqrt()).abs() < 1e-12);
        assert!((value(row.details.rmse_all) - (25.13_f64 / 3.0).sqrt()).abs() < 1e-12);
        assert!((row.details.bound.unwrap() - 0.05).abs() < 1e-12);
        assert_eq!((row.n, row.n_ok), (3, 2));
    }

    #[test]
    fn the_pictures_are_not_clipped() {
        let motion = Motion::uniform(20.0, AxialAngle::from_deg(20.0)).unwrap();
        let case = Case { name: "f".to_owned(), level: level(20.0, 40.0), motion, psnr_db: 40.0, seed: 1 };
        let (picture, bounds) = shot(&case).unwrap();
        assert_eq!(picture.dim(), (SIDE_PX, SIDE_PX));
        let clipped = picture.iter().filter(|&&value| value == 0.0 || value == 255.0).count();
        assert!(clipped < 2 * SIDE_PX * SIDE_PX / 1000, "{clipped}");
        let bounds = bounds.unwrap();
        assert!(bounds.plain.length_std_px < bounds.windowed.length_std_px);
    }
}
