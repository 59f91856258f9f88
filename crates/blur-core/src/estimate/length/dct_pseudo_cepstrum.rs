//! Pseudo-cepstrum of the collapsed DCT spectrum.

use ndarray::ArrayView2;

use super::collapsed_cepstrum::{CONTRAST_NEEDED, CollapsedCepstrum};
use super::oriented::Oriented;
use super::{from_trough, range_along};
use crate::estimate::per_size::PerSize;
use crate::estimate::{AxialAngle, LengthEstimate, LengthEstimator, Settings};
use crate::spectrum::Dct2;
use crate::{Result, image};

/// `dct-pseudo-cepstrum`: the lag of the most striking trough of the DCT of the collapsed log DCT spectrum (thesis algorithm
/// 4.2).
///
/// The picture is turned so that the motion lies along its rows, transformed, and the log power averaged over the
/// frequencies across the motion, weighted by how much signal they hold. The zeros of `sinc(L s)` repeat every `1/L`,
/// so the DCT of what is left after a cubic in `ln s` has a trough at `L`; the one that is deepest for the scatter around it is taken; a parabola places it between lags.
///
/// The second logarithm of the thesis's step 6 is left out: it takes logs of numbers near zero and of both signs.
///
/// # Uncertainty
///
/// The scatter of the cepstrum around the trough over the trough's curvature, first order. A wrong trough is not covered.
/// Of the answers called `ok`, 100, 99-100, 91-96 and 81-82 % (clean, 36, 28, 20 dB) are within two standard
/// uncertainties, at 0 and at 37 degrees; on clean pictures they are several times too long.
///
/// # When it fails
///
/// Noise that drowns the second dark line leaves one dip, whose cepstrum is broad: at 20 dB errors reach some percent.
/// Blurs longer than half of the picture leave too few periods; a wrong angle smears the dark lines of long blurs.
///
/// # Reference
///
/// J. A. Cortes-Osorio, J. B. Gomez-Mendoza and J. C. Riano-Rojas, IEEE Trans. Instrum. Meas. 68(10), 2019; J. M.
/// Hassanein and M. Rudko, "On the use of discrete cosine transform in cepstral analysis", IEEE Trans. ASSP 32, 1984;
/// thesis eq. 4.10 and algorithm 4.2.
#[derive(Debug)]
pub struct DctPseudoCepstrum {
    settings: Settings,
    plan: PerSize<Oriented<(Dct2, CollapsedCepstrum)>>,
}

impl DctPseudoCepstrum {
    /// A new estimator; plans are made when the first picture comes.
    pub fn new(settings: &Settings) -> Self {
        Self { settings: *settings, plan: PerSize::new() }
    }
}

impl LengthEstimator for DctPseudoCepstrum {
    fn estimate(&mut self, image: ArrayView2<'_, f32>, angle: AxialAngle) -> Result<LengthEstimate> {
        image::check(image)?;
        let range = range_along(&self.settings, image.dim(), angle);
        let window = self.settings.window;
        let oriented = self.plan.get(image.dim(), |dim| {
            Oriented::new(window, dim, |(rows, columns)| {
                (Dct2::new(rows, columns), CollapsedCepstrum::new(columns, 0.5 / columns as f64, columns))
            })
        });
        let (dct, cepstrum) = oriented.turn(image, angle, |(dct, _)| dct.input());
        cepstrum.collapsed.set_from_dct(dct.transform());
        Ok(from_trough(cepstrum.trough(range.min_px(), range.max_px()), range, CONTRAST_NEEDED))
    }
}
