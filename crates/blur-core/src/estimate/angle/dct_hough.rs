//! Hough transform of the binarised log DCT spectrum.

use ndarray::ArrayView2;

use super::dft_hough::MOST_RIVAL;
use super::hough_vote::{Directions, HoughVote};
use super::peak::no_direction;
use crate::estimate::front::{DctFront, DftFront};
use crate::estimate::per_size::PerSize;
use crate::estimate::{AngleEstimate, AngleEstimator, Settings};
use crate::{Result, image};

/// `dct-hough`: the direction of the line with the most votes of the brightest tenth of the levelled log DCT spectrum.
///
/// As [`DftHough`](super::DftHough) on the quadrant of a DCT; of the two directions `angle` and `180 - angle` that a
/// DCT cannot tell apart, the votes on the picture's DFT decide.
///
/// # Uncertainty
///
/// None is stated: votes have no simple distribution.
///
/// # When it fails
///
/// As [`DftHough`](super::DftHough).
///
/// # Reference
///
/// Thesis section 5.3.7 and table 5.2.
#[derive(Debug)]
pub struct DctHough {
    settings: Settings,
    plan: PerSize<Plan>,
}

#[derive(Debug)]
struct Plan {
    dct: DctFront,
    dct_vote: HoughVote,
    dft: DftFront,
    dft_vote: HoughVote,
}

impl DctHough {
    /// A new estimator; plans are made when the first picture comes.
    pub fn new(settings: &Settings) -> Self {
        Self { settings: *settings, plan: PerSize::new() }
    }
}

impl AngleEstimator for DctHough {
    fn estimate(&mut self, image: ArrayView2<'_, f32>) -> Result<AngleEstimate> {
        image::check(image)?;
        let settings = self.settings;
        let plan = self.plan.get(image.dim(), |dim| {
            let (dct, dft) = (DctFront::new(settings.window, dim), DftFront::new(settings.window, dim));
            let side = dim.0.max(dim.1);
            Plan {
                dct_vote: HoughVote::new(dct.levelled().bins(), side, Directions::Quadrant),
                dft_vote: HoughVote::new(dft.levelled().bins(), side, Directions::All),
                dct,
                dft,
            }
        });
        let Some(mut peak) = plan.dct_vote.find(plan.dct.set(image).bins()) else { return Ok(no_direction()) };
        let bins = plan.dft.set(image).bins();
        if plan.dft_vote.response_near(bins, 180.0 - peak.deg) > plan.dft_vote.response_near(bins, peak.deg) {
            peak.deg = 180.0 - peak.deg;
        }
        Ok(peak.estimate(None, MOST_RIVAL))
    }
}
