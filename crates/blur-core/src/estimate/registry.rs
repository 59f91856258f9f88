//! The methods by their names. Command line, benches and tables iterate over these lists.

use super::{AngleEstimator, JointEstimator, LengthEstimator, Settings};
use crate::{Error, Result};

/// One entry of a registry: a method that builds an estimator `E` (a boxed trait object).
#[derive(Debug)]
pub struct Method<E> {
    /// Name on the command line, in JSON and in tables.
    pub name: &'static str,
    /// What it does, in one line.
    pub summary: &'static str,
    build: fn(&Settings) -> E,
}

impl<E> Method<E> {
    /// A new estimator of this method.
    pub fn build(&self, settings: &Settings) -> E {
        (self.build)(settings)
    }
}

/// Angle methods. The first is the default.
pub const ANGLE: &[Method<Box<dyn AngleEstimator>>] = &[];

/// Length methods. The first is the default.
pub const LENGTH: &[Method<Box<dyn LengthEstimator>>] = &[];

/// Methods that fit angle and length together.
pub const JOINT: &[Method<Box<dyn JointEstimator>>] = &[];

/// The angle method called `name`.
pub fn angle(name: &str) -> Result<&'static Method<Box<dyn AngleEstimator>>> {
    find("angle", ANGLE, name)
}

/// The length method called `name`.
pub fn length(name: &str) -> Result<&'static Method<Box<dyn LengthEstimator>>> {
    find("length", LENGTH, name)
}

/// The joint method called `name`.
pub fn joint(name: &str) -> Result<&'static Method<Box<dyn JointEstimator>>> {
    find("joint", JOINT, name)
}

fn find<E>(kind: &'static str, methods: &'static [Method<E>], name: &str) -> Result<&'static Method<E>> {
    methods.iter().find(|method| method.name == name).ok_or_else(|| Error::UnknownMethod {
        kind,
        name: name.to_owned(),
        known: methods.iter().map(|method| method.name).collect::<Vec<_>>().join(" "),
    })
}
