//! Many trees on resampled observations.

use blur_sim::rng::Rng;
use linfa::traits::{Fit, PredictInplace};
use ndarray::{Array1, ArrayBase, ArrayView1, ArrayView2, Data, Ix2};
use serde::{Deserialize, Serialize};

use super::{Cart, Tree};
use crate::regression::samples::{self, Samples};
use crate::{Error, Result, check_size};

/// Settings of bagged trees: each tree sees as many observations as there are, drawn with replacement, and the
/// prediction is the mean of the trees. Every split considers all columns.
///
/// *Reference*: Breiman, Machine Learning 24 (1996) 123.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bagging {
    /// Number of trees, at least 1.
    pub trees: usize,
    /// Settings of each.
    pub tree: Cart,
    /// Draws the observations.
    pub seed: u64,
}

/// Trees whose mean is the prediction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Bagged {
    trees: Vec<Tree>,
}

impl Bagging {
    /// The observations of each tree.
    fn draws(&self, observations: usize) -> Vec<Vec<usize>> {
        (0..self.trees)
            .map(|tree| {
                let mut rng = Rng::new(self.seed, tree as u64);
                // The product stays below the count: the largest uniform number is 1 - 2⁻⁵³.
                (0..observations).map(|_| (rng.uniform() * observations as f64) as usize).collect()
            })
            .collect()
    }

    /// Fits one tree to each of the `draws`, lists of rows that may repeat, in place of those drawn with the seed.
    ///
    /// # Errors
    /// For samples that no regression can be fitted to, no draws, an empty draw, and rows that do not exist.
    pub fn fit_draws(&self, samples: &Samples<'_>, draws: &[Vec<usize>]) -> Result<Bagged> {
        self.tree.check()?;
        samples::check(samples)?;
        let inputs = samples.records().view();
        if draws.is_empty() || draws.iter().any(Vec::is_empty) {
            return Err(Error::TooFew { found: 0, needed: 1, purpose: "in every one of at least one draw" });
        }
        if let Some(&row) = draws.iter().flatten().find(|&&row| row >= inputs.nrows()) {
            return Err(Error::Size { what: "row of a draw", found: row, expected: inputs.nrows() - 1 });
        }
        let targets = samples.targets().view();
        Ok(Bagged { trees: draws.iter().map(|rows| self.tree.grow(inputs, targets, rows.clone())).collect() })
    }
}

impl Bagged {
    /// Whether its parts belong together, which they may not when it was read from a file.
    pub(in crate::regression) fn check(&self) -> Result<()> {
        if self.trees.is_empty() {
            return Err(Error::TooFew { found: 0, needed: 1, purpose: "as bagged trees" });
        }
        for tree in &self.trees {
            check_size("columns of a bagged tree", tree.columns(), self.columns())?;
            tree.check()?;
        }
        Ok(())
    }

    /// Columns of an observation.
    pub fn columns(&self) -> usize {
        self.trees.first().map_or(0, Tree::columns)
    }
}

impl<'a> Fit<ArrayView2<'a, f64>, ArrayView1<'a, f64>, Error> for Bagging {
    type Object = Bagged;

    fn fit(&self, samples: &Samples<'a>) -> Result<Bagged> {
        self.fit_draws(samples, &self.draws(samples.records().nrows()))
    }
}

impl<D: Data<Elem = f64>> PredictInplace<ArrayBase<D, Ix2>, Array1<f64>> for Bagged {
    fn predict_inplace(&self, inputs: &ArrayBase<D, Ix2>, out: &mut Array1<f64>) {
        for (row, to) in inputs.rows().into_iter().zip(out) {
            *to = self.trees.iter().map(|tree| tree.predict_row(row)).sum::<f64>() / self.trees.len() as f64;
        }
    }

    fn default_target(&self, inputs: &ArrayBase<D, Ix2>) -> Array1<f64> {
        Array1::zeros(inputs.nrows())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_are_uniform_with_replacement_and_repeat_with_the_seed() {
        let bagging = |seed| Bagging { trees: 400, tree: Cart { least_leaf: 8 }, seed };
        let draws = bagging(7).draws(100);
        assert_eq!(draws, bagging(7).draws(100));
        assert_ne!(draws, bagging(8).draws(100));
        let mut counts = vec![0_u32; 100];
        draws.iter().flatten().for_each(|&row| counts[row] += 1);
        // Each count is binomial with mean 400 and standard deviation 19.9.
        assert!(counts.iter().all(|&count| (300..500).contains(&count)), "{counts:?}");
        // A draw misses a row with probability 0.99^100; the mean share over 400 draws has a standard deviation of 0.0016.
        let missed: usize = draws.iter().map(|draw| (0..100).filter(|row| !draw.contains(row)).count()).sum();
        assert!((missed as f64 / 40_000.0 - 0.99_f64.powi(100)).abs() < 0.008, "{missed}");
    }
}
