//! Hough transform of the binarised log DFT spectrum.

use ndarray::ArrayView2;

use super::hough_vote::{Directions, HoughVote};
use super::peak::no_direction;
use crate::estimate::front::DftFront;
use crate::estimate::per_size::PerSize;
use crate::estimate::{AngleEstimate, AngleEstimator, Settings};
use crate::{Result, image};

/// `dft-hough`: the direction of the line with the most votes of the brightest tenth of the levelled log DFT spectrum.
///
/// Votes count in standard deviations above chance, so directions in which lines are long have no advantage.
///
/// # Uncertainty
///
/// None is stated: votes have no simple distribution.
///
/// # When it fails
///
/// Binarising throws away the dark lines; what votes is mostly the central ridge, which noise and short blurs widen.
/// The picture's own lines vote like those of the blur.
///
/// # Reference
///
/// S. Tiwari, V. P. Shukla and A. K. Singh, "Review of motion blur estimation techniques", J. Image and Graphics 1(4),
/// 2013; R. Lokhande, K. Arya and P. Gupta 2006. Thesis section 4.4.1.
#[derive(Debug)]
pub struct DftHough {
    settings: Settings,
    plan: PerSize<(DftFront, HoughVote)>,
}

/// A rival direction with more than this share of the best response makes the answer doubtful.
pub(super) const MOST_RIVAL: f64 = 0.8;

impl DftHough {
    /// A new estimator; plans are made when the first picture comes.
    pub fn new(settings: &Settings) -> Self {
        Self { settings: *settings, plan: PerSize::new() }
    }
}

impl AngleEstimator for DftHough {
    fn estimate(&mut self, image: ArrayView2<'_, f32>) -> Result<AngleEstimate> {
        image::check(image)?;
        let settings = self.settings;
        let (front, vote) = self.plan.get(image.dim(), |dim| {
            let front = DftFront::new(settings.window, dim);
            let vote = HoughVote::new(front.levelled().bins(), dim.0.max(dim.1), Directions::All);
            (front, vote)
        });
        let found = vote.find(front.set(image).bins());
        Ok(found.map_or_else(no_direction, |peak| peak.estimate(None, MOST_RIVAL)))
    }
}
