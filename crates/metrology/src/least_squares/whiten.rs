//! From correlated data to independent data of unit variance, and to conditions where a variance is zero.

use nalgebra::DMatrix;

use crate::Error;

/// Two matrices that act on data of a given covariance C.
#[derive(Debug, Clone)]
pub(super) struct Whitening {
    /// W with `W C W' = I`: a row for each direction in which the data scatter.
    pub(super) white: DMatrix<f64>,
    /// D with `D C D' = 0`: a row for each direction in which they do not.
    pub(super) exact: DMatrix<f64>,
}

impl Whitening {
    /// By Cholesky factorisation of the correlation matrix with pivoting, which stops at its rank: less than `n` roundings
    /// of a variance count as none. Asymmetry beyond that, and a negative variance, are errors.
    ///
    /// # Reference
    ///
    /// N. J. Higham, *Accuracy and Stability of Numerical Algorithms*, 2nd ed., SIAM 2002, section 10.3.
    pub(super) fn of(covariance: &DMatrix<f64>) -> Result<Self, Error> {
        let n = covariance.nrows();
        let tolerance = 8.0 * n as f64 * f64::EPSILON;
        let stds: Vec<f64> = covariance.diagonal().iter().map(|variance| variance.sqrt()).collect();
        let mut rest = DMatrix::zeros(n, n);
        for i in 0..n {
            if !stds[i].is_finite() {
                return Err(Error::Covariance { row: i });
            }
            for j in 0..n {
                let (element, mirrored, scale) = (covariance[(i, j)], covariance[(j, i)], stds[i] * stds[j]);
                // Not `>`: a NaN is an error as well.
                let possible = (element - mirrored).abs() <= 1e-10 * scale && element.abs() <= (1.0 + 1e-10) * scale;
                if !possible {
                    return Err(Error::Covariance { row: i });
                }
                rest[(i, j)] = if scale > 0.0 { (element + mirrored) / (2.0 * scale) } else { 0.0 };
            }
        }
        let mut factor = DMatrix::<f64>::zeros(n, n);
        let mut order: Vec<usize> = (0..n).collect();
        let mut rank = 0;
        while rank < n {
            let largest = (rank..n).fold(rank, |best, i| {
                if rest[(order[i], order[i])] > rest[(order[best], order[best])] { i } else { best }
            });
            order.swap(rank, largest);
            let pivot = rest[(order[rank], order[rank])];
            if pivot <= tolerance {
                break;
            }
            let row = order[rank];
            let column = rest.column(row) / pivot.sqrt();
            for &i in &order[rank + 1..] {
                for &j in &order[rank + 1..] {
                    rest[(i, j)] -= column[i] * column[j];
                }
            }
            for &i in &order[rank..] {
                factor[(i, rank)] = column[i];
            }
            rank += 1;
        }
        // What remains of a covariance is zero, not just its diagonal. A root of the tolerance bounds what rounding leaves
        // off the diagonal, since |c_ij|^2 <= c_ii c_jj.
        for &i in &order[rank..] {
            if rest[(i, i)] < -tolerance || order[rank..].iter().any(|&j| rest[(i, j)].abs() > tolerance.sqrt()) {
                return Err(Error::Covariance { row: i });
            }
        }
        Ok(Self::from_factor(&factor, &order, rank, &stds))
    }

    /// With rows in `order`, the correlation matrix is `[L1; L2] [L1; L2]'`: the data of the first rows are whitened by
    /// `L1^-1`, and those of the others are `L2 L1^-1` of them without any scatter of their own.
    fn from_factor(factor: &DMatrix<f64>, order: &[usize], rank: usize, stds: &[f64]) -> Self {
        let n = order.len();
        let lower = DMatrix::from_fn(rank, rank, |i, j| factor[(order[i], j)]);
        let others = DMatrix::from_fn(n - rank, rank, |i, j| factor[(order[rank + i], j)]);
        let inverse = lower.solve_lower_triangular(&DMatrix::identity(rank, rank)).unwrap_or_default();
        let predicted = others * &inverse;
        let mut white = DMatrix::zeros(rank, n);
        let mut exact = DMatrix::zeros(n - rank, n);
        for (place, &row) in order[..rank].iter().enumerate() {
            for i in 0..rank {
                white[(i, row)] = inverse[(i, place)] / stds[row];
            }
            for i in 0..n - rank {
                // In the unit of the row that is predicted; a row without variance is predicted by none.
                exact[(i, row)] = -predicted[(i, place)] * stds[order[rank + i]] / stds[row];
            }
        }
        for (i, &row) in order[rank..].iter().enumerate() {
            exact[(i, row)] = 1.0;
        }
        Self { white, exact }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whitened_covariance_is_the_identity() {
        let l = DMatrix::from_fn(5, 5, |i, j| if j <= i { 1.0 + (i * 3 + j) as f64 } else { 0.0 });
        let c = &l * l.transpose();
        let Whitening { white, exact } = Whitening::of(&c).unwrap();
        assert_eq!(exact.nrows(), 0);
        assert!((&white * &c * white.transpose() - DMatrix::identity(5, 5)).norm() < 1e-10);
    }

    #[test]
    fn directions_without_scatter_become_conditions() {
        // Rank 2 in 4 dimensions: the first has no variance, the last is the sum of the two between.
        let l = DMatrix::from_row_slice(4, 2, &[0.0, 0.0, 1.0, 0.0, 0.5, 2.0, 1.5, 2.0]);
        let c = &l * l.transpose();
        let Whitening { white, exact } = Whitening::of(&c).unwrap();
        assert_eq!((white.nrows(), exact.nrows()), (2, 2));
        assert!((&white * &c * white.transpose() - DMatrix::identity(2, 2)).norm() < 1e-13);
        assert!((&exact * &c * exact.transpose()).norm() < 1e-13);
    }

    #[test]
    fn what_is_no_covariance_is_refused() {
        let negative = DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 1.0]);
        let skew = DMatrix::from_row_slice(2, 2, &[1.0, 0.5, 0.2, 1.0]);
        let from_nothing = DMatrix::from_row_slice(2, 2, &[0.0, 0.5, 0.5, 1.0]);
        let nan = DMatrix::from_row_slice(2, 2, &[1.0, f64::NAN, f64::NAN, 1.0]);
        for bad in [negative, skew, from_nothing, nan] {
            assert!(matches!(Whitening::of(&bad), Err(Error::Covariance { .. })), "{bad}");
        }
    }
}
