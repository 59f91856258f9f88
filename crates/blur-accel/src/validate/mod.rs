//! Cross-validation: how well a regression does on observations that it has not seen.
//!
//! [`Folds`] say which observations are left out together, [`cross_validate`] predicts each of them by a pipeline that
//! has not seen it, [`length_alone`] is the baseline that every pipeline must beat, and [`Comparison`] says whether one
//! does.

mod baseline;
mod comparison;
mod cross;
mod folds;
mod metrics;

pub use baseline::length_alone;
pub use comparison::Comparison;
pub use cross::{Recipe, Validation, cross_validate};
pub use folds::Folds;
pub use metrics::{Metrics, coverage};
