//! From a blurred picture to its path: start, fit, noise, covariance.

use ndarray::{Array2, ArrayView2};
use rustfft::num_complex::Complex32;

use super::fit::{Fit, PLAIN, fit};
use super::kernel::Kernel;
use super::model::{BLURRED, GAINS, Model, Noise, ROUGH, Unknown};
use super::normal::{Matrix, sandwich};
use super::path::Path;
use super::residual::Residual;
use super::scene::{ALL, Scene};
use crate::estimate::LengthRange;

/// Low pass of the first fit in cycles per pixel, for a start that is one pixel off; each further one reaches higher by
/// the factor. At low frequencies a start that is pixels away leads to the right minimum.
const FIRST_BAND: f64 = 0.12;
const WIDER: f64 = 3.3;
/// Highest frequency of a picture along an axis.
const NYQUIST: f64 = 0.5;
/// Pixels that the picture may be displaced, beyond its path.
const OFFSET_PX: usize = 48;
/// With more contrast unexplained the start is in doubt, and others are tried.
const SUSPICIOUS: f64 = 0.01;
/// The bright part of a kernel may be but the slow part of a path: the other starts are longer by these factors and go
/// on beyond its end or, with the opposite ratio, before its begin.
const STRETCHED: [(f64, f64); 4] = [(2.0, 0.7), (2.0, -0.7), (4.0, 0.8), (4.0, -0.8)];

/// What a fit found.
#[derive(Debug, Clone, Copy)]
pub(super) struct Outcome {
    pub(super) path: Path,
    /// Covariance of the path's middle (right, down), length, angle and ratio, in this order, then of the illumination.
    pub(super) covariance: Matrix,
    /// Share of the picture's contrast that neither the blurred still nor noise explains.
    pub(super) unexplained: f64,
}

/// Plans and buffers for blurred pictures of one scene.
#[derive(Debug)]
pub(super) struct Measurement {
    range: LengthRange,
    kernel: Kernel,
    model: Model,
    /// Spectrum of the still under its Wiener filter, and the filter.
    still: Array2<Complex32>,
    trust: Array2<f32>,
}

impl Measurement {
    /// `optical_centre` is where the vignetting has its centre, in pixels to the right and down.
    pub(super) fn new(scene: &Scene, range: LengthRange, optical_centre: [f64; 2]) -> Self {
        let mut kernel = Kernel::new(scene.grid, range.max_px() as usize + OFFSET_PX);
        kernel.set_still(scene.mean.view());
        Self {
            range,
            kernel,
            model: Model::new(scene.grid, range.max_px(), optical_centre),
            still: Array2::zeros(scene.grid.spectrum()),
            trust: Array2::zeros(scene.grid.spectrum()),
        }
    }

    /// The path of `picture` relative to the stills; `None` when nothing can be fitted.
    pub(super) fn measure(&mut self, scene: &Scene, picture: ArrayView2<'_, f32>) -> Option<Outcome> {
        self.kernel.set(picture);
        let mut start = self.kernel.segment();
        start.length = start.length.min(self.range.max_px());
        let mut best = self.follow(scene, picture, start);
        if best.is_none_or(|best| best.unexplained > SUSPICIOUS) {
            for (factor, ratio) in STRETCHED {
                let stretched = start.stretched(factor, ratio, self.range.max_px());
                if let Some(found) = self.follow(scene, picture, stretched)
                    && best.is_none_or(|best| found.unexplained < best.unexplained)
                {
                    best = Some(found);
                }
            }
        }
        best
    }

    /// The path that least squares find from `path`.
    fn follow(&mut self, scene: &Scene, picture: ArrayView2<'_, f32>, mut path: Path) -> Option<Outcome> {
        let mut gain = PLAIN;
        let mut noise = Noise { picture: 1.0, still: 0.0 };
        let mut band = FIRST_BAND / self.kernel.cell_px();
        self.filter(scene, scene.variance.unwrap_or(0.0));
        while band < NYQUIST {
            let found = self.fit(picture, ROUGH, (path, gain), noise, band)?;
            (path, gain) = (found.path, found.gain);
            band *= WIDER;
        }
        let found = self.fit(picture, BLURRED, (path, gain), noise, ALL)?;
        noise.picture *= Residual::new(&self.model, BLURRED, &found, noise).own;
        // A single still has the noise of the picture, as far as anybody knows.
        let square_gain = found.gain[0] * found.gain[0];
        let of_still = scene.variance.unwrap_or(noise.picture / square_gain);
        noise.still = of_still * square_gain;
        self.filter(scene, of_still);

        let found = self.fit(picture, BLURRED, (found.path, found.gain), noise, ALL)?;
        let residual = Residual::new(&self.model, BLURRED, &found, noise);
        let inverse = found.normal.inverse()?;
        let variance = self.model.score_variance(BLURRED.len());
        let mut covariance = sandwich(&inverse, &variance, BLURRED.len());
        for value in covariance.iter_mut().flatten() {
            *value *= residual.mean;
        }
        Some(Outcome { path: found.path, covariance, unexplained: residual.unexplained })
    }

    fn fit(
        &mut self,
        picture: ArrayView2<'_, f32>,
        unknowns: &[Unknown],
        start: (Path, [f64; GAINS]),
        noise: Noise,
        band: f64,
    ) -> Option<Fit> {
        self.model.set_data(picture, &start.0, noise, &self.trust, band);
        fit(&mut self.model, &self.still, unknowns, start, self.range.max_px())
    }

    /// Puts the still under its Wiener filter for noise of `variance`. What the filtered still then lacks of the scene does
    /// not correlate with it (Berkson's error), so noise in the still adds to the residual and moves nothing.
    fn filter(&mut self, scene: &Scene, variance: f64) {
        let (rows, columns) = scene.grid.padded;
        let level = (variance * (rows * columns) as f64) as f32;
        for ((trust, still), (power, spectrum)) in
            self.trust.iter_mut().zip(&mut self.still).zip(scene.power.iter().zip(&scene.spectrum))
        {
            *trust = if *power > level { 1.0 - level / power } else { 0.0 };
            *still = spectrum * *trust;
        }
    }
}
