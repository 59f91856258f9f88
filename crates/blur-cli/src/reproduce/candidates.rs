//! The methods of the registries that measure one quantity, each by itself.

use blur_core::estimate::{AngleEstimator, JointEstimator, LengthEstimator, Settings, Status, registry};
use blur_sim::motion::Motion;
use ndarray::ArrayView2;

use super::answer::{Answer, Measure};
use crate::{Error, Result};

/// A method that is compared with others.
#[derive(Debug)]
pub struct Candidate {
    name: String,
    method: Method,
}

#[derive(Debug)]
enum Method {
    Angle(&'static registry::Method<Box<dyn AngleEstimator>>),
    Length(&'static registry::Method<Box<dyn LengthEstimator>>),
    Joint(&'static registry::Method<Box<dyn JointEstimator>>),
}

/// All methods that measure `measure`, or the one called `only`: those of angles for an angle, those of lengths for a
/// length or a speed, and the joint ones for each. A length method with the name of a joint one is called
/// `known-angle+NAME`, as in the records of `estimate`, and both answer to `NAME`.
///
/// # Errors
/// [`Error::NoCandidate`] when none is called `only`.
pub fn candidates(measure: Measure, only: Option<&str>) -> Result<Vec<Candidate>> {
    let mut all: Vec<(&str, Candidate)> = Vec::new();
    if measure == Measure::Angle {
        all.extend(
            registry::ANGLE
                .iter()
                .map(|method| (method.name, Candidate { name: method.name.to_owned(), method: Method::Angle(method) })),
        );
    } else {
        all.extend(registry::LENGTH.iter().map(|method| {
            let is_joint_too = registry::JOINT.iter().any(|joint| joint.name == method.name);
            let name = if is_joint_too { format!("known-angle+{}", method.name) } else { method.name.to_owned() };
            (method.name, Candidate { name, method: Method::Length(method) })
        }));
    }
    all.extend(
        registry::JOINT
            .iter()
            .map(|method| (method.name, Candidate { name: method.name.to_owned(), method: Method::Joint(method) })),
    );
    let known = || all.iter().map(|(_, candidate)| candidate.name.clone()).collect::<Vec<_>>().join(" ");
    match only {
        Some(only) if all.iter().all(|(name, candidate)| *name != only && candidate.name != only) => {
            Err(Error::NoCandidate { name: only.to_owned(), quantity: measure.title(), known: known() })
        }
        _ => Ok(all
            .into_iter()
            .filter(|(name, candidate)| only.is_none_or(|only| *name == only || candidate.name == only))
            .map(|(_, candidate)| candidate)
            .collect()),
    }
}

/// New estimators of all `candidates`.
pub(super) fn build(candidates: &[Candidate]) -> Vec<Contestant<'_>> {
    let settings = Settings::default();
    candidates
        .iter()
        .map(|candidate| {
            let estimator = match candidate.method {
                Method::Angle(method) => Estimator::Angle(method.build(&settings)),
                Method::Length(method) => Estimator::Length(method.build(&settings)),
                Method::Joint(method) => Estimator::Joint(method.build(&settings)),
            };
            Contestant { name: &candidate.name, estimator }
        })
        .collect()
}

impl Candidate {
    /// Its name in the tables.
    pub fn name(&self) -> &str {
        &self.name
    }
}

enum Estimator {
    Angle(Box<dyn AngleEstimator>),
    Length(Box<dyn LengthEstimator>),
    Joint(Box<dyn JointEstimator>),
}

/// What a method reads of a picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reading {
    pub(super) value: f64,
    pub(super) std: Option<f64>,
    pub(super) status: Status,
}

/// An estimator with its name.
pub(super) struct Contestant<'a> {
    pub(super) name: &'a str,
    estimator: Estimator,
}

impl Contestant<'_> {
    /// The angle in degrees or, for any other measure, the length in pixels. Methods of lengths are told the true angle.
    pub(super) fn read(
        &mut self,
        measure: Measure,
        picture: ArrayView2<'_, f32>,
        truth: &Motion,
    ) -> blur_core::Result<Reading> {
        Ok(match &mut self.estimator {
            Estimator::Angle(estimator) => {
                let found = estimator.estimate(picture)?;
                Reading { value: found.angle.deg(), std: found.std_deg, status: found.status }
            }
            Estimator::Length(estimator) => {
                let found = estimator.estimate(picture, truth.angle())?;
                Reading { value: found.length_px, std: found.std_px, status: found.status }
            }
            Estimator::Joint(estimator) => {
                let found = estimator.estimate(picture)?;
                let (value, std) = match measure {
                    Measure::Angle => (found.angle.deg(), found.angle_std_deg),
                    Measure::Length | Measure::Speed => (found.length_px, found.length_std_px),
                };
                Reading { value, std, status: found.status }
            }
        })
    }

    /// Its answer to the `picture` called `image`: an angle or a length.
    pub(super) fn answer(
        &mut self,
        measure: Measure,
        picture: ArrayView2<'_, f32>,
        truth: &Motion,
        image: &str,
        level: &str,
    ) -> Result<Answer> {
        let reading = self
            .read(measure, picture, truth)
            .map_err(|source| Error::Measuring { image: format!("{image}, {}", self.name), source })?;
        let truth = if measure == Measure::Angle { truth.angle().deg() } else { truth.length_px() };
        Ok(Answer::new(measure, image, level, self.name, truth, &reading))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_of_a_quantity_is_compared_once() {
        let names = |measure| -> Vec<String> {
            candidates(measure, None).unwrap().iter().map(|candidate| candidate.name().to_owned()).collect()
        };
        let (angles, lengths) = (names(Measure::Angle), names(Measure::Length));
        assert_eq!(angles.len(), registry::ANGLE.len() + registry::JOINT.len());
        assert_eq!(lengths.len(), registry::LENGTH.len() + registry::JOINT.len());
        assert_eq!(names(Measure::Speed), lengths);
        let mut distinct = lengths.clone();
        distinct.sort();
        distinct.dedup();
        assert_eq!(distinct.len(), lengths.len());
    }

    #[test]
    fn a_method_of_another_quantity_is_refused() {
        assert_eq!(candidates(Measure::Angle, Some("dct-radon")).unwrap().len(), 1);
        assert!(candidates(Measure::Length, Some("whittle")).is_ok());
        let refused = candidates(Measure::Length, Some("dct-radon")).unwrap_err().to_string();
        assert!(refused.contains("dct-radon") && refused.contains("dct-pseudo-cepstrum"), "{refused}");
    }
}
