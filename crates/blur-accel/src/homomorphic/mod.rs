//! The PSF of a picture from its spectrum and those of sharp pictures of the same scene.
//!
//! A blurred picture of a scene has the spectrum `|G| = |I| |H|`. With still pictures `I_k` of the scene, taken by the
//! camera at rest, the transfer function follows by homomorphic filtering (Cannon 1974; thesis eq. 6.9-6.13, figure 6.3):
//!
//! ```text
//! ln |H(u, v)| = ln |G(u, v)| - mean over k of ln |I_k(u, v)|
//! ```
//!
//! The inverse transform of `|H|` with phase zero is the zero-phase PSF. The motion lies along the rows, so only its
//! central row is of use, and by the projection theorem that row is the one-dimensional inverse transform of the mean of
//! `H` over `v`: no two-dimensional inverse is computed.
//!
//! # What noise demands
//!
//! Taken literally, the formula divides by empty bins, and on pictures with noise of 40 dB its `|H|` is off by 0.4 rms.
//! Four things are added, which bring that to 0.02 up to 0.2 cycles per pixel (0.02 without noise, 0.06 at 30 dB):
//!
//! - **Window**: a Hann window on all pictures; what is blurred into the picture at its borders leaks less.
//! - **Weight**: bin `(u, v)` weighs `S / (S + 300 N)`, as in a Wiener filter, with the power `S` of the backgrounds'
//!   signal and `N` of their noise, which is read where pictures have next to no signal.
//! - **Noise** is taken off the power of the blurred picture before its logarithm; a twentieth of it is always left.
//! - **Mean before exponential**: the transfer function of a motion along the rows does not depend on `v`, so the mean
//!   over `v` is taken of `ln |H|` where it is one number with errors of either sign. Where the weights of a whole
//!   column of bins add up to no more than a few bins, `|H|` is drawn towards 0.
//!
//! What multiplies a picture as a whole falls out: `|H|` is divided by its value at `u = 0`, so the PSF has the sum 1.
//!
//! Magnitudes know neither where the blur lies nor its direction: a motion and its reverse have the same PSF here, and
//! the sign of an acceleration is not in it.

mod power;
mod prototype;
mod psf;

use serde::{Deserialize, Serialize};

pub use prototype::Prototype;
pub use psf::HomomorphicPsf;

/// Transform that spectra are made with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Variant {
    /// Fourier transform, as in the thesis: its modulus does not change with a shift of the picture.
    #[default]
    Dft,
    /// Cosine transform: half the step in frequency, but its coefficients change with a shift, so that pictures which
    /// begin their motion where the backgrounds were taken agree with them less.
    Dct,
}

impl Variant {
    /// Frequencies along a row of a spectrum of a picture with so many columns, from 0 in equal steps.
    fn frequencies(self, columns: usize) -> usize {
        match self {
            Self::Dft => columns / 2 + 1,
            Self::Dct => columns,
        }
    }

    /// Period in pixels of the PSF with these frequencies: the inverse of their step.
    fn period_px(self, columns: usize) -> usize {
        match self {
            Self::Dft => columns,
            Self::Dct => 2 * columns,
        }
    }
}
