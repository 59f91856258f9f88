//! The tables `4.1`, `4.2`, `4.4` and `4.5`: every method on the thesis's synthetic protocol, beside what it states.
//!
//! Angles are 0 to 90 degrees in steps of 1 at a length of 55 px, lengths 5 to 95 px in steps of 1 at 0 degrees, all on
//! every picture ([`protocol`](super::protocol)). The thesis does not say in which steps it went from 20 to 36 dB; the
//! pictures here have 36, 28 and 20.

use super::accuracy::{self, Group};
use super::answer::Measure;
use super::candidates;
use super::outcome::{GROSS_DEG, GROSS_SHARE};
use super::protocol::{LEAST_SIDE_PX, Protocol};
use super::report::Report;
use super::shots::level_name;
use super::{Plan, pictures};
use crate::Result;

/// Angles of the angle experiments in degrees.
pub const ANGLES_DEG: std::ops::RangeInclusive<u32> = 0..=90;

/// Blur length of the angle experiments in pixels.
pub const LENGTH_PX: f64 = 55.0;

/// Lengths of the length experiments in pixels.
pub const LENGTHS_PX: std::ops::RangeInclusive<u32> = 5..=95;

/// Angle of the length experiments in degrees.
pub const ANGLE_DEG: f64 = 0.0;

/// PSNR in dB of the noisy tables.
const NOISY: [Option<f64>; 3] = [Some(36.0), Some(28.0), Some(20.0)];

/// Table 4.1: angles without noise.
///
/// # Errors
/// Those of [`Protocol::run`].
pub fn angles_clean(plan: &Plan) -> Result<Report> {
    make(plan, "4.1", angles()?, &[None])
}

/// Table 4.2: angles with noise.
///
/// # Errors
/// Those of [`Protocol::run`].
pub fn angles_noisy(plan: &Plan) -> Result<Report> {
    make(plan, "4.2", angles()?, &NOISY)
}

/// Table 4.4: lengths without noise.
///
/// # Errors
/// Those of [`Protocol::run`].
pub fn lengths_clean(plan: &Plan) -> Result<Report> {
    make(plan, "4.4", lengths()?, &[None])
}

/// Table 4.5: lengths with noise.
///
/// # Errors
/// Those of [`Protocol::run`].
pub fn lengths_noisy(plan: &Plan) -> Result<Report> {
    make(plan, "4.5", lengths()?, &NOISY)
}

fn angles() -> Result<Protocol> {
    Protocol::angles(ANGLES_DEG.map(f64::from), LENGTH_PX)
}

fn lengths() -> Result<Protocol> {
    Protocol::lengths(LENGTHS_PX.map(f64::from), ANGLE_DEG)
}

fn make(plan: &Plan, table: &'static str, protocol: Protocol, levels: &[Option<f64>]) -> Result<Report> {
    let protocol = Protocol { levels: levels.to_vec(), step: plan.step, seed: plan.seed, ..protocol };
    let measure = protocol.measure;
    let methods = candidates::candidates(measure, plan.only.as_deref())?;
    let sharp = pictures::sharp_pictures(&plan.images)?;
    let found = protocol.run(&sharp, &methods)?;
    let mut report = Report { answers: found.answers, ..Report::default() };
    report.notes.push(format!(
        "{} pictures, {} blurs of each, one pair in {}: {} blurred pictures at each level, seed {}",
        sharp.len(),
        protocol.motions.len(),
        plan.step,
        found.cases,
        plan.seed
    ));
    report.notes.push(format!(
        "errors are of all answers; gross: {}; k=2: of the answers called ok, errors within two stated uncertainties",
        match measure {
            Measure::Angle => format!("more than {GROSS_DEG} deg"),
            Measure::Length | Measure::Speed => format!("more than {:.0} %", 100.0 * GROSS_SHARE),
        }
    ));
    report.notes.push(
        "thesis: 20 pictures of USC-SIPI; its quartiles seem to be those of means over pictures, ours are of single pictures"
            .to_owned(),
    );
    if !found.too_small.is_empty() {
        let names = found.too_small.join(", ");
        report.notes.push(format!("some blurs leave less than {LEAST_SIDE_PX} px of {names}: left out"));
    }
    accuracy::summarise(&mut report, table, measure, &methods, &groups(levels))?;
    Ok(report)
}

/// Each level, and the noisy ones together, which is what the thesis states.
fn groups(levels: &[Option<f64>]) -> Vec<Group> {
    let names: Vec<String> = levels.iter().map(|&level| level_name(level)).collect();
    let alone = names.len() == 1;
    let mut groups: Vec<Group> =
        names.iter().map(|name| Group { name: name.clone(), levels: vec![name.clone()], has_thesis: alone }).collect();
    if !alone {
        groups.push(Group { name: "36-20 dB".to_owned(), levels: names, has_thesis: true });
    }
    groups
}
