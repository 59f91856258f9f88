//! Two-dimensional DCT-II.

use std::f32::consts::FRAC_1_SQRT_2;
use std::fmt;
use std::sync::Arc;

use ndarray::{Array2, ArrayView2};
use rustdct::{DctPlanner, TransformType2And3};

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
pub struct Dct2 {
    along_row: Arc<dyn TransformType2And3<f32>>,
    along_column: Arc<dyn TransformType2And3<f32>>,
    coefficients: Array2<f32>,
    /// Columns are transformed in strips of [`STRIP`], copied here one after the other.
    strip: Vec<f32>,
    scratch: Vec<f32>,
}

/// Columns per strip: 16 values of 4 bytes are one cache line.
const STRIP: usize = 16;

impl Dct2 {
    /// A transform of pictures of `rows` x `columns` pixels, both at least 1.
    pub fn new(rows: usize, columns: usize) -> Self {
        let mut planner = DctPlanner::new();
        let along_row = planner.plan_dct2(columns);
        let along_column = planner.plan_dct2(rows);
        let scratch = vec![0.0; along_row.get_scratch_len().max(along_column.get_scratch_len())];
        Self {
            along_row,
            along_column,
            coefficients: Array2::zeros((rows, columns)),
            strip: vec![0.0; rows * STRIP],
            scratch,
        }
    }

    /// Rows and columns of the pictures it transforms.
    pub fn dim(&self) -> (usize, usize) {
        self.coefficients.dim()
    }

    /// The picture to transform next; fill it, then call [`transform`](Self::transform).
    pub fn input(&mut self) -> &mut Array2<f32> {
        &mut self.coefficients
    }

    /// Transforms what [`input`](Self::input) holds and returns the coefficients, indexed `[m, n]` along rows and columns.
    pub fn transform(&mut self) -> ArrayView2<'_, f32> {
        let (rows, columns) = self.coefficients.dim();
        let scale = 2.0 / ((rows * columns) as f32).sqrt();
        if let Some(data) = self.coefficients.as_slice_mut() {
            for row in data.chunks_exact_mut(columns) {
                self.along_row.process_dct2_with_scratch(row, &mut self.scratch);
                row[0] *= FRAC_1_SQRT_2;
            }
            for left in (0..columns).step_by(STRIP) {
                let width = STRIP.min(columns - left);
                for (r, row) in data.chunks_exact(columns).enumerate() {
                    for (c, &value) in row[left..left + width].iter().enumerate() {
                        self.strip[c * rows + r] = value * scale;
                    }
                }
                for column in self.strip.chunks_exact_mut(rows).take(width) {
                    self.along_column.process_dct2_with_scratch(column, &mut self.scratch);
                    column[0] *= FRAC_1_SQRT_2;
                }
                for (r, row) in data.chunks_exact_mut(columns).enumerate() {
                    for (c, value) in row[left..left + width].iter_mut().enumerate() {
                        *value = self.strip[c * rows + r];
                    }
                }
            }
        }
        self.coefficients.view()
    }
}

impl fmt::Debug for Dct2 {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Dct2").field("dim", &self.dim()).finish_non_exhaustive()
    }
}
