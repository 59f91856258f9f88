//! The table `6.2`: the nineteen regressions of the thesis on its rig, in silico, beside what it states; the blur length
//! alone, which every one of them must beat; and physics, which has learnt nothing.
//!
//! Both [designs](Design) of the rig at two levels of noise, the seed's own pictures, five folds drawn at random as in the
//! thesis.

use blur_accel::reduce::Components;
use blur_accel::regression::{PRESETS, Preset};
use blur_accel::validate::Folds;
use blur_sim::rig::{Design, Rig};

use super::Plan;
use super::report::{Boxplot, Report, Row, TextTable};
use super::statistics::Summary;
use crate::Result;
use crate::accel::evaluate::{Line, Options, evaluate};
use crate::accel::study::Study;
use crate::accel::table::{COLUMNS, Fields, cells};

/// PSNR in dB of blurred pictures and stills.
pub const LEVELS_DB: [f64; 2] = [40.0, 30.0];

/// Folds of the validation, as in thesis section 6.4.2.
pub const FOLDS: usize = 5;

/// Makes the table.
///
/// # Errors
/// When `step` leaves too few pictures for the folds.
pub fn table(plan: &Plan) -> Result<Report> {
    let mut report = Report::default();
    let header: Vec<&str> = ["design", "regression, m/s2"].into_iter().chain(COLUMNS).collect();
    report.text = TextTable::new(&header);
    let presets: Vec<&'static Preset> = PRESETS.iter().collect();
    for psnr_db in LEVELS_DB {
        let rig = Rig { psnr_db: Some(psnr_db), ..Rig::default() };
        for (name, design) in Design::NAMED {
            let study = Study::simulate(&rig, design, plan.seed, plan.step)?;
            let folds = Folds::random(study.len(), FOLDS, plan.seed)?;
            let options = Options { presets: &presets, components: Components::default(), seed: plan.seed };
            let lines = evaluate(&study, &folds, &options)?;
            let level = format!("{name}, {psnr_db} dB");
            add(&mut report, &level, study.len(), &lines)?;
            report.boxplots.push(boxplot(&level, &lines));
        }
    }
    report.notes.push(format!(
        "{} regressions, length alone and physics; seed {}, one picture in {}, {FOLDS} folds; errors in m/s2",
        PRESETS.len(),
        plan.seed,
        plan.step
    ));
    report.notes.push(
        "on fixed-release the length betrays the acceleration: a model must beat the length alone to have measured more"
            .to_owned(),
    );
    Ok(report)
}

fn add(report: &mut Report, level: &str, pictures: usize, lines: &[Line]) -> Result<()> {
    for line in lines {
        let mut row = vec![level.to_owned(), line.title.to_owned()];
        row.extend(cells(line));
        report.text.push(row);
        report.push(&Row {
            table: "6.2",
            method: line.name.to_owned(),
            level: level.to_owned(),
            quantity: Some("accel_m_s2"),
            n: pictures,
            n_ok: line.n,
            errors: summary(line),
            thesis: line.thesis.map(|thesis| thesis.mae),
            details: Fields::from(line),
        })?;
    }
    Ok(())
}

/// Of absolute errors, none of which counts as gross.
fn summary(line: &Line) -> Option<Summary> {
    let errors: Vec<f64> = line.points.iter().map(|point| (point.answer_m_s2 - point.truth_m_s2).abs()).collect();
    Summary::of(&errors, f64::INFINITY)
}

fn boxplot(level: &str, lines: &[Line]) -> Boxplot {
    Boxplot {
        name: format!("6.2-{}", level.replace(", ", "-").replace(' ', "")),
        title: format!("Acceleration, {level}"),
        axis: "absolute error, m/s2".to_owned(),
        boxes: lines.iter().filter_map(|line| Some((line.name.to_owned(), summary(line)?))).collect(),
    }
}
