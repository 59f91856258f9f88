//! Angle methods, one file each.

mod dct_hough;
mod dct_radon;
mod dft_cepstrum;
mod dft_gabor;
mod dft_hough;
mod dft_pattern;
mod dft_radon;
mod hough_vote;
mod peak;
mod radon_search;
mod sandwich;
mod structure;

pub use dct_hough::DctHough;
pub use dct_radon::DctRadon;
pub use dft_cepstrum::DftCepstrum;
pub use dft_gabor::DftGabor;
pub use dft_hough::DftHough;
pub use dft_radon::DftRadon;
