//! Least squares as one system for residuals and coefficients, refined.

use nalgebra::{DMatrix, DVector};

use super::design::Design;
use super::double_double::DoubleDouble;
use super::householder::{PivotedQr, pivoted_qr};
use crate::Error;

/// A correction gains the digits that the condition of the matrix leaves of sixteen; Filip's leaves six.
const MOST_STEPS: usize = 12;
/// Corrections below this share of the solution end the refinement: a few bits more than a double holds.
const ENOUGH: f64 = 1e-19;

/// Solves `[I A; A' 0] [r; b] = [f; g]` for a design matrix A of full column rank.
///
/// With g = 0 it is the least-squares problem `A b = f` with residuals r; with f = 0 and g = -e it gives the column
/// `(A'A)^-1 e`. Residuals of the whole system are accumulated in double-double, which makes the corrections right in r
/// and b at once: refining b alone stalls when r is large.
///
/// # Reference
///
/// Å. Björck, "Iterative refinement of linear least squares solutions I", BIT 7 (1967) 257-278, eq. 2.3 and section 3.
#[derive(Debug)]
pub(super) struct Augmented<'a> {
    design: &'a Design,
    qr: PivotedQr,
}

impl<'a> Augmented<'a> {
    pub(super) fn new(design: &'a Design) -> Result<Self, Error> {
        let qr = pivoted_qr(&design.high);
        match qr.order[qr.rank..].iter().max() {
            Some(&column) => Err(Error::RankDeficient { column }),
            None => Ok(Self { design, qr }),
        }
    }

    /// The least-squares solution of `A b = y`: its residuals and coefficients.
    pub(super) fn fit(&self, y: &[DoubleDouble]) -> (Vec<DoubleDouble>, DVector<f64>) {
        let (r, b) = self.refined(y, &DVector::zeros(self.design.columns()));
        (r, DVector::from_iterator(b.len(), b.iter().map(|b| b.rounded())))
    }

    /// `(A'A)^-1`, each column refined.
    pub(super) fn inverse_gram(&self) -> DMatrix<f64> {
        let (n, p) = (self.design.rows(), self.design.columns());
        let mut inverse = DMatrix::zeros(p, p);
        for column in 0..p {
            let mut g = DVector::zeros(p);
            g[column] = -1.0;
            let (_, b) = self.refined(&vec![DoubleDouble::default(); n], &g);
            inverse.set_column(column, &DVector::from_iterator(p, b.iter().map(|b| b.rounded())));
        }
        inverse
    }

    /// The matrix that makes coefficients of the right-hand side: `S P R^-1 Q'`.
    pub(super) fn gain(&self) -> DMatrix<f64> {
        let PivotedQr { q, r, order, scales, .. } = &self.qr;
        let solved = r.solve_upper_triangular(&q.transpose()).unwrap_or_default();
        let mut gain = DMatrix::zeros(q.ncols(), q.nrows());
        for (place, &column) in order.iter().enumerate() {
            gain.set_row(column, &(solved.row(place) * scales[column]));
        }
        gain
    }

    fn refined(&self, f: &[DoubleDouble], g: &DVector<f64>) -> (Vec<DoubleDouble>, Vec<DoubleDouble>) {
        let (n, p) = (self.design.rows(), self.design.columns());
        let mut r = vec![DoubleDouble::default(); n];
        let mut b = vec![DoubleDouble::default(); p];
        let mut f_rest = DVector::from_iterator(n, f.iter().map(|f| f.rounded()));
        let mut g_rest = g.clone();
        let mut last = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let (dr, db) = self.solve(&f_rest, &g_rest);
            r.iter_mut().zip(&dr).for_each(|(r, &dr)| *r += dr.into());
            b.iter_mut().zip(&db).for_each(|(b, &db)| *b += db.into());
            // Lengths in the scaled coordinates, where columns weigh alike.
            let length = |b: &dyn Fn(usize) -> f64| (0..p).map(|j| (b(j) / self.qr.scales[j]).powi(2)).sum::<f64>();
            let change = (length(&|j| db[j]) / length(&|j| b[j].high)).sqrt();
            // The next correction is about as much smaller as this one was; NaN, of a solution of 0, ends too.
            if change.is_nan() || change >= last || change * (change / last.min(1.0)) < ENOUGH {
                break;
            }
            last = change;
            (f_rest, g_rest) = self.rest(f, g, &r, &b);
        }
        (r, b)
    }

    /// What the solution leaves of both right-hand sides: `f - r - A b` and `g - A' r`.
    fn rest(
        &self,
        f: &[DoubleDouble],
        g: &DVector<f64>,
        r: &[DoubleDouble],
        b: &[DoubleDouble],
    ) -> (DVector<f64>, DVector<f64>) {
        let (n, p) = (self.design.rows(), self.design.columns());
        let f_rest = DVector::from_fn(n, |row, _| {
            (0..p).fold(f[row] - r[row], |sum, column| sum - self.design.get(row, column) * b[column]).rounded()
        });
        let g_rest = DVector::from_fn(p, |column, _| {
            let start = DoubleDouble::from(g[column]);
            (0..n).fold(start, |sum, row| sum - self.design.get(row, column) * r[row]).rounded()
        });
        (f_rest, g_rest)
    }

    /// The solution in doubles: `R' h = g`, `d = Q' f`, `r = f - Q (d - h)`, `R b = d - h`.
    fn solve(&self, f: &DVector<f64>, g: &DVector<f64>) -> (DVector<f64>, DVector<f64>) {
        let PivotedQr { q, r, order, scales, .. } = &self.qr;
        let permuted = DVector::from_iterator(order.len(), order.iter().map(|&column| g[column] * scales[column]));
        let h = r.tr_solve_upper_triangular(&permuted).unwrap_or_default();
        let explained = q.tr_mul(f) - h;
        let solved = r.solve_upper_triangular(&explained).unwrap_or_default();
        let mut b = DVector::zeros(order.len());
        for (place, &column) in order.iter().enumerate() {
            b[column] = solved[place] * scales[column];
        }
        (f - q * explained, b)
    }
}
