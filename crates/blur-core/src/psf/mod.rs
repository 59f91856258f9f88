//! Models of the blur kernel of a linear motion: uniform and uniformly accelerated, in space and in frequency.
//!
//! A point of the scene that runs along `s(t)` during the exposure spreads its light over the path with the density
//! `l(s) = 1 / (T v(s))` (thesis eq. 3.11): the **PSF** of the motion. Its Fourier transform is the **transfer
//! function**, whose modulus is the **MTF**.

mod bessel;
mod fresnel;

pub use bessel::{BesselSums, spherical_bessel, spherical_bessel_sums};
pub use fresnel::{Fresnel, FresnelAuxiliary, fresnel, fresnel_auxiliary};
