//! The thesis's synthetic protocol on honest blur.
//!
//! Every picture is blurred by an exact exposure and cut to what the exposure covers, nothing wrapped around; of that
//! the centre square of at most 512 pixels is kept, noise of a given PSNR added, rounded to 8 bit and clipped. Angles
//! run over all directions at one length, lengths over one direction whose angle is given.

use std::ops::RangeInclusive;

use blur_core::estimate::registry::{self, Method};
use blur_core::estimate::{AngleEstimator, AxialAngle, LengthEstimator, Settings};
use blur_sim::expose::Exposer;
use blur_sim::motion::Motion;
use blur_sim::sensor::{Sensor, f32_from_u8};
use ndarray::Array2;
use rayon::prelude::*;
use thiserror::Error;

use crate::data::Sharp;

/// PSNR in dB of each level; `None` is clean, rounded only.
pub const LEVELS: [Option<f64>; 4] = [None, Some(36.0), Some(28.0), Some(20.0)];
/// Blur length of the angle experiments in pixels.
pub const ANGLE_LENGTH_PX: f64 = 55.0;
/// Longest side of the pictures measured.
pub const SIDE_PX: usize = 512;

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
    /// Lengths in pixels.
    pub lengths_px: Vec<f64>,
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
            lengths_px: steps(5..=95, 5),
            angle_methods: registry::ANGLE.iter().collect(),
            length_methods: registry::LENGTH.iter().collect(),
            seed: 20_180_101,
        }
    }
}

/// Blurs `sharp` and records it at each level: 8-bit values as `f32`.
fn exposures(
    exposer: &mut Exposer,
    sharp: &Sharp,
    motion: &Motion,
    seed: u64,
) -> Result<Vec<Array2<f32>>, blur_sim::Error> {
    let blurred = exposer.expose(sharp.luma.view(), motion)?;
    let (rows, columns) = blurred.dim();
    let n = SIDE_PX.min(rows).min(columns);
    let (top, left) = ((rows - n) / 2, (columns - n) / 2);
    let square = Array2::from_shape_fn((n, n), |(r, c)| blurred[[top + r, left + c]]);
    LEVELS
        .iter()
        .enumerate()
        .map(|(level, psnr)| {
            let sensor = psnr.map_or_else(|| Ok(Sensor::ideal()), |db| Sensor::ideal().with_psnr_db(db))?;
            Ok(f32_from_u8(sensor.record(square.view(), seed.wrapping_mul(4).wrapping_add(level as u64))?.view()))
        })
        .collect()
}

/// A seed for each exposure that does not depend on the order of work.
fn seed_of(plan: &Plan, picture: usize, case: usize) -> u64 {
    plan.seed.wrapping_add(picture as u64 * 100_003).wrapping_add(case as u64 * 1009)
}

/// Measures the angle of every picture at every angle and level with every angle method of the plan.
///
/// # Errors
///
/// When the simulator or a method fails on a picture.
pub fn run_angles(plan: &Plan, pictures: &[Sharp]) -> Result<Vec<Outcome>, Error> {
    let per_picture = pictures.par_iter().enumerate().map(|(index, sharp)| {
        let mut exposer = Exposer::new();
        let mut estimators: Vec<_> =
            plan.angle_methods.iter().map(|method| (method.name, method.build(&Settings::default()))).collect();
        let mut outcomes = Vec::new();
        for (case, &deg) in plan.angles_deg.iter().enumerate() {
            let simulation = |source| Error::Simulation { name: sharp.name.clone(), source };
            let truth = AxialAngle::from_deg(deg);
            let motion = Motion::uniform(ANGLE_LENGTH_PX, truth).map_err(simulation)?;
            let shots = exposures(&mut exposer, sharp, &motion, seed_of(plan, index, case)).map_err(simulation)?;
            for (level, shot) in shots.iter().enumerate() {
                for (method, estimator) in &mut estimators {
                    let found = estimator.estimate(shot.view()).map_err(|source| Error::Estimation {
                        name: sharp.name.clone(),
                        method,
                        source,
                    })?;
                    outcomes.push(Outcome {
                        method,
                        level,
                        picture: sharp.name.clone(),
                        truth: deg,
                        error: found.angle.minus_deg(truth),
                        std: found.std_deg,
                        ok: found.status.doubt().is_none(),
                    });
                }
            }
        }
        Ok(outcomes)
    });
    Ok(per_picture.collect::<Result<Vec<_>, Error>>()?.into_iter().flatten().collect())
}

/// Measures the length of every picture at every length and level with every length method of the plan, the angle of 0
/// degrees being given.
///
/// # Errors
///
/// When the simulator or a method fails on a picture.
pub fn run_lengths(plan: &Plan, pictures: &[Sharp]) -> Result<Vec<Outcome>, Error> {
    let per_picture = pictures.par_iter().enumerate().map(|(index, sharp)| {
        let mut exposer = Exposer::new();
        let mut estimators: Vec<_> =
            plan.length_methods.iter().map(|method| (method.name, method.build(&Settings::default()))).collect();
        let mut outcomes = Vec::new();
        for (case, &length_px) in plan.lengths_px.iter().enumerate() {
            let simulation = |source| Error::Simulation { name: sharp.name.clone(), source };
            let angle = AxialAngle::from_deg(0.0);
            let motion = Motion::uniform(length_px, angle).map_err(simulation)?;
            let seed = seed_of(plan, index, 1000 + case);
            let shots = exposures(&mut exposer, sharp, &motion, seed).map_err(simulation)?;
            for (level, shot) in shots.iter().enumerate() {
                for (method, estimator) in &mut estimators {
                    let found = estimator.estimate(shot.view(), angle).map_err(|source| Error::Estimation {
                        name: sharp.name.clone(),
                        method,
                        source,
                    })?;
                    outcomes.push(Outcome {
                        method,
                        level,
                        picture: sharp.name.clone(),
                        truth: length_px,
                        error: found.length_px - length_px,
                        std: found.std_px,
                        ok: found.status.doubt().is_none(),
                    });
                }
            }
        }
        Ok(outcomes)
    });
    Ok(per_picture.collect::<Result<Vec<_>, Error>>()?.into_iter().flatten().collect())
}

/// Absolute errors of one method at the given levels.
pub fn errors(outcomes: &[Outcome], method: &str, levels: &[usize]) -> Vec<f64> {
    outcomes.iter().filter(|o| o.method == method && levels.contains(&o.level)).map(|o| o.error.abs()).collect()
}
