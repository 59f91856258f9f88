//! The table `negatives`: which pictures that did not move are called `ok` all the same? There should be none.
//!
//! Sharp pictures as they are and their centre square of at most 512 px; a photograph that is out of focus; and sharp
//! pictures put out of focus by a disk, whose diameter is drawn log-uniform from [`DIAMETERS_PX`], at three levels of
//! noise.

use std::path::Path;

use blur_sim::defocus::Defocus;
use blur_sim::expose::Exposer;
use blur_sim::rng::Rng;
use ndarray::{Array2, ArrayView2};
use serde::Serialize;

use super::outcome::{Judge, Outcome};
use super::pictures::{self, Sharp};
use super::report::{Report, Row, TextTable, percent};
use super::shots::{self, SIDE_PX, level_name};
use super::statistics::{self, Interval};
use super::{Plan, ask_all, simulating};
use crate::picture::{self, Linearize};
use crate::{Error, Result};

/// Least and greatest diameter of the disks in pixels.
pub const DIAMETERS_PX: (f64, f64) = (4.0, 40.0);

/// PSNR in dB of the pictures out of focus.
pub const LEVELS: [Option<f64>; 3] = [None, Some(36.0), Some(28.0)];

/// The photograph out of focus, in the data folder.
const OUT_OF_FOCUS: &str = "real_photos/text_defocus.jpg";

/// Stream of the diameters, one for each picture, apart from those of scenes and noise.
const STREAM: u64 = 0x9e70_0003_0000_0000;

/// Least side of a picture that is measured.
const LEAST_SIDE_PX: usize = 64;

const WHOLE: &str = "sharp";
const CENTRE: &str = "sharp, centre";
const PHOTOGRAPH: &str = "photograph";

/// What is measured of one source.
enum Case<'a> {
    Sharp(&'a Sharp),
    Defocused(&'a Sharp, Defocus, u64),
    Photograph(Array2<f32>),
}

/// What this table alone states of a kind of picture.
#[derive(Debug, Clone, Serialize)]
pub struct Details {
    /// Share called `ok`.
    pub ok: Option<Interval>,
    /// How many are called `low_confidence`.
    pub n_low_confidence: usize,
    /// How many are called `no_motion_blur`.
    pub n_no_motion_blur: usize,
    /// The pictures called `ok`.
    pub offenders: Vec<String>,
}

/// Makes the table.
///
/// # Errors
/// When there are no pictures, or one of them cannot be read, exposed or measured.
pub fn table(plan: &Plan) -> Result<Report> {
    let sharp = pictures::sharp_pictures(&plan.images)?;
    let mut report = Report::default();
    let cases = cases(plan, &sharp, &mut report.notes)?;
    let answers = ask_all(&cases, &plan.method, Exposer::new, ask)?;
    report.outcomes = answers.into_iter().flatten().collect();
    report.notes.push(format!(
        "{}: {} pictures without motion of {} sources; disks of {} to {} px; none should be called ok",
        plan.method.name(),
        report.outcomes.len(),
        sharp.len(),
        DIAMETERS_PX.0,
        DIAMETERS_PX.1,
    ));
    summarise(plan, &mut report)?;
    Ok(report)
}

fn cases<'a>(plan: &Plan, sharp: &'a [Sharp], notes: &mut Vec<String>) -> Result<Vec<Case<'a>>> {
    let mut cases = Vec::new();
    for (index, sharp) in sharp.iter().enumerate().step_by(plan.step.max(1)) {
        cases.push(Case::Sharp(sharp));
        let index = index as u64;
        let (least, greatest) = DIAMETERS_PX;
        let diameter_px = least * (greatest / least).powf(Rng::new(plan.seed, STREAM + index).uniform());
        let disk = Defocus::new(diameter_px).map_err(simulating(&sharp.name))?;
        if shots::leaves(LEAST_SIDE_PX, sharp.luma.dim(), &disk) {
            cases.push(Case::Defocused(sharp, disk, plan.seed.wrapping_mul(1_000_003).wrapping_add(index)));
        } else {
            notes.push(format!("{}: not put out of focus, too small for {diameter_px:.1} px", sharp.name));
        }
    }
    match photograph(&plan.images.join(OUT_OF_FOCUS))? {
        Some(luma) => cases.push(Case::Photograph(luma)),
        None => notes.push(format!("{OUT_OF_FOCUS}: skipped, it is not in {}", plan.images.display())),
    }
    if cases.is_empty() { Err(Error::NoSharpPicture) } else { Ok(cases) }
}

fn photograph(path: &Path) -> Result<Option<Array2<f32>>> {
    if !path.exists() {
        return Ok(None);
    }
    let picture = picture::read(path, Linearize::Auto).map_err(|error| Error::from(error).in_file(path))?;
    Ok(Some(picture.luma))
}

fn ask(judge: &mut Judge, exposer: &mut Exposer, case: &Case<'_>) -> Result<Vec<Outcome>> {
    match case {
        Case::Sharp(sharp) => {
            let stored = sharp.luma.mapv(|value| value as f32);
            let centre = shots::centre_square(stored.view(), SIDE_PX);
            let mut kinds: Vec<(&str, ArrayView2<'_, f32>)> = vec![(WHOLE, stored.view())];
            if centre.dim() != stored.dim() {
                kinds.push((CENTRE, centre));
            }
            kinds.into_iter().map(|(kind, view)| judge.ask(view, &sharp.name, kind, None)).collect()
        }
        Case::Defocused(sharp, disk, seed) => {
            let shots =
                shots::shots(exposer, sharp.luma.view(), disk, &LEVELS, *seed).map_err(simulating(&sharp.name))?;
            let name = format!("{}, disk of {:.1} px", sharp.name, disk.diameter_px());
            shots
                .iter()
                .zip(LEVELS)
                .map(|(shot, level)| judge.ask(shot.view(), &name, &disk_level(level), None))
                .collect()
        }
        Case::Photograph(luma) => Ok(vec![judge.ask(luma.view(), OUT_OF_FOCUS, PHOTOGRAPH, None)?]),
    }
}

fn disk_level(psnr_db: Option<f64>) -> String {
    format!("disk, {}", level_name(psnr_db))
}

fn summarise(plan: &Plan, report: &mut Report) -> Result<()> {
    let mut text = TextTable::new(&["kind", "n", "ok", "ok %", "low confidence", "no motion blur"]);
    let kinds = [WHOLE, CENTRE, PHOTOGRAPH].map(str::to_owned).into_iter().chain(LEVELS.map(disk_level));
    for kind in kinds {
        let outcomes: Vec<&Outcome> = report.outcomes.iter().filter(|outcome| outcome.level == kind).collect();
        let row = row(plan.method.name(), kind, &outcomes);
        text.push(vec![
            row.level.clone(),
            row.n.to_string(),
            row.n_ok.to_string(),
            percent(row.details.ok),
            row.details.n_low_confidence.to_string(),
            row.details.n_no_motion_blur.to_string(),
        ]);
        report.push(&row)?;
    }
    report.text = text;
    report.listed = report.outcomes.iter().filter(|outcome| outcome.is_ok()).cloned().collect();
    Ok(())
}

fn row(method: String, level: String, outcomes: &[&Outcome]) -> Row<Details> {
    let count = |status: &str| outcomes.iter().filter(|outcome| outcome.status == status).count();
    let offenders: Vec<&&Outcome> = outcomes.iter().filter(|outcome| outcome.is_ok()).collect();
    Row {
        table: "negatives",
        method,
        level,
        quantity: None,
        n: outcomes.len(),
        n_ok: offenders.len(),
        errors: None,
        thesis: None,
        details: Details {
            ok: statistics::share(offenders.len(), outcomes.len()),
            n_low_confidence: count("low_confidence"),
            n_no_motion_blur: count("no_motion_blur"),
            offenders: offenders.iter().map(|outcome| outcome.image.clone()).collect(),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::super::outcome::tests::outcome;
    use super::*;

    #[test]
    fn offenders_are_counted_and_named() {
        let statuses = ["ok", "low_confidence", "no_motion_blur", "no_motion_blur"];
        let outcomes = statuses.map(|status| Outcome { status, ..outcome(0.0, 0.0) });
        let row = row("m".to_owned(), WHOLE.to_owned(), &outcomes.iter().collect::<Vec<_>>());
        assert_eq!((row.n, row.n_ok), (4, 1));
        assert_eq!((row.details.n_low_confidence, row.details.n_no_motion_blur), (1, 2));
        assert_eq!(row.details.offenders, ["a.png"]);
    }
}
