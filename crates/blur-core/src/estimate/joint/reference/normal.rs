//! Normal equations of a small least-squares problem, on the stack.

/// Most unknowns: five of the path, eight of the illumination.
pub(super) const MOST: usize = 13;
/// Unknowns and the data.
pub(super) const SIDE: usize = MOST + 1;

/// Inner products of the columns of a least-squares problem and of its data, which come last.
#[derive(Debug, Clone, Copy)]
pub(super) struct Normal {
    /// Number of unknowns.
    unknowns: usize,
    /// The products; row and column `unknowns` belong to the data.
    pub(super) products: [[f64; SIDE]; SIDE],
}

/// A symmetric matrix of the leading unknowns.
pub(super) type Matrix = [[f64; MOST]; MOST];

impl Normal {
    pub(super) fn new(unknowns: usize) -> Self {
        Self { unknowns, products: [[0.0; SIDE]; SIDE] }
    }

    /// The best values of the unknowns `from..`, with the ones before left out of the model, and the sum of squares that
    /// remains. `damping` is added to the diagonal of those before `damped`, in units of the diagonal (Levenberg,
    /// Marquardt). `None` when the columns depend on each other.
    pub(super) fn solve(&self, from: usize, damped: usize, damping: f64) -> Option<([f64; MOST], f64)> {
        let n = self.unknowns;
        let scale = self.scale();
        let root = self.cholesky(from, |i| if i < damped { 1.0 + damping } else { 1.0 }, &scale)?;
        let mut x = [0.0; MOST];
        for i in from..n {
            let known: f64 = (from..i).map(|k| root[i][k] * x[k]).sum();
            x[i] = (self.products[i][n] * scale[i] - known) / root[i][i];
        }
        let explained: f64 = x.iter().map(|x| x * x).sum();
        for i in (from..n).rev() {
            let known: f64 = (i + 1..n).map(|k| root[k][i] * x[k]).sum();
            x[i] = (x[i] - known) / root[i][i];
        }
        for (x, scale) in x.iter_mut().zip(scale) {
            *x *= scale;
        }
        Some((x, self.products[n][n] - explained))
    }

    /// The inverse of the products of the unknowns; `None` when the columns depend on each other.
    pub(super) fn inverse(&self) -> Option<Matrix> {
        let n = self.unknowns;
        let scale = self.scale();
        let root = self.cholesky(0, |_| 1.0, &scale)?;
        let mut inverse = [[0.0; MOST]; MOST];
        for unit in 0..n {
            let mut x = [0.0; MOST];
            for i in 0..n {
                let known: f64 = (0..i).map(|k| root[i][k] * x[k]).sum();
                x[i] = (f64::from(u8::from(i == unit)) - known) / root[i][i];
            }
            for i in (0..n).rev() {
                let known: f64 = (i + 1..n).map(|k| root[k][i] * x[k]).sum();
                x[i] = (x[i] - known) / root[i][i];
            }
            for i in 0..n {
                inverse[i][unit] = x[i] * scale[i] * scale[unit];
            }
        }
        Some(inverse)
    }

    /// The products without those of the data.
    pub(super) fn of_unknowns(&self) -> Matrix {
        std::array::from_fn(|i| std::array::from_fn(|j| self.products[i][j]))
    }

    /// The sum of squares that a fit of the column `constant` alone leaves of the data.
    pub(super) fn contrast(&self, constant: Option<usize>) -> f64 {
        let n = self.unknowns;
        let explained = constant.map_or(0.0, |i| self.products[i][n].powi(2) / self.products[i][i]);
        self.products[n][n] - explained
    }

    /// Factors that bring the diagonal to 1.
    fn scale(&self) -> [f64; MOST] {
        std::array::from_fn(|i| {
            let square = self.products[i][i];
            if i < self.unknowns && square > 0.0 { 1.0 / square.sqrt() } else { 0.0 }
        })
    }

    fn cholesky(&self, from: usize, diagonal: impl Fn(usize) -> f64, scale: &[f64; MOST]) -> Option<Matrix> {
        /// Share of a column that must not lie in the span of the others.
        const INDEPENDENT: f64 = 1e-10;
        let mut root = [[0.0; MOST]; MOST];
        for i in from..self.unknowns {
            for j in from..=i {
                let known: f64 = (from..j).map(|k| root[i][k] * root[j][k]).sum();
                if i == j {
                    let rest = diagonal(i) * self.products[i][i] * scale[i] * scale[i] - known;
                    // A NaN is refused too.
                    if rest.is_nan() || rest < INDEPENDENT {
                        return None;
                    }
                    root[i][i] = rest.sqrt();
                } else {
                    root[i][j] = (self.products[i][j] * scale[i] * scale[j] - known) / root[j][j];
                }
            }
        }
        Some(root)
    }
}

/// `a b a` for symmetric matrices of `n` unknowns.
pub(super) fn sandwich(a: &Matrix, b: &Matrix, n: usize) -> Matrix {
    let times = |x: &Matrix, y: &Matrix| -> Matrix {
        std::array::from_fn(|i| std::array::from_fn(|j| (0..n).map(|k| x[i][k] * y[k][j]).sum()))
    };
    times(&times(a, b), a)
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;

    /// Five columns of very different scale and data that they explain in part.
    fn problem() -> (DMatrix<f64>, DVector<f64>, Normal) {
        let design = DMatrix::from_fn(40, 5, |i, j| {
            10.0_f64.powi(j as i32 - 2) * ((i * (j + 2)) as f64 * 0.37 + j as f64).sin()
        });
        let data = DVector::from_fn(40, |i, _| (i as f64 * 0.61).cos());
        let mut normal = Normal::new(5);
        let columns: Vec<_> = design.column_iter().map(|c| c.clone_owned()).chain([data.clone()]).collect();
        for i in 0..6 {
            for j in 0..6 {
                normal.products[i][j] = columns[i].dot(&columns[j]);
            }
        }
        (design, data, normal)
    }

    #[test]
    fn solutions_are_those_of_a_singular_value_decomposition() {
        let (design, data, normal) = problem();
        for from in [0, 2] {
            let part = design.columns(from, 5 - from).clone_owned();
            let expected = part.clone().svd(true, true).solve(&data, 0.0).unwrap();
            let left = (&data - &part * &expected).norm_squared();
            let (found, rest) = normal.solve(from, 0, 0.0).unwrap();
            for i in from..5 {
                assert!((found[i] / expected[i - from] - 1.0).abs() < 1e-9, "{i}");
            }
            assert!((rest - left).abs() < 1e-9);
        }
        let inverse = normal.inverse().unwrap();
        let expected = (design.transpose() * &design).try_inverse().unwrap();
        for i in 0..5 {
            for j in 0..5 {
                let scale = (expected[(i, i)] * expected[(j, j)]).sqrt();
                assert!((inverse[i][j] - expected[(i, j)]).abs() < 1e-9 * scale);
            }
        }
    }

    #[test]
    fn columns_that_depend_on_each_other_are_refused() {
        let (_, _, mut normal) = problem();
        for i in 0..6 {
            normal.products[1][i] = 2.0 * normal.products[0][i];
        }
        for i in 0..6 {
            normal.products[i][1] = normal.products[1][i];
        }
        normal.products[1][1] = 4.0 * normal.products[0][0];
        assert!(normal.solve(0, 0, 0.0).is_none() && normal.inverse().is_none());
        normal.products[2][2] = f64::NAN;
        assert!(normal.solve(2, 0, 0.0).is_none());
    }
}
