//! What an estimator said of one picture, beside the truth.

use std::fmt;

use blur_core::estimate::{JointEstimator, MotionBlur, Settings};
use blur_sim::motion::Motion;
use ndarray::ArrayView2;
use serde::Serialize;

use crate::method::Method;
use crate::{Error, Result};

/// Errors of the angle above this many degrees are gross.
pub const GROSS_DEG: f64 = 5.0;

/// Errors of the length above this share of the true length are gross.
pub const GROSS_SHARE: f64 = 0.2;

/// The answer to one picture: a flat JSON object. Fields of the truth are absent where nothing moved, uncertainties
/// where the method states none.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outcome {
    /// The picture.
    pub image: String,
    /// Level of noise, or kind of picture.
    pub level: String,
    /// True angle in degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub true_angle_deg: Option<f64>,
    /// True length in pixels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub true_length_px: Option<f64>,
    /// Angle found, in degrees.
    pub angle_deg: f64,
    /// Its standard uncertainty.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle_std_deg: Option<f64>,
    /// Its error, in `[-90, 90)`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle_error_deg: Option<f64>,
    /// Length found, in pixels.
    pub length_px: f64,
    /// Its standard uncertainty.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub length_std_px: Option<f64>,
    /// Its error.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub length_error_px: Option<f64>,
    /// Correlation coefficient of angle and length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correlation: Option<f64>,
    /// `ok`, `low_confidence` or `no_motion_blur`.
    pub status: &'static str,
    /// Why the status is not `ok`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

impl Outcome {
    fn new(image: String, level: String, truth: Option<&Motion>, found: &MotionBlur) -> Self {
        Self {
            image,
            level,
            true_angle_deg: truth.map(|motion| motion.angle().deg()),
            true_length_px: truth.map(Motion::length_px),
            angle_deg: found.angle.deg(),
            angle_std_deg: found.angle_std_deg,
            angle_error_deg: truth.map(|motion| found.angle.minus_deg(motion.angle())),
            length_px: found.length_px,
            length_std_px: found.length_std_px,
            length_error_px: truth.map(|motion| found.length_px - motion.length_px()),
            correlation: found.correlation,
            status: found.status.name(),
            reason: found.status.doubt().map(|doubt| doubt.to_string()),
        }
    }

    /// Whether the method stands by its answer.
    pub fn is_ok(&self) -> bool {
        self.status == "ok"
    }

    /// Whether the angle or the length is off by more than [`GROSS_DEG`] or [`GROSS_SHARE`]; never without a truth.
    pub fn is_gross(&self) -> bool {
        let angle = self.angle_error_deg.is_some_and(|error| error.abs() > GROSS_DEG);
        let length = self.length_error_px.zip(self.true_length_px);
        angle || length.is_some_and(|(error, truth)| error.abs() > GROSS_SHARE * truth)
    }

    /// The squared distance to the truth in the metric of the stated covariance: chi-square of two degrees of freedom
    /// if that is right. `None` unless both uncertainties and the correlation are stated.
    pub fn squared_distance(&self) -> Option<f64> {
        let a = self.angle_error_deg? / self.angle_std_deg?;
        let b = self.length_error_px? / self.length_std_px?;
        let rho = self.correlation?;
        Some((a * a - 2.0 * rho * a * b + b * b) / (1.0 - rho * rho))
    }
}

/// One line for people.
impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { image, level, angle_deg, length_px, status, .. } = self;
        write!(f, "{image:32} {level:16} {angle_deg:7.2} deg {length_px:7.2} px")?;
        if let (Some(angle), Some(length)) = (self.angle_std_deg, self.length_std_px) {
            write!(f, "  u {angle:.3} deg {length:.3} px")?;
        }
        if let (Some(angle), Some(length)) = (self.true_angle_deg, self.true_length_px) {
            write!(f, "  truth {angle:.2} deg {length:.2} px")?;
        }
        if let (Some(angle), Some(length)) = (self.angle_error_deg, self.length_error_px) {
            write!(f, "  error {angle:+.3} deg {length:+.3} px{}", if self.is_gross() { " (gross)" } else { "" })?;
        }
        write!(f, "  {status}")?;
        self.reason.iter().try_for_each(|reason| write!(f, ": {reason}"))
    }
}

/// An estimator that answers with outcomes.
pub(super) struct Judge(Box<dyn JointEstimator>);

impl Judge {
    pub(super) fn new(method: &Method) -> Self {
        Self(method.build(&Settings::default()))
    }

    /// What the method says of `picture`, which is called `image`; `truth` is absent where nothing moved.
    pub(super) fn ask(
        &mut self,
        picture: ArrayView2<'_, f32>,
        image: &str,
        level: &str,
        truth: Option<&Motion>,
    ) -> Result<Outcome> {
        let named = |source| Error::Measuring { image: image.to_owned(), source };
        let found = self.0.estimate(picture).map_err(named)?;
        Ok(Outcome::new(image.to_owned(), level.to_owned(), truth, &found))
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// An answer of 30 degrees and 20 px called `ok`, with these errors.
    pub(in super::super) fn outcome(angle_error_deg: f64, length_error_px: f64) -> Outcome {
        Outcome {
            image: "a.png".to_owned(),
            level: "clean".to_owned(),
            true_angle_deg: Some(30.0),
            true_length_px: Some(20.0),
            angle_deg: 30.0 + angle_error_deg,
            angle_std_deg: Some(1.0),
            angle_error_deg: Some(angle_error_deg),
            length_px: 20.0 + length_error_px,
            length_std_px: Some(1.0),
            length_error_px: Some(length_error_px),
            correlation: None,
            status: "ok",
            reason: None,
        }
    }

    #[test]
    fn either_error_makes_an_answer_gross() {
        assert!(!outcome(4.9, -3.9).is_gross());
        assert!(outcome(-5.1, 0.0).is_gross() && outcome(5.1, 0.0).is_gross());
        assert!(outcome(0.0, 4.1).is_gross() && outcome(0.0, -4.1).is_gross());
    }

    #[test]
    fn the_distance_follows_the_axes_of_the_ellipse() {
        let of = |angle, length, rho| Outcome { correlation: Some(rho), ..outcome(angle, length) }.squared_distance();
        assert_eq!(of(1.0, 2.0, 0.0), Some(5.0));
        // Along the long axis, of variance 1 + rho, and the short one, of 1 - rho.
        assert!((of(1.0, 1.0, 0.8).unwrap() - 2.0 / 1.8).abs() < 1e-12);
        assert!((of(1.0, -1.0, 0.8).unwrap() - 2.0 / 0.2).abs() < 1e-12);
        assert_eq!(outcome(1.0, 1.0).squared_distance(), None);
    }
}
