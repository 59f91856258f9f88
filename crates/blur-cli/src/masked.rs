//! Measurements of the part of a picture that a mask marks.

use std::path::Path;

use blur_core::estimate::joint::Whittle;
use blur_core::estimate::{MotionBlur, Settings};
use blur_core::region::Mask;
use ndarray::ArrayView2;

use crate::Result;
use crate::picture::{self, Linearize};

/// White in a mask.
const WHITE: f32 = 255.0;

/// The estimator of the parts that one mask marks; the mask is read with the first picture.
pub(crate) struct Masked<'a> {
    path: &'a Path,
    mask: Option<Mask>,
    estimator: Whittle,
}

impl<'a> Masked<'a> {
    pub(crate) fn new(path: &'a Path, settings: &Settings) -> Self {
        Self { path, mask: None, estimator: Whittle::new(settings) }
    }

    /// The mask, once a picture has been measured.
    pub(crate) fn mask(&self) -> Option<&Mask> {
        self.mask.as_ref()
    }

    /// Direction and length of the blur where the mask is white.
    pub(crate) fn estimate(&mut self, image: ArrayView2<'_, f32>) -> Result<MotionBlur> {
        let mask = match self.mask.take() {
            Some(mask) => mask,
            None => read(self.path).map_err(|error| error.in_file(self.path))?,
        };
        let mask = self.mask.insert(mask);
        Ok(self.estimator.estimate_weighted(image, mask.weights())?)
    }
}

/// The mask in a picture file: white is measured, grey counts in part.
fn read(path: &Path) -> Result<Mask> {
    let grey = picture::read(path, Linearize::Off)?.luma;
    // Float pictures keep their scale, and NaN.
    if let Some(((row, column), &value)) = grey.indexed_iter().find(|(_, value)| !(0.0..=WHITE).contains(*value)) {
        return Err(blur_core::Error::Weight { row, column, value }.into());
    }
    Ok(Mask::new(grey.mapv(|value| (value / WHITE).min(1.0)).view())?)
}
