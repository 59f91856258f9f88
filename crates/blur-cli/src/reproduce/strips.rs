//! The tables `7.1`, `edges` and `7.2`: how small may the segment be in which a length is measured, and how must
//! its edge look?
//!
//! All sharp pictures are moved exactly along their rows, without wrapping, recorded in 8 bit without noise, and cut to the
//! middle 256 x 256 pixels; the thesis has the picture Baboon of that size alone, which is not among them. Segments are cut
//! about the middle. The direction is known. Errors are relative to the true length and of all answers; an answer more than
//! [`GROSS_SHARE`] off is gross, and counts as it is.

use blur_core::image::{MIN_SIDE, Window};
use serde::Serialize;

use super::Plan;
use super::outcome::GROSS_SHARE;
use super::report::{Report, Row, TextTable, number};
use super::segments::{Answer, Cut, SIDE_PX, ask, moved, sharp_pictures};
use super::statistics::Summary;
use crate::Result;

/// Heights of the segments of table 7.1, 256 pixels wide, with the thesis's mean errors in percent at a blur of 30 px.
pub const HEIGHTS_PX: [(usize, f64); 8] =
    [(256, 0.09), (128, 0.10), (64, 1.95), (32, 2.10), (16, 6.75), (8, 14.41), (4, 30.14), (2, 33.29)];

/// Blur of table 7.1 in pixels.
pub const LENGTH_PX: f64 = 30.0;

/// Lengths in pixels of table 7.2 with the thesis's least widths in pixels and its errors there in percent.
pub const LEAST_WIDTHS: [(usize, usize, f64); 9] = [
    (10, 20, 0.0),
    (20, 40, 0.0),
    (30, 60, 0.0),
    (40, 40, 0.0),
    (50, 100, 0.0),
    (60, 120, 0.0),
    (70, 130, 1.0),
    (80, 160, 0.0),
    (90, 180, 1.0),
];

/// A width suffices when the error in it, and in all wider ones, is at most this many percent.
pub const SUFFICIENT_PERCENT: f64 = 1.0;

/// Longest blur in pixels of `edges` and table 7.2: every length is measured on the pictures that bear it.
const LONGEST_PX: f64 = 90.0;

const OURS: &str = "whittle";
const THESIS: &str = "dct-pseudo-cepstrum";

/// Our length method under the window that costs least, and the thesis's under the thesis's.
const BEST: (&str, Window) = (OURS, Window::Tukey { taper: 0.25 });
const AS_IN_THESIS: (&str, Window) = (THESIS, Window::Hann);

/// What these tables alone state of a row.
#[derive(Debug, Clone, Serialize)]
pub struct Details {
    /// Blur in pixels.
    pub true_length_px: f64,
    /// Share of gross errors among all answers.
    pub gross: f64,
    /// Pictures with a gross error, in alphabetical order.
    pub gross_pictures: Vec<String>,
    /// Mean error in percent of the answers called `ok`.
    pub mean_ok: Option<f64>,
    /// Share of errors within two stated standard uncertainties, of the answers called `ok`.
    pub coverage_k2: Option<f64>,
    /// The least widths that suffice, in the row of the segment twice as wide as the blur (table 7.2).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub least_width: Option<LeastWidths>,
}

/// The least widths that suffice for a blur (table 7.2).
#[derive(Debug, Clone, Copy, Serialize)]
pub struct LeastWidths {
    /// By the median error, in pixels.
    pub by_median_px: Option<usize>,
    /// By the mean error, in pixels.
    pub by_mean_px: Option<usize>,
    /// The thesis's, in pixels.
    pub thesis_px: usize,
}

/// Makes table 7.1.
///
/// # Errors
/// When there are no pictures, or one of them cannot be read, exposed or measured.
pub fn heights(plan: &Plan) -> Result<Report> {
    let sharp = sharp_pictures(plan, LENGTH_PX)?;
    let mut report = Report { text: TextTable::new(&COLUMNS), ..Report::default() };
    report.notes.push(format!(
        "{} sharp pictures, {SIDE_PX}x{SIDE_PX}, moved along the rows, angle known; all answers count, gross: more than \
         {:.0} %",
        sharp.len(),
        100.0 * GROSS_SHARE
    ));
    report.notes.push(format!("{THESIS} needs segments of at least {MIN_SIDE} rows"));
    let shots = moved(&sharp, LENGTH_PX)?;
    for (method, window) in [BEST, (OURS, Window::Hann), AS_IN_THESIS] {
        for (height, thesis) in HEIGHTS_PX.into_iter().filter(|&(height, _)| is_measured(method, height)) {
            let cut = Cut::Soft { width: SIDE_PX, height, window };
            let answers = ask(method, &shots, LENGTH_PX, cut)?;
            let row =
                row("7.1", method, format!("{SIDE_PX}x{height}, {}", cut.edge()), LENGTH_PX, Some(thesis), &answers);
            report.text.push(line(&row));
            report.push(&row)?;
        }
    }
    Ok(report)
}

/// Makes the table of figures 7.4 and 7.5: the same pictures cut out along a hard edge, and under a window.
///
/// # Errors
/// Those of [`heights`].
pub fn edges(plan: &Plan) -> Result<Report> {
    let sharp = sharp_pictures(plan, LONGEST_PX)?;
    let mut report = Report { text: TextTable::new(&COLUMNS), ..Report::default() };
    report.notes.push(format!(
        "{} sharp pictures at each length, {SIDE_PX}x{SIDE_PX}, moved along the rows, angle known; hard disk: cut out along a \
         hard edge, black around it, no window (thesis, figure 7.4: above 100 % at every length), the others under a window \
         (figure 7.5: below 2 %)",
        sharp.len()
    ));
    let soft = |(method, window)| (method, Cut::Soft { width: SIDE_PX, height: SIDE_PX, window });
    for length_px in (1..=18).map(|i| f64::from(5 * i)) {
        let shots = moved(&sharp, length_px)?;
        for (method, cut) in [soft(BEST), (OURS, Cut::HardDisk), soft(AS_IN_THESIS), (THESIS, Cut::HardDisk)] {
            let answers = ask(method, &shots, length_px, cut)?;
            let row = row("edges", method, cut.edge().to_owned(), length_px, None, &answers);
            report.text.push(line(&row));
            report.push(&row)?;
        }
    }
    Ok(report)
}

/// Makes table 7.2: for programs a row for every length and width, for people one for every length.
///
/// # Errors
/// Those of [`heights`].
pub fn widths(plan: &Plan) -> Result<Report> {
    let sharp = sharp_pictures(plan, LONGEST_PX)?;
    let text = TextTable::new(&[&COLUMNS[..], &["least px, median", "least px, mean", "least px, thesis"]].concat());
    let mut report = Report { text, ..Report::default() };
    report.notes.push(format!(
        "{} sharp pictures, segments {SIDE_PX} px high and 20 to 250 px wide, angle known; the row is of the width 2 L, least: \
         in it and all wider ones the error is at most {SUFFICIENT_PERCENT} %; {OURS} takes no window up to 64 px, \
         nor in wider ones where its spectrum is not sure; {THESIS} needs {MIN_SIDE} columns",
        sharp.len()
    ));
    for (length, thesis_px, thesis) in LEAST_WIDTHS {
        let length_px = length as f64;
        let shots = moved(&sharp, length_px)?;
        for (method, window) in [BEST, AS_IN_THESIS] {
            let mut rows = Vec::new();
            for width in (20..=250).rev().step_by(10).filter(|&width| is_measured(method, width)) {
                let cut = Cut::Soft { width, height: SIDE_PX, window };
                let answers = ask(method, &shots, length_px, cut)?;
                let level = format!("{width}x{SIDE_PX}, {}", cut.edge());
                let thesis = (width == thesis_px).then_some(thesis);
                rows.push((width, row("7.2", method, level, length_px, thesis, &answers)));
            }
            let least_width = LeastWidths {
                by_median_px: least_width(&rows, |errors| errors.median),
                by_mean_px: least_width(&rows, |errors| errors.mean),
                thesis_px,
            };
            for (width, mut row) in rows {
                if width == 2 * length {
                    row.details.least_width = Some(least_width);
                    let px = |width: Option<usize>| width.map_or_else(|| "-".to_owned(), |width| width.to_string());
                    let least = [least_width.by_median_px, least_width.by_mean_px, Some(thesis_px)].map(px);
                    report.text.push([line(&row), least.to_vec()].concat());
                }
                report.push(&row)?;
            }
        }
    }
    Ok(report)
}

/// Whether the method takes segments of this height, or width.
fn is_measured(method: &str, side: usize) -> bool {
    method == OURS || side >= MIN_SIDE
}

/// The narrowest of `rows`, which run from wide to narrow, down to which all suffice.
fn least_width(rows: &[(usize, Row<Details>)], error: impl Fn(Summary) -> f64) -> Option<usize> {
    let suffices = |(_, row): &&(usize, Row<Details>)| row.errors.is_some_and(|of| error(of) <= SUFFICIENT_PERCENT);
    rows.iter().take_while(suffices).last().map(|&(width, _)| width)
}

fn row(
    table: &'static str,
    method: &str,
    level: String,
    true_length_px: f64,
    thesis: Option<f64>,
    answers: &[Answer<'_>],
) -> Row<Details> {
    let errors: Vec<f64> = answers.iter().map(|answer| answer.error).collect();
    let ok: Vec<&Answer<'_>> = answers.iter().filter(|answer| answer.is_ok).collect();
    let errors_ok: Vec<f64> = ok.iter().map(|answer| answer.error).collect();
    let covered = ok.iter().filter(|answer| answer.deviations.is_some_and(|deviations| deviations <= 2.0)).count();
    let mut gross_pictures: Vec<String> =
        answers.iter().filter(|answer| answer.is_gross()).map(|answer| answer.picture.to_owned()).collect();
    gross_pictures.sort();
    Row {
        table,
        method: method.to_owned(),
        level,
        quantity: Some("length_percent"),
        n: answers.len(),
        n_ok: ok.len(),
        errors: Summary::of(&errors, 100.0 * GROSS_SHARE),
        thesis,
        details: Details {
            true_length_px,
            gross: gross_pictures.len() as f64 / answers.len().max(1) as f64,
            gross_pictures,
            mean_ok: Summary::of(&errors_ok, f64::INFINITY).map(|summary| summary.mean),
            coverage_k2: (!ok.is_empty()).then(|| covered as f64 / ok.len() as f64),
            least_width: None,
        },
    }
}

const COLUMNS: [&str; 13] = [
    "segment",
    "L, px",
    "method",
    "n",
    "ok",
    "mean %",
    "thesis %",
    "median %",
    "max %",
    "gross %",
    "mean of ok %",
    "within 2 u %",
    "gross pictures",
];

fn line(row: &Row<Details>) -> Vec<String> {
    let details = &row.details;
    let percent = |share: f64| 100.0 * share;
    vec![
        row.level.clone(),
        number(Some(details.true_length_px), 0),
        row.method.clone(),
        row.n.to_string(),
        row.n_ok.to_string(),
        number(row.errors.map(|errors| errors.mean), 3),
        number(row.thesis, 2),
        number(row.errors.map(|errors| errors.median), 3),
        number(row.errors.map(|errors| errors.max), 2),
        number(Some(percent(details.gross)), 1),
        number(details.mean_ok, 3),
        number(details.coverage_k2.map(percent), 0),
        details.gross_pictures.join(" "),
    ]
}
