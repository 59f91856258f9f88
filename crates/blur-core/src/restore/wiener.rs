//! Wiener's filter, with the picture continued beyond its border as the filter expects it.

use ndarray::{Array2, ArrayView2};
use rustfft::num_complex::Complex32;

use super::LineBlur;
use super::canvas::Canvas;
use super::power::Power;

/// The filter `conj(H) S / (|H|^2 S + N)` for one blur, and the transforms that apply it.
#[derive(Debug)]
pub(super) struct Wiener {
    canvas: Canvas,
    /// Transfer function `H` of the blur.
    transfer: Array2<Complex32>,
    /// `S / N`, the power of the scene over that of everything that the blur does not explain.
    ratio: Array2<f32>,
    margin: Margin,
}

/// Vectors of the conjugate gradients, one value a pixel of the margin.
#[derive(Debug)]
struct Margin {
    values: Vec<f32>,
    residual: Vec<f32>,
    direction: Vec<f32>,
    image: Vec<f32>,
}

/// Steps of the conjugate gradients, at most.
const STEPS: usize = 30;
/// The residual relative to that of the first guess at which they end: nothing more is seen inside the picture.
const RESIDUAL: f64 = 4e-3;

impl Wiener {
    /// For pictures of `dim` rows and columns.
    pub(super) fn new(dim: (usize, usize), blur: &LineBlur) -> Self {
        let canvas = Canvas::new(dim, blur.extent_px());
        let (rows, columns) = canvas.layout().whole;
        let mut transfer = Array2::zeros((rows, columns / 2 + 1));
        for (out, (u, v)) in transfer.iter_mut().zip(canvas.frequencies()) {
            let value = blur.transfer(u, v);
            *out = Complex32::new(value.re as f32, value.im as f32);
        }
        let zeros = || vec![0.0; canvas.layout().margin_len()];
        let margin = Margin { values: zeros(), residual: zeros(), direction: zeros(), image: zeros() };
        Self { ratio: Array2::zeros(transfer.dim()), transfer, canvas, margin }
    }

    /// Takes the strength of scene and noise from `power`.
    pub(super) fn set(&mut self, power: &Power) {
        let (rows, columns) = self.canvas.layout().picture;
        let least = 0.5 / rows.max(columns) as f64;
        for (out, (u, v)) in self.ratio.iter_mut().zip(self.canvas.frequencies()) {
            *out = power.scene_over_rest(u, v, least) as f32;
        }
    }

    /// The scene of a picture of the size given, less `level`, which should be about its mean, with its margin: a periodic
    /// whole with the picture in its top left corner. After that the [`observed`](Self::observed) whole is known too.
    pub(super) fn restore(&mut self, picture: ArrayView2<'_, f32>, level: f32) -> ArrayView2<'_, f32> {
        self.fill_margin(picture, level);
        self.lay_observed(picture, level);
        let (transfer, ratio) = (flat(&self.transfer), flat(&self.ratio));
        self.canvas.filter(|i, bin| {
            let (h, ratio) = (transfer[i], ratio[i]);
            bin * h.conj() * (ratio / (1.0 + h.norm_sqr() * ratio))
        })
    }

    /// Lays the picture with the margin that was found for it on the input of the canvas.
    pub(super) fn lay_observed(&mut self, picture: ArrayView2<'_, f32>, level: f32) {
        self.canvas.lay(picture, level);
        self.canvas.layout().write_margin(self.canvas.input(), &self.margin.values);
    }

    /// Mean square of what this filter leaves unexplained of the whole on the input of the canvas, which is destroyed, and what
    /// it would be in the mean of white noise with variance 1.
    pub(super) fn residual(&mut self) -> (f64, f64) {
        let (rows, columns) = self.canvas.layout().whole;
        let seen = self.canvas.spectrum();
        let (mut left, mut white) = (0.0, 0.0);
        for ((bins, transfer), ratio) in seen.rows().into_iter().zip(self.transfer.rows()).zip(self.ratio.rows()) {
            let last = bins.len() - 1;
            for (column, ((bin, h), &ratio)) in bins.iter().zip(transfer).zip(ratio).enumerate() {
                // The other half of the spectrum is alike.
                let count = if column == 0 || (column == last && columns.is_multiple_of(2)) { 1.0 } else { 2.0 };
                let rest = 1.0 / (1.0 + h.norm_sqr() * ratio);
                left += f64::from(count * rest * rest * bin.norm_sqr());
                white += f64::from(count * rest);
            }
        }
        let size = rows as f64 * columns as f64;
        (left / (size * size), white / size)
    }

    /// The canvas, the transfer function on it, and the power of the scene over that of all else.
    pub(super) fn parts(&mut self) -> (&mut Canvas, &Array2<Complex32>, &Array2<f32>) {
        (&mut self.canvas, &self.transfer, &self.ratio)
    }

    /// Finds the margin that is most probable given the picture.
    ///
    /// `A q`, with `A = H F` and `F` the filter, is the blurred scene behind a whole `q`. A margin that is that of `A q`
    /// continues the scene; it solves the symmetric positive definite system `(1 - A_mm) q_m = A_mo q_o`, `m` the margin
    /// and `o` the picture. A plain iteration of it is the fixed point of EM, which needs some hundred steps.
    pub(super) fn fill_margin(&mut self, picture: ArrayView2<'_, f32>, level: f32) {
        let Self { canvas, transfer, ratio, margin: Margin { values, residual, direction, image } } = self;
        let (transfer, ratio) = (flat(transfer), flat(ratio));
        let seen = |i: usize, bin: Complex32| {
            let signal = transfer[i].norm_sqr() * ratio[i];
            bin * (signal / (1.0 + signal))
        };
        let layout = canvas.layout();
        canvas.lay(picture, level);
        canvas.reflect();
        layout.read_margin(canvas.input().view(), values);
        layout.read_margin(canvas.filter(seen), residual);
        for (residual, &value) in residual.iter_mut().zip(&*values) {
            *residual -= value;
        }
        direction.copy_from_slice(residual);
        let first = dot(residual, residual);
        let mut square = first;
        for _ in 0..STEPS {
            if square <= RESIDUAL * RESIDUAL * first || square <= 0.0 {
                break;
            }
            canvas.input().fill(0.0);
            layout.write_margin(canvas.input(), direction);
            layout.read_margin(canvas.filter(seen), image);
            for (image, &direction) in image.iter_mut().zip(&*direction) {
                *image = direction - *image;
            }
            let step = (square / dot(direction, image)) as f32;
            if !step.is_finite() {
                break;
            }
            add(values, step, direction);
            add(residual, -step, image);
            let next = dot(residual, residual);
            let share = (next / square) as f32;
            for (direction, &residual) in direction.iter_mut().zip(&*residual) {
                *direction = residual + share * *direction;
            }
            square = next;
        }
    }
}

/// The values of an array in standard layout, as all of a canvas are.
pub(super) fn flat<T>(array: &Array2<T>) -> &[T] {
    array.as_slice().unwrap_or_default()
}

fn dot(a: &[f32], b: &[f32]) -> f64 {
    a.iter().zip(b).map(|(&a, &b)| f64::from(a) * f64::from(b)).sum()
}

/// Adds `factor * what` to the front of `to`, or as far as that goes.
pub(super) fn add(to: &mut [f32], factor: f32, what: &[f32]) {
    for (to, &what) in to.iter_mut().zip(what) {
        *to += factor * what;
    }
}
