//! How the numbers that a model works on are made from pictures.

use ndarray::ArrayView2;
use serde::{Deserialize, Serialize};

use crate::Result;
use crate::homomorphic::{HomomorphicPsf, Prototype, Variant};

/// Settings of the homomorphic PSF.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Features {
    /// The transform.
    pub variant: Variant,
    /// Rows of the pictures.
    pub height_px: usize,
    /// Columns of the pictures.
    pub width_px: usize,
}

impl Features {
    /// Numbers for each picture.
    pub fn length(&self) -> usize {
        HomomorphicPsf::length(self.width_px)
    }

    /// What makes them.
    pub fn extractor(&self) -> HomomorphicPsf {
        HomomorphicPsf::new(self.variant, self.height_px, self.width_px)
    }

    /// A scene from its backgrounds.
    ///
    /// # Errors
    /// Those of [`Prototype::new`].
    pub fn prototype(&self, backgrounds: &[ArrayView2<'_, f32>]) -> Result<Prototype> {
        Prototype::new(self.variant, backgrounds)
    }
}
