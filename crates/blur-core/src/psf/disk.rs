//! The PSF of a lens out of focus: a disk.

use std::f64::consts::PI;

use super::positive;
use crate::Result;

/// Below this argument the first term of the series that is left out, `x² / 8`, is lost in rounding.
const TINY: f64 = 1e-9;

/// Blur by a uniform circular pupil out of focus: the light of a point fills a disk.
///
/// It is not a motion: its dark lines in the spectrum are circles about the origin. Models and tests of motion hold it
/// against their own.
///
/// # Reference
/// Goodman, *Introduction to Fourier Optics* (2005), 2.1.5: the transform of the circle function. Abramowitz and
/// Stegun, table 9.5, for its zeros.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiskBlur {
    diameter: f64,
}

impl DiskBlur {
    /// A disk of `diameter`, in any one unit.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) unless `diameter` is finite and greater than 0.
    pub fn new(diameter: f64) -> Result<Self> {
        Ok(Self { diameter: positive("disk diameter", diameter)? })
    }

    /// Diameter of the disk, in the unit it was given in.
    pub fn diameter(&self) -> f64 {
        self.diameter
    }

    /// The density `4 / (pi diameter²)`, per square unit, at the distance `r` from the centre; 0 outside the disk.
    pub fn psf(&self, r: f64) -> f64 {
        if r.is_nan() {
            f64::NAN
        } else if r.abs() <= 0.5 * self.diameter {
            4.0 / (PI * self.diameter * self.diameter)
        } else {
            0.0
        }
    }

    /// The transfer function `2 J1(x) / x` with `x = pi diameter rho`, at `rho` cycles per unit length in any
    /// direction: real, negative between its first two zeros `x = 3.8317` and `7.0156`. The error is below `1e-15` and
    /// the rounding of `x`.
    ///
    /// ```
    /// let disk = blur_core::psf::DiskBlur::new(10.0)?; // pixels
    /// assert!(disk.transfer(1.219_67 / 10.0).abs() < 1e-5);
    /// # Ok::<(), blur_core::Error>(())
    /// ```
    pub fn transfer(&self, rho: f64) -> f64 {
        let x = PI * self.diameter * rho;
        if x.abs() < TINY {
            1.0
        } else if x.is_infinite() {
            0.0
        } else {
            2.0 * libm::j1(x) / x
        }
    }
}
