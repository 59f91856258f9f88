//! Dark lines of the Radon transform at the known angle.

use ndarray::ArrayView2;

use super::{no_length, range_along, status_in};
use crate::estimate::front::DftFront;
use crate::estimate::per_size::PerSize;
use crate::estimate::{AxialAngle, Doubt, LengthEstimate, LengthEstimator, Settings, Status};
use crate::projection::{PatternBank, Profile, project};
use crate::{Result, image};

/// `dft-radon`: the length whose dark lines match the Radon transform of the levelled log DFT spectrum at the known
/// angle best.
///
/// The picture is not turned: the spectrum is projected onto the frequency along the motion instead. The projection is
/// compared with `ln sinc^2(L s)`, and a parabola places the length between those of the bank.
///
/// # Uncertainty
///
/// None is stated: the bank's lengths are too far apart for a curvature.
///
/// # When it fails
///
/// Levelling takes the mean of each ring, and with it part of the pattern of short blurs. Noise hides all but the first
/// dark line, and half the length with twice the depth fits nearly as well.
///
/// # Reference
///
/// M. Dobes, L. Machala and T. Furst, "Blurred image restoration: a fast method of finding the motion length and
/// angle", Digital Signal Processing 20(6), 2010. Thesis section 4.4.1.
#[derive(Debug)]
pub struct DftRadon {
    settings: Settings,
    plan: PerSize<Plan>,
}

#[derive(Debug)]
struct Plan {
    front: DftFront,
    profile: Profile,
    bank: PatternBank,
}

/// Gain in log likelihood below which the pattern could be chance.
const GAIN_NEEDED: f64 = 20.0;

impl DftRadon {
    /// A new estimator; plans are made when the first picture comes.
    pub fn new(settings: &Settings) -> Self {
        Self { settings: *settings, plan: PerSize::new() }
    }
}

impl LengthEstimator for DftRadon {
    fn estimate(&mut self, image: ArrayView2<'_, f32>, angle: AxialAngle) -> Result<LengthEstimate> {
        image::check(image)?;
        let range = range_along(&self.settings, image.dim(), angle);
        let settings = self.settings;
        let plan = self.plan.get(image.dim(), |dim| {
            let front = DftFront::new(settings.window, dim);
            let profile = Profile::fitting(front.levelled().bins(), dim.0, dim.1);
            let longest = settings.lengths_in((dim.0 as f64).hypot(dim.1 as f64));
            let bank = PatternBank::dark_lines(&profile, longest.min_px(), longest.max_px());
            Plan { front, profile, bank }
        });
        project(plan.front.set(image).bins(), angle.rad(), &mut plan.profile);
        let found = plan.bank.refined_match(&plan.profile);
        if found.gain <= 0.0 {
            return Ok(no_length(range));
        }
        let gain = found.gain / plan.front.variance_factor();
        let status = if gain >= GAIN_NEEDED {
            Status::Ok
        } else {
            Status::LowConfidence(Doubt::WeakLengthPeak { contrast: gain, needed: GAIN_NEEDED })
        };
        Ok(LengthEstimate {
            length_px: found.length_px,
            std_px: None,
            status: status_in(range, found.length_px, status),
        })
    }
}
