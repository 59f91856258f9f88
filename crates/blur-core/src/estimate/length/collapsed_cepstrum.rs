//! The way from a collapsed log spectrum to a length, shared by DCT and DFT.

use crate::spectrum::{Collapsed, LineCepstrum, Trough};

/// Collapsed log spectrum and its cepstrum.
#[derive(Debug)]
pub(super) struct CollapsedCepstrum {
    pub(super) collapsed: Collapsed,
    cepstrum: LineCepstrum,
}

/// Highest frequency along the motion that is used, cycles per pixel.
const MOST_ALONG: f64 = 0.4;
/// Contrast below which a trough is doubtful: mere noise and the picture's own structure reach 3 to 4 somewhere among
/// some hundred independent lags.
pub(super) const CONTRAST_NEEDED: f64 = 4.0;

impl CollapsedCepstrum {
    /// For spectra of `columns` frequencies, `step` cycles per pixel apart, of pictures `extent_px` pixels wide.
    pub(super) fn new(columns: usize, step: f64, extent_px: usize) -> Self {
        let least = 1.0 / extent_px as f64;
        let used = ((MOST_ALONG / step) as usize + 2).min(columns);
        Self { collapsed: Collapsed::new(used), cepstrum: LineCepstrum::new(step, least, MOST_ALONG) }
    }

    /// The deepest trough between two lengths, after `collapsed` has been set.
    pub(super) fn trough(&mut self, least_px: f64, most_px: f64) -> Option<Trough> {
        self.cepstrum.compute(self.collapsed.values());
        self.cepstrum.deepest_trough(least_px, most_px)
    }
}
