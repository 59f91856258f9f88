//! Two-dimensional DFT of real pictures.

use std::fmt;
use std::sync::Arc;

use ndarray::{Array2, ArrayView2};
use realfft::{RealFftPlanner, RealToComplex};
use rustfft::num_complex::Complex32;
use rustfft::{Fft, FftPlanner};

/// Two-dimensional DFT of real pictures of one size.
///
/// # Normalisation and order
///
/// `F[j, k] = sum sum g exp(-2 pi i (row j / M + column k / N))`, no factor. The result has all `M` rows but only the
/// columns `0..=N/2`; the others are the complex conjugates `F[j, k] = conj F[M - j, N - k]`. Row `j` belongs to the
/// frequency `j / M`, or `(j - M) / M` above `M / 2`; column `k` to `k / N`, in cycles per pixel.
pub struct Dft2 {
    along_row: Arc<dyn RealToComplex<f32>>,
    along_column: Arc<dyn Fft<f32>>,
    input: Array2<f32>,
    spectrum: Array2<Complex32>,
    /// Columns are transformed in strips of [`STRIP`], copied here one after the other.
    strip: Vec<Complex32>,
    scratch: Vec<Complex32>,
}

/// Columns per strip: 8 values of 8 bytes are one cache line.
const STRIP: usize = 8;

impl Dft2 {
    /// A transform of pictures of `rows` x `columns` pixels, both at least 1.
    pub fn new(rows: usize, columns: usize) -> Self {
        let along_row = RealFftPlanner::new().plan_fft_forward(columns);
        let along_column = FftPlanner::new().plan_fft_forward(rows);
        let scratch = along_row.get_scratch_len().max(along_column.get_inplace_scratch_len());
        Self {
            along_row,
            along_column,
            input: Array2::zeros((rows, columns)),
            spectrum: Array2::zeros((rows, columns / 2 + 1)),
            strip: vec![Complex32::default(); rows * STRIP],
            scratch: vec![Complex32::default(); scratch],
        }
    }

    /// Rows and columns of the pictures it transforms.
    pub fn dim(&self) -> (usize, usize) {
        self.input.dim()
    }

    /// The picture to transform next; fill it, then call [`transform`](Self::transform), which destroys it.
    pub fn input(&mut self) -> &mut Array2<f32> {
        &mut self.input
    }

    /// Transforms what [`input`](Self::input) holds and returns the half spectrum, `rows` x `columns / 2 + 1`.
    pub fn transform(&mut self) -> ArrayView2<'_, Complex32> {
        let (rows, columns) = self.input.dim();
        let half = columns / 2 + 1;
        if let (Some(picture), Some(spectrum)) = (self.input.as_slice_mut(), self.spectrum.as_slice_mut()) {
            for (row, out) in picture.chunks_exact_mut(columns).zip(spectrum.chunks_exact_mut(half)) {
                // The lengths are those of the plan, the only thing that can go wrong here.
                let done = self.along_row.process_with_scratch(row, out, &mut self.scratch);
                debug_assert!(done.is_ok());
            }
            for left in (0..half).step_by(STRIP) {
                let width = STRIP.min(half - left);
                for (r, row) in spectrum.chunks_exact(half).enumerate() {
                    for (c, &value) in row[left..left + width].iter().enumerate() {
                        self.strip[c * rows + r] = value;
                    }
                }
                self.along_column.process_with_scratch(&mut self.strip[..width * rows], &mut self.scratch);
                for (r, row) in spectrum.chunks_exact_mut(half).enumerate() {
                    for (c, value) in row[left..left + width].iter_mut().enumerate() {
                        *value = self.strip[c * rows + r];
                    }
                }
            }
        }
        self.spectrum.view()
    }
}

impl fmt::Debug for Dft2 {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Dft2").field("dim", &self.dim()).finish_non_exhaustive()
    }
}
