//! Methods that find direction and length at once, one file each.

mod lag_peak;
mod phase_autocorrelation;
mod whittle;

pub use phase_autocorrelation::PhaseAutocorrelation;
pub use whittle::{Stage, Whittle};
