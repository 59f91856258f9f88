//! A lens out of focus during the exposure: what is not motion.

use crate::expose::Blur;
use crate::{Error, Result, check};
use blur_core::psf::DiskBlur;
use rustfft::num_complex::Complex;

/// A uniform circular pupil out of focus: every point of the scene becomes a disk.
///
/// ```
/// use blur_sim::{defocus::Defocus, expose::expose, scene::DeadLeaves, scene::dead_leaves};
/// # fn main() -> blur_sim::Result<()> {
/// let scene = dead_leaves(1, 112, 162, &DeadLeaves::default())?;
/// let picture = expose(scene.view(), &Defocus::new(11.3)?)?;
/// assert_eq!(picture.dim(), (100, 150));
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Defocus(DiskBlur);

impl Defocus {
    /// A disk of `diameter_px`, above 0 and at most 1e6 pixels.
    ///
    /// # Errors
    /// [`Error::Parameter`] out of the range.
    pub fn new(diameter_px: f64) -> Result<Self> {
        const EXPECTED: &str = "above 0, at most 1e6";
        let name = "diameter of the disk in px";
        let value = check::range(name, diameter_px, 0.0, 1e6, EXPECTED)?;
        DiskBlur::new(value).map(Self).map_err(|_| Error::Parameter { name, value, expected: EXPECTED })
    }

    /// Diameter of the disk in pixels.
    pub fn diameter_px(&self) -> f64 {
        self.0.diameter()
    }
}

impl Blur for Defocus {
    fn extent_px(&self) -> (usize, usize) {
        // As for a motion, an integer but for its rounding counts as that integer.
        let whole = (self.diameter_px() - 1e-9).ceil().max(0.0) as usize;
        (whole, whole)
    }

    fn gain(&self, _uses: usize) -> impl Fn(f64, f64) -> Complex<f64> {
        |u: f64, v: f64| Complex::new(self.0.transfer(u.hypot(v)), 0.0)
    }
}
