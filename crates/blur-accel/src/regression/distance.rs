//! Distances between observations.

use ndarray::{Array1, Array2, ArrayView2};

/// Below this share of the squared lengths a difference of squares has lost too many digits.
const CLOSE: f64 = 1e-3;

/// Squared Euclidean distance of each row of `a` to each row of `b`: one matrix product, and the difference itself where
/// two rows are so close that the product would cancel.
pub(super) fn squared_distances(a: ArrayView2<'_, f64>, b: ArrayView2<'_, f64>) -> Array2<f64> {
    let squares =
        |rows: ArrayView2<'_, f64>| -> Array1<f64> { rows.rows().into_iter().map(|row| row.dot(&row)).collect() };
    let (a_squares, b_squares) = (squares(a), squares(b));
    let mut distances = a.dot(&b.t());
    for (i, mut row) in distances.rows_mut().into_iter().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            let sum = a_squares[i] + b_squares[j];
            let squared = sum - 2.0 * *entry;
            *entry = if squared > CLOSE * sum {
                squared
            } else {
                a.row(i).iter().zip(b.row(j)).map(|(x, z)| (x - z) * (x - z)).sum()
            };
        }
    }
    distances
}
