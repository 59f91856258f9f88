//! Spectra of pictures: DCT-II, DFT, and what is built on them.
//!
//! Each transform is a value that owns its plans and scratch for one picture size: build it once, reuse it per frame.
//! Spectra are `f32`; their rounding error is below 1e-6 of the rms coefficient at the sizes in use.

mod bins;
mod cepstrum;
mod collapse;
mod dct;
mod dft;
mod level;
mod log;
mod noise;
mod phase;
mod power;

pub use bins::SpectrumBins;
pub use cepstrum::{Cepstrum, LineCepstrum, Trough};
pub use collapse::Collapsed;
pub use dct::Dct2;
pub(crate) use dft::fast_size;
pub use dft::{Dft2, InverseDft2};
pub use level::Levelled;
pub(crate) use log::{exp, ln};
pub use noise::{NoiseFloor, Powers};
pub use phase::PhaseOnly;
pub use power::{PowerBin, PowerSpectrum};
