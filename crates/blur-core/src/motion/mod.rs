//! From a blur in pixels to a motion in metres and seconds.

mod acceleration;
mod speed;

pub use acceleration::{AcceleratedPath, PathAcceleration};
pub use speed::{COVERAGE_K, Exposure, Speed};
