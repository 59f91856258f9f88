//! Estimators: from a picture to the direction and the length of its motion blur.
//!
//! A method is one file and one line in the [`registry`]. Angle methods live in [`angle`], length methods in
//! [`length`], methods that fit both at once in [`joint`]. A [`Pair`] joins an angle and a length method into one
//! [`JointEstimator`], which is all that a program needs to know.
//!
//! An estimator value owns its plans and buffers: build it once and reuse it. The first picture of a size allocates;
//! later pictures of that size do not.

pub mod angle;
mod front;
mod heading;
pub mod joint;
pub mod length;
mod pair;
mod per_size;
pub mod registry;
mod settings;
mod types;

pub use heading::Heading;
pub use pair::{KnownAngle, Pair};
pub use settings::{LengthRange, Settings};
pub use types::{
    Acceleration, AngleEstimate, AxialAngle, Doubt, Evidence, LengthEstimate, MotionBlur, SignedRatio, Status,
};

use ndarray::ArrayView2;

use crate::Result;

/// Estimates the direction of a motion blur.
pub trait AngleEstimator: Send {
    /// The direction of the blur in `image` (rows x columns, row 0 at the top, any size of at least
    /// [`MIN_SIDE`](crate::image::MIN_SIDE) pixels each way).
    ///
    /// Fails on pictures that are too small, constant or not finite; an uncertain answer is not an error but a
    /// [`Status`].
    fn estimate(&mut self, image: ArrayView2<'_, f32>) -> Result<AngleEstimate>;
}

/// Estimates the length of a motion blur of known direction.
pub trait LengthEstimator: Send {
    /// The length in pixels of the blur in `image` along `angle`. Fails as [`AngleEstimator::estimate`] does.
    fn estimate(&mut self, image: ArrayView2<'_, f32>, angle: AxialAngle) -> Result<LengthEstimate>;
}

/// Estimates direction and length of a motion blur together.
pub trait JointEstimator: Send {
    /// Direction and length of the blur in `image`. Fails as [`AngleEstimator::estimate`] does.
    fn estimate(&mut self, image: ArrayView2<'_, f32>) -> Result<MotionBlur>;
}
