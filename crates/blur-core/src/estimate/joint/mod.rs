//! Methods that find direction and length at once, one file each.

mod lag_peak;
mod phase_autocorrelation;

pub use phase_autocorrelation::PhaseAutocorrelation;
