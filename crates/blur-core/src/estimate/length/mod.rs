//! Length methods, one file each.

mod autocorrelation;
mod collapsed_cepstrum;
mod dct_pseudo_cepstrum;
mod dft_cepstrum;
mod dft_radon;
mod oriented;
mod whittle;

pub use autocorrelation::Autocorrelation;
pub use dct_pseudo_cepstrum::DctPseudoCepstrum;
pub use dft_cepstrum::DftCepstrum;
pub use dft_radon::DftRadon;
pub use whittle::Whittle;

use super::{AxialAngle, Doubt, LengthEstimate, LengthRange, Settings, Status};
use crate::spectrum::Trough;

/// The lengths to search along `angle` in a picture: its extent is the longest straight line of that direction in it.
pub(super) fn range_along(settings: &Settings, (rows, columns): (usize, usize), angle: AxialAngle) -> LengthRange {
    let (sin, cos) = angle.rad().sin_cos();
    settings.lengths_in((columns as f64 / cos.abs()).min(rows as f64 / sin.abs()))
}

/// A length within this share of an end of the range counts as being at the end.
const AT_END: f64 = 0.01;

/// `status`, or a worse one when the length found is an end of the range searched.
pub(super) fn status_in(range: LengthRange, length_px: f64, status: Status) -> Status {
    let at_end = length_px < range.min_px() * (1.0 + AT_END) || length_px > range.max_px() * (1.0 - AT_END);
    let doubt = Doubt::LengthAtRangeEnd { length_px, min_px: range.min_px(), max_px: range.max_px() };
    if at_end { status.worse(Status::LowConfidence(doubt)) } else { status }
}

/// The estimate from a trough of a cepstrum or an autocorrelation, doubtful below the contrast `needed`.
fn from_trough(trough: Option<Trough>, range: LengthRange, needed: f64) -> LengthEstimate {
    let Some(Trough { lag_px, contrast, std_px }) = trough else { return no_length(range) };
    let status =
        if contrast >= needed { Status::Ok } else { Status::LowConfidence(Doubt::WeakLengthPeak { contrast, needed }) };
    LengthEstimate { length_px: lag_px, std_px: Some(std_px), status: status_in(range, lag_px, status) }
}

/// What a method answers when there is no pattern at all.
pub(super) fn no_length(range: LengthRange) -> LengthEstimate {
    LengthEstimate { length_px: range.min_px(), std_px: None, status: Status::NoMotionBlur(Doubt::NoPattern) }
}
