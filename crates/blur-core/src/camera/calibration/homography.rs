//! The homography from a board to its picture.

use nalgebra::{DMatrix, Matrix2, Matrix3, SMatrix, SVector, Vector2, Vector3};

use super::{MIN_POINTS, View};

/// Points whose scatter across is less than this part of the scatter along count as lying on a line.
const LINE: f64 = 1e-6;
/// The least but one squared singular value, relative to the largest, below which the points leave a homography open.
const RANK: f64 = 1e-12;
const GAUSS_NEWTON_STEPS: usize = 10;

/// The homography `(u, v, 1) ~ H (X, Y, 1)`: the direct linear transform on normalised points (Hartley and Zisserman 2003,
/// algorithm 4.2), refined for the least distances in the picture. Why not, if there is none.
pub(super) fn fit(view: &View) -> Result<Matrix3<f64>, &'static str> {
    if view.board.len() != view.image_px.len() {
        return Err("the board and the picture differ in the number of points");
    }
    if view.board.len() < MIN_POINTS {
        return Err("at least 4 points are needed");
    }
    if view.board.iter().chain(&view.image_px).flatten().any(|value| !value.is_finite()) {
        return Err("every coordinate must be a finite number");
    }
    let (board, from_board) = normalised(&view.board)?;
    let (image, from_image) = normalised(&view.image_px)?;
    let linear = direct_linear_transform(&board, &image)?;
    let refined = refine(linear, &board, &image);
    let to_image = from_image.try_inverse().ok_or("the points lie on a line")?;
    Ok(to_image * refined * from_board)
}

/// Points moved and scaled to mean 0 and mean square distance 2, and the matrix that does so.
fn normalised(points: &[[f64; 2]]) -> Result<(Vec<Vector2<f64>>, Matrix3<f64>), &'static str> {
    let count = points.len() as f64;
    let mean = points.iter().map(|&p| Vector2::from(p)).sum::<Vector2<f64>>() / count;
    let scatter: Matrix2<f64> = points.iter().map(|&p| Vector2::from(p) - mean).map(|d| d * d.transpose()).sum();
    let eigenvalues = scatter.symmetric_eigenvalues();
    let is_spread = eigenvalues.min() > LINE * LINE * eigenvalues.max();
    if !is_spread {
        return Err("the points lie on a line");
    }
    let scale = (2.0 * count / scatter.trace()).sqrt();
    let matrix = Matrix3::new(scale, 0.0, -scale * mean.x, 0.0, scale, -scale * mean.y, 0.0, 0.0, 1.0);
    Ok((points.iter().map(|&p| (Vector2::from(p) - mean) * scale).collect(), matrix))
}

fn direct_linear_transform(board: &[Vector2<f64>], image: &[Vector2<f64>]) -> Result<Matrix3<f64>, &'static str> {
    let mut gram = SMatrix::<f64, 9, 9>::zeros();
    for (b, p) in board.iter().zip(image) {
        let b = b.push(1.0);
        let mut rows = SMatrix::<f64, 9, 2>::zeros();
        rows.fixed_view_mut::<3, 1>(0, 0).copy_from(&b);
        rows.fixed_view_mut::<3, 1>(6, 0).copy_from(&(-p.x * b));
        rows.fixed_view_mut::<3, 1>(3, 1).copy_from(&b);
        rows.fixed_view_mut::<3, 1>(6, 1).copy_from(&(-p.y * b));
        gram += rows * rows.transpose();
    }
    let eigen = gram.symmetric_eigen();
    let mut order: Vec<usize> = (0..9).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    let is_fixed = eigen.eigenvalues[order[1]] > RANK * eigen.eigenvalues[order[8]];
    if !is_fixed {
        return Err("all but a few points lie on a line");
    }
    let h = eigen.eigenvectors.column(order[0]);
    Ok(Matrix3::from_row_slice(h.clone_owned().as_slice()))
}

/// Gauss-Newton steps for the distances in the picture; each is taken only if it helps.
fn refine(start: Matrix3<f64>, board: &[Vector2<f64>], image: &[Vector2<f64>]) -> Matrix3<f64> {
    let cost =
        |h: &Matrix3<f64>| -> f64 { board.iter().zip(image).map(|(b, p)| (apply(h, *b) - p).norm_squared()).sum() };
    let (mut best, mut least) = (start, cost(&start));
    for _ in 0..GAUSS_NEWTON_STEPS {
        // The scale of H is free: a row of its own keeps the step across H.
        let mut normal = SMatrix::<f64, 9, 9>::zeros();
        let mut gradient = SVector::<f64, 9>::zeros();
        for (b, p) in board.iter().zip(image) {
            let b = b.push(1.0);
            let q = best * b;
            let mut rows = SMatrix::<f64, 9, 2>::zeros();
            for axis in 0..2 {
                rows.fixed_view_mut::<3, 1>(3 * axis, axis).copy_from(&(b / q.z));
                rows.fixed_view_mut::<3, 1>(6, axis).copy_from(&(-b * (q[axis] / (q.z * q.z))));
            }
            normal += rows * rows.transpose();
            gradient += rows * (p - q.xy() / q.z);
        }
        let entries = SVector::<f64, 9>::from_column_slice(best.transpose().as_slice());
        normal += entries * entries.transpose() * (normal.trace() / entries.norm_squared());
        let Some(step) = normal.cholesky().map(|factor| factor.solve(&gradient)) else { break };
        let tried = Matrix3::from_row_slice((entries + step).as_slice());
        let found = cost(&tried);
        let is_better = found < least;
        if !is_better {
            break;
        }
        (best, least) = (tried, found);
    }
    best
}

fn apply(h: &Matrix3<f64>, point: Vector2<f64>) -> Vector2<f64> {
    let q: Vector3<f64> = h * point.push(1.0);
    q.xy() / q.z
}

/// Singular values and the vector of the least one of a matrix with any number of rows.
pub(super) fn null_vector(rows: &DMatrix<f64>) -> Option<(Vec<f64>, Vec<f64>)> {
    let eigen = (rows.transpose() * rows).symmetric_eigen();
    let mut order: Vec<usize> = (0..eigen.eigenvalues.len()).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    let &first = order.first()?;
    let values = order.iter().map(|&i| eigen.eigenvalues[i].max(0.0).sqrt()).collect();
    Some((values, eigen.eigenvectors.column(first).iter().copied().collect()))
}
