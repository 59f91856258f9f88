//! QR with column pivoting.

use nalgebra::DMatrix;

/// `A S P = Q R` with a diagonal S of powers of two, so that scaling rounds nothing, and the permutation P.
#[derive(Debug, Clone)]
pub(super) struct PivotedQr {
    /// Orthonormal columns, as many as `rank`.
    pub(super) q: DMatrix<f64>,
    /// Upper triangular, `rank` rows and columns.
    pub(super) r: DMatrix<f64>,
    /// Column of A that stands at each place; those past `rank` depend on the others.
    pub(super) order: Vec<usize>,
    /// Elements of S for each column of A.
    pub(super) scales: Vec<f64>,
    /// Number of columns that do not depend on others.
    pub(super) rank: usize,
}

/// Householder QR that takes the longest remaining column next, after scaling all to about unit length. A column of
/// which less than `max(rows, columns)` roundings of its length remain depends on those before it.
///
/// # Reference
///
/// P. Businger, G. H. Golub, Numer. Math. 7 (1965) 269-276.
pub(super) fn pivoted_qr(matrix: &DMatrix<f64>) -> PivotedQr {
    let (rows, columns) = matrix.shape();
    let mut work = matrix.clone();
    let mut scales = Vec::with_capacity(columns);
    for mut column in work.column_iter_mut() {
        let norm = column.norm();
        let scale = if norm > 0.0 { (-norm.log2().round()).exp2() } else { 1.0 };
        column *= scale;
        scales.push(scale);
    }
    let tolerance = rows.max(columns) as f64 * f64::EPSILON;
    let mut order: Vec<usize> = (0..columns).collect();
    let mut axes: Vec<(usize, Vec<f64>)> = Vec::with_capacity(columns);
    for step in 0..rows.min(columns) {
        let remaining = |column: usize| work.view((step, column), (rows - step, 1)).norm();
        let (pivot, norm) = (step..columns)
            .map(|column| (column, remaining(column)))
            .fold((step, -1.0), |best, next| if next.1 > best.1 { next } else { best });
        if norm <= tolerance {
            break;
        }
        work.swap_columns(step, pivot);
        order.swap(step, pivot);
        // The axis v of the reflection I - 2 v v', with the sign that does not cancel.
        let mut axis: Vec<f64> = work.view((step, step), (rows - step, 1)).iter().copied().collect();
        axis[0] += norm.copysign(axis[0]);
        let length = axis.iter().map(|v| v * v).sum::<f64>().sqrt();
        for v in &mut axis {
            *v /= length;
        }
        for column in step..columns {
            reflect(&mut work, step, column, &axis);
        }
        axes.push((step, axis));
    }
    let rank = axes.len();
    let mut q = DMatrix::identity(rows, rank);
    for (step, axis) in axes.iter().rev() {
        for column in 0..rank {
            reflect(&mut q, *step, column, axis);
        }
    }
    let r = work.view((0, 0), (rank, rank)).upper_triangle();
    PivotedQr { q, r, order, scales, rank }
}

fn reflect(matrix: &mut DMatrix<f64>, first_row: usize, column: usize, axis: &[f64]) {
    let mut target = matrix.view_mut((first_row, column), (axis.len(), 1));
    let dot: f64 = target.iter().zip(axis).map(|(t, v)| t * v).sum();
    target.iter_mut().zip(axis).for_each(|(t, v)| *t -= 2.0 * dot * v);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factors_multiply_to_the_scaled_and_permuted_matrix() {
        let a = DMatrix::from_fn(7, 3, |i, j| ((i * 5 + j * 3) % 7) as f64 * 10f64.powi(j as i32 * 4));
        let PivotedQr { q, r, order, scales, rank } = pivoted_qr(&a);
        assert_eq!(rank, 3);
        let product = &q * &r;
        for (place, &column) in order.iter().enumerate() {
            let error = (product.column(place) - a.column(column) * scales[column]).norm();
            assert!(error < 1e-14, "{error}");
        }
        assert!((q.transpose() * &q - DMatrix::identity(3, 3)).norm() < 1e-14);
    }

    #[test]
    fn a_column_that_is_a_sum_of_others_lowers_the_rank() {
        let mut a = DMatrix::from_fn(6, 3, |i, j| (i as f64 + 1.0).powi(j as i32));
        a.set_column(2, &(a.column(0) * 3.0 + a.column(1) * 0.1));
        assert_eq!(pivoted_qr(&a).rank, 2);
    }
}
