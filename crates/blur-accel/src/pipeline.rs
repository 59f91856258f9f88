//! Principal components, common scales and a regression, fitted together.

use ndarray::{Array1, Array2, ArrayView1, ArrayView2};
use serde::{Deserialize, Serialize};

use crate::reduce::{Components, Pca, Scaler};
use crate::regression::{Fitted, Preset};
use crate::{Result, check_size};

/// What is fitted to the data of one training.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Pipeline {
    pca: Pca,
    scaler: Scaler,
    regression: Fitted,
}

impl Pipeline {
    /// Fits the components to `inputs`, one observation a row, and the regression `preset` to `targets` over the
    /// standardised coordinates.
    ///
    /// # Errors
    /// Those of [`Pca::fit`] and [`Preset::fit`].
    pub fn fit(
        inputs: ArrayView2<'_, f64>,
        targets: ArrayView1<'_, f64>,
        components: Components,
        preset: &Preset,
        seed: u64,
    ) -> Result<Self> {
        Self::fit_with(inputs, components, |scores| preset.fit(scores, targets, seed))
    }

    /// As [`Pipeline::fit`], with any regression: `fit` gets the standardised coordinates, one observation a row.
    ///
    /// # Errors
    /// Those of [`Pca::fit`] and of `fit`.
    pub(crate) fn fit_with(
        inputs: ArrayView2<'_, f64>,
        components: Components,
        fit: impl FnOnce(ArrayView2<'_, f64>) -> Result<Fitted>,
    ) -> Result<Self> {
        let pca = Pca::fit(inputs, components)?;
        let scores = pca.apply(inputs)?;
        let scaler = Scaler::of(scores.view());
        let regression = fit(scaler.apply(scores.view()).view())?;
        Ok(Self { pca, scaler, regression })
    }

    /// Numbers in an observation.
    pub fn columns(&self) -> usize {
        self.pca.columns()
    }

    /// The components.
    pub fn pca(&self) -> &Pca {
        &self.pca
    }

    /// The regression.
    pub fn regression(&self) -> &Fitted {
        &self.regression
    }

    /// Predictions for observations, one a row.
    ///
    /// # Errors
    /// [`Error::Size`](crate::Error::Size) when an observation has another number of numbers than [`columns`](Self::columns).
    pub fn predict(&self, inputs: ArrayView2<'_, f64>) -> Result<Array1<f64>> {
        Ok(self.regression.predict(self.scores(inputs)?.view()))
    }

    /// Standard deviation of each prediction, where the regression has one.
    ///
    /// # Errors
    /// As [`predict`](Self::predict).
    pub fn predict_std(&self, inputs: ArrayView2<'_, f64>) -> Result<Option<Array1<f64>>> {
        Ok(self.regression.predict_std(self.scores(inputs)?.view()))
    }

    fn scores(&self, inputs: ArrayView2<'_, f64>) -> Result<Array2<f64>> {
        Ok(self.scaler.apply(self.pca.apply(inputs)?.view()))
    }

    /// Whether its parts belong together, which they may not when it was read from a file.
    pub(crate) fn check(&self) -> Result<()> {
        self.pca.check()?;
        self.scaler.check()?;
        self.regression.check()?;
        let expected = self.pca.components();
        check_size("scores that are scaled", self.scaler.columns(), expected)?;
        check_size("inputs of the regression", self.regression.columns(), expected)
    }
}
