//! Trained models as files.
//!
//! A [`Model`] is a [`Pipeline`] with all that a later reader needs: how the features were made ([`Features`]), what it
//! was trained for ([`Conditions`]), how far a picture may be from those of the training ([`Domain`]) and where it comes
//! from ([`Provenance`]). It is written as JSON that carries its format, version and checksum.

mod domain;
mod features;
mod file;
mod provenance;

use ndarray::{ArrayView1, ArrayView2, Axis};
use serde::{Deserialize, Serialize};

pub use domain::{Domain, FALSE_ALARM_RATE};
pub use features::Features;
pub use file::{FORMAT, VERSION, sha256};
pub use provenance::{Conditions, CrossValidation, Provenance, Source};

use crate::pipeline::Pipeline;
use crate::validate::{Folds, Recipe, cross_validate};
use crate::{Error, Result, check_size};

/// Parts that the pictures of a training are divided in: each is held out once.
const FOLDS: usize = 5;

/// Least pictures that a model can be trained on: two in each held-out part.
pub const MIN_PICTURES: usize = 10;

/// What a model is trained on and how.
#[derive(Clone, Copy)]
pub struct Training<'a> {
    /// How the inputs were made.
    pub features: Features,
    /// PSFs of the pictures, one a row, [`Features::length`] numbers each.
    pub inputs: ArrayView2<'a, f64>,
    /// Their accelerations in m/s².
    pub targets: ArrayView1<'a, f64>,
    /// Principal components and regression.
    pub recipe: Recipe,
    /// Seed of all that is drawn.
    pub seed: u64,
    /// Where the pictures come from.
    pub source: Source<'a>,
    /// Exposure of all pictures in seconds, if known and the same.
    pub exposure_s: Option<f64>,
    /// Metres in the scene for each pixel, if known and the same.
    pub scale_m_per_px: Option<f64>,
}

/// A regression that was trained on pictures, ready to be used on others taken in the same way.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Model {
    features: Features,
    conditions: Conditions,
    provenance: Provenance,
    domain: Domain,
    pipeline: Pipeline,
}

/// The acceleration of one picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction {
    /// m/s².
    pub accel_m_s2: f64,
    /// Its standard deviation, when the regression has one.
    pub std_m_s2: Option<f64>,
    /// Distance from the pictures of the training, in units of the largest that is accepted.
    pub distance: f64,
}

impl Model {
    /// Trains a model, tries how it does on pictures that it has not seen, and learns which pictures it knows.
    ///
    /// # Errors
    /// [`Error::TooFew`] for less than [`MIN_PICTURES`], [`Error::Size`] when inputs, targets and features do not belong
    /// together, and those of [`cross_validate`], as [`Error::NotFinite`] for an acceleration that is no number.
    pub fn train(training: &Training<'_>) -> Result<Self> {
        let Training { features, inputs, targets, recipe, seed, source, .. } = *training;
        let pictures = inputs.nrows();
        if pictures < MIN_PICTURES {
            return Err(Error::TooFew { found: pictures, needed: MIN_PICTURES, purpose: "to train a model" });
        }
        check_size("numbers in the PSF of a picture", inputs.ncols(), features.length())?;
        check_size("accelerations", targets.len(), pictures)?;
        let folds = Folds::random(pictures, FOLDS, seed)?;
        let validation = cross_validate(recipe, inputs, targets, &folds, seed)?;
        let pipeline = Pipeline::fit(inputs, targets, recipe.components, recipe.preset, seed)?;
        let domain = Domain::learn(pipeline.pca(), inputs, recipe.components, &folds)?;
        let range = |start: f64, pick: fn(f64, f64) -> f64| targets.iter().copied().fold(start, pick);
        Ok(Self {
            features,
            conditions: Conditions {
                accel_min_m_s2: range(f64::INFINITY, f64::min),
                accel_max_m_s2: range(f64::NEG_INFINITY, f64::max),
                exposure_s: training.exposure_s,
                scale_m_per_px: training.scale_m_per_px,
            },
            provenance: Provenance::new(
                &recipe,
                seed,
                pictures,
                source,
                CrossValidation { folds: FOLDS, metrics: validation.metrics },
            ),
            domain,
            pipeline,
        })
    }

    /// How the PSFs of pictures are made.
    pub fn features(&self) -> Features {
        self.features
    }

    /// What it was trained for.
    pub fn conditions(&self) -> &Conditions {
        &self.conditions
    }

    /// Where it comes from.
    pub fn provenance(&self) -> &Provenance {
        &self.provenance
    }

    /// Which pictures it accepts.
    pub fn domain(&self) -> &Domain {
        &self.domain
    }

    /// The components and the regression.
    pub fn pipeline(&self) -> &Pipeline {
        &self.pipeline
    }

    /// The acceleration behind the PSF of a picture.
    ///
    /// # Errors
    /// [`Error::Size`] when the PSF has another length than those of the training, [`Error::NotFinite`], and
    /// [`Error::OutsideTraining`] when it is unlike them, see [`Domain`].
    pub fn predict(&self, psf: ArrayView1<'_, f64>) -> Result<Prediction> {
        check_size("numbers in the PSF of the picture", psf.len(), self.features.length())?;
        if let Some((column, &value)) = psf.indexed_iter().find(|(_, value)| !value.is_finite()) {
            return Err(Error::NotFinite { what: "the PSF", row: 0, column, value });
        }
        let observation = psf.insert_axis(Axis(0));
        let distance = self.domain.distance(self.pipeline.pca(), psf)?;
        // A distance that is no number is none to trust.
        if distance.is_nan() || distance > 1.0 {
            return Err(Error::OutsideTraining {
                distance,
                accel_min_m_s2: self.conditions.accel_min_m_s2,
                accel_max_m_s2: self.conditions.accel_max_m_s2,
            });
        }
        Ok(Prediction {
            accel_m_s2: self.pipeline.predict(observation)?[0],
            std_m_s2: self.pipeline.predict_std(observation)?.map(|std| std[0]),
            distance,
        })
    }

    /// Whether its parts belong together, which a file may have wrong although it is undamaged.
    fn check(&self) -> Result<()> {
        self.pipeline.check()?;
        check_size(
            "numbers in an observation of the model's components",
            self.pipeline.columns(),
            self.features.length(),
        )?;
        self.domain.check()
    }
}
