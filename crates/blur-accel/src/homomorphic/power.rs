//! Powers of the spectrum of a picture, and the noise in them.

use std::fmt;

use blur_core::image::{Taper, Window, check};
use blur_core::spectrum::{Dct2, Dft2, NoiseFloor, Powers};
use ndarray::{Array2, ArrayView2};

use super::Variant;
use crate::{Error, Result};

/// Makes power spectra of pictures of one size; plans and buffers are kept.
pub(super) struct PowerSpectrum {
    taper: Taper,
    transform: Transform,
    /// One row for each frequency across the motion, one column for each along it.
    powers: Array2<f32>,
    floor: NoiseFloor,
}

enum Transform {
    Dft(Dft2),
    Dct(Dct2),
}

impl PowerSpectrum {
    pub(super) fn new(variant: Variant, rows: usize, columns: usize) -> Self {
        Self {
            taper: Taper::new(Window::Hann, rows, columns),
            transform: match variant {
                Variant::Dft => Transform::Dft(Dft2::new(rows, columns)),
                Variant::Dct => Transform::Dct(Dct2::new(rows, columns)),
            },
            powers: Array2::zeros((rows, variant.frequencies(columns))),
            floor: NoiseFloor::new(),
        }
    }

    /// Rows and columns of the pictures.
    pub(super) fn dim(&self) -> (usize, usize) {
        match &self.transform {
            Transform::Dft(dft) => dft.dim(),
            Transform::Dct(dct) => dct.dim(),
        }
    }

    /// The powers of a picture, scaled to its variance, and the mean power of its noise.
    pub(super) fn of(&mut self, picture: ArrayView2<'_, f32>) -> Result<(&Array2<f32>, f32)> {
        let (rows, columns) = self.dim();
        if picture.dim() != (rows, columns) {
            let (height, width) = picture.dim();
            return Err(Error::PictureSize { width, height, expected_width: columns, expected_height: rows });
        }
        check(picture)?;
        let noise = match &mut self.transform {
            Transform::Dft(dft) => {
                self.taper.apply(picture, dft.input());
                let scale = 1.0 / (rows * columns) as f32;
                self.powers.zip_mut_with(&dft.transform(), |power, bin| *power = bin.norm_sqr() * scale);
                let radius =
                    |j: usize, k: usize| (j.min(rows - j) as f64 / rows as f64).hypot(k as f64 / columns as f64);
                self.floor.read(self.powers.dim(), Powers::OfComplex, radius, |j, k| self.powers[[j, k]])
            }
            Transform::Dct(dct) => {
                self.taper.apply(picture, dct.input());
                self.powers.zip_mut_with(&dct.transform(), |power, coefficient| *power = coefficient * coefficient);
                let radius = |m: usize, n: usize| 0.5 * (m as f64 / rows as f64).hypot(n as f64 / columns as f64);
                self.floor.read(self.powers.dim(), Powers::OfReal, radius, |m, n| self.powers[[m, n]])
            }
        };
        Ok((&self.powers, noise))
    }
}

impl fmt::Debug for PowerSpectrum {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PowerSpectrum").field("dim", &self.dim()).finish_non_exhaustive()
    }
}
