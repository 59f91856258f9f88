//! How much a picture varies around each point, direction by direction and scale by scale.

use ndarray::{Array2, ArrayView2, ArrayViewMut1};

use super::gaussian::{RowFilter, derivative, filter, gaussian};
use crate::each::each;

/// Pixels from one point of the grid to the next.
pub(super) const STEP_PX: usize = 4;
/// Standard deviations in pixels of the Gaussians whose derivatives are taken.
const SCALES_PX: [f64; SCALES] = [0.7, 1.4, 2.8, 5.6];
pub(super) const SCALES: usize = 4;
/// The scales at which opposite ends of a blur are compared.
pub(super) const CORRELATED: [usize; 2] = [1, 2];
/// Standard deviations in pixels of the Gaussian windows in which squares are averaged, and the least one relative to
/// the scale.
const WINDOWS_PX: [f64; WINDOWS] = [5.0, 12.0];
pub(super) const WINDOWS: usize = 2;
const LEAST_WINDOW: f64 = 1.5;
/// The calmest points of a picture tell its noise: those of this share.
const CALM: f64 = 0.05;
/// Least noise variance of a picture of eight bits: that of its rounding.
const ROUNDING: f64 = 1.0 / 12.0;

/// Mean squares and product of the derivatives along the columns' and rows' axes.
#[derive(Debug)]
struct Tensor {
    xx: Array2<f32>,
    xy: Array2<f32>,
    yy: Array2<f32>,
}

/// Structure tensors of a picture.
#[derive(Debug)]
pub(super) struct Texture {
    /// `tensors[scale][window]`.
    tensors: Vec<Vec<Tensor>>,
    /// Derivatives at the scales [`CORRELATED`].
    gradients: Vec<(Array2<f32>, Array2<f32>)>,
    /// Mean square of a derivative of the noise, scale by scale.
    noise: [f32; SCALES],
    noise_variance: f64,
}

/// The texture at one scale.
struct Scale {
    tensors: Vec<Tensor>,
    gradient: Option<(Array2<f32>, Array2<f32>)>,
    /// Mean square of a derivative of white noise of variance 1.
    of_white: f64,
}

impl Scale {
    /// With the derivatives themselves if they are to be kept.
    fn new(image: &Array2<f32>, sigma_px: f64, kept: bool) -> Self {
        let (smooth, slope) = (gaussian(sigma_px), derivative(sigma_px));
        let energy = |taps: &[f32]| taps.iter().map(|&tap| f64::from(tap).powi(2)).sum::<f64>();
        let (mut x, mut y) = (RowFilter::new(image, &slope, &smooth), RowFilter::new(image, &smooth, &slope));
        let blocks = (image.nrows() / STEP_PX, image.ncols() / STEP_PX);
        let mut products = [(); 3].map(|()| Array2::zeros(blocks));
        let mut gradient = kept.then(|| (Array2::zeros(image.dim()), Array2::zeros(image.dim())));
        for row in 0..image.nrows() {
            let (x, y) = (x.next_row(), y.next_row());
            if let Some((all_x, all_y)) = &mut gradient {
                all_x.row_mut(row).iter_mut().zip(x).for_each(|(to, &from)| *to = from);
                all_y.row_mut(row).iter_mut().zip(y).for_each(|(to, &from)| *to = from);
            }
            // Pixels beyond the last whole block count for nothing.
            if row / STEP_PX < blocks.0 {
                for (products, (a, b)) in products.iter_mut().zip([(x, x), (x, y), (y, y)]) {
                    add_to_blocks(products.row_mut(row / STEP_PX), a, b);
                }
            }
        }
        let of_window = |&window: &f64| {
            let taps = window_taps(window.max(LEAST_WINDOW * sigma_px));
            let [xx, xy, yy] = products.each_ref().map(|block| filter(block, &taps, &taps));
            Tensor { xx, xy, yy }
        };
        Self {
            tensors: WINDOWS_PX.iter().map(of_window).collect(),
            gradient,
            of_white: energy(&smooth) * energy(&slope),
        }
    }
}

impl Texture {
    /// The texture of `image`, at least [`STEP_PX`] pixels each way.
    pub(super) fn new(image: ArrayView2<'_, f32>) -> Self {
        let image = image.to_owned();
        let numbered: Vec<(usize, f64)> = SCALES_PX.into_iter().enumerate().collect();
        let scales = each(&numbered, |&(scale, sigma)| Scale::new(&image, sigma, CORRELATED.contains(&scale)));
        let of_white: Vec<f64> = scales.iter().map(|scale| scale.of_white).collect();
        let (tensors, gradients): (Vec<_>, Vec<_>) =
            scales.into_iter().map(|scale| (scale.tensors, scale.gradient)).unzip();
        let mut calm: Vec<f32> =
            tensors[0][1].xx.iter().zip(&tensors[0][1].yy).map(|(xx, yy)| 0.5 * (xx + yy)).collect();
        let place = (CALM * calm.len() as f64) as usize;
        let (_, &mut calm, _) = calm.select_nth_unstable_by(place, f32::total_cmp);
        let variance = (f64::from(calm) / of_white[0]).max(ROUNDING);
        let noise = std::array::from_fn(|scale| (of_white[scale] * variance) as f32);
        Self { tensors, gradients: gradients.into_iter().flatten().collect(), noise, noise_variance: variance }
    }

    /// Rows and columns of the grid.
    pub(super) fn dim(&self) -> (usize, usize) {
        self.tensors[0][0].xx.dim()
    }

    /// Logarithms of the mean square of the derivative along the direction `(cos, sin)` (y down) and across it, noise
    /// taken away, at one point of the grid.
    pub(super) fn log_energies(
        &self,
        (scale, window): (usize, usize),
        at: (usize, usize),
        (cos, sin): (f32, f32),
    ) -> [f32; 2] {
        let tensor = &self.tensors[scale][window];
        let (xx, xy, yy) = (tensor.xx[at], tensor.xy[at], tensor.yy[at]);
        let along = xx * cos * cos + 2.0 * xy * cos * sin + yy * sin * sin;
        let noise = self.noise[scale];
        [along, xx + yy - along].map(|energy| ((energy - noise).max(0.0) + LEFT * noise).ln())
    }

    /// Variance of the picture's noise.
    pub(super) fn noise_variance(&self) -> f64 {
        self.noise_variance
    }

    /// Derivatives of the picture along its rows and columns, smoothed by a Gaussian of 1.4 pixels.
    pub(super) fn gradient(&self) -> &(Array2<f32>, Array2<f32>) {
        &self.gradients[0]
    }

    /// Root mean square of that gradient where the picture shows nothing but noise.
    pub(super) fn gradient_noise(&self) -> f32 {
        (2.0 * self.noise[CORRELATED[0]]).sqrt()
    }

    /// Whether the picture has texture at a pixel, by row and column, that noise alone would hardly have.
    pub(super) fn is_textured(&self, (row, column): (usize, usize)) -> bool {
        let tensor = &self.tensors[0][1];
        let (rows, columns) = tensor.xx.dim();
        let at = ((row / STEP_PX).min(rows - 1), (column / STEP_PX).min(columns - 1));
        0.5 * (tensor.xx[at] + tensor.yy[at]) > TEXTURED * self.noise[0]
    }

    /// Correlations of the derivative along the direction at the two ends of a blur of `length_px`, `-1/2` where a white
    /// scene is blurred so: one map a window, for scale number `index` of [`CORRELATED`].
    pub(super) fn end_correlations(&self, index: usize, length_px: f64, (cos, sin): (f32, f32)) -> Vec<Array2<f32>> {
        let (x, y) = &self.gradients[index];
        let scale = CORRELATED[index];
        let half = 0.5 * length_px as f32;
        let (rows, columns) = self.dim();
        let (mut product, mut energy) = (Array2::zeros((rows, columns)), Array2::zeros((rows, columns)));
        let (mut begins, mut ends) = (vec![0.0; x.ncols()], vec![0.0; x.ncols()]);
        // Every second pixel each way: the derivatives are smooth.
        for pixel in (0..rows * STEP_PX).step_by(2) {
            let middle = pixel as f32 + 0.5;
            slopes_at(middle - half * sin, (x, y), (cos, sin), &mut begins);
            slopes_at(middle + half * sin, (x, y), (cos, sin), &mut ends);
            let (mut products, mut energies) = (product.row_mut(pixel / STEP_PX), energy.row_mut(pixel / STEP_PX));
            for ((block, product), energy) in products.iter_mut().enumerate().zip(&mut energies) {
                for column in [0.5, 2.5] {
                    let middle = (block * STEP_PX) as f32 + column;
                    let (p, q) = (interpolate(&begins, middle - half * cos), interpolate(&ends, middle + half * cos));
                    *product += 0.25 * p * q;
                    *energy += 0.125 * (p * p + q * q);
                }
            }
        }
        let of_window = |&window: &f64| {
            let taps = window_taps(window.max(LEAST_WINDOW * SCALES_PX[scale]));
            let mut correlation = filter(&product, &taps, &taps);
            let energy = filter(&energy, &taps, &taps);
            correlation.zip_mut_with(&energy, |c, e| *c /= e + self.noise[scale]);
            correlation
        };
        WINDOWS_PX.iter().map(of_window).collect()
    }
}

/// Share of the noise that is left under an energy, so that its logarithm is finite.
const LEFT: f32 = 0.3;
/// Energy that shows texture, relative to noise.
const TEXTURED: f32 = 1.5;

/// Taps on the grid of a Gaussian window, whose points are means over blocks already.
fn window_taps(sigma_px: f64) -> Vec<f32> {
    let block = (STEP_PX * STEP_PX - 1) as f64 / 12.0;
    gaussian((sigma_px * sigma_px - block).sqrt() / STEP_PX as f64)
}

/// Adds the share of one row in the means of `a b` over the blocks that it goes through.
fn add_to_blocks(means: ArrayViewMut1<'_, f32>, a: &[f32], b: &[f32]) {
    const SHARE: f32 = 1.0 / (STEP_PX * STEP_PX) as f32;
    let (a, b) = (a.as_chunks::<STEP_PX>().0, b.as_chunks::<STEP_PX>().0);
    for ((mean, a), b) in means.into_iter().zip(a).zip(b) {
        for (a, b) in a.iter().zip(b) {
            *mean += SHARE * a * b;
        }
    }
}

/// The derivative along the direction `(cos, sin)` on the line at `row`, from those along rows and columns.
fn slopes_at(row: f32, (x, y): (&Array2<f32>, &Array2<f32>), (cos, sin): (f32, f32), line: &mut [f32]) {
    let (above, share) = place(row, x.nrows());
    let rows = x.row(above).into_iter().zip(x.row(above + 1)).zip(y.row(above).into_iter().zip(y.row(above + 1)));
    for (slope, ((x, below_x), (y, below_y))) in line.iter_mut().zip(rows) {
        *slope = cos * (x + share * (below_x - x)) + sin * (y + share * (below_y - y));
    }
}

fn interpolate(line: &[f32], at: f32) -> f32 {
    let (left, share) = place(at, line.len());
    line[left] + share * (line[left + 1] - line[left])
}

/// The last but one of `count` points that is not beyond `at`, and what share of a step that is beyond it.
fn place(at: f32, count: usize) -> (usize, f32) {
    let at = at.clamp(0.0, (count - 1) as f32);
    let before = (at as usize).min(count - 2);
    (before, at - before as f32)
}
