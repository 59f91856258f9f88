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
/// contribution. A wrong peak is not covered. Share of errors within two standard uncertainties, on photographs blurred
/// by 15, 30, 55 and 90 px:
///
/// | clean | 36 dB | 28 dB | 20 dB |
/// |---|---|---|---|
/// | 99-100 % | 90, 97, 98, 96 % | 83, 87, 93, 93 % | 65, 69, 77, 79 % |
///
/// Short blurs in noise leave few dark lines, and the picture's own structure moves the peak further than is stated.
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
