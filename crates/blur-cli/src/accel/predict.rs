//! From a model, the stills of a scene and a blurred picture of it to an acceleration.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use blur_accel::homomorphic::{HomomorphicPsf, Prototype};
use blur_accel::model::{Model, Prediction};
use ndarray::ArrayView1;
use serde::Serialize;

use super::features;
use crate::input::{self, Input};
use crate::{Error, Result};

/// A model that is ready for pictures of one scene.
pub struct Predictor {
    model: Model,
    scene: Prototype,
    extractor: HomomorphicPsf,
}

impl Predictor {
    /// Makes the model ready for the scene that the `backgrounds` show: files, folders or patterns of still pictures.
    ///
    /// # Errors
    /// [`Error::InFile`] for a background that cannot be read or is of another size than the pictures of the training.
    pub fn new(model: Model, backgrounds: &[PathBuf]) -> Result<Self> {
        let mut stills = Vec::new();
        for input in input::expand(backgrounds) {
            match input {
                Input::File(path) => stills.push(path),
                Input::Failed { argument, error } => return Err(error.in_file(&argument)),
                Input::Sample => {}
            }
        }
        let scene = features::prototype(&model.features(), &stills)?;
        Ok(Self { extractor: model.features().extractor(), model, scene })
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The acceleration in a picture of the scene.
    ///
    /// # Errors
    /// Those of reading a picture; [`Error::Accel`] when it is refused, as by [`Model::predict`] when it is unlike the
    /// pictures of the training.
    pub fn predict(&mut self, picture: &Path) -> Result<Prediction> {
        let luma = features::read_luma(picture)?;
        let psf = self.extractor.extract(luma.view(), &self.scene)?;
        Ok(self.model.predict(ArrayView1::from(psf))?)
    }
}

/// Reads a model from a file.
///
/// # Errors
/// [`Error::InFile`] when it cannot be read or is no model.
pub fn read(path: &Path) -> Result<Model> {
    let model = fs::read(path).map_err(Error::Read).and_then(|text| Ok(Model::from_json(&text)?));
    model.map_err(|error| error.in_file(path))
}

#[derive(Serialize)]
struct Record<'a> {
    image: &'a str,
    method: &'a str,
    accel_m_s2: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    accel_std_m_s2: Option<f64>,
    distance: f64,
}

/// Writes a prediction as one JSON object on a line of its own; `method` is the name of the regression.
pub fn write_json(out: &mut impl Write, image: &str, method: &str, prediction: &Prediction) -> io::Result<()> {
    let &Prediction { accel_m_s2, std_m_s2: accel_std_m_s2, distance } = prediction;
    serde_json::to_writer(&mut *out, &Record { image, method, accel_m_s2, accel_std_m_s2, distance })?;
    out.write_all(b"\n")
}
