use crate::Error;
use crate::error::check;

/// What may remain of a matrix of rank below its size after the sums of squares are taken away, by rounding.
const TOLERANCE: f64 = 1e-10;

/// Correlation coefficients of several quantities: symmetric, 1 on the diagonal, positive semi-definite.
///
/// Coefficients copied from a rounded table may miss positive semi-definiteness by the rounding and are refused then;
/// more digits help.
///
/// # Reference
///
/// GUM 5.2.2 eq. 14.
#[derive(Debug, Clone, PartialEq)]
pub struct Correlation {
    size: usize,
    /// Row-major coefficients.
    coefficients: Vec<f64>,
    /// Row-major `L` with `L L^T` = coefficients.
    factor: Vec<f64>,
}

impl Correlation {
    /// `size` uncorrelated quantities.
    pub fn independent(size: usize) -> Self {
        let mut identity = vec![0.0; size * size];
        identity.iter_mut().step_by(size + 1).for_each(|x| *x = 1.0);
        Self { size, factor: identity.clone(), coefficients: identity }
    }

    /// A full matrix of `size` rows, row after row.
    pub fn new(size: usize, row_major: &[f64]) -> Result<Self, Error> {
        if row_major.len() != size * size {
            return Err(Error::Count {
                what: "correlation coefficients",
                expected: size * size,
                found: row_major.len(),
            });
        }
        for row in 0..size {
            let one = row_major[row * size + row];
            check(one == 1.0, "correlation of a quantity with itself", one, "1")?;
            for column in row + 1..size {
                let (upper, lower) = (row_major[row * size + column], row_major[column * size + row]);
                check(upper.abs() <= 1.0, "correlation coefficient", upper, "in -1..=1")?;
                if upper != lower {
                    return Err(Error::NotSymmetric { row, column, upper, lower });
                }
            }
        }
        Ok(Self { size, factor: square_root(size, row_major)?, coefficients: row_major.to_vec() })
    }

    /// `size` quantities of which pairs `(i, j, r)` are correlated, the others not.
    ///
    /// ```
    /// let r = metrology::Correlation::from_pairs(3, &[(0, 2, 0.5)])?;
    /// assert_eq!((r.get(2, 0), r.get(0, 1), r.get(1, 1)), (0.5, 0.0, 1.0));
    /// # Ok::<(), metrology::Error>(())
    /// ```
    pub fn from_pairs(size: usize, pairs: &[(usize, usize, f64)]) -> Result<Self, Error> {
        let mut matrix = Self::independent(size).coefficients;
        for &(i, j, r) in pairs {
            let index = i.max(j);
            if index >= size {
                return Err(Error::Index { index, count: size });
            }
            matrix[i * size + j] = r;
            matrix[j * size + i] = r;
        }
        Self::new(size, &matrix)
    }

    /// Number of quantities.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Coefficient of quantities `i` and `j`; 0 if there is no such quantity.
    pub fn get(&self, i: usize, j: usize) -> f64 {
        if i < self.size && j < self.size { self.coefficients[i * self.size + j] } else { 0.0 }
    }

    /// Whether quantity `i` is correlated with any other.
    pub fn is_correlated(&self, i: usize) -> bool {
        (0..self.size).any(|j| j != i && self.get(i, j) != 0.0)
    }

    #[cfg(feature = "monte-carlo")]
    /// Row `i` of a matrix whose product with its transpose is this one: it makes correlated normals of independent
    /// ones (JCGM 101 C.5).
    pub(crate) fn factor_row(&self, i: usize) -> &[f64] {
        &self.factor[i * self.size..(i + 1) * self.size]
    }

    pub(crate) fn check_size(&self, count: usize) -> Result<(), Error> {
        if self.size == count {
            return Ok(());
        }
        Err(Error::Count { what: "rows of the correlation matrix", expected: count, found: self.size })
    }
}

/// Cholesky factor with the largest remaining variance first, which needs no full rank (Higham, *Accuracy and Stability
/// of Numerical Algorithms*, 10.3).
fn square_root(size: usize, matrix: &[f64]) -> Result<Vec<f64>, Error> {
    let mut rest = matrix.to_vec();
    let mut factor = vec![0.0; size * size];
    for k in 0..size {
        let (pivot, variance) = (0..size)
            .map(|i| (i, rest[i * size + i]))
            .fold((0, f64::NEG_INFINITY), |best, next| if next.1 > best.1 { next } else { best });
        if variance <= TOLERANCE {
            break;
        }
        let column: Vec<f64> = (0..size).map(|i| rest[i * size + pivot] / variance.sqrt()).collect();
        for i in 0..size {
            factor[i * size + k] = column[i];
            for j in 0..size {
                rest[i * size + j] -= column[i] * column[j];
            }
        }
    }
    let residual = rest.iter().fold(0.0, |worst: f64, x| worst.max(x.abs()));
    if residual <= TOLERANCE { Ok(factor) } else { Err(Error::NotPositiveSemidefinite { residual }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_correlations_are_refused() {
        assert!(matches!(Correlation::new(2, &[1.0, 0.5, 0.4, 1.0]), Err(Error::NotSymmetric { .. })));
        assert!(Correlation::new(2, &[1.0, 1.5, 1.5, 1.0]).is_err());
        assert!(Correlation::new(2, &[1.0, f64::NAN, f64::NAN, 1.0]).is_err());
        assert!(Correlation::new(2, &[1.0, 0.5]).is_err());
        // a ~ b and b ~ c, but a ~ -c.
        let odd = Correlation::from_pairs(3, &[(0, 1, 0.9), (1, 2, 0.9), (0, 2, -0.9)]);
        assert!(matches!(odd, Err(Error::NotPositiveSemidefinite { .. })), "{odd:?}");
        assert!(Correlation::from_pairs(2, &[(0, 2, 0.5)]).is_err());
    }

    #[test]
    fn the_factor_squares_to_the_matrix_even_without_full_rank() {
        for r in [
            Correlation::from_pairs(3, &[(0, 1, 1.0), (0, 2, -1.0), (1, 2, -1.0)]),
            Correlation::from_pairs(3, &[(0, 1, -0.36), (0, 2, 0.86), (1, 2, -0.65)]), // GUM H.2
            Correlation::from_pairs(4, &[(1, 3, 0.99)]),
        ] {
            let r = r.unwrap();
            for i in 0..r.size() {
                for j in 0..r.size() {
                    let product: f64 = r.factor_row(i).iter().zip(r.factor_row(j)).map(|(a, b)| a * b).sum();
                    assert!((product - r.get(i, j)).abs() < 1e-14, "{i} {j}");
                }
            }
        }
    }
}
