//! Ordinary least squares.

use linfa::traits::Fit;
use ndarray::{ArrayView1, ArrayView2};

use super::{Linear, PivotedQr, Samples, Terms, design, targets};
use crate::regression::samples;
use crate::{Error, Result};

/// Settings of ordinary least squares. Where the terms outnumber the observations, or are combinations of each other,
/// the answer is the basic solution, in which as many terms as the rank have a coefficient: that of MATLAB's `fitlm`, and
/// not the one of least norm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LeastSquares {
    /// The terms of the model.
    pub terms: Terms,
}

impl<'a> Fit<ArrayView2<'a, f64>, ArrayView1<'a, f64>, Error> for LeastSquares {
    type Object = Linear;

    fn fit(&self, samples: &Samples<'a>) -> Result<Linear> {
        samples::check(samples)?;
        let inputs = samples.records().view();
        let terms = self.terms.of(inputs.ncols());
        let coefficients = PivotedQr::of(design(inputs, &terms)).solve(&targets(samples));
        Ok(Linear::of(inputs.ncols(), &terms, &coefficients))
    }
}
