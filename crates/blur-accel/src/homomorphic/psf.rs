//! The zero-phase PSF of a blurred picture.

use std::fmt;
use std::sync::Arc;

use ndarray::ArrayView2;
use realfft::{ComplexToReal, RealFftPlanner};
use rustfft::num_complex::Complex64;

use super::power::PowerSpectrum;
use super::{Prototype, Variant};
use crate::{Error, Result};

/// Share of the noise that is left in a bin where it exceeds the power.
const LEAST_NOISE_SHARE: f32 = 0.05;

/// Extracts the zero-phase PSFs of pictures of one size that were blurred along their rows. Plans and buffers are kept:
/// after [`new`](Self::new) nothing is allocated.
///
/// ```
/// use blur_accel::homomorphic::{HomomorphicPsf, Prototype, Variant};
/// use blur_core::estimate::AxialAngle;
/// use blur_sim::{expose::expose, motion::Motion, scene::DeadLeaves, scene::dead_leaves};
/// use ndarray::s;
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let scene = dead_leaves(1, 256, 276, &DeadLeaves::default())?;
/// let motion = Motion::uniform(20.0, AxialAngle::from_deg(0.0))?;
/// let blurred = expose(scene.view(), &motion)?.mapv(|light| light as f32);
/// let still = scene.slice(s![.., 10..266]).mapv(|light| light as f32);
///
/// let scene = Prototype::new(Variant::Dft, &[still.view()])?;
/// let mut extractor = HomomorphicPsf::new(Variant::Dft, 256, 256);
/// let psf = extractor.extract(blurred.view(), &scene)?;
/// assert_eq!(psf.len(), 129);
/// # Ok(())
/// # }
/// ```
pub struct HomomorphicPsf {
    variant: Variant,
    spectrum: PowerSpectrum,
    mtf: Vec<f64>,
    half: Vec<Complex64>,
    row: Vec<f64>,
    scratch: Vec<Complex64>,
    inverse: Arc<dyn ComplexToReal<f64>>,
}

impl HomomorphicPsf {
    /// For pictures of `rows` x `columns` pixels, both at least 1.
    pub fn new(variant: Variant, rows: usize, columns: usize) -> Self {
        let period = variant.period_px(columns);
        let inverse = RealFftPlanner::new().plan_fft_inverse(period);
        Self {
            variant,
            spectrum: PowerSpectrum::new(variant, rows, columns),
            mtf: vec![0.0; variant.frequencies(columns)],
            half: vec![Complex64::default(); period / 2 + 1],
            row: vec![0.0; period],
            scratch: vec![Complex64::default(); inverse.get_scratch_len()],
            inverse,
        }
    }

    /// Numbers in the PSF of a picture with so many columns.
    pub fn length(columns: usize) -> usize {
        columns / 2 + 1
    }

    /// The zero-phase PSF of `picture`, a blurred picture of the scene of `prototype`, at the lags of 0 to half the
    /// columns of the picture in pixels. It is even in the lag and its sum over all lags of both signs is 1.
    ///
    /// # Errors
    /// [`Error::PictureSize`] when the picture or the prototype is of another size, [`Error::OtherVariant`] when the
    /// prototype was made with another transform, [`Error::Picture`] when the picture is too small, constant or not
    /// finite.
    pub fn extract(&mut self, picture: ArrayView2<'_, f32>, prototype: &Prototype) -> Result<&[f64]> {
        let (rows, columns) = self.spectrum.dim();
        if prototype.dim() != (rows, columns) {
            let (height, width) = prototype.dim();
            return Err(Error::PictureSize { width, height, expected_width: columns, expected_height: rows });
        }
        if prototype.variant() != self.variant {
            return Err(Error::OtherVariant { found: prototype.variant(), expected: self.variant });
        }
        let (powers, noise) = self.spectrum.of(picture)?;
        self.mtf.fill(0.0);
        for (powers, weights) in powers.rows().into_iter().zip(prototype.weights().rows()) {
            for ((sum, &power), &weight) in self.mtf.iter_mut().zip(powers).zip(weights) {
                let signal = (power - noise).max(LEAST_NOISE_SHARE * noise);
                *sum += f64::from(weight * 0.5 * signal.ln());
            }
        }
        for (value, (weights, logs)) in self.mtf.iter_mut().zip(prototype.sums()) {
            // One bin's worth of prior belief in |H| = 0 where the backgrounds carry no signal.
            *value = if weights > 0.0 { ((*value - logs) / weights).exp() * weights / (weights + 1.0) } else { 0.0 };
        }
        let gain = self.mtf.first().copied().unwrap_or(0.0);
        if !(gain.is_finite() && gain > 0.0) {
            return Err(Error::NoCommonSignal);
        }
        self.half.fill(Complex64::default());
        for (bin, value) in self.half.iter_mut().zip(&mut self.mtf) {
            *value /= gain;
            bin.re = *value;
        }
        let done = self.inverse.process_with_scratch(&mut self.half, &mut self.row, &mut self.scratch);
        debug_assert!(done.is_ok());
        let psf = &mut self.row[..Self::length(columns)];
        let period = self.variant.period_px(columns) as f64;
        for value in psf.iter_mut() {
            *value /= period;
        }
        Ok(psf)
    }

    /// The modulus of the transfer function behind the last PSF, 1 at its first frequency 0. The step in frequency is
    /// `1 / columns` cycles per pixel for [`Variant::Dft`] and half of that for [`Variant::Dct`].
    pub fn mtf(&self) -> &[f64] {
        &self.mtf
    }
}

impl fmt::Debug for HomomorphicPsf {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("HomomorphicPsf")
            .field("variant", &self.variant)
            .field("dim", &self.spectrum.dim())
            .finish_non_exhaustive()
    }
}
