//! What a method that is compared with others said of one quantity of one picture.

use std::fmt;

use blur_core::estimate::AxialAngle;
use serde::Serialize;

use super::candidates::Reading;
use super::outcome::{GROSS_DEG, GROSS_SHARE};

/// What is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum Measure {
    /// The angle in degrees.
    #[serde(rename = "angle_deg")]
    Angle,
    /// The length in pixels; methods of lengths know the angle.
    #[serde(rename = "length_px")]
    Length,
    /// The speed in metres per second; errors are summarised in percent.
    #[serde(rename = "speed_m_s")]
    Speed,
}

impl Measure {
    /// The name in rows of what is summarised, with its unit.
    pub fn field(self) -> &'static str {
        match self {
            Self::Angle => "angle_deg",
            Self::Length => "length_px",
            Self::Speed => "speed_percent",
        }
    }

    /// That for people.
    pub fn title(self) -> &'static str {
        match self {
            Self::Angle => "angle, deg",
            Self::Length => "length, px",
            Self::Speed => "speed, %",
        }
    }
}

/// The answer to one picture: a flat JSON object, in the unit that `quantity` names.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answer {
    /// The picture.
    pub image: String,
    /// Level of noise.
    pub level: String,
    /// The method.
    pub method: String,
    /// What is measured.
    pub quantity: Measure,
    /// The truth.
    pub truth: f64,
    /// What was found.
    pub value: f64,
    /// Its standard uncertainty.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub std: Option<f64>,
    /// Its error; that of an angle is in `[-90, 90)`.
    pub error: f64,
    /// `ok`, `low_confidence` or `no_motion_blur`.
    pub status: &'static str,
    /// Why the status is not `ok`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

impl Answer {
    pub(super) fn new(
        quantity: Measure,
        image: &str,
        level: &str,
        method: &str,
        truth: f64,
        reading: &Reading,
    ) -> Self {
        let Reading { value, std, status } = *reading;
        let error = match quantity {
            Measure::Angle => AxialAngle::from_deg(value).minus_deg(AxialAngle::from_deg(truth)),
            Measure::Length | Measure::Speed => value - truth,
        };
        Self {
            image: image.to_owned(),
            level: level.to_owned(),
            method: method.to_owned(),
            quantity,
            truth,
            value,
            std,
            error,
            status: status.name(),
            reason: status.doubt().map(|doubt| doubt.to_string()),
        }
    }

    /// Whether the method stands by its answer.
    pub fn is_ok(&self) -> bool {
        self.status == "ok"
    }

    /// The error as it is summarised: in degrees, in pixels, or in percent of the true speed.
    pub fn summarised_error(&self) -> f64 {
        self.error * self.unit()
    }

    /// The stated standard uncertainty in the same unit.
    pub fn summarised_std(&self) -> Option<f64> {
        self.std.map(|std| std * self.unit())
    }

    fn unit(&self) -> f64 {
        match self.quantity {
            Measure::Angle | Measure::Length => 1.0,
            Measure::Speed => 100.0 / self.truth,
        }
    }

    /// Whether the angle is off by more than [`GROSS_DEG`], or the length or speed by more than [`GROSS_SHARE`].
    pub fn is_gross(&self) -> bool {
        let most = match self.quantity {
            Measure::Angle => GROSS_DEG,
            Measure::Length | Measure::Speed => GROSS_SHARE * self.truth,
        };
        self.error.abs() > most
    }

    /// Whether the truth lies within `k` stated standard uncertainties; `None` where none is stated.
    pub fn covers(&self, k: f64) -> Option<bool> {
        self.std.map(|std| self.error.abs() <= k * std)
    }
}

/// One line for people.
impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { image, level, method, truth, value, error, status, .. } = self;
        write!(f, "{image:32} {level:8} {method:24} {value:9.3}")?;
        self.std.iter().try_for_each(|std| write!(f, "  u {std:.3}"))?;
        write!(f, "  truth {truth:.3}  error {error:+.3}{}", if self.is_gross() { " (gross)" } else { "" })?;
        write!(f, "  {status}")?;
        self.reason.iter().try_for_each(|reason| write!(f, ": {reason}"))
    }
}

#[cfg(test)]
pub(super) mod tests {
    use blur_core::estimate::Status;

    use super::*;

    /// An answer called `ok` with a standard uncertainty of 1.
    pub(in super::super) fn answer(quantity: Measure, truth: f64, value: f64) -> Answer {
        let reading = Reading { value, std: Some(1.0), status: Status::Ok };
        Answer::new(quantity, "a.png", "clean", "m", truth, &reading)
    }

    #[test]
    fn angles_are_compared_as_axes() {
        let found = answer(Measure::Angle, 1.0, 179.0);
        assert_eq!((found.error, found.is_gross(), found.covers(2.0)), (-2.0, false, Some(true)));
    }

    #[test]
    fn errors_of_speeds_are_percent_of_the_truth() {
        let found = answer(Measure::Speed, 4.0, 5.0);
        assert_eq!((found.summarised_error(), found.summarised_std()), (25.0, Some(25.0)));
        assert!(found.is_gross() && !answer(Measure::Speed, 4.0, 4.7).is_gross());
        assert!(answer(Measure::Length, 10.0, 12.1).is_gross() && !answer(Measure::Length, 10.0, 11.9).is_gross());
        assert_eq!(found.covers(0.9), Some(false));
    }
}
