//! The thesis's synthetic protocol on honest blur (section 4.4.1).
//!
//! Every picture is blurred by an exact exposure and cut to what the exposure covers, nothing wrapped around; of that
//! the centre square of at most 512 pixels is kept, noise of a given PSNR added, rounded to 8 bit and clipped. Angles run
//! at one length; lengths run along one direction, which is told to the methods of lengths. Each picture is blurred once
//! for all levels and methods.

use blur_core::estimate::AxialAngle;
use blur_sim::expose::Exposer;
use blur_sim::motion::Motion;
use rayon::prelude::*;

use super::answer::{Answer, Measure};
use super::candidates::{self, Candidate};
use super::pictures::Sharp;
use super::shots::{self, level_name};
use super::simulating;
use super::thinning::thinned;
use crate::{Error, Result};

/// Least side of a picture that is measured.
pub const LEAST_SIDE_PX: usize = 64;

/// Which pictures are made, and what is asked of them.
#[derive(Debug, Clone)]
pub struct Protocol {
    /// What is measured.
    pub measure: Measure,
    /// Blurs of every picture.
    pub motions: Vec<Motion>,
    /// PSNR in dB of the noise added, `None` for none.
    pub levels: Vec<Option<f64>>,
    /// Only one pair of picture and motion in so many.
    pub step: usize,
    /// Seed of the noise.
    pub seed: u64,
}

/// What came of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Answers {
    /// All answers, in an order that does not depend on the threads.
    pub answers: Vec<Answer>,
    /// Pairs of picture and motion that were measured.
    pub cases: usize,
    /// Names of the pictures that are too small for some of the motions, once for each.
    pub too_small: Vec<String>,
}

/// One picture with its motion.
struct Case<'a> {
    sharp: &'a Sharp,
    motion: &'a Motion,
    seed: u64,
}

impl Protocol {
    /// Angles at one length.
    ///
    /// # Errors
    /// When a motion is refused.
    pub fn angles(degrees: impl IntoIterator<Item = f64>, length_px: f64) -> Result<Self> {
        Self::new(Measure::Angle, degrees.into_iter().map(|deg| (length_px, deg)))
    }

    /// Lengths at one angle.
    ///
    /// # Errors
    /// When a motion is refused.
    pub fn lengths(lengths_px: impl IntoIterator<Item = f64>, angle_deg: f64) -> Result<Self> {
        Self::new(Measure::Length, lengths_px.into_iter().map(|length_px| (length_px, angle_deg)))
    }

    fn new(measure: Measure, blurs: impl Iterator<Item = (f64, f64)>) -> Result<Self> {
        let motions = blurs.map(|(length_px, deg)| Motion::uniform(length_px, AxialAngle::from_deg(deg)));
        let motions = motions.collect::<blur_sim::Result<_>>()?;
        Ok(Self { measure, motions, levels: shots::LEVELS.to_vec(), step: 1, seed: 1 })
    }

    /// Blurs the pictures and asks all `methods`, on the threads of the rayon pool that this is called in.
    ///
    /// # Errors
    /// [`Error::NoSharpPicture`] when no picture is large enough, and when one cannot be exposed or measured.
    pub fn run(&self, pictures: &[Sharp], methods: &[Candidate]) -> Result<Answers> {
        let (cases, too_small) = self.cases(pictures);
        if cases.is_empty() {
            return Err(Error::NoSharpPicture);
        }
        let answers = cases
            .par_iter()
            .map_init(
                || (Exposer::new(), candidates::build(methods)),
                |(exposer, contestants), case| {
                    let Case { sharp, motion, seed } = *case;
                    let shots = shots::shots(exposer, sharp.luma.view(), motion, &self.levels, seed)
                        .map_err(simulating(&sharp.name))?;
                    let mut answers = Vec::with_capacity(shots.len() * contestants.len());
                    for (shot, &level) in shots.iter().zip(&self.levels) {
                        for contestant in &mut *contestants {
                            let level = level_name(level);
                            answers.push(contestant.answer(self.measure, shot.view(), motion, &sharp.name, &level)?);
                        }
                    }
                    Ok(answers)
                },
            )
            .collect::<Result<Vec<_>>>()?;
        Ok(Answers { answers: answers.into_iter().flatten().collect(), cases: cases.len(), too_small })
    }

    fn cases<'a>(&'a self, pictures: &'a [Sharp]) -> (Vec<Case<'a>>, Vec<String>) {
        let (mut cases, mut too_small) = (Vec::new(), Vec::new());
        for number in thinned(pictures.len() * self.motions.len(), self.step) {
            let (index, blur) = (number / self.motions.len(), number % self.motions.len());
            let (sharp, motion) = (&pictures[index], &self.motions[blur]);
            if shots::leaves(LEAST_SIDE_PX, sharp.luma.dim(), motion) {
                let seed = self.seed.wrapping_add(index as u64 * 100_003).wrapping_add(blur as u64 * 1009);
                cases.push(Case { sharp, motion, seed });
            } else if too_small.last() != Some(&sharp.name) {
                too_small.push(sharp.name.clone());
            }
        }
        (cases, too_small)
    }
}

/// Absolute errors of one method, of all answers whatever their status, at the levels of these names.
pub fn errors<L: AsRef<str>>(answers: &[Answer], method: &str, levels: &[L]) -> Vec<f64> {
    of(answers, method, levels).map(|answer| answer.summarised_error().abs()).collect()
}

/// The answers of one method at the levels of these names.
pub fn of<'a, L: AsRef<str>>(
    answers: &'a [Answer],
    method: &'a str,
    levels: &'a [L],
) -> impl Iterator<Item = &'a Answer> {
    answers
        .iter()
        .filter(move |answer| answer.method == method && levels.iter().any(|level| level.as_ref() == answer.level))
}
