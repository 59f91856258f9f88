//! The methods by their names. Command line, benches and tables iterate over these lists.

use std::fmt;
use std::str::FromStr;

use ndarray::ArrayView2;

use super::{AngleEstimator, JointEstimator, LengthEstimator, Pair, Settings, angle, joint, length};
use crate::{Error, Result};

/// One entry of a registry: a method that builds an estimator `E` (a boxed trait object).
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

impl<E> fmt::Debug for Method<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Method").field("name", &self.name).finish_non_exhaustive()
    }
}

/// Angle methods. The first is the default.
pub const ANGLE: &[Method<Box<dyn AngleEstimator>>] = &[
    Method {
        name: "dft-radon",
        summary: "dark lines of the DFT spectrum by the Radon transform",
        build: |settings| Box::new(angle::DftRadon::new(settings)),
    },
    Method {
        name: "dct-radon",
        summary: "dark lines of the DCT spectrum by the Radon transform",
        build: |settings| Box::new(angle::DctRadon::new(settings)),
    },
    Method {
        name: "dct-hough",
        summary: "brightest line of the DCT spectrum by votes",
        build: |settings| Box::new(angle::DctHough::new(settings)),
    },
    Method {
        name: "dft-hough",
        summary: "brightest line of the DFT spectrum by votes",
        build: |settings| Box::new(angle::DftHough::new(settings)),
    },
    Method {
        name: "dft-cepstrum",
        summary: "deepest trough of the two-dimensional cepstrum",
        build: |settings| Box::new(angle::DftCepstrum::new(settings)),
    },
    Method {
        name: "dft-gabor",
        summary: "strongest Gabor filter on the DFT spectrum",
        build: |settings| Box::new(angle::DftGabor::new(settings)),
    },
];

/// Length methods. The first is the default.
pub const LENGTH: &[Method<Box<dyn LengthEstimator>>] = &[
    Method {
        name: "dct-pseudo-cepstrum",
        summary: "trough of the DCT of the collapsed log DCT spectrum",
        build: |settings| Box::new(length::DctPseudoCepstrum::new(settings)),
    },
    Method {
        name: "autocorrelation",
        summary: "minimum of the autocorrelation of the derivative",
        build: |settings| Box::new(length::Autocorrelation::new(settings)),
    },
    Method {
        name: "dft-cepstrum",
        summary: "trough of the cepstrum of the collapsed DFT spectrum",
        build: |settings| Box::new(length::DftCepstrum::new(settings)),
    },
    Method {
        name: "dft-radon",
        summary: "dark lines of the Radon transform at the known angle",
        build: |settings| Box::new(length::DftRadon::new(settings)),
    },
    Method {
        name: "whittle",
        summary: "maximum likelihood of the whole spectrum along the known angle",
        build: |settings| Box::new(length::Whittle::new(settings)),
    },
];

/// Methods that fit angle and length together. The first is the default of programs.
pub const JOINT: &[Method<Box<dyn JointEstimator>>] = &[
    Method {
        name: "whittle",
        summary: "maximum likelihood of the whole spectrum",
        build: |settings| Box::new(joint::Whittle::new(settings)),
    },
    Method {
        name: "phase-autocorrelation",
        summary: "peak of the autocorrelation of the phase-only image",
        build: |settings| Box::new(joint::PhaseAutocorrelation::new(settings)),
    },
];

/// A joint method that compares a picture with sharp pictures of the same scene.
pub struct ReferenceMethod {
    /// Name on the command line, in JSON and in tables.
    pub name: &'static str,
    /// What it does, in one line.
    pub summary: &'static str,
    build: fn(&[ArrayView2<'_, f32>], &Settings) -> Result<joint::Reference>,
}

impl ReferenceMethod {
    /// A new estimator for pictures of the scene that `stills` show. Fails as [`joint::Reference::new`] does.
    pub fn build(&self, stills: &[ArrayView2<'_, f32>], settings: &Settings) -> Result<joint::Reference> {
        (self.build)(stills, settings)
    }
}

impl fmt::Debug for ReferenceMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ReferenceMethod").field("name", &self.name).finish_non_exhaustive()
    }
}

/// Joint methods that need sharp pictures of the same scene. They can all look for an
/// [`Acceleration`](super::Acceleration), with its sign.
pub const REFERENCE: &[ReferenceMethod] = &[ReferenceMethod {
    name: "reference",
    summary: "least squares against sharp pictures of the same scene",
    build: joint::Reference::new,
}];

/// Joint methods that fit the likelihood and so can look for an [`Acceleration`](super::Acceleration) too.
pub const ACCELERATION: &[&str] = &["whittle"];

/// Joint methods that can weigh the pixels of a region, as [`joint::Whittle::estimate_weighted`] does.
pub const WEIGHTED: &[&str] = &["whittle"];

/// Joint methods that can follow a motion from frame to frame, as [`joint::Tracker`] does.
pub const TRACKING: &[&str] = &["whittle"];

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

/// An estimator of direction and length by its name: a joint method, or an angle and a length method as `ANGLE+LENGTH`.
///
/// ```
/// use blur_core::estimate::registry::Choice;
/// let choice: Choice = "dct-radon+dct-pseudo-cepstrum".parse().unwrap();
/// assert_eq!(choice.to_string(), "dct-radon+dct-pseudo-cepstrum");
/// assert_eq!(Choice::default().to_string(), "whittle");
/// assert!("wiener".parse::<Choice>().is_err());
/// ```
#[derive(Debug, Clone, Copy)]
pub enum Choice {
    /// A joint method.
    Joint(&'static Method<Box<dyn JointEstimator>>),
    /// An angle method, then a length method along the angle found.
    Pair(&'static Method<Box<dyn AngleEstimator>>, &'static Method<Box<dyn LengthEstimator>>),
}

impl Choice {
    /// A new estimator.
    pub fn build(&self, settings: &Settings) -> Box<dyn JointEstimator> {
        match self {
            Self::Joint(joint) => joint.build(settings),
            Self::Pair(angle, length) => Box::new(Pair::new(angle.build(settings), length.build(settings))),
        }
    }

    /// The names of the two methods, or that of the joint one alone.
    fn names(&self) -> (&'static str, Option<&'static str>) {
        match self {
            Self::Joint(joint) => (joint.name, None),
            Self::Pair(angle, length) => (angle.name, Some(length.name)),
        }
    }
}

/// The first joint method.
impl Default for Choice {
    fn default() -> Self {
        const { assert!(!JOINT.is_empty(), "there is a joint method") }
        Self::Joint(&JOINT[0])
    }
}

/// By the names.
impl PartialEq for Choice {
    fn eq(&self, other: &Self) -> bool {
        self.names() == other.names()
    }
}

impl Eq for Choice {}

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.names() {
            (joint, None) => f.write_str(joint),
            (angle, Some(length)) => write!(f, "{angle}+{length}"),
        }
    }
}

impl FromStr for Choice {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        match name.split_once('+') {
            Some((angle_name, length_name)) => Ok(Self::Pair(angle(angle_name)?, length(length_name)?)),
            None => joint(name).map(Self::Joint),
        }
    }
}

fn find<E>(kind: &'static str, methods: &'static [Method<E>], name: &str) -> Result<&'static Method<E>> {
    methods.iter().find(|method| method.name == name).ok_or_else(|| Error::UnknownMethod {
        kind,
        name: name.to_owned(),
        known: methods.iter().map(|method| method.name).collect::<Vec<_>>().join(" "),
    })
}
