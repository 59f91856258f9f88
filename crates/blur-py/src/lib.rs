//! The Python package `motion_blur`: thin over [`blur_core::meter`], with no logic of its own.
//!
//! The way of a call: keyword arguments (`options`) and an array of `NumPy` (`image`) → [`blur_core::meter::Meter`], with
//! the interpreter's lock released → plain `data`. `batch` does it on threads, `picture` reads files, `blur` models and
//! undoes blurs, `camera` calibrates, `simulation` makes pictures of known truth.
//!
//! What Python sees is described, with its types, in `python/motion_blur/_native.pyi`.

#![allow(clippy::doc_markdown, reason = "the comments of what Python sees are shown there as they are, without markup")]

mod array;
mod batch;
mod blur;
mod camera;
mod data;
mod error;
mod image;
mod meter;
mod options;
mod picture;
mod simulation;

use pyo3::prelude::*;

/// Direction, length, speed and acceleration from one motion-blurred picture, with their uncertainties.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::batch::estimate_batch;
    #[pymodule_export]
    use super::blur::{psf, restore};
    #[pymodule_export]
    use super::camera::{Calibration, Camera, calibrate, find_board};
    #[pymodule_export]
    use super::error::MotionBlurError;
    #[pymodule_export]
    use super::meter::{Meter, estimate};
    #[pymodule_export]
    use super::picture::read;
    #[pymodule_export]
    use super::simulation::{dead_leaves, simulate};
}
