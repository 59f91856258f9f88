//! An angle method and a length method, one after the other.

use ndarray::ArrayView2;

use super::{AngleEstimate, AngleEstimator, AxialAngle, JointEstimator, LengthEstimator, MotionBlur, Status};
use crate::{Result, image};

/// Measures the angle first and then the length along it.
pub struct Pair {
    angle: Box<dyn AngleEstimator>,
    length: Box<dyn LengthEstimator>,
}

impl Pair {
    /// Joins an angle method (or a [`KnownAngle`]) and a length method.
    pub fn new(angle: Box<dyn AngleEstimator>, length: Box<dyn LengthEstimator>) -> Self {
        Self { angle, length }
    }
}

impl JointEstimator for Pair {
    fn estimate(&mut self, image: ArrayView2<'_, f32>) -> Result<MotionBlur> {
        let angle = self.angle.estimate(image)?;
        let length = self.length.estimate(image, angle.angle)?;
        Ok(MotionBlur {
            angle: angle.angle,
            angle_std_deg: angle.std_deg,
            length_px: length.length_px,
            length_std_px: length.std_px,
            correlation: None,
            direction_deg: None,
            status: angle.status.worse(length.status),
            evidence: None,
            acceleration: None,
        })
    }
}

/// An angle that is known beforehand, for instance from the direction of a rail.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownAngle(pub AxialAngle);

impl AngleEstimator for KnownAngle {
    fn estimate(&mut self, image: ArrayView2<'_, f32>) -> Result<AngleEstimate> {
        // How large a picture must be is for the length method to say.
        image::check_pixels(image)?;
        Ok(AngleEstimate { angle: self.0, std_deg: None, status: Status::Ok })
    }
}
