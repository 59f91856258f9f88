//! Steered Gabor filters on the log DFT spectrum.

use ndarray::ArrayView2;

use super::dft_pattern::DftPattern;
use crate::Result;
use crate::estimate::{AngleEstimate, AngleEstimator, Settings};
use crate::projection::PatternBank;

/// `dft-gabor`: the direction in which Gabor filters at the centre of the levelled log DFT spectrum respond most.
///
/// The filters are waves across the ridge of the spectrum, one for each period `1/L`, with a Gaussian envelope across
/// and none along their wave fronts. Such a filter is constant on lines, so its response is that of a one-dimensional
/// Gabor function on the Radon transform, which is how it is computed. Responses count as explained share of the
/// variance, so that filters of different periods compare.
///
/// # Uncertainty
///
/// As [`DftRadon`](super::DftRadon): 99, 97, 89 and 67 % of the errors at 55 px (clean, 36, 28, 20 dB) lie within two
/// standard uncertainties.
///
/// # When it fails
///
/// As [`DftRadon`](super::DftRadon); it sees the central ridge and two dark lines only, so noise hurts it more.
///
/// # Reference
///
/// I. M. Rekleitis, "Steerable filters and cepstral analysis for optical flow calculation from a single blurred image",
/// Vision Interface 1996; F. Krahmer et al., "Blind image deconvolution: motion blur estimation", IMA 2006.
#[derive(Debug)]
pub struct DftGabor(DftPattern);

impl DftGabor {
    /// A new estimator; plans are made when the first picture comes.
    pub fn new(settings: &Settings) -> Self {
        Self(DftPattern::new(settings, PatternBank::gabor))
    }
}

impl AngleEstimator for DftGabor {
    fn estimate(&mut self, image: ArrayView2<'_, f32>) -> Result<AngleEstimate> {
        self.0.estimate(image)
    }
}
