//! What a regression is fitted to.

use linfa::DatasetBase;
use ndarray::{ArrayView1, ArrayView2};

use crate::{Error, Result};

/// Observations, one a row, and the target of each. `dataset.view()` makes it from an owned [`linfa::Dataset`].
pub type Samples<'a> = DatasetBase<ArrayView2<'a, f64>, ArrayView1<'a, f64>>;

/// Fails for less than two observations, none of a column, targets that are not one for each, and numbers that are not
/// finite.
pub(super) fn check(samples: &Samples<'_>) -> Result<()> {
    let (inputs, targets) = (samples.records(), samples.targets());
    if inputs.nrows() != targets.len() {
        return Err(Error::Size { what: "targets", found: targets.len(), expected: inputs.nrows() });
    }
    if targets.len() < 2 {
        return Err(Error::TooFew { found: targets.len(), needed: 2, purpose: "for a regression" });
    }
    if inputs.ncols() == 0 {
        return Err(Error::Size { what: "columns of the inputs", found: 0, expected: 1 });
    }
    if let Some(((row, column), &value)) = inputs.indexed_iter().find(|(_, value)| !value.is_finite()) {
        return Err(Error::NotFinite { what: "the input", row, column, value });
    }
    if let Some((row, &value)) = targets.iter().enumerate().find(|(_, value)| !value.is_finite()) {
        return Err(Error::NotFinite { what: "the target", row, column: 0, value });
    }
    Ok(())
}
