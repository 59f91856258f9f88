//! Where a model comes from and what it is for.

use serde::{Deserialize, Serialize};

use crate::reduce::Components;
use crate::validate::{Metrics, Recipe};

/// What a model was trained for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Conditions {
    /// Least acceleration of the training in m/s².
    pub accel_min_m_s2: f64,
    /// Greatest acceleration of the training in m/s².
    pub accel_max_m_s2: f64,
    /// Exposure of all its pictures in seconds, if known and the same.
    pub exposure_s: Option<f64>,
    /// Metres in the scene for each pixel, if known and the same.
    pub scale_m_per_px: Option<f64>,
}

/// Pictures that a model was trained on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Source<'a> {
    /// Name of their folder.
    pub folder: &'a str,
    /// SHA-256 checksum of them, hexadecimal.
    pub sha256: &'a str,
}

/// Where a model comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// Version of the program that trained it.
    pub program: String,
    /// The regression.
    pub preset: String,
    /// Principal components that were asked for.
    pub components: Components,
    /// Seed of all that was drawn.
    pub seed: u64,
    /// Pictures that it was trained on.
    pub pictures: usize,
    /// Name of their folder.
    pub data: String,
    /// SHA-256 checksum of them, hexadecimal.
    pub data_sha256: String,
    /// How it did on pictures that it had not seen.
    pub validation: CrossValidation,
}

impl Provenance {
    pub(super) fn new(
        recipe: &Recipe,
        seed: u64,
        pictures: usize,
        source: Source<'_>,
        validation: CrossValidation,
    ) -> Self {
        Self {
            program: env!("CARGO_PKG_VERSION").to_owned(),
            preset: recipe.preset.name.to_owned(),
            components: recipe.components,
            seed,
            pictures,
            data: source.folder.to_owned(),
            data_sha256: source.sha256.to_owned(),
            validation,
        }
    }
}

/// Errors of predictions for pictures that were left out of the training.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CrossValidation {
    /// Parts that the pictures were divided in.
    pub folds: usize,
    /// Over all pictures, in m/s².
    pub metrics: Metrics,
}
