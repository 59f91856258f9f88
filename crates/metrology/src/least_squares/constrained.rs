//! Least squares under linear conditions.

use nalgebra::{DMatrix, DVector};

use super::householder::pivoted_qr;
use crate::Error;

/// How far a superfluous condition may be off, as a share of its largest term.
const CONTRADICTION: f64 = 1e-9;

/// The coefficients that satisfy `M b = d`: `b = fixed d + free c` for any c.
#[derive(Debug, Clone)]
pub(super) struct Conditions {
    /// Coefficients of d.
    pub(super) fixed: DMatrix<f64>,
    /// Orthonormal columns that no condition touches.
    pub(super) free: DMatrix<f64>,
}

impl Conditions {
    /// By QR of M' (the null-space method). A condition that follows from the others must agree with them.
    ///
    /// # Reference
    ///
    /// Å. Björck, *Numerical Methods for Least Squares Problems*, SIAM 1996, section 5.1.3.
    pub(super) fn new(matrix: &DMatrix<f64>, d: &DVector<f64>) -> Result<Self, Error> {
        let (count, p) = matrix.shape();
        let pivoted = pivoted_qr(&matrix.transpose());
        let kept = &pivoted.order[..pivoted.rank];
        // With the identity beside it, the orthogonal factor is square.
        let beside = DMatrix::from_fn(p, kept.len() + p, |i, j| match kept.get(j) {
            Some(&row) => matrix[(row, i)],
            None => f64::from(u8::from(i + kept.len() == j)),
        });
        let (q, r) = beside.qr().unpack();
        let triangle = r.view((0, 0), (kept.len(), kept.len())).upper_triangle();
        let basis = q.columns(0, kept.len()).into_owned();
        // M_kept = R' Q1', so b = Q1 R'^-1 d_kept.
        let inverse = triangle.solve_upper_triangular(&DMatrix::identity(kept.len(), kept.len())).unwrap_or_default();
        let from_kept = basis * inverse.transpose();
        let mut fixed = DMatrix::zeros(p, count);
        for (place, &row) in kept.iter().enumerate() {
            fixed.set_column(row, &from_kept.column(place));
        }
        let b = &fixed * d;
        for row in 0..count {
            let terms = matrix.row(row).transpose().component_mul(&b);
            let largest = terms.amax().max(d[row].abs());
            if (terms.sum() - d[row]).abs() > CONTRADICTION * largest {
                return Err(Error::Contradiction { condition: row });
            }
        }
        Ok(Self { fixed, free: q.columns(kept.len(), p - kept.len()).into_owned() })
    }
}
