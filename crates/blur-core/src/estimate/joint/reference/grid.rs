//! The padded grid on which stills are blurred.

use std::f64::consts::PI;

use ndarray::{Array2, ArrayView2};
use rustfft::num_complex::Complex32;

use super::path::Path;
use crate::spectrum::fast_size;

/// Least number of pixels between opposite borders of the periodic continuation.
const GAP_PX: usize = 48;
/// Pixels at the border of the field that the band-limited continuation beyond it reaches.
const BORDER_PX: f64 = 4.0;
/// Pixels over which the weight of a pixel rises from 0 to 1.
const TAPER_PX: f64 = 16.0;

/// Sizes of a picture and of the periodic field around it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Grid {
    /// Rows and columns of the picture.
    pub(super) picture: (usize, usize),
    /// Rows and columns of the transforms.
    pub(super) padded: (usize, usize),
}

impl Grid {
    pub(super) fn new(picture: (usize, usize)) -> Self {
        Self { picture, padded: (fast_size(picture.0 + GAP_PX), fast_size(picture.1 + GAP_PX)) }
    }

    /// Rows and columns of a half spectrum.
    pub(super) fn spectrum(&self) -> (usize, usize) {
        (self.padded.0, self.padded.1 / 2 + 1)
    }

    /// Cycles per pixel downwards of a row of a spectrum.
    pub(super) fn down(&self, row: usize) -> f64 {
        let rows = self.padded.0;
        (if 2 * row > rows { row as f64 - rows as f64 } else { row as f64 }) / rows as f64
    }

    /// Cycles per pixel to the right of a column of a half spectrum.
    pub(super) fn right(&self, column: usize) -> f64 {
        column as f64 / self.padded.1 as f64
    }

    /// How many bins of the whole spectrum a column of the half spectrum stands for.
    pub(super) fn multiplicity(&self, column: usize) -> f64 {
        if column == 0 || 2 * column == self.padded.1 { 1.0 } else { 2.0 }
    }

    /// Writes `picture` into `out`, of the padded size, and continues it periodically: in the gap the mirror images of the
    /// two borders fade into each other. No pixel that is used sees the gap; it only must not have an edge, whose ripples
    /// would.
    pub(super) fn fill(&self, picture: ArrayView2<'_, f32>, out: &mut Array2<f32>) {
        let (rows, columns) = self.picture;
        for (row, mut out_row) in picture.rows().into_iter().zip(out.rows_mut()) {
            for (value, out) in row.iter().zip(&mut out_row) {
                *out = *value;
            }
            for column in columns..self.padded.1 {
                let (after, before, share) = fade(column, columns, self.padded.1);
                out_row[column] = row[after] + share * (row[before] - row[after]);
            }
        }
        for row in rows..self.padded.0 {
            let (after, before, share) = fade(row, rows, self.padded.0);
            for column in 0..self.padded.1 {
                let (a, b) = (out[[after, column]], out[[before, column]]);
                out[[row, column]] = a + share * (b - a);
            }
        }
    }

    /// Weights of the rows and of the columns: 0 unless the whole of `path` before a pixel lies in the field of the still.
    pub(super) fn set_window(&self, path: &Path, weights: &mut [Vec<f32>; 2]) {
        let ends = path.ends();
        for (axis, weights) in weights.iter_mut().enumerate() {
            let size = if axis == 0 { self.picture.0 } else { self.picture.1 };
            // Rows run down, the second coordinate.
            let (a, b) = (ends[0][1 - axis], ends[1][1 - axis]);
            let first = a.max(b).max(0.0) + BORDER_PX;
            let last = size as f64 - 1.0 + a.min(b).min(0.0) - BORDER_PX;
            let taper = TAPER_PX.min(0.25 * (last - first)).max(1.0);
            for (i, weight) in weights.iter_mut().enumerate() {
                let inside = (i as f64 - first).min(last - i as f64);
                let rise = ((inside + 1.0) / (taper + 1.0)).clamp(0.0, 1.0);
                *weight = (0.5 - 0.5 * (PI * rise).cos()) as f32;
            }
        }
    }

    /// `exp(-2 pi i f shift)` for the frequencies `f` of the rows and of the columns of a half spectrum.
    pub(super) fn set_phases(&self, shift: [f64; 2], phases: &mut [Vec<Complex32>; 2]) {
        for (row, phase) in phases[0].iter_mut().enumerate() {
            *phase = turn(self.down(row) * shift[1]);
        }
        for (column, phase) in phases[1].iter_mut().enumerate() {
            *phase = turn(self.right(column) * shift[0]);
        }
    }

    /// Room for [`set_window`](Self::set_window).
    pub(super) fn window(&self) -> [Vec<f32>; 2] {
        [vec![0.0; self.picture.0], vec![0.0; self.picture.1]]
    }

    /// Room for [`set_phases`](Self::set_phases).
    pub(super) fn phases(&self) -> [Vec<Complex32>; 2] {
        [self.spectrum().0, self.spectrum().1].map(|n| vec![Complex32::default(); n])
    }
}

/// `exp(-2 pi i cycles)`.
fn turn(cycles: f64) -> Complex32 {
    let (sin, cos) = (2.0 * PI * (cycles - cycles.round())).sin_cos();
    Complex32::new(cos as f32, -sin as f32)
}

/// For the sample `i` in `inner..len` of a periodic continuation: its mirror image at the end of the inner samples, that
/// at their beginning, and the share of the latter, from 0 to 1.
fn fade(i: usize, inner: usize, len: usize) -> (usize, usize, f32) {
    let along = ((i - inner) as f64 + 0.5) / (len - inner) as f64;
    let share = along * along * along * (along * (along * 6.0 - 15.0) + 10.0);
    (reflect(i, inner), reflect(len - 1 - i, inner), share as f32)
}

/// The sample in `0..inner` seen at `i` in mirrors half a sample outside both ends; that at `-1 - i` is the same one.
fn reflect(i: usize, inner: usize) -> usize {
    let i = i % (2 * inner);
    if i < inner { i } else { 2 * inner - 1 - i }
}
