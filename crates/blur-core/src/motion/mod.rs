//! From a blur in pixels to a motion in metres and seconds.

mod speed;

pub use speed::{COVERAGE_K, Exposure, Speed};
