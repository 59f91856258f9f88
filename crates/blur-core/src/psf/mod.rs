//! Models of the blur kernel of a linear motion, uniform and uniformly accelerated, in space and in frequency; and of
//! what is easily taken for one, a lens out of focus ([`DiskBlur`]).
//!
//! A point of the scene that runs along `s(t)` during the exposure spreads its light over the path with the density
//! `l(s) = 1 / (T v(s))` (thesis eq. 3.11): the **PSF** of the motion. Its Fourier transform is the **transfer
//! function**, whose modulus is the **MTF**.
//!
//! # Conventions
//!
//! - **Lengths** are in any one unit (pixels, millimetres, metres); a PSF is per that unit and integrates to 1.
//! - **Frequencies** `u` of [`transfer`](UniformBlur::transfer) and [`mtf`](UniformBlur::mtf) are in cycles per that
//!   unit, with the kernel `e^{-2 pi i u s}`; `omega = 2 pi u` of the cosine and sine transforms is in radians per that
//!   unit. Every transform is 1 at frequency 0.
//! - **`sinc`** is the normalised one, `sinc(x) = sin(pi x) / (pi x)`: see [`sinc`].
//! - **Not a number** in, not a number out; every transform tends to 0 at infinite frequency and is 0 there.
//!
//! ```
//! use blur_core::psf::{AcceleratedBlur, UniformBlur};
//!
//! # fn main() -> blur_core::Result<()> {
//! let uniform = UniformBlur::new(20.0)?; // pixels
//! assert_eq!(uniform.mtf(1.0 / 20.0), 0.0);
//! // An acceleration fills the zeros of the sinc: the first one rises to about |r| / pi.
//! let accelerated = AcceleratedBlur::new(20.0, 0.3)?;
//! assert!((accelerated.mtf(1.0 / 20.0) - 0.3 / std::f64::consts::PI).abs() < 1e-3);
//! # Ok(())
//! # }
//! ```

mod accelerated;
mod bessel;
mod chirp;
mod disk;
mod fresnel;
mod raster;
mod uniform;

pub use accelerated::AcceleratedBlur;
pub use bessel::{BesselSums, spherical_bessel, spherical_bessel_sums};
pub use disk::DiskBlur;
pub use fresnel::{Fresnel, FresnelAuxiliary, fresnel, fresnel_auxiliary};
pub use raster::{MAX_KERNEL_LENGTH_PX, accelerated_line_kernel, line_kernel};
pub use uniform::{UniformBlur, sinc};

use crate::{Error, Result};

/// `value` when it is a finite number greater than 0.
fn positive(name: &'static str, value: f64) -> Result<f64> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(Error::Parameter { name, value, expected: "a finite number greater than 0" })
    }
}

/// `value` when it is a finite number.
fn finite(name: &'static str, value: f64) -> Result<f64> {
    if value.is_finite() { Ok(value) } else { Err(Error::Parameter { name, value, expected: "a finite number" }) }
}
