//! Regressions that are linear in their coefficients: ordinary, with interactions, robust and stepwise.

mod least_squares;
mod qr;
mod robust;
mod stepwise;

use linfa::traits::PredictInplace;
use nalgebra::{DMatrix, DVector};
use ndarray::{Array1, ArrayBase, ArrayView2, Data, Ix2};
use serde::{Deserialize, Serialize};

use super::Samples;
use crate::{Error, Result, check_size};
pub use least_squares::LeastSquares;
use qr::PivotedQr;
pub use robust::Robust;
pub use stepwise::Stepwise;

/// A product of columns; the empty one is the constant 1.
pub type Term = Vec<usize>;

/// Which terms a model has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Terms {
    /// The constant and every column.
    Linear,
    /// Those and the products of every two different columns.
    Interactions,
    /// The constant, every column and its square.
    Squares,
}

impl Terms {
    /// The terms of observations of so many columns.
    fn of(self, columns: usize) -> Vec<Term> {
        let mut terms = vec![vec![]];
        terms.extend((0..columns).map(|column| vec![column]));
        match self {
            Self::Linear => {}
            Self::Interactions => {
                terms.extend((0..columns).flat_map(|a| (a + 1..columns).map(move |b| vec![a, b])));
            }
            Self::Squares => terms.extend((0..columns).map(|column| vec![column, column])),
        }
        terms
    }
}

/// A sum of products of columns.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Linear {
    columns: usize,
    terms: Vec<Term>,
    coefficients: Vec<f64>,
}

impl Linear {
    /// Without the terms whose coefficient is 0.
    fn of(columns: usize, terms: &[Term], coefficients: &DVector<f64>) -> Self {
        let (terms, coefficients) = terms
            .iter()
            .zip(coefficients.iter())
            .filter(|&(_, &coefficient)| coefficient != 0.0)
            .map(|(term, &coefficient)| (term.clone(), coefficient))
            .unzip();
        Self { columns, terms, coefficients }
    }

    /// Whether its parts belong together, which they may not when it was read from a file.
    pub(super) fn check(&self) -> Result<()> {
        check_size("coefficients of a linear regression", self.coefficients.len(), self.terms.len())?;
        match self.terms.iter().flatten().find(|&&column| column >= self.columns) {
            Some(&found) => Err(Error::Size { what: "a column of a linear regression", found, expected: self.columns }),
            None => Ok(()),
        }
    }

    /// Columns of an observation.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// The terms of the model with their coefficients; those that are not listed have none.
    pub fn coefficients(&self) -> impl Iterator<Item = (&Term, f64)> {
        self.terms.iter().zip(self.coefficients.iter().copied())
    }
}

impl<D: Data<Elem = f64>> PredictInplace<ArrayBase<D, Ix2>, Array1<f64>> for Linear {
    fn predict_inplace(&self, inputs: &ArrayBase<D, Ix2>, out: &mut Array1<f64>) {
        for (row, to) in inputs.rows().into_iter().zip(out) {
            *to = self
                .coefficients()
                .map(|(term, coefficient)| coefficient * term.iter().map(|&column| row[column]).product::<f64>())
                .sum();
        }
    }

    fn default_target(&self, inputs: &ArrayBase<D, Ix2>) -> Array1<f64> {
        Array1::zeros(inputs.nrows())
    }
}

/// One term a column.
fn design(inputs: ArrayView2<'_, f64>, terms: &[Term]) -> DMatrix<f64> {
    DMatrix::from_fn(inputs.nrows(), terms.len(), |row, term| {
        terms[term].iter().map(|&column| inputs[[row, column]]).product()
    })
}

fn targets(samples: &Samples<'_>) -> DVector<f64> {
    DVector::from_iterator(samples.targets().len(), samples.targets().iter().copied())
}
