//! The figures of a section, one file each.

pub mod budget;
pub mod cepstrum;
pub mod collapsed;
pub mod evidence;
pub mod headline;
pub mod likelihood;
pub mod picture;
pub mod psf;
pub mod regions;
pub mod repeat;
pub mod residuals;
pub mod restored;
pub mod spectrum;
