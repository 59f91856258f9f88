//! Methods that find direction and length at once, one file each.

mod lag_peak;
mod phase_autocorrelation;
mod reference;
mod whittle;

pub use phase_autocorrelation::PhaseAutocorrelation;
pub use reference::Reference;
pub(super) use whittle::Along as WhittleAlong;
pub(crate) use whittle::MOST_FREQUENCY;
pub use whittle::{Diagnosis, Stage, Surface, Tracked, Tracker, Whittle};

/// The spectra of sharp scenes, for others who model pictures.
pub(crate) mod scene {
    pub(crate) use super::whittle::{FALL, MEAN, STD, TERMS, terms};
}

use super::{AxialAngle, Doubt, LengthRange, MotionBlur, Status};

/// What a method answers when it sees no pattern of a blur in `range`.
fn no_pattern(range: LengthRange) -> MotionBlur {
    MotionBlur {
        angle: AxialAngle::from_deg(0.0),
        angle_std_deg: None,
        length_px: range.min_px(),
        length_std_px: None,
        correlation: None,
        direction_deg: None,
        status: Status::NoMotionBlur(Doubt::NoPattern),
        evidence: None,
        acceleration: None,
    }
}

/// Terms of the mean log power spectrum of sharp pictures, as [`Whittle`] expands it.
pub const SCENE_TERMS: usize = whittle::TERMS;

/// The terms at the frequency `(u, v)` in cycles per pixel, `v` downwards, not both 0: `1, x, x^2`, the cosine and sine
/// of 2 and 4 times the direction, `x^3`, those of 6 and 8 times the direction, `x` times those of 2 and 4, then the
/// ridges along both axes; `x = ln(f / 0.1)` at the radius `f`. They expand the logarithm of the power times
/// `(f / 0.1)^2.2`.
///
/// ```
/// let terms = blur_core::estimate::joint::scene_terms(0.1, 0.0);
/// assert!((terms[3] - 1.0).abs() < 1e-12 && terms[1].abs() < 1e-12);
/// ```
pub fn scene_terms(u: f64, v: f64) -> [f64; SCENE_TERMS] {
    whittle::terms(u, v)
}

/// Mean and standard deviation over sharp pictures of the amplitude of each of [`scene_terms`], the prior of
/// [`Whittle`]. That of the first term, the level, is free.
pub fn scene_prior() -> ([f64; SCENE_TERMS], [f64; SCENE_TERMS]) {
    (whittle::MEAN, whittle::STD)
}
