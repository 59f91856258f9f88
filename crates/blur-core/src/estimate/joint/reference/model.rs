//! The model of the blurred picture and its derivatives, as weighted spectra.

use std::f64::consts::PI;

use ndarray::{Array2, ArrayView2};
use rustfft::num_complex::Complex32;

use super::grid::Grid;
use super::normal::{MOST, Matrix, Normal};
use super::path::{Path, TransferTable};
use crate::spectrum::{Dft2, InverseDft2};

/// What a column of the least-squares problem stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Unknown {
    /// The middle of the path, to the right.
    Right,
    /// The same, down.
    Down,
    /// The path's length.
    Length,
    /// Its angle in radians.
    Angle,
    /// The acceleration ratio.
    Ratio,
    /// The coefficient of `x^i y^j` in the gain, `x` and `y` from -1 to 1 over the picture.
    Gain(i32, i32),
    /// A constant added to the picture.
    Offset,
    /// The curvature of a vignetting that the stills share with the picture.
    Vignetting,
}

use Unknown::{Angle, Down, Gain, Length, Offset, Ratio, Right, Vignetting};

/// Unknowns of a displaced still: the displacement, then the illumination.
pub(super) const STILL: &[Unknown] =
    &[Right, Down, Gain(0, 0), Gain(1, 0), Gain(0, 1), Gain(2, 0), Gain(1, 1), Gain(0, 2), Offset];

/// Unknowns of a blurred picture far from the solution, where the illumination matters little.
pub(super) const ROUGH: &[Unknown] = &[Right, Down, Length, Angle, Ratio, Gain(0, 0), Offset];

/// Unknowns of a blurred picture: the path, then the illumination.
pub(super) const BLURRED: &[Unknown] = &[
    Right,
    Down,
    Length,
    Angle,
    Ratio,
    Gain(0, 0),
    Gain(1, 0),
    Gain(0, 1),
    Gain(2, 0),
    Gain(1, 1),
    Gain(0, 2),
    Offset,
    Vignetting,
];

/// Coefficients of a gain: those of 1, x, y, x^2, x y and y^2.
pub(super) const GAINS: usize = 6;

/// The coefficients of the gain among the values of `unknowns`.
pub(super) fn gain_of(unknowns: &[Unknown], values: &[f64]) -> [f64; GAINS] {
    const ORDER: [Unknown; GAINS] = [Gain(0, 0), Gain(1, 0), Gain(0, 1), Gain(2, 0), Gain(1, 1), Gain(0, 2)];
    ORDER
        .map(|term| unknowns.iter().zip(values).find(|(unknown, _)| **unknown == term).map_or(0.0, |(_, value)| *value))
}

/// How many of `unknowns` belong to the path; they come first.
pub(super) fn of_path(unknowns: &[Unknown]) -> usize {
    unknowns.iter().take_while(|unknown| matches!(unknown, Right | Down | Length | Angle | Ratio)).count()
}

/// Variances that the residual has, in squared grey levels a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Noise {
    /// Of the blurred picture.
    pub(super) picture: f64,
    /// Of the mean still, as it appears in the picture: times the squared gain.
    pub(super) still: f64,
}

/// Renders the columns of the least-squares problem.
#[derive(Debug)]
pub(super) struct Model {
    pub(super) grid: Grid,
    table: TransferTable,
    dft: Dft2,
    inverse: InverseDft2,
    phases: [Vec<Complex32>; 2],
    /// Spectra of the blurred still, of its first and second derivative by the cycles along the path, and by the ratio.
    blurred: Array2<Complex32>,
    slope: Array2<Complex32>,
    bend: Array2<Complex32>,
    per_ratio: Array2<Complex32>,
    /// Pixels of the blurred still, and of the one moment that the vignetting needs beside the other.
    pixels: Array2<f32>,
    moment: Array2<f32>,
    /// Weights of the rows and columns of the picture.
    window: [Vec<f32>; 2],
    /// Square root of the weight of each bin, its multiplicity included.
    root_weight: Array2<f32>,
    /// Weighted spectra of the columns, the data after them.
    columns: Vec<Array2<Complex32>>,
    data: Array2<Complex32>,
    /// Where the vignetting has its centre, in pixels to the right and down.
    optical_centre: [f64; 2],
}

impl Model {
    /// For paths of up to `most_length` pixels.
    pub(super) fn new(grid: Grid, most_length: f64, optical_centre: [f64; 2]) -> Self {
        let complex = || Array2::zeros(grid.spectrum());
        Self {
            table: TransferTable::new(most_length * std::f64::consts::FRAC_1_SQRT_2),
            dft: Dft2::new(grid.padded.0, grid.padded.1),
            inverse: InverseDft2::new(grid.padded.0, grid.padded.1),
            phases: grid.phases(),
            blurred: complex(),
            slope: complex(),
            bend: complex(),
            per_ratio: complex(),
            pixels: Array2::zeros(grid.picture),
            moment: Array2::zeros(grid.picture),
            window: grid.window(),
            root_weight: Array2::zeros(grid.spectrum()),
            columns: (0..MOST).map(|_| complex()).collect(),
            data: complex(),
            optical_centre,
            grid,
        }
    }

    /// Lays the window of `path` over `picture` and weights the spectra by the inverse of the power of `noise`; the part
    /// of it that comes from the still shows through the transfer function of `path`. `trust` is the Wiener filter of the
    /// still. Frequencies much above `band` cycles per pixel count little.
    pub(super) fn set_data(
        &mut self,
        picture: ArrayView2<'_, f32>,
        path: &Path,
        noise: Noise,
        trust: &Array2<f32>,
        band: f64,
    ) {
        self.grid.set_window(path, &mut self.window);
        let total = (self.grid.padded.0 * self.grid.padded.1) as f64;
        self.set_transfer(path);
        let direction = path.direction();
        for ((row, column), weight) in self.root_weight.indexed_iter_mut() {
            let (u, v) = (self.grid.right(column), self.grid.down(row));
            let transfer = self.table.at((path.length * dot_product(direction, u, v)).abs()).value.norm_sqr();
            let power = noise.picture + noise.still * f64::from(transfer * trust[[row, column]]);
            let low_pass = (-(u * u + v * v) / (band * band)).exp();
            *weight = (self.grid.multiplicity(column) * low_pass / (power * total)).sqrt() as f32;
        }
        windowed(picture, &self.window, |_, _| 1.0, self.dft.input());
        weighted(self.dft.transform(), &self.root_weight, &mut self.data);
    }

    /// Effective number of pixels: the sum of the squared window.
    pub(super) fn pixels(&self) -> f64 {
        let squares = |weights: &[f32]| weights.iter().map(|&w| f64::from(w).powi(2)).sum::<f64>();
        squares(&self.window[0]) * squares(&self.window[1])
    }

    fn set_transfer(&mut self, path: &Path) {
        let direction = path.direction();
        self.table.set(path.ratio, path.length * 0.5 * (direction[0].abs() + direction[1].abs()));
    }

    /// Renders the columns of `unknowns` for the blurred `still` (its half spectrum) and returns their products.
    /// `gain` are the coefficients of the gain that the derivatives by the path are taken at.
    pub(super) fn products(
        &mut self,
        still: &Array2<Complex32>,
        path: &Path,
        unknowns: &[Unknown],
        gain: &[f64; GAINS],
    ) -> Normal {
        self.blur(still, path);
        for (index, &unknown) in unknowns.iter().enumerate() {
            self.render(path, unknown, gain);
            weighted(self.dft.transform(), &self.root_weight, &mut self.columns[index]);
        }
        products(&self.columns[..unknowns.len()], &self.data)
    }

    /// Fills the spectra of the blurred still and its pixels.
    fn blur(&mut self, still: &Array2<Complex32>, path: &Path) {
        self.set_transfer(path);
        self.grid.set_phases(path.centre, &mut self.phases);
        let direction = path.direction();
        let (nyquist_row, nyquist_column) = (self.grid.padded.0 / 2, self.grid.padded.1 / 2);
        for row in 0..still.nrows() {
            let v = self.grid.down(row);
            for column in 0..still.ncols() {
                let cycles = path.length * dot_product(direction, self.grid.right(column), v);
                let mut at = self.table.at(cycles.abs());
                if cycles < 0.0 {
                    (at.value, at.slope) = (at.value.conj(), -at.slope.conj());
                    (at.bend, at.per_ratio) = (at.bend.conj(), at.per_ratio.conj());
                }
                // The bins at half a cycle have no sign, so no displacement can be seen in them.
                let is_nyquist = row == nyquist_row || column == nyquist_column;
                let moved = if is_nyquist {
                    Complex32::default()
                } else {
                    still[[row, column]] * self.phases[0][row] * self.phases[1][column]
                };
                let bin = [row, column];
                self.blurred[bin] = moved * at.value;
                self.slope[bin] = moved * at.slope;
                self.bend[bin] = moved * at.bend;
                self.per_ratio[bin] = moved * at.per_ratio;
            }
        }
        self.inverse.input().assign(&self.blurred);
        copy_corner(self.inverse.transform(), &mut self.pixels);
    }

    /// Puts the windowed column of `unknown` into the input of the transform.
    fn render(&mut self, path: &Path, unknown: Unknown, gain: &[f64; GAINS]) {
        let [right, down] = path.direction();
        // The derivative of the direction by the angle.
        let turned = [down, -right];
        let turn = |frequency: f64| Complex32::new(0.0, (-2.0 * PI * frequency) as f32);
        match unknown {
            Gain(i, j) => {
                windowed(self.pixels.view(), &self.window, |x, y| x.powi(i) * y.powi(j), self.dft.input());
                return;
            }
            Offset => {
                constant(&self.window, self.dft.input());
                return;
            }
            Vignetting => {
                self.render_vignetting(path);
                return;
            }
            Right => self.fill(|model, bin, u, _| model.blurred[bin] * turn(u)),
            Down => self.fill(|model, bin, _, v| model.blurred[bin] * turn(v)),
            Length => self.fill(|model, bin, u, v| model.slope[bin] * dot_product([right, down], u, v) as f32),
            Angle => self.fill(|model, bin, u, v| model.slope[bin] * (path.length * dot_product(turned, u, v)) as f32),
            Ratio => self.fill(|model, bin, _, _| model.per_ratio[bin]),
        }
        windowed(self.inverse.transform(), &self.window, |x, y| gain_at(gain, x, y), self.dft.input());
    }

    /// The part of a vignetting `1 - k rho^2` that the gain cannot take up because it does not commute with the blur:
    /// `h * (rho^2 I) - rho^2 (h * I)` is a sum of moments of the path about its middle `c`,
    /// `-2 ((x - c) . d) (s h) * I + (s^2 h) * I`, and of terms of the gain. In units of the picture's half diagonal.
    fn render_vignetting(&mut self, path: &Path) {
        let first = path.length / (2.0 * PI);
        self.fill(|model, bin, _, _| model.slope[bin] * Complex32::new(0.0, first as f32));
        copy_corner(self.inverse.transform(), &mut self.moment);
        self.fill(|model, bin, _, _| model.bend[bin] * (-first * first) as f32);
        let second = self.inverse.transform();
        let direction = path.direction();
        let middle: f64 = (0..2).map(|i| (self.optical_centre[i] + path.centre[i]) * direction[i]).sum();
        let (rows, columns) = self.grid.picture;
        let scale = 4.0 / ((rows * rows + columns * columns) as f64);
        let out = self.dft.input();
        out.fill(0.0);
        for (row, &row_weight) in self.window[0].iter().enumerate() {
            for (column, &weight) in self.window[1].iter().enumerate() {
                let at = column as f64 * direction[0] + row as f64 * direction[1] - middle;
                let value = second[[row, column]] - 2.0 * at as f32 * self.moment[[row, column]];
                out[[row, column]] = row_weight * weight * scale as f32 * value;
            }
        }
    }

    /// Fills the input of the inverse transform.
    fn fill(&mut self, value: impl Fn(&Self, [usize; 2], f64, f64) -> Complex32) {
        for row in 0..self.grid.padded.0 {
            let v = self.grid.down(row);
            for column in 0..=self.grid.padded.1 / 2 {
                let bin = [row, column];
                let value = value(self, bin, self.grid.right(column), v);
                self.inverse.input()[bin] = value;
            }
        }
    }

    /// The weighted spectrum of what is left of the data with the unknowns at `values`, bin by bin.
    pub(super) fn residual(&self, values: &[f64], mut each: impl FnMut([usize; 2], f64)) {
        for ((row, column), &data) in self.data.indexed_iter() {
            let mut rest = data;
            for (spectrum, &value) in self.columns.iter().zip(values) {
                rest -= spectrum[[row, column]] * value as f32;
            }
            each([row, column], f64::from(rest.norm_sqr()));
        }
    }

    /// The noise power that the weight of a bin stands for, in squared grey levels a pixel.
    pub(super) fn noise_power(&self, bin: [usize; 2]) -> f64 {
        let total = (self.grid.padded.0 * self.grid.padded.1) as f64;
        self.grid.multiplicity(bin[1]) / (f64::from(self.root_weight[bin]).powi(2) * total)
    }

    /// The variance of the score `sum J* w R` of `unknowns` columns for noise of the power that the weights stand for. The
    /// window lies between the noise and the weights, so it is not the products of the columns: see `sandwich`.
    pub(super) fn score_variance(&mut self, unknowns: usize) -> Matrix {
        let total = (self.grid.padded.0 * self.grid.padded.1) as f32;
        for index in 0..unknowns {
            for ((row, column), value) in self.inverse.input().indexed_iter_mut() {
                let multiplicity = self.grid.multiplicity(column) as f32;
                *value = self.columns[index][[row, column]] * (self.root_weight[[row, column]] * total / multiplicity);
            }
            let filtered = self.inverse.transform();
            windowed(filtered, &self.window, |_, _| 1.0, self.dft.input());
            let spectrum = self.dft.transform();
            for ((row, column), out) in self.columns[index].indexed_iter_mut() {
                let multiplicity = self.grid.multiplicity(column) as f32;
                // The root of the noise power, spread over the bins.
                let root_power = multiplicity / (total * self.root_weight[[row, column]]);
                *out = spectrum[[row, column]] * root_power;
            }
        }
        products(&self.columns[..unknowns], &self.data).of_unknowns()
    }
}

/// The frequency `(u, v)` along a direction.
fn dot_product(direction: [f64; 2], u: f64, v: f64) -> f64 {
    u * direction[0] + v * direction[1]
}

/// The gain at `x` and `y`, from its coefficients in the order of the unknowns.
fn gain_at(gain: &[f64; GAINS], x: f32, y: f32) -> f32 {
    let [one, of_x, of_y, of_xx, of_xy, of_yy] = gain.map(|c| c as f32);
    one + x * (of_x + x * of_xx + y * of_xy) + y * (of_y + y * of_yy)
}

/// Writes `picture` times the window times `factor(x, y)` into the corner of `out`, and 0 elsewhere.
fn windowed(
    picture: ArrayView2<'_, f32>,
    window: &[Vec<f32>; 2],
    factor: impl Fn(f32, f32) -> f32,
    out: &mut Array2<f32>,
) {
    let (rows, columns) = (window[0].len(), window[1].len());
    let unit = |i: usize, n: usize| (2.0 * i as f32 + 1.0) / n as f32 - 1.0;
    out.fill(0.0);
    for row in 0..rows {
        let y = unit(row, rows);
        let row_weight = window[0][row];
        if row_weight == 0.0 {
            continue;
        }
        for column in 0..columns {
            let weight = row_weight * window[1][column];
            out[[row, column]] = weight * factor(unit(column, columns), y) * picture[[row, column]];
        }
    }
}

fn constant(window: &[Vec<f32>; 2], out: &mut Array2<f32>) {
    out.fill(0.0);
    for (row, &row_weight) in window[0].iter().enumerate() {
        for (column, &weight) in window[1].iter().enumerate() {
            out[[row, column]] = row_weight * weight;
        }
    }
}

fn weighted(spectrum: ArrayView2<'_, Complex32>, weights: &Array2<f32>, out: &mut Array2<Complex32>) {
    for ((out, value), &weight) in out.iter_mut().zip(spectrum).zip(weights) {
        *out = *value * weight;
    }
}

fn copy_corner(padded: ArrayView2<'_, f32>, out: &mut Array2<f32>) {
    for (mut out_row, row) in out.rows_mut().into_iter().zip(padded.rows()) {
        for (out, value) in out_row.iter_mut().zip(row) {
            *out = *value;
        }
    }
}

/// Inner products of weighted half spectra.
fn products(columns: &[Array2<Complex32>], data: &Array2<Complex32>) -> Normal {
    let n = columns.len();
    let mut normal = Normal::new(n);
    let spectrum = |i: usize| if i < n { &columns[i] } else { data };
    for row in 0..data.nrows() {
        for i in 0..=n {
            for j in 0..=i {
                let (a, b) = (spectrum(i).row(row), spectrum(j).row(row));
                if let (Some(a), Some(b)) = (a.to_slice(), b.to_slice()) {
                    normal.products[i][j] += dot(a, b);
                }
            }
        }
    }
    for i in 0..=n {
        for j in 0..i {
            normal.products[j][i] = normal.products[i][j];
        }
    }
    normal
}

/// The real part of the inner product of two rows.
fn dot(a: &[Complex32], b: &[Complex32]) -> f64 {
    // Eight sums side by side: the compiler may not reorder floating-point additions by itself.
    const LANES: usize = 8;
    let mut sums = [0.0_f32; LANES];
    let (a_chunks, b_chunks) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest: f32 = a_chunks.remainder().iter().zip(b_chunks.remainder()).map(|(a, b)| a.re * b.re + a.im * b.im).sum();
    for (a, b) in a_chunks.zip(b_chunks) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a.re * b.re + a.im * b.im;
        }
    }
    f64::from(sums.iter().sum::<f32>() + rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step of one of the path's parameters.
    type Step = (f64, fn(&mut Path, f64));

    /// Columns of the model, one after the other, with equal weights.
    fn columns(path: &Path, unknowns: &[Unknown]) -> Vec<Array2<Complex32>> {
        let grid = Grid::new((64, 80));
        let mut model = Model::new(grid, 40.0, [39.5, 31.5]);
        let picture = Array2::from_shape_fn(grid.picture, |(y, x)| ((y * 31 + x * 57 + y * x) % 101) as f32);
        let mut dft = Dft2::new(grid.padded.0, grid.padded.1);
        grid.fill(picture.view(), dft.input());
        let still = dft.transform().to_owned();
        let noise = Noise { picture: 1.0, still: 0.0 };
        let trust = Array2::zeros(grid.spectrum());
        let window = Path { centre: [4.0, -2.0], length: 12.0, angle: 0.5, ratio: 0.3 };
        model.set_data(picture.view(), &window, noise, &trust, 100.0);
        model.products(&still, path, unknowns, &[0.9, 0.1, -0.05, 0.02, 0.03, -0.04]);
        model.columns[..unknowns.len()].to_vec()
    }

    /// The blurred still under a gain.
    fn blurred(path: &Path) -> Array2<Complex32> {
        let gains = [Gain(0, 0), Gain(1, 0), Gain(0, 1), Gain(2, 0), Gain(1, 1), Gain(0, 2)];
        let parts = columns(path, &gains);
        let mut sum = Array2::zeros(parts[0].dim());
        for (part, gain) in parts.iter().zip([0.9_f32, 0.1, -0.05, 0.02, 0.03, -0.04]) {
            sum.scaled_add(gain.into(), part);
        }
        sum
    }

    #[test]
    fn the_columns_of_the_path_are_derivatives() {
        let path = Path { centre: [4.2, -2.3], length: 12.0, angle: 0.5, ratio: 0.3 };
        let found = columns(&path, &[Right, Down, Length, Angle, Ratio]);
        let steps: [Step; 5] = [
            (0.02, |path, step| path.centre[0] += step),
            (0.02, |path, step| path.centre[1] += step),
            (0.02, |path, step| path.length += step),
            (0.002, |path, step| path.angle += step),
            (0.01, |path, step| path.ratio += step),
        ];
        for (column, (step, change)) in found.iter().zip(steps) {
            let at = |sign: f64| {
                let mut changed = path;
                change(&mut changed, sign * step);
                blurred(&changed)
            };
            let difference = (at(1.0) - at(-1.0)).mapv(|value| value / (2.0 * step as f32));
            let size: f32 = column.iter().map(Complex32::norm_sqr).sum();
            let error: f32 = column.iter().zip(&difference).map(|(a, b)| (a - b).norm_sqr()).sum();
            // Central differences are off by the square of the step, single precision by less.
            assert!(error < 1e-4 * size, "{error} of {size}");
        }
    }

    #[test]
    fn the_vignetting_is_what_a_gain_cannot_take_up() {
        // In space: the mean over the path of rho^2 I, minus rho^2 times the mean of I, for a plane wave.
        let grid = Grid::new((64, 80));
        let path = Path { centre: [5.0, 0.0], length: 10.0, angle: 0.0, ratio: 0.0 };
        let column = vignetting_of_wave(&grid, &path);
        let (rows, columns) = grid.picture;
        let rho2 = |x: f64, y: f64| {
            4.0 * ((x - 39.5).powi(2) + (y - 31.5).powi(2)) / ((rows * rows + columns * columns) as f64)
        };
        let scale = 4.0 / ((rows * rows + columns * columns) as f64);
        for (x, y) in [(40, 30), (50, 20), (30, 40)] {
            let (x_f, y_f) = (f64::from(x), f64::from(y));
            let mut expected = 0.0;
            let mut mean = 0.0;
            for i in 0..1000 {
                let shift = (f64::from(i) + 0.5) / 100.0;
                expected += rho2(x_f - shift, y_f) * wave(x_f - shift) / 1000.0;
                mean += wave(x_f - shift) / 1000.0;
            }
            // About the middle of the path, c = 5: |x - xi|^2 = |x - c|^2 - 2 (x - c) s + s^2.
            expected -= rho2(x_f - 5.0, y_f) * mean;
            let found = f64::from(column[[y as usize, x as usize]]);
            assert!((found - expected).abs() < 0.01 * 100.0 * scale * 25.0, "{x} {y}: {found} for {expected}");
        }
    }

    fn wave(x: f64) -> f64 {
        100.0 * (0.2 * x).sin()
    }

    /// The vignetting's column in pixels, for waves along x and a window of 1 in the middle.
    fn vignetting_of_wave(grid: &Grid, path: &Path) -> Array2<f32> {
        let mut model = Model::new(*grid, 40.0, [39.5, 31.5]);
        let picture = Array2::from_shape_fn(grid.picture, |(_, x)| wave(x as f64) as f32);
        let mut dft = Dft2::new(grid.padded.0, grid.padded.1);
        grid.fill(picture.view(), dft.input());
        let still = dft.transform().to_owned();
        for weights in &mut model.window {
            weights.fill(1.0);
        }
        model.blur(&still, path);
        model.render_vignetting(path);
        model.dft.input().clone()
    }
}
