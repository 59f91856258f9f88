//! Synthetic motion-blurred pictures with known truth.
//!
//! The modules are the path of the light: a sharp [`scene`], a [`motion`] of it over the sensor (or a [`defocus`]), the
//! [`expose`]d picture, possibly [`displaced`], and what the [`sensor`] makes of it. [`rng`] feeds them all: a seed
//! gives the same picture on every machine. [`sample`] puts them together once, and [`rig`] for a whole experiment with
//! accelerated motion.
//!
//! # Conventions
//!
//! Those of [`blur_core`]: row 0 at the top, angles counter-clockwise as seen, frequencies in cycles per pixel with
//! `v` downwards, `s = u cos(angle) - v sin(angle)` along the motion. Scenes and exposures are `Array2<f64>` on the
//! scale 0..255, recorded pictures `Array2<u8>`.
//!
//! # The blur is exact
//!
//! A scene's samples stand for the band-limited picture through them, and the blur is its time average: the spectrum
//! times `sinc(L s)` (or the transform of the accelerated path), for real-valued lengths and angles. Only pixels that
//! see nothing but the scene are kept.

mod check;
pub mod defocus;
pub mod displaced;
mod error;
pub mod expose;
pub mod motion;
pub mod rig;
pub mod rng;
pub mod rolling;
pub mod sample;
pub mod scene;
pub mod sensor;
pub mod street;
mod tabulated;
mod transform;

pub use error::{Error, Result};
