//! Principal components by one thin singular value decomposition.

use nalgebra::DMatrix;
use ndarray::{Array1, Array2, ArrayView2, Axis};
use serde::{Deserialize, Serialize};

use crate::{Error, Result, check_size};

/// How many components to keep.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Components {
    /// So many, or as many as the data have.
    Count(usize),
    /// The fewest that explain this share of the variance, above 0 and at most 1.
    Share(f64),
}

impl Default for Components {
    /// 76, as in thesis section 6.3.5.
    fn default() -> Self {
        Self::Count(76)
    }
}

/// Principal components of a set of observations.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Pca {
    mean: Array1<f64>,
    /// One component a row, each of length 1.
    axes: Array2<f64>,
    variances: Array1<f64>,
    total_variance: f64,
}

impl Pca {
    /// The components of `data`, one observation a row, the one of largest variance first. The entry of largest
    /// magnitude in each axis is positive.
    ///
    /// # Errors
    /// [`Error::TooFew`] for less than two observations, [`Error::Parameter`] for a count of 0 or a share that is no
    /// share, [`Error::NotFinite`], and [`Error::Convergence`].
    pub fn fit(data: ArrayView2<'_, f64>, components: Components) -> Result<Self> {
        let (rows, columns) = data.dim();
        if rows < 2 {
            return Err(Error::TooFew { found: rows, needed: 2, purpose: "for principal components" });
        }
        if columns == 0 {
            return Err(Error::Size { what: "numbers in an observation", found: 0, expected: 1 });
        }
        if let Some(((row, column), &value)) = data.indexed_iter().find(|(_, value)| !value.is_finite()) {
            return Err(Error::NotFinite { what: "the input", row, column, value });
        }
        match components {
            Components::Count(0) => {
                return Err(Error::Parameter { name: "components", value: 0.0, expected: "at least 1" });
            }
            Components::Share(share) if !(share > 0.0 && share <= 1.0) => {
                return Err(Error::Parameter {
                    name: "explained share",
                    value: share,
                    expected: "above 0 and at most 1",
                });
            }
            _ => {}
        }
        let mean = data.sum_axis(Axis(0)) / rows as f64;
        let centred = DMatrix::from_fn(rows, columns, |row, column| data[[row, column]] - mean[column]);
        let svd = centred.try_svd(false, true, f64::EPSILON, 0).ok_or(Error::Convergence {
            what: "the singular value decomposition",
            rows,
            columns,
        })?;
        let Some(v_t) = svd.v_t else {
            return Err(Error::Convergence { what: "the singular value decomposition", rows, columns });
        };
        let mut order: Vec<usize> = (0..svd.singular_values.len()).collect();
        order.sort_by(|&a, &b| svd.singular_values[b].total_cmp(&svd.singular_values[a]));
        let variance = |index: usize| svd.singular_values[index].powi(2) / (rows - 1) as f64;
        let total_variance: f64 = order.iter().map(|&index| variance(index)).sum();
        // Centred observations have one dimension less than there are of them; what only rounding fills is none.
        let least = f64::EPSILON * rows.max(columns) as f64 * order.first().map_or(0.0, |&i| svd.singular_values[i]);
        let rank = order.iter().filter(|&&index| svd.singular_values[index] > least).count();
        let most = rank.min(rows - 1).max(1);
        let kept = match components {
            Components::Count(count) => count.min(most),
            Components::Share(share) => {
                let mut sum = 0.0;
                let enough = |index: &usize| {
                    sum += variance(*index);
                    sum >= share * total_variance
                };
                order.iter().position(enough).map_or(most, |position| (position + 1).min(most))
            }
        };
        let mut axes = Array2::zeros((kept, columns));
        for (mut axis, &index) in axes.rows_mut().into_iter().zip(&order) {
            let row = v_t.row(index);
            let largest = row.iter().copied().fold(0.0_f64, |a, b| if b.abs() > a.abs() { b } else { a });
            axis.iter_mut().zip(row.iter()).for_each(|(to, &from)| *to = from * largest.signum());
        }
        let variances = order.iter().take(kept).map(|&index| variance(index)).collect();
        Ok(Self { mean, axes, variances, total_variance })
    }

    /// Numbers in an observation.
    pub fn columns(&self) -> usize {
        self.mean.len()
    }

    /// Components kept.
    pub fn components(&self) -> usize {
        self.axes.nrows()
    }

    /// Variance of each component, with the denominator `n - 1`.
    pub fn variances(&self) -> &Array1<f64> {
        &self.variances
    }

    /// Share of the variance of the data that each component explains.
    pub fn explained_shares(&self) -> Array1<f64> {
        if self.total_variance > 0.0 { &self.variances / self.total_variance } else { &self.variances * 0.0 }
    }

    /// Coordinates of observations, one a row.
    ///
    /// # Errors
    /// [`Error::Size`] when they have another number of numbers than those it was made from.
    pub fn apply(&self, data: ArrayView2<'_, f64>) -> Result<Array2<f64>> {
        check_size("numbers in an observation", data.ncols(), self.columns())?;
        Ok((&data - &self.mean).dot(&self.axes.t()))
    }

    /// What the components leave of observations, one a row: the observation less its projection.
    ///
    /// # Errors
    /// As [`apply`](Self::apply).
    pub fn residuals(&self, data: ArrayView2<'_, f64>) -> Result<Array2<f64>> {
        check_size("numbers in an observation", data.ncols(), self.columns())?;
        let centred = &data - &self.mean;
        let projected = centred.dot(&self.axes.t()).dot(&self.axes);
        Ok(centred - projected)
    }

    /// Whether its parts belong together, which they may not when it was read from a file.
    pub(crate) fn check(&self) -> Result<()> {
        check_size("numbers in a principal component", self.axes.ncols(), self.mean.len())?;
        check_size("variances of principal components", self.variances.len(), self.axes.nrows())?;
        match self.variances.iter().find(|variance| !(variance.is_finite() && **variance >= 0.0)) {
            Some(&value) => Err(Error::Parameter { name: "variance of a component", value, expected: "at least 0" }),
            None => Ok(()),
        }
    }
}
