//! Cepstrum of the collapsed DFT spectrum.

use ndarray::ArrayView2;

use super::collapsed_cepstrum::{CONTRAST_NEEDED, CollapsedCepstrum};
use super::oriented::Oriented;
use super::{from_trough, range_along};
use crate::estimate::per_size::PerSize;
use crate::estimate::{AxialAngle, LengthEstimate, LengthEstimator, Settings};
use crate::image::{Taper, Window};
use crate::spectrum::Dft2;
use crate::{Result, image};

/// `dft-cepstrum`: the lag of the most striking trough of the cepstrum of the collapsed log DFT spectrum.
///
/// As [`DctPseudoCepstrum`](super::DctPseudoCepstrum) with a DFT, which needs a taper where the DCT's even extension
/// has none.
///
/// # Uncertainty
///
/// As [`DctPseudoCepstrum`](super::DctPseudoCepstrum).
///
/// # When it fails
///
/// As [`DctPseudoCepstrum`](super::DctPseudoCepstrum); half as many frequencies make the trough of long blurs weaker.
///
/// # Reference
///
/// T. M. Cannon, "Blind deconvolution of spatially invariant image blurs with phase", IEEE Trans. ASSP 24(1), 1976;
/// F. Krahmer et al., IMA 2006; thesis eq. 4.9 and section 4.4.1.
#[derive(Debug)]
pub struct DftCepstrum {
    settings: Settings,
    plan: PerSize<Oriented<Plan>>,
}

#[derive(Debug)]
struct Plan {
    canvas: ndarray::Array2<f32>,
    taper: Taper,
    dft: Dft2,
    cepstrum: CollapsedCepstrum,
}

/// Taper along and across the motion of the turned picture.
const WINDOW: Window = Window::Tukey { taper: 0.25 };

impl DftCepstrum {
    /// A new estimator; plans are made when the first picture comes.
    pub fn new(settings: &Settings) -> Self {
        Self { settings: *settings, plan: PerSize::new() }
    }
}

impl LengthEstimator for DftCepstrum {
    fn estimate(&mut self, image: ArrayView2<'_, f32>, angle: AxialAngle) -> Result<LengthEstimate> {
        image::check(image)?;
        let range = range_along(&self.settings, image.dim(), angle);
        let window = self.settings.window;
        let oriented = self.plan.get(image.dim(), |dim| {
            Oriented::new(window, dim, |(rows, columns)| Plan {
                canvas: ndarray::Array2::zeros((rows, columns)),
                taper: Taper::new(window.unwrap_or(WINDOW), rows, columns),
                dft: Dft2::new(rows, columns),
                cepstrum: CollapsedCepstrum::new(columns / 2 + 1, 1.0 / columns as f64, columns),
            })
        });
        let plan = oriented.turn(image, angle, |plan| &mut plan.canvas);
        plan.taper.apply(plan.canvas.view(), plan.dft.input());
        let columns = plan.dft.dim().1;
        plan.cepstrum.collapsed.set_from_dft(plan.dft.transform(), columns);
        Ok(from_trough(plan.cepstrum.trough(range.min_px(), range.max_px()), range, CONTRAST_NEEDED))
    }
}
