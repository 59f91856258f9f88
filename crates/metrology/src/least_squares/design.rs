//! The design matrix.

use nalgebra::DMatrix;

use super::double_double::DoubleDouble;

/// A design matrix: a row for each point, a column for each coefficient. Its elements carry twice the digits of a
/// double, since the rounding of an element moves the solution as much as an error of the data would, and in the powers
/// of an ill-conditioned polynomial that is what limits it.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    pub(super) high: DMatrix<f64>,
    pub(super) low: DMatrix<f64>,
}

impl Design {
    /// The columns `1, x, x^2, ..., x^degree`, each power to about 32 digits.
    ///
    /// ```
    /// let design = metrology::least_squares::Design::polynomial(&[1.0, 2.0, 3.0], 1);
    /// assert_eq!((design.rows(), design.columns()), (3, 2));
    /// ```
    pub fn polynomial(x: &[f64], degree: usize) -> Self {
        let mut design = Self::from(DMatrix::zeros(x.len(), degree + 1));
        for (row, &x) in x.iter().enumerate() {
            let mut power = DoubleDouble::from(1.0);
            for column in 0..=degree {
                design.set(row, column, power);
                power = power * DoubleDouble::from(x);
            }
        }
        design
    }

    /// Number of points.
    pub fn rows(&self) -> usize {
        self.high.nrows()
    }

    /// Number of coefficients.
    pub fn columns(&self) -> usize {
        self.high.ncols()
    }

    /// The elements, rounded to doubles.
    pub fn rounded(&self) -> &DMatrix<f64> {
        &self.high
    }

    pub(super) fn get(&self, row: usize, column: usize) -> DoubleDouble {
        DoubleDouble { high: self.high[(row, column)], low: self.low[(row, column)] }
    }

    pub(super) fn set(&mut self, row: usize, column: usize, element: DoubleDouble) {
        self.high[(row, column)] = element.high;
        self.low[(row, column)] = element.low;
    }

    /// Every row times its factor.
    pub(super) fn scale_rows(&mut self, factors: &[f64]) {
        for (row, &factor) in factors.iter().enumerate() {
            for column in 0..self.columns() {
                self.set(row, column, self.get(row, column) * DoubleDouble::from(factor));
            }
        }
    }
}

/// Elements taken as exact.
impl From<DMatrix<f64>> for Design {
    fn from(high: DMatrix<f64>) -> Self {
        let low = DMatrix::zeros(high.nrows(), high.ncols());
        Self { high, low }
    }
}
