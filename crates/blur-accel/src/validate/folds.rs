//! Which observations are left out together.

use std::collections::BTreeMap;

use blur_sim::rng::Rng;

use crate::{Error, Result};

/// A partition of observations: each fold is predicted by what is learnt from all others.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Folds {
    /// Observations of each fold, ascending.
    tests: Vec<Vec<usize>>,
    observations: usize,
}

impl Folds {
    /// So many folds of observations drawn at random; their sizes differ by at most one.
    ///
    /// # Errors
    /// [`Error::Parameter`] for less than two folds and [`Error::TooFew`] for less observations than folds or than
    /// three, of which two are left to learn from.
    pub fn random(observations: usize, folds: usize, seed: u64) -> Result<Self> {
        check(observations, folds)?;
        let mut order: Vec<usize> = (0..observations).collect();
        shuffle(&mut order, seed);
        Ok(Self::of((0..folds).map(|fold| order.iter().copied().skip(fold).step_by(folds).collect()).collect()))
    }

    /// So many folds of whole groups, as of all pictures of one poster, drawn at random: the next group goes to the
    /// smallest fold, the largest groups first. With as many folds as groups each group is left out alone.
    ///
    /// # Errors
    /// Those of [`Folds::random`], and [`Error::TooFew`] for less groups than folds.
    pub fn grouped<G: Ord>(groups: &[G], folds: usize, seed: u64) -> Result<Self> {
        check(groups.len(), folds)?;
        let mut members: BTreeMap<&G, Vec<usize>> = BTreeMap::new();
        for (observation, group) in groups.iter().enumerate() {
            members.entry(group).or_default().push(observation);
        }
        if members.len() < folds {
            return Err(Error::TooFew { found: members.len(), needed: folds, purpose: "as groups, one for each fold" });
        }
        let mut members: Vec<Vec<usize>> = members.into_values().collect();
        shuffle(&mut members, seed);
        members.sort_by_key(|group| std::cmp::Reverse(group.len()));
        let mut tests: Vec<Vec<usize>> = vec![Vec::new(); folds];
        for group in members {
            if let Some(smallest) = tests.iter_mut().min_by_key(|test| test.len()) {
                smallest.extend(group);
            }
        }
        Ok(Self::of(tests))
    }

    fn of(mut tests: Vec<Vec<usize>>) -> Self {
        for test in &mut tests {
            test.sort_unstable();
        }
        let observations = tests.iter().map(Vec::len).sum();
        Self { tests, observations }
    }

    /// Number of folds.
    pub fn count(&self) -> usize {
        self.tests.len()
    }

    /// Observations in all folds.
    pub fn observations(&self) -> usize {
        self.observations
    }

    /// What each fold leaves out, in ascending order.
    pub fn tests(&self) -> impl Iterator<Item = &[usize]> {
        self.tests.iter().map(Vec::as_slice)
    }

    /// What each fold learns from, and what it leaves out, both in ascending order.
    pub fn splits(&self) -> impl Iterator<Item = (Vec<usize>, &[usize])> {
        self.tests().map(|test| {
            ((0..self.observations).filter(|observation| test.binary_search(observation).is_err()).collect(), test)
        })
    }
}

fn check(observations: usize, folds: usize) -> Result<()> {
    if folds < 2 {
        return Err(Error::Parameter { name: "folds", value: folds as f64, expected: "at least 2" });
    }
    if observations < folds.max(3) {
        return Err(Error::TooFew { found: observations, needed: folds.max(3), purpose: "for the folds" });
    }
    Ok(())
}

/// Every order is equally likely (Fisher & Yates).
fn shuffle<T>(items: &mut [T], seed: u64) {
    let mut rng = Rng::new(seed, 0);
    for last in (1..items.len()).rev() {
        items.swap(last, (rng.uniform() * (last + 1) as f64) as usize);
    }
}
