//! Radon transform of the log DFT spectrum.

use ndarray::ArrayView2;

use super::dft_pattern::DftPattern;
use crate::Result;
use crate::estimate::{AngleEstimate, AngleEstimator, Settings};
use crate::projection::PatternBank;

/// `dft-radon`: the direction in which the Radon transform of the levelled log DFT spectrum shows the dark lines of a
/// uniform blur best.
///
/// The picture is tapered, transformed, its log power levelled; for every direction the spectrum is projected onto the
/// frequency along the motion and compared with `ln sinc^2(L s)` for all lengths. The best match wins and is refined on
/// all bins by a parabola.
///
/// # Uncertainty
///
/// The sandwich formula over blocks of bins around the best match, and what sharp pictures may look like as a Type B
/// contribution. Two standard uncertainties covered 99, 98 and 93 % of the errors on clean pictures and at 36 and 28 dB,
/// but only 77 % at 20 dB, where the picture's own structure moves the peak. A wrong peak is not covered.
///
/// # When it fails
///
/// Periodic textures and long parallel edges draw lines of their own. Blurs shorter than about 5 px have no dark line
/// inside the band used.
///
/// # Reference
///
/// M. E. Moghaddam and M. Jamzad, "Linear motion blur parameter estimation in noisy images using fuzzy sets and power
/// spectrum", EURASIP J. Adv. Signal Process. 2007; A. Deshpande and S. Patnaik 2012. Thesis sections 1.2.1 and 4.4.1.
#[derive(Debug)]
pub struct DftRadon(DftPattern);

impl DftRadon {
    /// A new estimator; plans are made when the first picture comes.
    pub fn new(settings: &Settings) -> Self {
        Self(DftPattern::new(settings, PatternBank::dark_lines))
    }
}

impl AngleEstimator for DftRadon {
    fn estimate(&mut self, image: ArrayView2<'_, f32>) -> Result<AngleEstimate> {
        self.0.estimate(image)
    }
}
