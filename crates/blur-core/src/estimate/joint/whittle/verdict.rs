//! How far to trust a fit.

use super::rows::Found;
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
/// Least gain and lead of rows: neighbours show the same things, and how far they do is known from themselves alone. On design
/// photographs one gross answer in a thousand gains more, one in a hundred more than [`LEAST_GAIN`].
const LEAST_ROWS_GAIN: f64 = 36.0;
/// What must be added to it when the rows are twice as peaked as their scene, a power law and nothing else. Gross answers in
/// periodic design photographs, 1.2 to 2.2 times as peaked, gain or lead by up to 170.
const ROWS_GAIN_OF_PEAKS: f64 = 150.0;
/// Most standard uncertainty of a length, relative, and of an angle in degrees.
const MOST_LENGTH_STD: f64 = 0.08;
const MOST_ANGLE_STD_DEG: f64 = 3.0;

/// Whether `outcome` is that there is no motion blur, whatever else is found.
pub(super) fn is_denied(outcome: &Outcome) -> bool {
    outcome.over_disk < LEAST_OVER_DISK || outcome.density < NO_DENSITY
}

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

/// Whether rows that gain so much say something of the blur, with or without doubt.
pub(super) fn rows_tell(found: &Found) -> bool {
    found.gain >= LEAST_GAIN
}

/// The status of what rows say, searched for in `range`. They do not tell a sharp scene from one whose blur the noise has
/// covered, so that they never deny a blur.
pub(super) fn status_of_rows(found: &Found, range: LengthRange) -> Status {
    let std = found.variance.sqrt();
    let clear = found.gain.min(found.lead);
    let most_peaks = 1.0 + (clear - LEAST_ROWS_GAIN) / ROWS_GAIN_OF_PEAKS;
    // Written so that what is not a number is in doubt.
    let is_plain = found.gain >= LEAST_ROWS_GAIN;
    if !is_plain {
        Status::LowConfidence(Doubt::SmallGain { gain: found.gain, needed: LEAST_ROWS_GAIN })
    } else if clear < LEAST_ROWS_GAIN {
        let share = |lead: f64| (found.gain - lead) / found.gain;
        Status::LowConfidence(Doubt::RivalBlur { share: share(found.lead), most: share(LEAST_ROWS_GAIN) })
    } else if found.peaks > most_peaks {
        Status::LowConfidence(Doubt::PeriodicTexture { peakedness: found.peaks, most: most_peaks })
    } else if std > MOST_LENGTH_STD {
        Status::LowConfidence(Doubt::Uncertain { std: 100.0 * std, most: 100.0 * MOST_LENGTH_STD, unit: "%" })
    } else {
        crate::estimate::length::status_in(range, found.length, Status::Ok)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An outcome that nothing speaks against.
    fn perfect() -> Outcome {
        let mut covariance = [[0.0; 3]; 3];
        (covariance[0][0], covariance[1][1]) = (1e-4, 1e-5);
        Outcome {
            length: 20.0,
            angle: 0.3,
            covariance,
            band: 0.5,
            start: 0,
            gain: 900.0,
            density: 0.2,
            rival: 0.0,
            over_disk: 400.0,
            log_share: -7.0,
            peaks: 1.0,
            misfit: 1.0,
        }
    }

    fn judged(change: impl FnOnce(&mut Outcome)) -> Status {
        let mut outcome = perfect();
        change(&mut outcome);
        status(&outcome, LengthRange::new(4.0, 100.0).unwrap())
    }

    #[test]
    fn a_perfect_outcome_is_ok() {
        assert_eq!(judged(|_| {}), Status::Ok);
    }

    #[test]
    fn every_rule_raises_its_own_doubt() {
        type Case = (fn(&mut Outcome), fn(Status) -> bool);
        let cases: [Case; 10] = [
            (|o| o.over_disk = 4.9, |s| matches!(s, Status::NoMotionBlur(Doubt::Defocus { gain: 4.9, .. }))),
            (|o| o.density = 0.0049, |s| matches!(s, Status::NoMotionBlur(Doubt::WeakEvidence { .. }))),
            // A coherent blur needs the least gain, half a percent incoherent light or less.
            (
                |o| o.density = 0.0055,
                |s| matches!(s, Status::LowConfidence(Doubt::WeakEvidence { needed: LEAST_DENSITY, .. })),
            ),
            // With a share of 5 % the most is needed.
            (
                |o| (o.density, o.log_share) = (0.019, 0.05_f64.ln()),
                |s| matches!(s, Status::LowConfidence(Doubt::WeakEvidence { needed: MOST_DENSITY, .. })),
            ),
            (|o| o.gain = 17.0, |s| matches!(s, Status::LowConfidence(Doubt::SmallGain { gain: 17.0, .. }))),
            (|o| o.log_share = 0.09_f64.ln(), |s| matches!(s, Status::LowConfidence(Doubt::Incoherent { .. }))),
            (
                |o| (o.peaks, o.density) = (1.1, 0.05),
                |s| matches!(s, Status::LowConfidence(Doubt::PeriodicTexture { .. })),
            ),
            (|o| o.rival = 0.6, |s| matches!(s, Status::LowConfidence(Doubt::RivalBlur { .. }))),
            (
                |o| o.covariance[0][0] = 0.081 * 0.081,
                |s| matches!(s, Status::LowConfidence(Doubt::Uncertain { unit: "%", .. })),
            ),
            (
                |o| o.covariance[1][1] = 3.1_f64.to_radians().powi(2),
                |s| matches!(s, Status::LowConfidence(Doubt::Uncertain { unit: "deg", .. })),
            ),
        ];
        for (i, (change, is_expected)) in cases.into_iter().enumerate() {
            let status = judged(change);
            assert!(is_expected(status), "rule {i}: {status:?}");
        }
        for length in [4.01, 99.9] {
            let status = judged(|o| o.length = length);
            assert!(matches!(status, Status::LowConfidence(Doubt::LengthAtRangeEnd { .. })), "{length}: {status:?}");
        }
    }

    #[test]
    fn rows_are_doubted_by_limits_of_their_own() {
        let range = LengthRange::new(4.0, 36.0).unwrap();
        let judged = |length: f64, std: f64, gain: f64, lead: f64| {
            status_of_rows(&Found { length, variance: std * std, gain, lead, peaks: 1.0 }, range)
        };
        assert_eq!(judged(20.0, 0.079, 36.1, f64::INFINITY), Status::Ok);
        assert_eq!(judged(20.0, 0.01, 900.0, 36.1), Status::Ok);
        for gain in [35.9, -3.0, f64::NAN] {
            let status = judged(20.0, 0.01, gain, f64::INFINITY);
            assert!(matches!(status, Status::LowConfidence(Doubt::SmallGain { .. })), "{gain}: {status:?}");
        }
        // The more peaked, the more must both be.
        for (peaks, needed) in [(1.1, 51.0), (1.3, 81.0), (2.0, 186.0)] {
            let of = |gain, lead| status_of_rows(&Found { length: 20.0, variance: 1e-4, gain, lead, peaks }, range);
            assert_eq!(of(needed + 0.1, needed + 0.1), Status::Ok);
            for status in [of(needed - 0.1, f64::INFINITY), of(900.0, needed - 0.1)] {
                assert!(matches!(status, Status::LowConfidence(Doubt::PeriodicTexture { .. })), "{status:?}");
            }
        }
        let doubts = [judged(20.0, 0.01, 40.0, 35.0), judged(20.0, 0.081, 40.0, 40.0), judged(35.9, 0.01, 40.0, 40.0)];
        assert!(matches!(doubts[0], Status::LowConfidence(Doubt::RivalBlur { .. })), "{doubts:?}");
        assert!(matches!(doubts[1], Status::LowConfidence(Doubt::Uncertain { unit: "%", .. })), "{doubts:?}");
        assert!(matches!(doubts[2], Status::LowConfidence(Doubt::LengthAtRangeEnd { .. })), "{doubts:?}");
    }

    #[test]
    fn limits_that_are_kept_raise_no_doubt() {
        let cases: [fn(&mut Outcome); 6] = [
            |o| o.over_disk = 5.1,
            |o| o.density = 0.0061,
            |o| o.log_share = 0.079_f64.ln(),
            // A texture is forgiven when the evidence is strong.
            |o| o.peaks = 1.5,
            |o| o.rival = 0.49,
            |o| o.covariance[0][0] = 0.079 * 0.079,
        ];
        for (i, change) in cases.into_iter().enumerate() {
            assert_eq!(judged(change), Status::Ok, "limit {i}");
        }
    }
}
