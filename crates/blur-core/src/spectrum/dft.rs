//! Two-dimensional DFT of real pictures and its inverse.

use std::fmt;
use std::sync::Arc;

use ndarray::{Array2, ArrayView2};
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
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
    columns: Columns,
    input: Array2<f32>,
    spectrum: Array2<Complex32>,
    scratch: Vec<Complex32>,
}

impl Dft2 {
    /// A transform of pictures of `rows` x `columns` pixels, both at least 1.
    pub fn new(rows: usize, columns: usize) -> Self {
        let along_row = RealFftPlanner::new().plan_fft_forward(columns);
        Self {
            columns: Columns::new(FftPlanner::new().plan_fft_forward(rows), rows),
            input: Array2::zeros((rows, columns)),
            spectrum: Array2::zeros((rows, columns / 2 + 1)),
            scratch: vec![Complex32::default(); along_row.get_scratch_len()],
            along_row,
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
        let columns = self.input.ncols();
        let half = columns / 2 + 1;
        if let (Some(picture), Some(spectrum)) = (self.input.as_slice_mut(), self.spectrum.as_slice_mut()) {
            for (row, out) in picture.chunks_exact_mut(columns).zip(spectrum.chunks_exact_mut(half)) {
                // The lengths are those of the plan, the only thing that can go wrong here.
                let done = self.along_row.process_with_scratch(row, out, &mut self.scratch);
                debug_assert!(done.is_ok());
            }
            self.columns.transform(spectrum, half);
        }
        self.spectrum.view()
    }
}

impl fmt::Debug for Dft2 {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Dft2").field("dim", &self.dim()).finish_non_exhaustive()
    }
}

/// Inverse of [`Dft2`] for one size: from a half spectrum back to the real picture.
///
/// # Normalisation and order
///
/// `g[row, column] = 1/(M N) sum sum F exp(2 pi i (row j / M + column k / N))` over the whole plane, so that it undoes
/// `Dft2`. Only the columns `0..=N/2` of `F` are given; the others count as their complex conjugates.
pub struct InverseDft2 {
    along_row: Arc<dyn ComplexToReal<f32>>,
    columns: Columns,
    spectrum: Array2<Complex32>,
    picture: Array2<f32>,
    scratch: Vec<Complex32>,
}

impl InverseDft2 {
    /// A transform to pictures of `rows` x `columns` pixels, both at least 1.
    pub fn new(rows: usize, columns: usize) -> Self {
        let along_row = RealFftPlanner::new().plan_fft_inverse(columns);
        Self {
            columns: Columns::new(FftPlanner::new().plan_fft_inverse(rows), rows),
            spectrum: Array2::zeros((rows, columns / 2 + 1)),
            picture: Array2::zeros((rows, columns)),
            scratch: vec![Complex32::default(); along_row.get_scratch_len()],
            along_row,
        }
    }

    /// Rows and columns of the pictures it makes.
    pub fn dim(&self) -> (usize, usize) {
        self.picture.dim()
    }

    /// The half spectrum to transform next, `rows` x `columns / 2 + 1`; fill it, then call
    /// [`transform`](Self::transform), which destroys it.
    pub fn input(&mut self) -> &mut Array2<Complex32> {
        &mut self.spectrum
    }

    /// Transforms what [`input`](Self::input) holds and returns the picture, `rows` x `columns`.
    pub fn transform(&mut self) -> ArrayView2<'_, f32> {
        let (rows, columns) = self.picture.dim();
        let half = columns / 2 + 1;
        let scale = 1.0 / (rows * columns) as f32;
        if let (Some(spectrum), Some(picture)) = (self.spectrum.as_slice_mut(), self.picture.as_slice_mut()) {
            self.columns.transform(spectrum, half);
            for (row, out) in spectrum.chunks_exact_mut(half).zip(picture.chunks_exact_mut(columns)) {
                // A real row needs real first and Nyquist bins; rounding leaves an imaginary speck.
                row[0].im = 0.0;
                if columns % 2 == 0 {
                    row[columns / 2].im = 0.0;
                }
                let done = self.along_row.process_with_scratch(row, out, &mut self.scratch);
                debug_assert!(done.is_ok());
                for value in out {
                    *value *= scale;
                }
            }
        }
        self.picture.view()
    }
}

impl fmt::Debug for InverseDft2 {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("InverseDft2").field("dim", &self.dim()).finish_non_exhaustive()
    }
}

/// One-dimensional transforms of all columns of a spectrum.
struct Columns {
    fft: Arc<dyn Fft<f32>>,
    rows: usize,
    /// Columns are transformed in strips of [`STRIP`], copied here one after the other.
    strip: Vec<Complex32>,
    scratch: Vec<Complex32>,
}

/// Columns per strip: 8 values of 8 bytes are one cache line.
const STRIP: usize = 8;

impl Columns {
    fn new(fft: Arc<dyn Fft<f32>>, rows: usize) -> Self {
        let scratch = vec![Complex32::default(); fft.get_inplace_scratch_len()];
        Self { fft, rows, strip: vec![Complex32::default(); rows * STRIP], scratch }
    }

    /// Transforms the columns of a spectrum of rows of `width` values.
    fn transform(&mut self, spectrum: &mut [Complex32], width: usize) {
        let rows = self.rows;
        for left in (0..width).step_by(STRIP) {
            let count = STRIP.min(width - left);
            for (r, row) in spectrum.chunks_exact(width).enumerate() {
                for (c, &value) in row[left..left + count].iter().enumerate() {
                    self.strip[c * rows + r] = value;
                }
            }
            self.fft.process_with_scratch(&mut self.strip[..count * rows], &mut self.scratch);
            for (r, row) in spectrum.chunks_exact_mut(width).enumerate() {
                for (c, value) in row[left..left + count].iter_mut().enumerate() {
                    *value = self.strip[c * rows + r];
                }
            }
        }
    }
}

/// The least product of 2, 3 and 5 that is even and at least `n`.
pub(crate) fn fast_size(n: usize) -> usize {
    let is_fast = |size: &usize| {
        let mut rest = *size;
        for factor in [2, 3, 5] {
            while rest.is_multiple_of(factor) {
                rest /= factor;
            }
        }
        rest == 1 && size.is_multiple_of(2)
    };
    // The next power of two is one.
    (n..=2 * n.next_power_of_two()).find(is_fast).unwrap_or(n)
}
