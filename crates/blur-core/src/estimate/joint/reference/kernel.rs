//! The kernel between two pictures, seen in space, and the path read from it: where the search starts.

use std::f64::consts::PI;

use ndarray::{Array2, ArrayView2};
use rustfft::num_complex::Complex32;

use super::grid::Grid;
use super::path::Path;
use super::power::mean_power;
use crate::image::{Taper, Window};
use crate::spectrum::{Dft2, InverseDft2};

/// Share of the mean power around a bin that is added to its own power: where the still has little to say, the kernel is
/// not asked. What moves in and out at the borders disturbs the kernel in the same proportion.
const REGULAR: f32 = 0.1;
/// Directions that a line is sought in, over half a turn.
const DIRECTIONS: usize = 360;
/// Cells on either side of a line that belong to it.
const HALF_WIDTH: isize = 1;
/// Displacements are sought on a square of about twice this many cells each way; a cell of a large one is several pixels.
const CELLS: usize = 180;

/// Deconvolves a picture by a still.
#[derive(Debug)]
pub(super) struct Kernel {
    grid: Grid,
    taper: Taper,
    dft: Dft2,
    inverse: InverseDft2,
    tapered: Array2<f32>,
    /// Tapered spectrum of the still, and the mean power around each bin of it.
    still: Array2<Complex32>,
    level: Array2<f32>,
    /// The kernel around its origin, `reach` cells each way.
    square: Array2<f32>,
    reach: isize,
    /// Side of a cell in pixels.
    cell: usize,
    /// Sums along parallel lines, then along one of them.
    profile: Vec<f64>,
}

impl Kernel {
    /// For displacements of up to `reach` pixels.
    pub(super) fn new(grid: Grid, reach: usize) -> Self {
        let (rows, columns) = grid.padded;
        let reach = reach.min(rows.min(columns) / 2 - 1);
        let cell = reach.div_ceil(CELLS).max(1);
        let reach = reach / cell;
        Self {
            grid,
            taper: Taper::new(Window::Tukey { taper: 0.25 }, grid.picture.0, grid.picture.1),
            dft: Dft2::new(rows, columns),
            inverse: InverseDft2::new(rows, columns),
            tapered: Array2::zeros(grid.picture),
            still: Array2::zeros(grid.spectrum()),
            level: Array2::zeros(grid.spectrum()),
            square: Array2::zeros((2 * reach + 1, 2 * reach + 1)),
            reach: reach as isize,
            cell,
            profile: vec![0.0; 4 * reach + 8],
        }
    }

    /// Takes the sharp picture that the kernel starts from.
    pub(super) fn set_still(&mut self, picture: ArrayView2<'_, f32>) {
        self.transform(picture);
        self.still.assign(&self.dft.transform());
        mean_power(&self.grid, &self.still, &mut self.level);
    }

    /// Computes the kernel that turns the still into `picture`.
    pub(super) fn set(&mut self, picture: ArrayView2<'_, f32>) {
        self.transform(picture);
        let spectrum = self.dft.transform();
        for (((out, value), still), level) in
            self.inverse.input().iter_mut().zip(spectrum).zip(&self.still).zip(&self.level)
        {
            let power = still.norm_sqr() + REGULAR * level;
            *out = if power > 0.0 { value * still.conj() / power } else { Complex32::default() };
        }
        let (rows, columns) = self.grid.padded;
        let kernel = self.inverse.transform();
        let cell = self.cell as isize;
        let first = -self.reach * cell - (cell - 1) / 2;
        self.square.fill(0.0);
        for row in 0..self.square.nrows() as isize * cell {
            let down = (first + row).rem_euclid(rows as isize) as usize;
            for column in 0..self.square.ncols() as isize * cell {
                let right = (first + column).rem_euclid(columns as isize) as usize;
                self.square[[(row / cell) as usize, (column / cell) as usize]] += kernel[[down, right]];
            }
        }
    }

    /// Side in pixels of the cells that the kernel is seen in: how far off a segment's ends may be.
    pub(super) fn cell_px(&self) -> f64 {
        self.cell as f64
    }

    /// Puts the tapered picture, without its mean, into the input of the transform.
    fn transform(&mut self, picture: ArrayView2<'_, f32>) {
        self.taper.apply(picture, &mut self.tapered);
        let input = self.dft.input();
        input.fill(0.0);
        for (row, mut out) in self.tapered.rows().into_iter().zip(input.rows_mut()) {
            for (value, out) in row.iter().zip(&mut out) {
                *out = *value;
            }
        }
    }

    /// Place of the highest value, to the cell, in pixels: right, down.
    pub(super) fn peak(&self) -> [f64; 2] {
        let mut best = (f32::NEG_INFINITY, [0.0; 2]);
        for ((row, column), &value) in self.square.indexed_iter() {
            if value > best.0 {
                best = (value, [column, row].map(|i| (i as isize - self.reach) as f64 * self.cell_px()));
            }
        }
        best.1
    }

    /// The straight segment that holds most of the kernel.
    pub(super) fn segment(&mut self) -> Path {
        let mut best = (f64::NEG_INFINITY, 0.0, 0.0);
        for index in 0..DIRECTIONS {
            let angle = PI * index as f64 / DIRECTIONS as f64;
            let (sum, offset) = self.brightest_line(angle);
            if sum > best.0 {
                best = (sum, angle, offset);
            }
        }
        let (_, angle, offset) = best;
        let (sin, cos) = angle.sin_cos();
        self.profile_along(angle, offset);
        let (from, to, mean) = longest_box(&self.profile);
        let middle = 0.5 * (from + to) as f64 - self.middle() - 0.5;
        let length = (to - from) as f64;
        // A path of ratio r has its centre of mass r / 6 of its length before its middle.
        let ratio = (-6.0 * (mean - 0.5 * (from + to - 1) as f64) / length).clamp(-0.8, 0.8);
        // Along the line, and across it to its right as seen.
        let centre = [middle * cos + offset * sin, -middle * sin + offset * cos].map(|cells| cells * self.cell_px());
        Path { centre, length: length * self.cell_px(), angle, ratio }
    }

    fn middle(&self) -> f64 {
        (self.profile.len() / 2) as f64
    }

    /// The greatest sum along a line of direction `angle`, and the line's distance from the origin.
    fn brightest_line(&mut self, angle: f64) -> (f64, f64) {
        let (sin, cos) = (angle.sin() as f32, angle.cos() as f32);
        self.profile.fill(0.0);
        let middle = self.middle() as f32;
        let reach = self.reach as f32;
        for (row, values) in self.square.rows().into_iter().enumerate() {
            let down = row as f32 - reach;
            let width = (reach * reach - down * down).max(0.0).sqrt() as usize;
            let first = self.reach as usize - width;
            for (column, &value) in values.iter().enumerate().skip(first).take(2 * width + 1) {
                let right = column as f32 - reach;
                let place = right * sin + down * cos + middle;
                let share = place - place.floor();
                self.profile[place as usize] += f64::from(value * (1.0 - share));
                self.profile[place as usize + 1] += f64::from(value * share);
            }
        }
        let mut best = (f64::NEG_INFINITY, 0.0);
        for i in 1..self.profile.len() - 1 {
            let sum: f64 = self.profile[i - 1..=i + 1].iter().sum();
            if sum > best.0 {
                best = (sum, i as f64 - self.middle());
            }
        }
        best
    }

    /// The kernel along a line, summed over its width.
    fn profile_along(&mut self, angle: f64, offset: f64) {
        let (sin, cos) = angle.sin_cos();
        let middle = self.middle();
        let reach = self.reach as f64;
        for (i, out) in self.profile.iter_mut().enumerate() {
            let at = i as f64 - middle;
            *out = 0.0;
            for aside in -HALF_WIDTH..=HALF_WIDTH {
                let across = offset + aside as f64;
                let (right, down) = (at * cos + across * sin + reach, -at * sin + across * cos + reach);
                *out += bilinear(&self.square, down, right);
            }
        }
    }
}

/// Interpolates between pixels; 0 outside.
fn bilinear(picture: &Array2<f32>, row: f64, column: f64) -> f64 {
    let (top, left) = (row.floor(), column.floor());
    let at = |r: f64, c: f64| {
        let inside = r >= 0.0 && c >= 0.0 && r < picture.nrows() as f64 && c < picture.ncols() as f64;
        if inside { f64::from(picture[[r as usize, c as usize]]) } else { 0.0 }
    };
    let (y, x) = (row - top, column - left);
    (1.0 - y) * ((1.0 - x) * at(top, left) + x * at(top, left + 1.0))
        + y * ((1.0 - x) * at(top + 1.0, left) + x * at(top + 1.0, left + 1.0))
}

/// The box `from..to` that fits `profile` best in the least-squares sense, and the mean place of what it holds.
fn longest_box(profile: &[f64]) -> (usize, usize, f64) {
    let mut best = (f64::NEG_INFINITY, 0, 1);
    for from in 0..profile.len() {
        let mut sum = 0.0;
        for to in from + 1..=profile.len() {
            sum += profile[to - 1];
            let gain = if sum > 0.0 { sum * sum / (to - from) as f64 } else { 0.0 };
            if gain > best.0 {
                best = (gain, from, to);
            }
        }
    }
    let (_, from, to) = best;
    let sum: f64 = profile[from..to].iter().sum();
    let moment: f64 = (from..to).map(|i| i as f64 * profile[i]).sum();
    (from, to, if sum > 0.0 { moment / sum } else { 0.5 * (from + to - 1) as f64 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_segment_is_read_off_to_a_cell_or_two() {
        for deg in [0.0_f64, 30.0, 90.0, 141.0] {
            let mut kernel = Kernel::new(Grid::new((200, 200)), 100);
            let (sin, cos) = deg.to_radians().sin_cos();
            let reach = kernel.reach as f64;
            // Forty pixels from (10, -5), a point every tenth of a pixel, each shared by its four neighbours.
            for i in 0..400 {
                let at = (f64::from(i) + 0.5) / 10.0;
                let (right, down) = (10.0 + at * cos + reach, -5.0 - at * sin + reach);
                let (x, y) = (right - right.floor(), down - down.floor());
                for (dy, dx, share) in
                    [(0, 0, (1.0 - y) * (1.0 - x)), (0, 1, (1.0 - y) * x), (1, 0, y * (1.0 - x)), (1, 1, y * x)]
                {
                    kernel.square[[down as usize + dy, right as usize + dx]] += (share / 400.0) as f32;
                }
            }
            let found = kernel.segment();
            let (middle_right, middle_down) = (10.0 + 20.0 * cos, -5.0 - 20.0 * sin);
            assert!((found.length - 40.0).abs() < 3.0, "{deg}: {found:?}");
            assert!((found.centre[0] - middle_right).hypot(found.centre[1] - middle_down) < 2.0, "{deg}: {found:?}");
            let turned = (found.angle.to_degrees() - deg + 90.0).rem_euclid(180.0) - 90.0;
            assert!(turned.abs() < 2.0 && found.ratio.abs() < 0.3, "{deg}: {found:?}");
        }
    }
}
