//! How far to trust a fit.

use super::view::Outcome;
use crate::estimate::{Doubt, LengthRange, Status};

/// Least gain in log-likelihood over no blur, and over a disk.
const LEAST_GAIN: f64 = 18.0;
const LEAST_OVER_DISK: f64 = 5.0;
/// Least gain for each bin of signal; below the first there is no blur to speak of.
const NO_DENSITY: f64 = 0.005;
/// Gain needed for each bin of signal: as much as the share of light that does not follow the kernel, between these
/// bounds. Edges and textures gain something by a kernel that half the light contradicts; a true blur that gains as
/// little, because noise covers most of it, is coherent in what is left.
const LEAST_DENSITY: f64 = 0.006;
const MOST_DENSITY: f64 = 0.02;
/// Most light that may not follow the kernel. Sharp edges and textures mimic some of the pattern, not all.
const MOST_SHARE: f64 = 0.08;
/// Most evidence that another mode may have, relative to the best.
const MOST_RIVAL: f64 = 0.5;
/// A spectrum more peaked than this is that of a periodic texture, whose own lines may stand for the blur's: then the
/// evidence must be stronger, by these bounds.
const PERIODIC: f64 = 1.08;
const PERIODIC_DENSITY: f64 = 0.06;
const PERIODIC_RIVAL: f64 = 0.3;
/// Most standard uncertainty of a length, relative, and of an angle in degrees.
const MOST_LENGTH_STD: f64 = 0.08;
const MOST_ANGLE_STD_DEG: f64 = 3.0;

/// The status of `outcome`, searched for in `range`; the first reason for doubt that applies.
pub(super) fn status(outcome: &Outcome, range: LengthRange) -> Status {
    let share = outcome.log_share.exp();
    let angle_std_deg = outcome.covariance[1][1].sqrt().to_degrees();
    let length_std = outcome.covariance[0][0].sqrt();
    let strong = outcome.density > PERIODIC_DENSITY && outcome.rival < PERIODIC_RIVAL;
    let needed = share.clamp(LEAST_DENSITY, MOST_DENSITY);
    let weak = Doubt::WeakEvidence { per_bin: outcome.density, needed };
    if outcome.over_disk < LEAST_OVER_DISK {
        Status::NoMotionBlur(Doubt::Defocus { gain: outcome.over_disk, needed: LEAST_OVER_DISK })
    } else if outcome.density < NO_DENSITY {
        Status::NoMotionBlur(weak)
    } else if outcome.density < needed {
        Status::LowConfidence(weak)
    } else if outcome.gain < LEAST_GAIN {
        Status::LowConfidence(Doubt::SmallGain { gain: outcome.gain, needed: LEAST_GAIN })
    } else if share > MOST_SHARE {
        Status::LowConfidence(Doubt::Incoherent { share, most: MOST_SHARE })
    } else if outcome.peaks > PERIODIC && !strong {
        Status::LowConfidence(Doubt::PeriodicTexture { peakedness: outcome.peaks, most: PERIODIC })
    } else if outcome.rival > MOST_RIVAL {
        Status::LowConfidence(Doubt::RivalBlur { share: outcome.rival, most: MOST_RIVAL })
    } else if length_std > MOST_LENGTH_STD {
        Status::LowConfidence(Doubt::Uncertain { std: 100.0 * length_std, most: 100.0 * MOST_LENGTH_STD, unit: "%" })
    } else if angle_std_deg > MOST_ANGLE_STD_DEG {
        Status::LowConfidence(Doubt::Uncertain { std: angle_std_deg, most: MOST_ANGLE_STD_DEG, unit: "deg" })
    } else {
        crate::estimate::length::status_in(range, outcome.length, Status::Ok)
    }
}
