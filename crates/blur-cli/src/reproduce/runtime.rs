//! The tables `4.3` and `4.6`: the time that every method takes for one picture.
//!
//! As in thesis section 4.4.2 one picture without noise is measured a hundred times. The times are of this machine and
//! not those of the thesis; what can be compared is how many plain 2-D FFTs of the same picture, taken in turn with the
//! methods, fit into them.

use std::cmp::Reverse;
use std::time::Instant;

use blur_core::estimate::AxialAngle;
use blur_core::spectrum::Dft2;
use blur_sim::expose::Exposer;
use blur_sim::motion::Motion;
use ndarray::ArrayView2;
use serde::Serialize;

use super::answer::Measure;
use super::candidates;
use super::pictures::{self, Sharp};
use super::protocol::LEAST_SIDE_PX;
use super::report::{Boxplot, Report, Row, TextTable, number};
use super::shots::{self, SIDE_PX};
use super::statistics::Summary;
use super::synthetic::{ANGLE_DEG, LENGTH_PX};
use super::{Plan, simulating, thesis};
use crate::{Error, Result};

/// Times that every method is run.
pub const RUNS: usize = 100;

/// The name of what all are compared with.
const FFT: &str = "fft-2d";

/// What these tables alone state.
#[derive(Debug, Clone, Serialize)]
pub struct Details {
    /// Least time over that of a plain 2-D FFT of the picture: what else the machine does only ever adds.
    pub ratio_to_fft: Option<f64>,
}

/// Table 4.3: times of the angle methods.
///
/// # Errors
/// When there is no picture, or it cannot be read, exposed or measured.
pub fn angles(plan: &Plan) -> Result<Report> {
    make(plan, "4.3", Measure::Angle)
}

/// Table 4.6: times of the length methods.
///
/// # Errors
/// When there is no picture, or it cannot be read, exposed or measured.
pub fn lengths(plan: &Plan) -> Result<Report> {
    make(plan, "4.6", Measure::Length)
}

fn make(plan: &Plan, table: &'static str, measure: Measure) -> Result<Report> {
    let methods = candidates::candidates(measure, plan.only.as_deref())?;
    let motion = Motion::uniform(LENGTH_PX, AxialAngle::from_deg(ANGLE_DEG))?;
    let sharp = largest(pictures::sharp_pictures(&plan.images)?, &motion)?;
    let shots = shots::shots(&mut Exposer::new(), sharp.luma.view(), &motion, &[None], plan.seed)
        .map_err(simulating(&sharp.name))?;
    let Some(shot) = shots.first() else { return Err(Error::NoSharpPicture) };
    let level = format!("{}x{}", shot.ncols(), shot.nrows());
    let mut report = Report::default();
    report.notes.push(format!(
        "{} with a blur of {LENGTH_PX} px at {ANGLE_DEG} deg, cut to {level}; {} runs on one thread",
        sharp.name,
        plan.share_of(RUNS)
    ));
    report.notes.push(
        "times depend on the machine and on what else it does; the thesis's (MATLAB 2015b) are not to be reproduced"
            .to_owned(),
    );
    let mut times_ms = vec![(FFT.to_owned(), Vec::new())];
    times_ms.extend(methods.iter().map(|method| (method.name().to_owned(), Vec::new())));
    let mut contestants = candidates::build(&methods);
    let mut dft = Dft2::new(shot.nrows(), shot.ncols());
    // The first round makes plans and buffers and is not counted.
    for round in 0..=plan.share_of(RUNS) {
        let mut took = vec![timed(|| transform(&mut dft, shot.view()))];
        for contestant in &mut contestants {
            let mut outcome = Ok(());
            took.push(timed(|| {
                outcome = contestant.read(measure, shot.view(), &motion).map(|_| ());
            }));
            outcome.map_err(|source| Error::Measuring { image: sharp.name.clone(), source })?;
        }
        if round > 0 {
            times_ms.iter_mut().zip(took).for_each(|((_, times), took)| times.push(took));
        }
    }
    summarise(&mut report, table, &level, &times_ms)?;
    Ok(report)
}

/// The picture that is largest after the blur, at most [`SIDE_PX`]; the first of several.
fn largest(pictures: Vec<Sharp>, motion: &Motion) -> Result<Sharp> {
    let (lost_rows, lost_cols) = motion.extent_px();
    let side = |picture: &Sharp| {
        let (rows, cols) = picture.luma.dim();
        rows.saturating_sub(lost_rows).min(cols.saturating_sub(lost_cols)).min(SIDE_PX)
    };
    pictures
        .into_iter()
        .filter(|picture| side(picture) >= LEAST_SIDE_PX)
        .min_by_key(|picture| Reverse(side(picture)))
        .ok_or(Error::NoSharpPicture)
}

fn transform(dft: &mut Dft2, picture: ArrayView2<'_, f32>) {
    dft.input().assign(&picture);
    std::hint::black_box(dft.transform());
}

/// Milliseconds.
fn timed(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    1e3 * start.elapsed().as_secs_f64()
}

fn summarise(report: &mut Report, table: &'static str, level: &str, times_ms: &[(String, Vec<f64>)]) -> Result<()> {
    let mut text = TextTable::new(&["time, ms", "n", "mean", "median", "min", "q1", "q3", "max", "x fft", "thesis"]);
    let mut boxes = Vec::new();
    let mut fft_least_ms = None;
    for (method, times) in times_ms {
        let summary = Summary::of(times, f64::INFINITY);
        let least_ms = summary.map(|summary| summary.min);
        let fft_least_ms = *fft_least_ms.get_or_insert(least_ms);
        let row = Row {
            table,
            method: method.clone(),
            level: level.to_owned(),
            quantity: Some("time_ms"),
            n: times.len(),
            n_ok: times.len(),
            errors: summary,
            thesis: thesis::time_ms(table, method),
            details: Details { ratio_to_fft: least_ms.zip(fft_least_ms).map(|(least, fft)| least / fft) },
        };
        let time = |pick: fn(&Summary) -> f64| number(row.errors.as_ref().map(pick), 3);
        text.push(vec![
            row.method.clone(),
            row.n.to_string(),
            time(|times| times.mean),
            time(|times| times.median),
            time(|times| times.min),
            time(|times| times.q1),
            time(|times| times.q3),
            time(|times| times.max),
            number(row.details.ratio_to_fft, 1),
            number(row.thesis, 2),
        ]);
        boxes.extend(summary.map(|summary| (method.clone(), summary)));
        report.push(&row)?;
    }
    report.boxplots.push(Boxplot {
        name: table.to_owned(),
        title: format!("Table {table}, {level}"),
        axis: "time, ms".to_owned(),
        boxes,
    });
    report.text = text;
    Ok(())
}
