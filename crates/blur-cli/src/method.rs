//! Which estimator to use, by the names of the registry.

use std::sync::Arc;

use blur_core::estimate::joint::Reference;
use blur_core::estimate::{AxialAngle, JointEstimator, KnownAngle, Pair, Settings, registry};

use crate::{Error, Result};

type Length = registry::Method<Box<dyn blur_core::estimate::LengthEstimator>>;

/// A choice of estimator.
#[derive(Clone)]
pub struct Method(Choice);

#[derive(Clone)]
enum Choice {
    Registered(registry::Choice),
    KnownAngle(AxialAngle, &'static Length),
    /// The estimator itself: it knows its stills.
    Reference(&'static str, Arc<Reference>),
}

impl Method {
    /// The first joint method.
    pub fn recommended() -> Self {
        Self(Choice::Registered(registry::Choice::default()))
    }

    /// The joint method called `name`, or the pair called `ANGLE+LENGTH`.
    pub fn named(name: &str) -> Result<Self> {
        match name.parse() {
            Ok(choice) => Ok(Self(Choice::Registered(choice))),
            Err(_) if registry::REFERENCE.iter().any(|method| method.name == name) => {
                Err(Error::NeedsStills { method: name.to_owned() })
            }
            Err(error) if name.contains('+') => Err(error.into()),
            Err(_) => Err(unknown(name)),
        }
    }

    /// An angle method, then a length method along the angle found; `None` is the first of its registry.
    pub fn pair(angle: Option<&str>, length: Option<&str>) -> Result<Self> {
        let angle = match angle {
            Some(name) => registry::angle(name)?,
            None => registry::ANGLE.first().ok_or(Error::NoMethod { kind: "angle" })?,
        };
        Ok(Self(Choice::Registered(registry::Choice::Pair(angle, length_method(length)?))))
    }

    /// A length method along a known angle; `None` is the first of the registry.
    pub fn known_angle(angle: AxialAngle, length: Option<&str>) -> Result<Self> {
        Ok(Self(Choice::KnownAngle(angle, length_method(length)?)))
    }

    /// The method called `name` that compares with sharp pictures, ready with its own.
    pub fn with_stills(name: &'static str, estimator: Reference) -> Self {
        Self(Choice::Reference(name, Arc::new(estimator)))
    }

    /// The method in the registry, unless it needs more than that: a known angle or sharp pictures.
    pub fn choice(&self) -> Option<registry::Choice> {
        match self.0 {
            Choice::Registered(choice) => Some(choice),
            Choice::KnownAngle(..) | Choice::Reference(..) => None,
        }
    }

    /// The name in results: that of the joint method, `ANGLE+LENGTH` or `known-angle+LENGTH`.
    pub fn name(&self) -> String {
        match &self.0 {
            Choice::Registered(choice) => choice.to_string(),
            Choice::KnownAngle(_, length) => format!("known-angle+{}", length.name),
            Choice::Reference(name, _) => (*name).to_owned(),
        }
    }

    /// Refuses a method that cannot look for an acceleration, and names those that can.
    pub fn check_acceleration(&self) -> Result<()> {
        match &self.0 {
            Choice::Reference(..) => Ok(()),
            Choice::Registered(registry::Choice::Joint(joint)) if registry::ACCELERATION.contains(&joint.name) => {
                Ok(())
            }
            _ => Err(Error::NoAcceleration { method: self.name(), known: registry::ACCELERATION.join(", ") }),
        }
    }

    /// Refuses a method that cannot measure the part that a mask marks.
    pub fn check_mask(&self) -> Result<()> {
        match &self.0 {
            Choice::Registered(registry::Choice::Joint(joint)) if registry::WEIGHTED.contains(&joint.name) => Ok(()),
            _ => Err(Error::NoMask { method: self.name(), known: registry::WEIGHTED.join(", ") }),
        }
    }

    /// A new estimator. The settings of a method that compares with sharp pictures are those it was made with.
    pub fn build(&self, settings: &Settings) -> Box<dyn JointEstimator> {
        match &self.0 {
            Choice::Reference(_, estimator) => Box::new(Reference::clone(estimator)),
            Choice::Registered(choice) => choice.build(settings),
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
