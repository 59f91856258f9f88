//! Which estimator to use, by the names of the registry.

use std::sync::Arc;

use blur_core::estimate::joint::Reference;
use blur_core::estimate::{AxialAngle, JointEstimator, KnownAngle, Pair, Settings, registry};

use crate::{Error, Result};

type Angle = registry::Method<Box<dyn blur_core::estimate::AngleEstimator>>;
type Length = registry::Method<Box<dyn blur_core::estimate::LengthEstimator>>;
type Joint = registry::Method<Box<dyn JointEstimator>>;

/// A choice of estimator.
#[derive(Clone)]
pub struct Method(Choice);

#[derive(Clone)]
enum Choice {
    Joint(&'static Joint),
    Pair(&'static Angle, &'static Length),
    KnownAngle(AxialAngle, &'static Length),
    /// The estimator itself: it knows its stills.
    Reference(&'static str, Arc<Reference>),
}

impl Method {
    /// The first joint method or, if there is none, the first angle and the first length method.
    pub fn recommended() -> Result<Self> {
        match registry::JOINT.first() {
            Some(joint) => Ok(Self(Choice::Joint(joint))),
            None => Self::pair(None, None),
        }
    }

    /// The joint method called `name`, or the pair called `ANGLE+LENGTH`.
    pub fn named(name: &str) -> Result<Self> {
        match name.split_once('+') {
            Some((angle, length)) => Self::pair(Some(angle), Some(length)),
            None => match registry::joint(name) {
                Ok(joint) => Ok(Self(Choice::Joint(joint))),
                Err(_) if registry::REFERENCE.iter().any(|method| method.name == name) => {
                    Err(Error::NeedsStills { method: name.to_owned() })
                }
                Err(_) => Err(unknown(name)),
            },
        }
    }

    /// An angle method, then a length method along the angle found; `None` is the first of its registry.
    pub fn pair(angle: Option<&str>, length: Option<&str>) -> Result<Self> {
        let angle = match angle {
            Some(name) => registry::angle(name)?,
            None => registry::ANGLE.first().ok_or(Error::NoMethod { kind: "angle" })?,
        };
        Ok(Self(Choice::Pair(angle, length_method(length)?)))
    }

    /// A length method along a known angle; `None` is the first of the registry.
    pub fn known_angle(angle: AxialAngle, length: Option<&str>) -> Result<Self> {
        Ok(Self(Choice::KnownAngle(angle, length_method(length)?)))
    }

    /// The method called `name` that compares with sharp pictures, ready with its own.
    pub fn with_stills(name: &'static str, estimator: Reference) -> Self {
        Self(Choice::Reference(name, Arc::new(estimator)))
    }

    /// The name in results: that of the joint method, `ANGLE+LENGTH` or `known-angle+LENGTH`.
    pub fn name(&self) -> String {
        match &self.0 {
            Choice::Joint(joint) => joint.name.to_owned(),
            Choice::Pair(angle, length) => format!("{}+{}", angle.name, length.name),
            Choice::KnownAngle(_, length) => format!("known-angle+{}", length.name),
            Choice::Reference(name, _) => (*name).to_owned(),
        }
    }

    /// Refuses a method that cannot look for an acceleration, and names those that can.
    pub fn check_acceleration(&self) -> Result<()> {
        match &self.0 {
            Choice::Reference(..) => Ok(()),
            Choice::Joint(joint) if registry::ACCELERATION.contains(&joint.name) => Ok(()),
            _ => Err(Error::NoAcceleration { method: self.name(), known: registry::ACCELERATION.join(", ") }),
        }
    }

    /// Refuses a method that cannot measure the part that a mask marks.
    pub fn check_mask(&self) -> Result<()> {
        match &self.0 {
            Choice::Joint(joint) if registry::WEIGHTED.contains(&joint.name) => Ok(()),
            _ => Err(Error::NoMask { method: self.name(), known: registry::WEIGHTED.join(", ") }),
        }
    }

    /// A new estimator. The settings of a method that compares with sharp pictures are those it was made with.
    pub fn build(&self, settings: &Settings) -> Box<dyn JointEstimator> {
        match &self.0 {
            Choice::Reference(_, estimator) => Box::new(Reference::clone(estimator)),
            Choice::Joint(joint) => joint.build(settings),
            Choice::Pair(angle, length) => Box::new(Pair::new(angle.build(settings), length.build(settings))),
            Choice::KnownAngle(angle, length) => {
                Box::new(Pair::new(Box::new(KnownAngle(*angle)), length.build(settings)))
            }
        }
    }
}

fn length_method(name: Option<&str>) -> Result<&'static Length> {
    match name {
        Some(name) => Ok(registry::length(name)?),
        None => registry::LENGTH.first().ok_or(Error::NoMethod { kind: "length" }),
    }
}

fn unknown(name: &str) -> Error {
    let mut known: Vec<_> = registry::JOINT.iter().map(|method| method.name.to_owned()).collect();
    known.extend(Method::pair(None, None).map(|pair| format!("a pair such as {}", pair.name())));
    Error::UnknownMethod { name: name.to_owned(), known: known.join(", ") }
}
