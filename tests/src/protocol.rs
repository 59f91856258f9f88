//! The thesis's synthetic protocol on honest blur.
//!
//! Every picture is blurred by an exact exposure and cut to what the exposure covers, nothing wrapped around; of that
//! the centre square of at most 512 pixels is kept, noise of a given PSNR added, rounded to 8 bit and clipped. Angles
//! run over all directions at one length, lengths over one direction whose angle is given.

use std::ops::RangeInclusive;

use blur_cli::reproduce::shots;
use blur_core::estimate::registry::{self, Method};
use blur_core::estimate::{AngleEstimator, AxialAngle, LengthEstimator, Settings};
use blur_sim::expose::Exposer;
use blur_sim::motion::Motion;
use ndarray::ArrayView2;
use rayon::prelude::*;
use thiserror::Error;

use crate::data::Sharp;

pub use blur_cli::reproduce::shots::LEVELS;

/// What can go wrong in a run of the protocol.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// The simulator refused.
    #[error("{name}: {source}")]
    Simulation {
        /// Picture.
        name: String,
        /// Why.
        source: blur_sim::Error,
    },
    /// A method failed on a picture.
    #[error("{name}, {method}: {source}")]
    Estimation {
        /// Picture.
        name: String,
        /// Method.
        method: &'static str,
        /// Why.
        source: blur_core::Error,
    },
}

/// One measured picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Method.
    pub method: &'static str,
    /// Index into [`LEVELS`].
    pub level: usize,
    /// Picture.
    pub picture: String,
    /// The true angle (degrees) or length (pixels).
    pub truth: f64,
    /// Signed error in degrees or pixels.
    pub error: f64,
    /// The method's own standard uncertainty, if it states one.
    pub std: Option<f64>,
    /// Whether the method called its answer `ok`.
    pub ok: bool,
}

/// Which pictures of the protocol to run.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Angles in degrees.
    pub angles_deg: Vec<f64>,
    /// Blur length of the angle experiments in pixels.
    pub angle_length_px: f64,
    /// Lengths in pixels.
    pub lengths_px: Vec<f64>,
    /// Angle of the length experiments in degrees.
    pub length_angle_deg: f64,
    /// Angle methods.
    pub angle_methods: Vec<&'static Method<Box<dyn AngleEstimator>>>,
    /// Length methods.
    pub length_methods: Vec<&'static Method<Box<dyn LengthEstimator>>>,
    /// Seed of the noise.
    pub seed: u64,
}

impl Plan {
    /// Angles 0 to 179 in steps of 7 degrees at 55 px, lengths 5 to 95 px in steps of 5 at 0 degrees, all methods.
    pub fn full() -> Self {
        let steps = |range: RangeInclusive<u32>, step: usize| range.step_by(step).map(f64::from).collect();
        Self {
            angles_deg: steps(0..=179, 7),
            angle_length_px: 55.0,
            lengths_px: steps(5..=95, 5),
            length_angle_deg: 0.0,
            angle_methods: registry::ANGLE.iter().collect(),
            length_methods: registry::LENGTH.iter().collect(),
            seed: 20_180_101,
        }
    }
}

/// What a method says of one picture: signed error, standard uncertainty, whether it called its answer `ok`.
type Answer = (f64, Option<f64>, bool);

/// Exposes every picture with every motion at every level and asks every method. `truth` is what is measured of a motion;
/// seeds begin at `seed` and do not depend on the order of work.
fn run<E>(
    pictures: &[Sharp],
    motions: &[Motion],
    methods: &[&'static Method<E>],
    seed: u64,
    truth: impl Fn(&Motion) -> f64 + Sync,
    ask: impl Fn(&mut E, ArrayView2<'_, f32>, &Motion) -> blur_core::Result<Answer> + Sync,
) -> Result<Vec<Outcome>, Error> {
    let per_picture =
        pictures.par_iter().enumerate().map(|(index, sharp)| {
            let mut exposer = Exposer::new();
            let mut estimators: Vec<_> =
                methods.iter().map(|method| (method.name, method.build(&Settings::default()))).collect();
            let mut outcomes = Vec::new();
            for (case, motion) in motions.iter().enumerate() {
                let seed = seed.wrapping_add(index as u64 * 100_003).wrapping_add(case as u64 * 1009);
                let shots = shots::shots(&mut exposer, sharp.luma.view(), motion, &LEVELS, seed)
                    .map_err(|source| Error::Simulation { name: sharp.name.clone(), source })?;
                for (level, shot) in shots.iter().enumerate() {
                    for (method, estimator) in &mut estimators {
                        let (error, std, ok) = ask(estimator, shot.view(), motion)
                            .map_err(|source| Error::Estimation { name: sharp.name.clone(), method, source })?;
                        let (picture, truth) = (sharp.name.clone(), truth(motion));
                        outcomes.push(Outcome { method, level, picture, truth, error, std, ok });
                    }
                }
            }
            Ok(outcomes)
        });
    Ok(per_picture.collect::<Result<Vec<_>, Error>>()?.into_iter().flatten().collect())
}

/// The uniform motions of these lengths (pixels) and angles (degrees).
fn motions(blurs: impl Iterator<Item = (f64, f64)>) -> Result<Vec<Motion>, Error> {
    blurs
        .map(|(length_px, deg)| Motion::uniform(length_px, AxialAngle::from_deg(deg)))
        .collect::<Result<_, _>>()
        .map_err(|source| Error::Simulation { name: "the plan".to_owned(), source })
}

/// Measures the angle of every picture at every angle and level with every angle method of the plan.
///
/// # Errors
///
/// When the simulator or a method fails on a picture.
pub fn run_angles(plan: &Plan, pictures: &[Sharp]) -> Result<Vec<Outcome>, Error> {
    let motions = motions(plan.angles_deg.iter().map(|&deg| (plan.angle_length_px, deg)))?;
    run(
        pictures,
        &motions,
        &plan.angle_methods,
        plan.seed,
        |motion| motion.angle().deg(),
        |method, image, motion| {
            let found = method.estimate(image)?;
            Ok((found.angle.minus_deg(motion.angle()), found.std_deg, found.status.doubt().is_none()))
        },
    )
}

/// Measures the length of every picture at every length and level with every length method of the plan, the angle being
/// given.
///
/// # Errors
///
/// When the simulator or a method fails on a picture.
pub fn run_lengths(plan: &Plan, pictures: &[Sharp]) -> Result<Vec<Outcome>, Error> {
    let motions = motions(plan.lengths_px.iter().map(|&length_px| (length_px, plan.length_angle_deg)))?;
    // Seeds of their own: far beyond those of the angles.
    let seed = plan.seed.wrapping_add(1000 * 1009);
    run(pictures, &motions, &plan.length_methods, seed, Motion::length_px, |method, image, motion| {
        let found = method.estimate(image, motion.angle())?;
        Ok((found.length_px - motion.length_px(), found.std_px, found.status.doubt().is_none()))
    })
}

/// Absolute errors of one method at the given levels.
pub fn errors(outcomes: &[Outcome], method: &str, levels: &[usize]) -> Vec<f64> {
    outcomes.iter().filter(|o| o.method == method && levels.contains(&o.level)).map(|o| o.error.abs()).collect()
}
