//! Radon transform of the log DCT spectrum.

use ndarray::ArrayView2;

use super::dft_pattern::MOST_RIVAL;
use super::peak::no_direction;
use super::radon_search::{DIRECTIONS_DEG, QUADRANT_DEG, RadonSearch};
use crate::estimate::front::{DctFront, DftFront};
use crate::estimate::per_size::PerSize;
use crate::estimate::{AngleEstimate, AngleEstimator, Settings};
use crate::projection::PatternBank;
use crate::{Result, image};

/// `dct-radon`: the direction in which the Radon transform of the levelled log DCT spectrum shows the dark lines of a
/// uniform blur best (thesis algorithm 4.1).
///
/// Against the thesis's algorithm three steps are more robust: the spectrum is levelled and limited instead of
/// binarised at 0.9, whole projections are compared with `ln sinc^2(L s)` instead of taking the brightest ray, and the
/// peak is refined by a parabola.
///
/// # All directions
///
/// A DCT has no phase: its quadrant holds the spectra of the picture and of its mirror image one over the other, so
/// `angle` and `180 - angle` look alike. The search runs over `[0, 90]`; which of the two it is, the same match decides
/// on the picture's DFT.
///
/// # Uncertainty
///
/// As [`DftRadon`](super::DftRadon), and shorter still: 98, 94, 85 and 72 % of the errors at 55 px (clean, 36, 28, 20 dB)
/// lie within two standard uncertainties, since the overlaid mirror image is not counted.
///
/// # When it fails
///
/// As [`DftRadon`](super::DftRadon), and more often: each dark line is overlaid with the mirror image's bright ones.
///
/// # Reference
///
/// J. A. Cortes-Osorio, J. B. Gomez-Mendoza and J. C. Riano-Rojas, "Velocity estimation from a single linear motion
/// blurred image using discrete cosine transform", IEEE Trans. Instrum. Meas. 68(10), 2019; thesis algorithm 4.1.
#[derive(Debug)]
pub struct DctRadon {
    settings: Settings,
    plan: PerSize<Plan>,
}

#[derive(Debug)]
struct Plan {
    dct: DctFront,
    dct_search: RadonSearch,
    dft: DftFront,
    dft_search: RadonSearch,
}

impl DctRadon {
    /// A new estimator; plans are made when the first picture comes.
    pub fn new(settings: &Settings) -> Self {
        Self { settings: *settings, plan: PerSize::new() }
    }
}

impl AngleEstimator for DctRadon {
    fn estimate(&mut self, image: ArrayView2<'_, f32>) -> Result<AngleEstimate> {
        image::check(image)?;
        let settings = self.settings;
        let plan = self.plan.get(image.dim(), |dim| {
            let (dct, dft) = (DctFront::new(settings.window, dim), DftFront::new(settings.window, dim));
            let range = settings.lengths_in(dim.0.max(dim.1) as f64);
            let bank = |profile: &_| PatternBank::dark_lines(profile, range.min_px(), range.max_px());
            Plan {
                dct_search: RadonSearch::new(dct.levelled(), dim, QUADRANT_DEG, bank),
                dft_search: RadonSearch::new(dft.levelled(), dim, DIRECTIONS_DEG, bank),
                dct,
                dft,
            }
        });
        let Some(mut found) = plan.dct_search.find(plan.dct.set(image)) else {
            return Ok(no_direction());
        };
        let dft = plan.dft.set(image);
        if plan.dft_search.gain_at(dft, 180.0 - found.peak.deg) > plan.dft_search.gain_at(dft, found.peak.deg) {
            found.peak.deg = 180.0 - found.peak.deg;
        }
        Ok(found.peak.estimate(Some(found.std_deg), MOST_RIVAL))
    }
}
