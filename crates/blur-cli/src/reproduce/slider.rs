//! The tables `5.2` and `5.3`: every method on the virtual rig of the thesis's chapter 5, beside what it states.
//!
//! Five posters at 1.21 m before a slider of constant speed, 0.1 s, 0.7789 mm/px, 512x512 pixels
//! ([`belt`](blur_sim::rig::belt)). Table 5.2: angles 0 to 90 degrees in steps of 1 at the speed V9, five pictures of each
//! poster. Table 5.3: the ten speeds along the rows, ten pictures of each poster. The thesis does not state the noise of its
//! camera; the pictures here have a PSNR of 40 and of 30 dB. Exposure and scale are those of the rig, without error: the
//! uncertainty of a speed is that of its length.

use blur_core::camera::Scale;
use blur_core::estimate::AxialAngle;
use blur_core::motion::{Exposure, Speed};
use blur_sim::rig::belt::SPEEDS_M_S;
use blur_sim::rig::{POSTERS, Pass, Rig, Studio};
use blur_sim::sensor::f32_from_u8;
use metrology::Measurement;
use ndarray::ArrayView2;
use rayon::prelude::*;

use super::accuracy::{self, Group};
use super::answer::{Answer, Measure};
use super::candidates::{self, Candidate, Contestant, Reading};
use super::report::Report;
use super::shots::level_name;
use super::synthetic::ANGLES_DEG;
use super::thinning::thinned;
use super::{Plan, simulating};
use crate::{Error, Result};

/// PSNR in dB of the pictures.
pub const LEVELS_DB: [f64; 2] = [40.0, 30.0];

/// Pictures of each poster at each angle.
const SHOTS_AN_ANGLE: usize = 5;

/// Pictures of each poster at each speed.
pub const SHOTS_A_SPEED: usize = 10;

/// Table 5.2: angles.
///
/// # Errors
/// When a picture cannot be taken or measured.
pub fn angles(plan: &Plan) -> Result<Report> {
    let methods = candidates::candidates(Measure::Angle, plan.only.as_deref())?;
    let cells = ANGLES_DEG.count();
    let passes = passes(plan, cells, SHOTS_AN_ANGLE, |rig, poster, index, cell| {
        let angle = AxialAngle::from_deg(f64::from(*ANGLES_DEG.start()) + cell as f64);
        rig.pass(poster, index, SPEEDS_M_S[SPEEDS_M_S.len() - 1], angle, plan.seed)
    })?;
    let mut report = Report::default();
    note(&mut report, plan, &passes, cells * SHOTS_AN_ANGLE);
    for psnr_db in LEVELS_DB {
        report
            .answers
            .extend(take(psnr_db, Measure::Angle, &passes, &methods, |_| ())?.into_iter().flat_map(|(a, ())| a));
    }
    accuracy::summarise(&mut report, "5.2", Measure::Angle, &methods, &groups())?;
    Ok(report)
}

/// Table 5.3: speeds.
///
/// # Errors
/// When a picture cannot be taken or measured.
pub fn speeds(plan: &Plan) -> Result<Report> {
    let methods = candidates::candidates(Measure::Speed, plan.only.as_deref())?;
    let passes = speed_passes(plan)?;
    let mut report = Report::default();
    note(&mut report, plan, &passes, SPEEDS_M_S.len() * SHOTS_A_SPEED);
    for psnr_db in LEVELS_DB {
        report
            .answers
            .extend(take(psnr_db, Measure::Speed, &passes, &methods, |_| ())?.into_iter().flat_map(|(a, ())| a));
    }
    accuracy::summarise(&mut report, "5.3", Measure::Speed, &methods, &groups())?;
    Ok(report)
}

/// The pictures of table 5.3: in the order of speeds, then posters, then shots.
pub(super) fn speed_passes(plan: &Plan) -> Result<Vec<Pass>> {
    passes(plan, SPEEDS_M_S.len(), SHOTS_A_SPEED, |rig, poster, index, cell| {
        rig.pass(poster, index, SPEEDS_M_S[cell], AxialAngle::from_deg(0.0), plan.seed)
    })
}

/// The plan's share of `shots` pictures of each poster in each of `cells`.
fn passes(
    plan: &Plan,
    cells: usize,
    shots: usize,
    pass: impl Fn(&Rig, usize, usize, usize) -> blur_sim::Result<Pass>,
) -> Result<Vec<Pass>> {
    let rig = Rig::belt_driven();
    thinned(cells * POSTERS.len() * shots, plan.step)
        .map(|number| {
            let (cell, poster, shot) =
                (number / (POSTERS.len() * shots), number / shots % POSTERS.len(), number % shots);
            Ok(pass(&rig, poster, cell * shots + shot, cell)?)
        })
        .collect()
}

/// The rig with this noise.
fn rig(psnr_db: f64) -> Rig {
    Rig { psnr_db: Some(psnr_db), ..Rig::belt_driven() }
}

/// Takes all pictures with noise of this PSNR, asks all `methods` about each, and looks at it otherwise.
pub(super) fn take<L: Send>(
    psnr_db: f64,
    measure: Measure,
    passes: &[Pass],
    methods: &[Candidate],
    look: impl Fn(ArrayView2<'_, u8>) -> L + Sync,
) -> Result<Vec<(Vec<Answer>, L)>> {
    let rig = rig(psnr_db);
    let studio = Studio::new(&rig)?;
    let level = level_name(Some(psnr_db));
    passes
        .par_iter()
        .map_init(
            || (studio.clone(), candidates::build(methods)),
            |(studio, contestants), pass| {
                let name = format!("{} {:03}", POSTERS[pass.poster].name, pass.index);
                let recorded = studio.passing(pass).map_err(simulating(&name))?;
                let picture = f32_from_u8(recorded.view());
                let answers = contestants
                    .iter_mut()
                    .map(|contestant| match measure {
                        Measure::Speed => speed(contestant, &rig, pass, picture.view(), &name, &level),
                        Measure::Angle | Measure::Length => {
                            contestant.answer(measure, picture.view(), &pass.motion, &name, &level)
                        }
                    })
                    .collect::<Result<_>>()?;
                Ok((answers, look(recorded.view())))
            },
        )
        .collect()
}

/// The speed that follows from the length that a method finds.
fn speed(
    contestant: &mut Contestant<'_>,
    rig: &Rig,
    pass: &Pass,
    picture: ArrayView2<'_, f32>,
    name: &str,
    level: &str,
) -> Result<Answer> {
    let length = contestant
        .read(Measure::Speed, picture, &pass.motion)
        .map_err(|source| Error::Measuring { image: format!("{name}, {}", contestant.name), source })?;
    let scale = Scale::new(Measurement::exact(rig.scale_m_per_px)?)?;
    let exposure = Exposure::new(Measurement::exact(rig.exposure_s)?)?;
    let speed = Speed::from_blur(length.value, length.std, scale, exposure);
    let reading = Reading { value: speed.value_m_s, std: speed.std_m_s, status: length.status };
    Ok(Answer::new(Measure::Speed, name, level, contestant.name, pass.speed_m_s, &reading))
}

fn note(report: &mut Report, plan: &Plan, passes: &[Pass], each: usize) {
    report.notes.push(format!(
        "{} posters, {each} pictures of each, one in {}: {} pictures at each level, seed {}",
        POSTERS.len(),
        plan.step,
        passes.len(),
        plan.seed
    ));
    report.notes.push(
        "errors are of all answers; k=2: of the answers called ok, errors within two stated uncertainties".to_owned(),
    );
    report.notes.push("thesis: five printed posters before a real camera, whose noise it does not state".to_owned());
}

fn groups() -> Vec<Group> {
    let group = |psnr_db| {
        let name = level_name(Some(psnr_db));
        Group { levels: vec![name.clone()], name, has_thesis: true }
    };
    LEVELS_DB.map(group).into()
}
