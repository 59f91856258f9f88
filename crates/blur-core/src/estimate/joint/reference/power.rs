//! The smooth power spectrum of a still.

use ndarray::Array2;
use rustfft::num_complex::Complex32;

use super::grid::Grid;

/// Bins on either side over which powers are averaged.
const REACH: usize = 4;

/// Writes the mean power of a half spectrum around each of its bins into `mean`.
pub(super) fn mean_power(grid: &Grid, spectrum: &Array2<Complex32>, mean: &mut Array2<f32>) {
    let (rows, columns) = spectrum.dim();
    let width = grid.padded.1;
    let share = 1.0 / ((2 * REACH + 1) * (2 * REACH + 1)) as f32;
    // Along a row the missing half is the mirror image through the origin.
    let power = |row: usize, column: usize| {
        let column = column % width;
        if column < columns {
            spectrum[[row, column]].norm_sqr()
        } else {
            spectrum[[(rows - row) % rows, width - column]].norm_sqr()
        }
    };
    let along = Array2::from_shape_fn((rows, columns), |(row, column)| {
        (0..=2 * REACH).map(|k| power(row, column + k + width - REACH)).sum::<f32>()
    });
    for ((row, column), out) in mean.indexed_iter_mut() {
        let sum: f32 = (0..=2 * REACH).map(|k| along[[(row + k + rows - REACH) % rows, column]]).sum();
        *out = sum * share;
    }
}
