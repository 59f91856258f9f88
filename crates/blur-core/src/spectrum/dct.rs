//! Two-dimensional DCT-II.

use std::f64::consts::PI;

use ndarray::{Array2, ArrayView2};
use rustfft::num_complex::{Complex32, Complex64};

use super::dft::Dft2;

/// Two-dimensional DCT-II of pictures of one size.
///
/// # Normalisation
///
/// Orthonormal, as in thesis eq. 4.8:
///
/// ```text
/// G[m, n] = 2 / sqrt(M N) sum sum g[row, column] C_m cos(pi (2 row + 1) m / 2M) C_n cos(pi (2 column + 1) n / 2N)
/// ```
///
/// with `C_0 = 1 / sqrt 2` and 1 otherwise. Coefficient `[m, n]` belongs to the frequencies `m / 2M` along rows and
/// `n / 2N` along columns, in cycles per pixel.
///
/// # Method
///
/// One real DFT of the picture with its even samples first and its odd ones after them in reverse order, along both
/// axes: a DCT costs hardly more than a DFT and works for any size. J. Makhoul, "A fast cosine transform in one and two
/// dimensions", IEEE Trans. ASSP 28(1), 1980.
#[derive(Debug)]
pub struct Dct2 {
    picture: Array2<f32>,
    coefficients: Array2<f32>,
    dft: Dft2,
    /// `exp(-i pi m / 2M)` with the factors of the normalisation, along rows and along columns.
    row_twiddles: Vec<Complex32>,
    column_twiddles: Vec<Complex32>,
}

impl Dct2 {
    /// A transform of pictures of `rows` x `columns` pixels, both at least 1.
    pub fn new(rows: usize, columns: usize) -> Self {
        Self {
            picture: Array2::zeros((rows, columns)),
            coefficients: Array2::zeros((rows, columns)),
            dft: Dft2::new(rows, columns),
            row_twiddles: twiddles(rows, rows),
            column_twiddles: twiddles(columns, columns / 2 + 1),
        }
    }

    /// Rows and columns of the pictures it transforms.
    pub fn dim(&self) -> (usize, usize) {
        self.picture.dim()
    }

    /// The picture to transform next; fill it, then call [`transform`](Self::transform).
    pub fn input(&mut self) -> &mut Array2<f32> {
        &mut self.picture
    }

    /// Transforms what [`input`](Self::input) holds and returns the coefficients, indexed `[m, n]` along rows and columns.
    pub fn transform(&mut self) -> ArrayView2<'_, f32> {
        let (rows, columns) = self.picture.dim();
        let even = columns.div_ceil(2);
        for (r, row) in self.picture.rows().into_iter().enumerate() {
            let mut permuted = self.dft.input().row_mut(permuted_index(r, rows));
            if let (Some(row), Some(permuted)) = (row.as_slice(), permuted.as_slice_mut()) {
                let (evens, odds) = permuted.split_at_mut(even);
                for (pair, value) in row.chunks(2).zip(evens) {
                    *value = pair[0];
                }
                for (pair, value) in row.chunks_exact(2).zip(odds.iter_mut().rev()) {
                    *value = pair[1];
                }
            }
        }
        let spectrum = self.dft.transform();
        for (m, mut out) in self.coefficients.rows_mut().into_iter().enumerate() {
            let (here, mirrored) = (spectrum.row(m), spectrum.row((rows - m) % rows));
            let (Some(here), Some(mirrored), Some(out)) = (here.as_slice(), mirrored.as_slice(), out.as_slice_mut())
            else {
                continue;
            };
            // With P = b V[m, n] and Q = conj(b V[-m, n]): G[m, n] = Re a (P + Q) / 2, G[m, N - n] = -Im a (P - Q) / 2.
            let a = self.row_twiddles[m];
            for (n, ((&v, &w), &b)) in here.iter().zip(mirrored).zip(&self.column_twiddles).enumerate() {
                let (p, q) = (b * v, (b * w).conj());
                out[n] = (a * (p + q)).re;
                if n > 0 && 2 * n < columns {
                    out[columns - n] = -(a * (p - q)).im;
                }
            }
        }
        self.coefficients.view()
    }
}

/// Where sample `i` of `n` goes: even samples to the front in order, odd ones to the back in reverse order.
fn permuted_index(i: usize, n: usize) -> usize {
    if i.is_multiple_of(2) { i / 2 } else { n - 1 - i / 2 }
}

/// `C_k exp(-i pi k / 2n) / sqrt n` for the first `count` of `n` coefficients: two of them make the factor
/// `2 / sqrt(M N)` of the normalisation and the halves of the real parts.
fn twiddles(n: usize, count: usize) -> Vec<Complex32> {
    (0..count)
        .map(|k| {
            let first = if k == 0 { 0.5_f64.sqrt() } else { 1.0 };
            let value = Complex64::from_polar(first / (n as f64).sqrt(), -PI * k as f64 / (2 * n) as f64);
            Complex32::new(value.re as f32, value.im as f32)
        })
        .collect()
}
