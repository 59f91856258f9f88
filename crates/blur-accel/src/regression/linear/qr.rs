//! Orthogonal factors with column pivoting, which find the rank.

use nalgebra::{DMatrix, DVector};

/// Factors of a matrix X with as many rows as observations: `X P = Q R`, the columns in the order P of what is left of
/// them beside those before.
///
/// *Reference*: Businger & Golub, Numerische Mathematik 7 (1965) 269; the rank is that of MATLAB's `regress` and `fitlm`.
pub(super) struct PivotedQr {
    /// R above the diagonal and the Householder vectors on and below it.
    packed: DMatrix<f64>,
    diagonal: Vec<f64>,
    /// Columns of X in the order of the factors.
    order: Vec<usize>,
}

impl PivotedQr {
    pub(super) fn of(mut x: DMatrix<f64>) -> Self {
        let (rows, columns) = x.shape();
        let mut order: Vec<usize> = (0..columns).collect();
        let mut diagonal: Vec<f64> = Vec::new();
        for k in 0..rows.min(columns) {
            let rest = |column: usize| x.column(column).rows_range(k..).norm_squared();
            // The first of equals, as everywhere.
            let (pivot, squared) =
                (k..columns).map(|column| (column, rest(column))).fold((k, -1.0), |a, b| if b.1 > a.1 { b } else { a });
            let norm = squared.sqrt();
            let largest = diagonal.first().map_or(norm, |first: &f64| first.abs());
            if norm <= rows.max(columns) as f64 * f64::EPSILON * largest {
                break;
            }
            x.swap_columns(k, pivot);
            order.swap(k, pivot);
            let head = if x[(k, k)] > 0.0 { -norm } else { norm };
            x[(k, k)] -= head;
            diagonal.push(head);
            let mut reflector = x.column(k).rows_range(k..).into_owned();
            reflector.normalize_mut();
            for column in k + 1..columns {
                reflect(&reflector, &mut x.column_mut(column).rows_range_mut(k..));
            }
            x.column_mut(k).rows_range_mut(k..).copy_from(&reflector);
        }
        Self { packed: x, diagonal, order }
    }

    /// Columns that are not combinations of others.
    pub(super) fn rank(&self) -> usize {
        self.diagonal.len()
    }

    /// Which columns those are.
    pub(super) fn independent(&self) -> &[usize] {
        &self.order[..self.rank()]
    }

    /// The basic solution of least squares: 0 for every column that is a combination of others.
    pub(super) fn solve(&self, y: &DVector<f64>) -> DVector<f64> {
        let mut y = y.clone();
        for k in 0..self.rank() {
            let reflector = self.packed.column(k).rows_range(k..).into_owned();
            reflect(&reflector, &mut y.rows_range_mut(k..));
        }
        let mut solution = DVector::zeros(self.packed.ncols());
        for k in (0..self.rank()).rev() {
            let known: f64 = (k + 1..self.rank()).map(|j| self.packed[(k, j)] * solution[self.order[j]]).sum();
            solution[self.order[k]] = (y[k] - known) / self.diagonal[k];
        }
        solution
    }

    /// The orthogonal factor, one column for each of the rank.
    pub(super) fn basis(&self) -> DMatrix<f64> {
        let mut basis = DMatrix::identity(self.packed.nrows(), self.rank());
        for k in (0..self.rank()).rev() {
            let reflector = self.packed.column(k).rows_range(k..).into_owned();
            for mut column in basis.column_iter_mut() {
                reflect(&reflector, &mut column.rows_range_mut(k..));
            }
        }
        basis
    }

    /// Diagonal of `(X' X)⁻¹` over the independent columns, in the order of X; 0 for the others.
    pub(super) fn inverse_gram_diagonal(&self) -> Vec<f64> {
        let mut diagonal = vec![0.0; self.packed.ncols()];
        // Column j of R⁻¹ by back substitution; row i of it belongs to the column order[i].
        for j in 0..self.rank() {
            let mut column = vec![0.0; j + 1];
            column[j] = 1.0 / self.diagonal[j];
            for i in (0..j).rev() {
                let known: f64 = (i + 1..=j).map(|l| self.packed[(i, l)] * column[l]).sum();
                column[i] = -known / self.diagonal[i];
            }
            column.iter().zip(&self.order).for_each(|(entry, &of)| diagonal[of] += entry * entry);
        }
        diagonal
    }
}

/// `y - 2 v (v' y)` for a unit vector v.
fn reflect<S>(v: &DVector<f64>, y: &mut nalgebra::Vector<f64, nalgebra::Dyn, S>)
where
    S: nalgebra::StorageMut<f64, nalgebra::Dyn>,
{
    let product = 2.0 * v.dot(y);
    y.axpy(-product, v, 1.0);
}
