//! One motion-blurred picture in; direction, blur length and speed out.
//!
//! Pure computation: no files, no threads, no printing. The modules are the path that the data takes:
//!
//! [`image`] (grey, window, crop, rotate) → [`spectrum`] (DCT, DFT, cepstrum) → [`projection`] (Radon, Hough) →
//! [`psf`] (uniform, accelerated, out of focus) → [`estimate`] (angle, length, joint: one file per method) → [`camera`] (pinhole,
//! scale) → [`motion`] (speed).
//!
//! # Conventions
//!
//! - **Pixels** come as `ndarray::ArrayView2<f32>`, row 0 at the top, any linear scale (0..255, 0..65535, 0..1).
//! - **Angle**: degrees, counter-clockwise from +x *as a person sees the picture* (y up), in `[0, 180)`. A magnitude
//!   spectrum cannot tell a motion from the opposite one; [`AxialAngle`](estimate::AxialAngle) is therefore an axis.
//! - **Blur length**: the width in pixels of the uniform line PSF, a real number.
//! - **Frequencies** `u` (along columns) and `v` (along rows, downwards) are in cycles per pixel. The frequency along
//!   the motion is `s = u cos(angle) - v sin(angle)`; the transfer function of a uniform blur is `sinc(L s)`.
//! - **Uncertainties** are standard uncertainties (one standard deviation).

pub mod camera;
mod error;
pub mod estimate;
pub mod image;
pub mod motion;
pub mod projection;
pub mod psf;
pub mod region;
pub mod restore;
pub mod spectrum;

pub use error::{Error, Result};
