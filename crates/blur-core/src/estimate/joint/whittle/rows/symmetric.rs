//! Arithmetic of small symmetric matrices, row after row in one slice, without allocating.

/// Adds `factor * of`.
pub(super) fn add_multiple(to: &mut [f64], factor: f64, of: &[f64]) {
    for (to, &of) in to.iter_mut().zip(of) {
        *to += factor * of;
    }
}

/// Adds `x' M x` of each row `x` to its value in `out`.
pub(super) fn add_forms(matrix: &[f64], rows: &[f64], n: usize, out: &mut [f64]) {
    for (out, row) in out.iter_mut().zip(rows.chunks_exact(n)) {
        *out += matrix.chunks_exact(n).zip(row).map(|(line, &x)| x * dot(line, row)).sum::<f64>();
    }
}

/// Sum of products; of two symmetric matrices the trace of their product.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut parts = [0.0; 4];
    let (a, b) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a.zip(b) {
        for ((part, a), b) in parts.iter_mut().zip(a).zip(b) {
            *part += a * b;
        }
    }
    parts.iter().sum::<f64>() + rest
}

/// Rows of a factor that are added to the product at once.
const TOGETHER: usize = 4;

/// The product of two square matrices.
pub(super) fn multiply(a: &[f64], b: &[f64], out: &mut [f64], n: usize) {
    for (out, a) in out.chunks_exact_mut(n).zip(a.chunks_exact(n)) {
        out.fill(0.0);
        let (factors, last) = a.as_chunks::<TOGETHER>();
        for ([a0, a1, a2, a3], b) in factors.iter().zip(b.chunks_exact(TOGETHER * n)) {
            let (b01, b23) = b.split_at(2 * n);
            let ((b0, b1), (b2, b3)) = (b01.split_at(n), b23.split_at(n));
            for ((((out, b0), b1), b2), b3) in out.iter_mut().zip(b0).zip(b1).zip(b2).zip(b3) {
                *out += (a0 * b0 + a1 * b1) + (a2 * b2 + a3 * b3);
            }
        }
        for (&a, b) in last.iter().zip(b.chunks_exact(n).skip(n - last.len())) {
            add_multiple(out, a, b);
        }
    }
}

/// The trace of a product of two square matrices.
pub(super) fn trace_of_product(a: &[f64], b: &[f64], n: usize) -> f64 {
    a.chunks_exact(n)
        .enumerate()
        .map(|(i, row)| row.iter().zip(b[i..].iter().step_by(n)).map(|(a, b)| a * b).sum::<f64>())
        .sum()
}

/// Inverts a symmetric matrix in its place by Cholesky's decomposition. The logarithm of its determinant; `None` when it
/// is not positive definite.
pub(super) fn invert(matrix: &mut [f64], n: usize, work: &mut [f64]) -> Option<f64> {
    let mut log_determinant = 0.0;
    // The factor L.
    for i in 0..n {
        let (above, row) = matrix.split_at_mut(i * n);
        for j in 0..i {
            let factor = &above[j * n..=j * n + j];
            row[j] = (row[j] - dot(&row[..j], &factor[..j])) / factor[j];
        }
        let square = row[i] - dot(&row[..i], &row[..i]);
        if square.is_nan() || square <= 0.0 {
            return None;
        }
        log_determinant += square.ln();
        row[i] = square.sqrt();
    }
    // Its inverse.
    for i in 0..n {
        let (above, row) = work.split_at_mut(i * n);
        let factor = &matrix[i * n..(i + 1) * n];
        row[..i].fill(0.0);
        for k in 0..i {
            add_multiple(&mut row[..=k], -factor[k] / factor[i], &above[k * n..=k * n + k]);
        }
        row[i] = 1.0 / factor[i];
    }
    matrix.fill(0.0);
    for row in work.chunks_exact(n).take(n).enumerate().map(|(k, row)| &row[..=k]) {
        for (out, &a) in matrix.chunks_exact_mut(n).zip(row) {
            add_multiple(out, a, row);
        }
    }
    Some(log_determinant)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_of_an_autoregression_has_three_diagonals() {
        // Covariance r^|i-j|: determinant (1 - r^2)^(n-1), inverse (1 + r^2, at the ends 1, beside them -r) / (1 - r^2).
        let (n, r) = (7_usize, 0.9_f64);
        let mut matrix: Vec<f64> = (0..n * n).map(|at| r.powi((at / n).abs_diff(at % n) as i32)).collect();
        let log_determinant = invert(&mut matrix, n, &mut vec![f64::NAN; n * n]).unwrap();
        assert!((log_determinant - 6.0 * (1.0 - r * r).ln()).abs() < 1e-12);
        for (at, found) in matrix.iter().enumerate() {
            let (i, j) = (at / n, at % n);
            let expected = match i.abs_diff(j) {
                0 if i == 0 || i == n - 1 => 1.0,
                0 => 1.0 + r * r,
                1 => -r,
                _ => 0.0,
            };
            assert!((found * (1.0 - r * r) - expected).abs() < 1e-12, "{i} {j}: {found}");
        }
    }

    #[test]
    fn what_is_not_positive_definite_has_no_inverse() {
        for matrix in [[1.0, 2.0, 2.0, 1.0], [0.0; 4], [f64::NAN; 4]] {
            assert!(invert(&mut matrix.clone(), 2, &mut [0.0; 4]).is_none(), "{matrix:?}");
        }
    }

    #[test]
    fn products_of_any_size_are_sums_over_rows_and_columns() {
        for n in [1_usize, 3, 4, 7, 9] {
            let values = |seed: usize| (0..n * n).map(move |i| ((i * i + seed * i) % 11) as f64).collect::<Vec<f64>>();
            let (a, b) = (values(3), values(5));
            let mut product = vec![f64::NAN; n * n];
            multiply(&a, &b, &mut product, n);
            for (at, found) in product.iter().enumerate() {
                let written: f64 = (0..n).map(|k| a[at / n * n + k] * b[k * n + at % n]).sum();
                assert!((found - written).abs() < 1e-12, "{n} {at}: {found} {written}");
            }
        }
    }

    #[test]
    fn products_are_those_written_out() {
        let (a, b) = ([1.0, 2.0, 3.0, 4.0], [5.0, 6.0, 7.0, 8.0]);
        let mut product = [0.0; 4];
        multiply(&a, &b, &mut product, 2);
        assert_eq!(product, [19.0, 22.0, 43.0, 50.0]);
        assert_eq!(trace_of_product(&a, &b, 2), 69.0);
        let mut forms = [1.0, 0.0];
        add_forms(&a, &[1.0, 1.0, 2.0, -1.0], 2, &mut forms);
        assert_eq!(forms, [11.0, -2.0]);
    }
}
