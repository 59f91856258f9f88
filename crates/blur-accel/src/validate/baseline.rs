//! What the blur length alone says about the acceleration.

use linfa::traits::Fit;
use ndarray::{ArrayView1, ArrayView2, Axis};

use super::cross::validate;
use super::{Folds, Validation};
use crate::Result;
use crate::pipeline::Pipeline;
use crate::reduce::Components;
use crate::regression::linear::{LeastSquares, Terms};
use crate::regression::{Fitted, Samples};

/// Cross-validates the null baseline: a parabola of the blur length by least squares. `lengths_px` holds the length of
/// each picture and `targets` its acceleration.
///
/// On a rig that releases its carriage at rest and always takes the picture at the same place, `v² = 2 a d`: the blur
/// grows with the root of the acceleration, so acceleration is a parabola of blur length whatever the rest of the picture
/// says. A model that does not beat this has learnt lengths, not accelerations.
///
/// # Errors
/// Those of [`cross_validate`](super::cross_validate).
pub fn length_alone(
    lengths_px: ArrayView1<'_, f64>,
    targets: ArrayView1<'_, f64>,
    folds: &Folds,
) -> Result<Validation> {
    validate(lengths_px.insert_axis(Axis(1)), targets, folds, fit)
}

/// The one component of one column is the column; on its standard scale the squares are well conditioned.
fn fit(lengths: ArrayView2<'_, f64>, targets: ArrayView1<'_, f64>) -> Result<Pipeline> {
    Pipeline::fit_with(lengths, Components::Count(1), |lengths| {
        LeastSquares { terms: Terms::Squares }.fit(&Samples::new(lengths.view(), targets.view())).map(Fitted::Linear)
    })
}
