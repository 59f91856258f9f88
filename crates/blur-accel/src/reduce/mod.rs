//! From many numbers to few: principal components and common scales.

mod pca;
mod scaler;

pub use pca::{Components, Pca};
pub use scaler::Scaler;
