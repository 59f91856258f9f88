//! The peak of a response over all directions.

use crate::estimate::{AngleEstimate, AxialAngle, Doubt, Status};

/// A peak of a response sampled over directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Peak {
    pub(super) deg: f64,
    pub(super) height: f64,
    /// The highest response at least [`APART_DEG`] away, relative to the peak's.
    pub(super) rival: f64,
}

/// Directions nearer than this to a peak belong to it.
const APART_DEG: f64 = 15.0;

impl Peak {
    /// The highest of `responses` at directions `i * step_deg`, which are cyclic over 180 degrees or, for a DCT, mirrored
    /// at 0 and 90 degrees; `None` when no response is positive.
    pub(super) fn of(responses: &[f64], step_deg: f64) -> Option<Self> {
        let (at, &height) = responses.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
        if height.is_nan() || height <= 0.0 {
            return None;
        }
        let deg = at as f64 * step_deg;
        let peak_axis = AxialAngle::from_deg(deg);
        let rival = (responses.iter().enumerate())
            .filter(|&(i, _)| peak_axis.distance_deg(AxialAngle::from_deg(i as f64 * step_deg)) > APART_DEG)
            .map(|(_, &response)| response)
            .fold(0.0, f64::max);
        Some(Self { deg, height, rival: rival / height })
    }

    /// An estimate from this peak, `low_confidence` when a rival direction is nearly as good.
    pub(super) fn estimate(self, std_deg: Option<f64>, most_rival: f64) -> AngleEstimate {
        let status = if self.rival <= most_rival {
            Status::Ok
        } else {
            Status::LowConfidence(Doubt::RivalAngle { share: self.rival, most: most_rival })
        };
        AngleEstimate { angle: AxialAngle::from_deg(self.deg), std_deg, status }
    }
}

/// What a method answers when no direction stands out at all.
pub(super) fn no_direction() -> AngleEstimate {
    AngleEstimate { angle: AxialAngle::from_deg(0.0), std_deg: None, status: Status::NoMotionBlur(Doubt::NoPattern) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_seam_at_180_degrees_is_no_border() {
        let mut responses = vec![0.1; 180];
        responses[179] = 1.0;
        responses[3] = 0.9;
        responses[60] = 0.5;
        let peak = Peak::of(&responses, 1.0).unwrap();
        assert_eq!((peak.deg, peak.rival), (179.0, 0.5));
    }

    #[test]
    fn without_a_positive_response_there_is_no_peak() {
        assert_eq!(Peak::of(&[0.0; 10], 1.0), None);
        assert_eq!(Peak::of(&[], 1.0), None);
    }
}
