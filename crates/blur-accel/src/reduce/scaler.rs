//! Columns of mean 0 and standard deviation 1.

use ndarray::{Array1, Array2, ArrayView2, Axis};
use serde::{Deserialize, Serialize};

use crate::{Error, Result, check_size};

/// Mean and standard deviation of each column of the data it was made from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scaler {
    mean: Array1<f64>,
    /// 1 for a column without spread, which becomes 0.
    std: Array1<f64>,
}

impl Scaler {
    /// From one observation a row; the standard deviation has the denominator `n - 1`.
    pub fn of(data: ArrayView2<'_, f64>) -> Self {
        let rows = data.nrows() as f64;
        let mean = data.sum_axis(Axis(0)) / rows.max(1.0);
        let std = data
            .columns()
            .into_iter()
            .zip(&mean)
            .map(|(column, mean)| {
                let sum: f64 = column.iter().map(|value| (value - mean) * (value - mean)).sum();
                let std = (sum / (rows - 1.0).max(1.0)).sqrt();
                if std > 0.0 { std } else { 1.0 }
            })
            .collect();
        Self { mean, std }
    }

    /// Columns that it scales.
    pub fn columns(&self) -> usize {
        self.mean.len()
    }

    /// Scaled copy of `data`, which has as many columns.
    pub(crate) fn apply(&self, data: ArrayView2<'_, f64>) -> Array2<f64> {
        (&data - &self.mean) / &self.std
    }

    /// Whether its parts belong together, which they may not when it was read from a file.
    pub(crate) fn check(&self) -> Result<()> {
        check_size("standard deviations of scores", self.std.len(), self.mean.len())?;
        match self.std.iter().find(|std| !(std.is_finite() && **std > 0.0)) {
            Some(&value) => Err(Error::Parameter { name: "standard deviation of a score", value, expected: "above 0" }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn columns_are_centred_and_scaled() {
        let data = array![[1.0, 5.0], [3.0, 5.0], [5.0, 5.0]];
        let scaled = Scaler::of(data.view()).apply(data.view());
        assert_eq!(scaled, array![[-1.0, 0.0], [0.0, 0.0], [1.0, 0.0]]);
    }
}
