//! The fields that say how good a result is.

use blur_core::estimate::Evidence;
use serde::Serialize;

/// What speaks for and against the result, see [`Evidence`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EvidenceFields {
    /// Gain in log-likelihood over no blur, for each bin of signal.
    pub gain_per_bin: f64,
    /// Evidence for the best other blur, relative to the one found.
    pub rival_share: f64,
    /// Share of the light that does not follow the motion.
    pub incoherent_share: f64,
    /// Mean squared standardised residual of the spectrum.
    pub misfit: f64,
    /// Highest frequency that the result rests on, in cycles per pixel.
    pub band_cycles_per_px: f64,
}

impl From<Evidence> for EvidenceFields {
    fn from(found: Evidence) -> Self {
        Self {
            gain_per_bin: found.gain_per_bin,
            rival_share: found.rival_share,
            incoherent_share: found.incoherent_share,
            misfit: found.misfit,
            band_cycles_per_px: found.band_cycles_per_px,
        }
    }
}
