//! From a blur in pixels to a motion in metres and seconds.

mod acceleration;
mod rolling_shutter;
mod speed;
mod speed_change;

pub use acceleration::{AcceleratedPath, PathAcceleration};
pub use rolling_shutter::{RolledBlur, RolledSpeed, RollingShutter};
pub use speed::{COVERAGE_K, Exposure, Speed};
pub use speed_change::{LEAST_TILE_ROWS, SpeedChange, TileMotion};
