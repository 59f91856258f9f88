//! Terms that earn their place.

use linfa::traits::Fit;
use metrology::f_tail;
use nalgebra::{DMatrix, DVector};
use ndarray::{ArrayView1, ArrayView2};

use super::{Linear, PivotedQr, Samples, Term, Terms, design, targets};
use crate::regression::samples;
use crate::{Error, Result};

/// A term enters below this probability of its F.
const ENTER: f64 = 0.05;
/// A term leaves above this probability of its F.
const LEAVE: f64 = 0.10;
/// A candidate of which less than this share of its length is left beside the model says nothing new.
const NEW: f64 = 1e-10;
/// Steps for each observation after which the search has gone astray; so many terms as observations fit into a model, and
/// few enter twice.
const STEPS: usize = 10;

/// Settings of stepwise regression, as MATLAB's `stepwiselm` from the linear model up to all interactions: the term of
/// least p-value enters while that is below 0.05; when none is, the one of largest p-value leaves if that is above 0.10.
/// An interaction is in the model only beside both of its columns. Where a model leaves no degree of freedom, or nothing
/// of the targets, nothing more can be tested, and it is the answer.
///
/// *Reference*: Draper & Smith, *Applied Regression Analysis*, 3rd ed. 1998, chapter 15.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Stepwise;

impl<'a> Fit<ArrayView2<'a, f64>, ArrayView1<'a, f64>, Error> for Stepwise {
    type Object = Linear;

    fn fit(&self, samples: &Samples<'a>) -> Result<Linear> {
        samples::check(samples)?;
        let inputs = samples.records().view();
        let all = Terms::Interactions.of(inputs.ncols());
        let mut search = Search::start(inputs, targets(samples), all);
        for _ in 0..STEPS * inputs.nrows() {
            if let Some(term) = search.best_to_enter() {
                search.enter(term);
            } else if let Some(term) = search.worst_to_leave() {
                search.leave(term);
            } else {
                return Ok(search.fitted(inputs.ncols()));
            }
        }
        Err(Error::Convergence { what: "the stepwise search", rows: inputs.nrows(), columns: inputs.ncols() })
    }
}

struct Search {
    all: Vec<Term>,
    /// Every term, one a column.
    x: DMatrix<f64>,
    y: DVector<f64>,
    /// Indices of the terms in the model, ascending.
    model: Vec<usize>,
    /// What the model leaves of every term.
    left: DMatrix<f64>,
    /// What the model leaves of the targets.
    residuals: DVector<f64>,
    /// Observations less terms of the model.
    dof: usize,
}

impl Search {
    /// From the columns that are not combinations of each other.
    fn start(inputs: ArrayView2<'_, f64>, y: DVector<f64>, all: Vec<Term>) -> Self {
        let x = design(inputs, &all);
        let linear = PivotedQr::of(x.columns(0, inputs.ncols() + 1).into_owned());
        let mut model = linear.independent().to_vec();
        model.sort_unstable();
        let mut search = Self { left: x.clone(), residuals: y.clone(), dof: 0, all, x, y, model };
        search.project();
        search
    }

    fn factors(&self) -> PivotedQr {
        PivotedQr::of(self.x.select_columns(&self.model))
    }

    /// Takes the model out of every term and the targets.
    fn project(&mut self) {
        let basis = self.factors().basis();
        self.left = self.x.clone();
        self.residuals = self.y.clone();
        // Twice, so that rounding leaves nothing of the model behind.
        for _ in 0..2 {
            self.left -= &basis * basis.tr_mul(&self.left);
            self.residuals -= &basis * basis.tr_mul(&self.residuals);
        }
        self.dof = self.y.len() - basis.ncols();
    }

    /// Whether what the model leaves is nothing but rounding, of which no test can tell anything.
    fn is_exact(&self) -> bool {
        self.residuals.norm() <= self.y.len() as f64 * f64::EPSILON * self.y.norm()
    }

    fn contains(&self, term: usize) -> bool {
        self.model.binary_search(&term).is_ok()
    }

    /// The candidate of least p-value, if that is small enough.
    fn best_to_enter(&self) -> Option<usize> {
        if self.dof < 2 || self.is_exact() {
            return None;
        }
        // All candidates have the same degrees of freedom: the least p-value is that of the largest share explained.
        let mut best: Option<(usize, f64)> = None;
        for (term, columns) in self.all.iter().enumerate() {
            // The column c is term c + 1.
            let allowed = columns.len() < 2 || columns.iter().all(|column| self.contains(column + 1));
            let left = self.left.column(term);
            let norm = left.norm_squared();
            if self.contains(term) || !allowed || norm <= NEW * NEW * self.x.column(term).norm_squared() {
                continue;
            }
            let explained = left.dot(&self.residuals).powi(2) / norm;
            if best.is_none_or(|(_, most)| explained > most) {
                best = Some((term, explained));
            }
        }
        best.filter(|&(_, explained)| {
            let remaining = (self.residuals.norm_squared() - explained).max(0.0);
            let dof = (self.dof - 1) as f64;
            f_tail(explained / (remaining / dof), 1, dof) < ENTER
        })
        .map(|(term, _)| term)
    }

    fn enter(&mut self, term: usize) {
        let direction = self.left.column(term).normalize();
        let shares = self.left.tr_mul(&direction);
        self.left.ger(-1.0, &direction, &shares, 1.0);
        let share = direction.dot(&self.residuals);
        self.residuals.axpy(-share, &direction, 1.0);
        self.dof -= 1;
        let at = self.model.partition_point(|&other| other < term);
        self.model.insert(at, term);
    }

    /// The term of largest p-value, if that is large enough; never the constant nor a column of an interaction.
    fn worst_to_leave(&self) -> Option<usize> {
        if self.dof < 1 || self.is_exact() {
            return None;
        }
        let factors = self.factors();
        let coefficients = factors.solve(&self.y);
        let variances = factors.inverse_gram_diagonal();
        let residual_variance = self.residuals.norm_squared() / self.dof as f64;
        let needed = |term: usize| match self.all[term].as_slice() {
            [] => true,
            [column] => self.model.iter().any(|&other| self.all[other].len() == 2 && self.all[other].contains(column)),
            _ => false,
        };
        self.model
            .iter()
            .enumerate()
            .filter(|&(_, &term)| !needed(term))
            .map(|(at, &term)| (term, coefficients[at].powi(2) / (residual_variance * variances[at])))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .filter(|&(_, f)| f_tail(f, 1, self.dof as f64) > LEAVE)
            .map(|(term, _)| term)
    }

    fn leave(&mut self, term: usize) {
        self.model.retain(|&other| other != term);
        self.project();
    }

    fn fitted(&self, columns: usize) -> Linear {
        let terms: Vec<Term> = self.model.iter().map(|&term| self.all[term].clone()).collect();
        Linear::of(columns, &terms, &self.factors().solve(&self.y))
    }
}
