//! Sharp pictures to be exposed: `f64` on the scale 0..255, row 0 at the top.

mod bars;
mod dead_leaves;
mod gaussian_field;
mod plane_waves;

pub use bars::{Bars, bars};
pub use dead_leaves::{DeadLeaves, dead_leaves};
pub use gaussian_field::{FIELD_MEAN, FIELD_STD, gaussian_field};
pub use plane_waves::{PlaneWave, plane_waves};
