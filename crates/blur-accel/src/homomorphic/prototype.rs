//! The sharp scene: the mean log spectrum of its still pictures.

use ndarray::{Array2, ArrayView2};

use super::Variant;
use super::power::PowerSpectrum;
use crate::{Error, Result};

/// A bin whose signal in the backgrounds has so many times the power of their noise weighs one half.
const HALF_WEIGHT_SNR: f32 = 300.0;

/// What still pictures of a scene, the backgrounds, tell about its spectrum: the mean over them of `ln |I|` (thesis eq.
/// 6.10) and how much each bin is worth.
#[derive(Debug, Clone)]
pub struct Prototype {
    variant: Variant,
    dim: (usize, usize),
    weights: Array2<f32>,
    /// Sum of the weights over the frequencies across the motion, for each frequency along it.
    weight_sums: Vec<f64>,
    /// The same sum of weight times mean log modulus.
    weighted_logs: Vec<f64>,
}

impl Prototype {
    /// From at least one background, all of one size (at least 32 x 32 pixels, any linear scale). Several average out
    /// their noise. They need not be aligned; each may have its own brightness.
    ///
    /// # Errors
    /// [`Error::TooFew`] for none, [`Error::Background`] for one that is of another size than the first, too small,
    /// constant or not finite.
    pub fn new(variant: Variant, backgrounds: &[ArrayView2<'_, f32>]) -> Result<Self> {
        let Some(first) = backgrounds.first() else {
            return Err(Error::TooFew { found: 0, needed: 1, purpose: "as backgrounds of a scene" });
        };
        let (rows, columns) = first.dim();
        let mut spectrum = PowerSpectrum::new(variant, rows, columns);
        let mut logs = Array2::<f32>::zeros((rows, variant.frequencies(columns)));
        let mut noise = 0.0;
        let share = 1.0 / backgrounds.len() as f32;
        for (index, &background) in backgrounds.iter().enumerate() {
            let (powers, floor) = spectrum
                .of(background)
                .map_err(|source| Error::Background { number: index + 1, source: Box::new(source) })?;
            noise += floor * share;
            logs.zip_mut_with(powers, |log, &power| *log += 0.5 * share * power.max(f32::MIN_POSITIVE).ln());
        }
        let weights = logs.mapv(|log| {
            let signal = ((2.0 * log).exp() - noise).max(0.0);
            signal / (signal + HALF_WEIGHT_SNR * noise)
        });
        let mut weight_sums = vec![0.0; weights.ncols()];
        let mut weighted_logs = vec![0.0; weights.ncols()];
        for (weights, logs) in weights.rows().into_iter().zip(logs.rows()) {
            for (((sum, weighted), &weight), &log) in
                weight_sums.iter_mut().zip(&mut weighted_logs).zip(weights).zip(logs)
            {
                *sum += f64::from(weight);
                *weighted += f64::from(weight) * f64::from(log);
            }
        }
        Ok(Self { variant, dim: (rows, columns), weights, weight_sums, weighted_logs })
    }

    /// Transform that it was made with.
    pub fn variant(&self) -> Variant {
        self.variant
    }

    /// Rows and columns of the backgrounds.
    pub fn dim(&self) -> (usize, usize) {
        self.dim
    }

    pub(super) fn weights(&self) -> &Array2<f32> {
        &self.weights
    }

    /// For each frequency along the motion the sum of the weights and that of weight times mean log modulus.
    pub(super) fn sums(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.weight_sums.iter().copied().zip(self.weighted_logs.iter().copied())
    }
}
