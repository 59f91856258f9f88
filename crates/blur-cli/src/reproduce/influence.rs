//! The table `5.4.3`: what the errors of the speeds go together with.
//!
//! The thesis correlates the error with the brightness, contrast, correlation, energy, entropy and homogeneity of its blurred
//! pictures, poster by poster, and with the speed. Here the pictures are those of table `5.3` at the lower noise. Shots of
//! one poster at one speed are hardly different pictures, so they count once: with the means of their absolute errors and of
//! their features.

use blur_sim::rig::Pass;
use serde::Serialize;

use super::Plan;
use super::answer::{Answer, Measure};
use super::candidates::{self, Candidate};
use super::correlation::{self, Coefficient};
use super::report::{Report, Row, TextTable, number};
use super::slider::{self, LEVELS_DB};
use super::statistics::Summary;
use super::texture::Texture;
use crate::Result;

const TABLE: &str = "5.4.3";

/// The last influence, after the features of the picture.
const SPEED: &str = "speed";

/// What this table alone states.
#[derive(Debug, Clone, Serialize)]
pub struct Details {
    /// Pearson's correlation of the absolute error and the influence over all settings.
    pub pearson: Option<Coefficient>,
    /// Spearman's.
    pub spearman: Option<Coefficient>,
    /// Pearson's within posters, as in thesis figure 5.12.
    pub within_posters: Option<Coefficient>,
}

/// The answers to one picture, and what it looks like.
type Taken = (Vec<Answer>, Texture);

/// Means over the shots of one poster at one speed.
struct Setting {
    poster: usize,
    /// Mean absolute error of every method in percent.
    errors: Vec<f64>,
    /// Mean of every feature, and the speed.
    influences: Vec<f64>,
}

/// Makes the table.
///
/// # Errors
/// When a picture cannot be taken or measured.
pub fn table(plan: &Plan) -> Result<Report> {
    let methods = candidates::candidates(Measure::Speed, plan.only.as_deref())?;
    let passes = slider::speed_passes(plan)?;
    let taken = slider::take(LEVELS_DB[0], Measure::Speed, &passes, &methods, Texture::of)?;
    let settings = settings(&passes, &taken, methods.len());
    let mut report = Report::default();
    report.notes.push(format!(
        "{} pictures of {} settings at {} dB, one in {}, seed {}; the absolute error in percent of the speed",
        passes.len(),
        settings.len(),
        LEVELS_DB[0],
        plan.step,
        plan.seed
    ));
    report.notes.push(
        "95 % intervals and p count settings; there are no more than five posters, and a feature hardly differs within one"
            .to_owned(),
    );
    report.notes.push(
        "thesis, of dct-pseudo-cepstrum: the error falls with entropy and brightness and goes with the speed"
            .to_owned(),
    );
    summarise(&mut report, &methods, &settings)?;
    report.answers = taken.into_iter().flat_map(|(answers, _)| answers).collect();
    Ok(report)
}

/// The settings in the order of the pictures.
fn settings(passes: &[Pass], taken: &[Taken], methods: usize) -> Vec<Setting> {
    let shots: Vec<(&Pass, &Taken)> = passes.iter().zip(taken).collect();
    let same = |a: &(&Pass, _), b: &(&Pass, _)| (a.0.poster, a.0.speed_m_s) == (b.0.poster, b.0.speed_m_s);
    shots
        .chunk_by(same)
        .map(|shots| {
            let mean = |value: &dyn Fn(&Taken) -> f64| {
                shots.iter().map(|(_, taken)| value(taken)).sum::<f64>() / shots.len() as f64
            };
            let pass = shots[0].0;
            let errors = (0..methods).map(|method| mean(&|(answers, _)| answers[method].summarised_error().abs()));
            let features = (0..Texture::NAMES.len()).map(|feature| mean(&|(_, texture)| texture.values()[feature]));
            Setting {
                poster: pass.poster,
                errors: errors.collect(),
                influences: features.chain([pass.speed_m_s]).collect(),
            }
        })
        .collect()
}

fn summarise(report: &mut Report, methods: &[Candidate], settings: &[Setting]) -> Result<()> {
    let mut text = TextTable::new(&[
        "speed, %",
        "influence",
        "n",
        "Pearson",
        "95 %",
        "p",
        "Spearman",
        "95 %",
        "p",
        "within posters",
        "95 %",
        "p",
    ]);
    let posters: Vec<usize> = settings.iter().map(|setting| setting.poster).collect();
    for (index, method) in methods.iter().enumerate() {
        let errors: Vec<f64> = settings.iter().map(|setting| setting.errors[index]).collect();
        for (number, influence) in Texture::NAMES.into_iter().chain([SPEED]).enumerate() {
            let values: Vec<f64> = settings.iter().map(|setting| setting.influences[number]).collect();
            let details = Details {
                pearson: correlation::pearson(&values, &errors),
                spearman: correlation::spearman(&values, &errors),
                within_posters: correlation::pearson_within(&values, &errors, &posters),
            };
            let mut cells = vec![method.name().to_owned(), influence.to_owned(), settings.len().to_string()];
            for found in [details.pearson, details.spearman, details.within_posters] {
                cells.extend(three(found));
            }
            text.push(cells);
            report.push(&Row {
                table: TABLE,
                method: method.name().to_owned(),
                level: influence.to_owned(),
                quantity: Some(Measure::Speed.field()),
                n: settings.len(),
                n_ok: settings.len(),
                errors: Summary::of(&errors, f64::INFINITY),
                thesis: None,
                details,
            })?;
        }
    }
    report.text = text;
    Ok(())
}

fn three(coefficient: Option<Coefficient>) -> [String; 3] {
    let interval = coefficient.map_or_else(|| "-".to_owned(), |found| format!("{:+.2} {:+.2}", found.low, found.high));
    [number(coefficient.map(|found| found.value), 2), interval, number(coefficient.map(|found| found.p), 4)]
}
