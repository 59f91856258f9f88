//! Projections of spectra: the Radon and the Hough transform, and the pattern of dark lines that they look for.

mod hough;
mod pattern;
mod radon;

pub use hough::{Hough, Votes};
pub use pattern::{Match, PatternBank};
pub use radon::{BlockLines, Blocks, Profile, project};
