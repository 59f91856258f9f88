//! A calibrated camera.

use std::mem::offset_of;

use blur_core::camera::{Intrinsics, PARAMETERS};

use crate::versioned::Versioned;
use crate::{Error, Result};

/// A calibrated camera, a pinhole with lens distortion; model and order are those of OpenCV. Begin with
/// mb_camera camera = {sizeof camera};
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Camera {
    /// Its size in bytes: sizeof(mb_camera).
    pub struct_size: usize,
    /// Columns of the pictures that it was calibrated with. Pictures to measure may be larger or smaller, of one shape.
    pub width_px: usize,
    /// Rows.
    pub height_px: usize,
    /// fx, fy, cx, cy, skew in pixels, then k1, k2, p1, p2, k3.
    pub parameters: [f64; 10],
    /// Covariance of the parameters, row by row; 0 where a parameter counts as exact.
    pub covariance: [[f64; 10]; 10],
}

// SAFETY: `repr(C)`, the size first, and numbers only.
unsafe impl Versioned for Camera {
    const NAME: &'static str = "mb_camera";
    const LEAST_BYTES: usize = offset_of!(Self, covariance) + size_of::<[[f64; PARAMETERS]; PARAMETERS]>();
}

impl Camera {
    pub(crate) fn intrinsics(&self) -> Result<Intrinsics> {
        Intrinsics::new(self.parameters, self.covariance, self.width_px, self.height_px).map_err(Error::Configuration)
    }
}
