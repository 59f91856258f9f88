//! Rotation of a picture so that the motion lies along its rows.

use ndarray::{Array2, ArrayView2};

use super::window::{Taper, Window};
use crate::estimate::AxialAngle;

/// Turns pictures of one size so that a motion of a given angle runs along the rows (thesis algorithm 4.2, step 2).
///
/// The result has the size of the picture, or that size with rows and columns exchanged when the motion is nearer to
/// the vertical: two sizes in all, so transforms of both can be planned beforehand. Values between pixels come from
/// cubic convolution (Keys 1981, a = -1/2).
///
/// A picture that needs no turning keeps its borders: they suit a DCT, whose even extension has no step there. A turned
/// one has slanted borders, which would draw lines across the spectrum: it is tapered before and after turning.
#[derive(Debug, Clone)]
pub struct Rotation {
    plain: Taper,
    tapered: Taper,
    always: bool,
    standardised: Array2<f32>,
    /// The standardised picture with [`MARGIN`] pixels of 0 or of its border values all around.
    padded: Vec<f32>,
    /// Weights of the taper after turning, for as many rows and as many columns as the picture has.
    row_weights: Vec<f32>,
    column_weights: Vec<f32>,
    /// Weights of the four neighbours at each phase.
    kernel: Vec<[f32; 4]>,
}

/// Taper of a turned picture.
const TURNED: Window = Window::Tukey { taper: 0.25 };
/// Below this tilt against the rows or columns the picture counts as not turned: what the borders lose is less than 1 %.
const UPRIGHT_DEG: f64 = 0.5;
/// Pixels around the picture, so that the neighbours of every point can be read without a look at the borders.
const MARGIN: usize = 4;

impl Rotation {
    /// For pictures of `rows` x `columns` pixels. A `window` is laid over every picture, turned or not, instead of the
    /// choice described above.
    pub fn new(window: Option<Window>, rows: usize, columns: usize) -> Self {
        let turned = window.unwrap_or(TURNED);
        Self {
            plain: Taper::new(Window::None, rows, columns),
            tapered: Taper::new(turned, rows, columns),
            always: window.is_some(),
            standardised: Array2::zeros((rows, columns)),
            padded: vec![0.0; (rows + 2 * MARGIN) * (columns + 2 * MARGIN)],
            row_weights: turned.weights(rows),
            column_weights: turned.weights(columns),
            // Phase i holds the fractions from i to i + 1: its middle, but for the first, which keeps whole pixels.
            kernel: (0..PHASES).map(|i| keys(if i == 0 { 0.0 } else { (i as f32 + 0.5) / PHASES as f32 })).collect(),
        }
    }

    /// Rows and columns of the result for a motion of this angle.
    pub fn canvas_dim(&self, angle: AxialAngle) -> (usize, usize) {
        let (rows, columns) = self.standardised.dim();
        if is_steep(angle) { (columns, rows) } else { (rows, columns) }
    }

    /// Writes the turned picture, with mean 0 and variance 1 before its taper, into `out`, which must be of
    /// [`canvas_dim`](Self::canvas_dim).
    pub fn apply(&mut self, image: ArrayView2<'_, f32>, angle: AxialAngle, out: &mut Array2<f32>) {
        let from_axis = (angle.deg() + 45.0).rem_euclid(90.0) - 45.0;
        let upright = from_axis.abs() < UPRIGHT_DEG;
        let taper = if upright && !self.always { &self.plain } else { &self.tapered };
        taper.apply(image, &mut self.standardised);
        self.pad(upright);

        let (rows, columns) = self.standardised.dim();
        let (out_rows, out_columns) = out.dim();
        let (down_weights, along_weights) = if is_steep(angle) {
            (&self.column_weights, &self.row_weights)
        } else {
            (&self.row_weights, &self.column_weights)
        };
        // Right angles exactly: sin and cos in radians miss them by a rounding error.
        let (sin, cos) = match (from_axis == 0.0, is_steep(angle)) {
            (true, true) => (1.0, 0.0),
            (true, false) => (0.0, 1.0),
            (false, _) => angle.rad().sin_cos(),
        };
        let middle = |n: usize| (n as f64 - 1.0) / 2.0;
        let stride = columns + 2 * MARGIN;
        // Points further out than this have no neighbour in the picture: they read the margin.
        let (last_y, last_x) = (fixed((rows + MARGIN + 1) as f64), fixed((columns + MARGIN + 1) as f64));
        let first_point = fixed(2.0);
        for (r, mut out_row) in out.rows_mut().into_iter().enumerate() {
            let row_weight = if upright { 1.0 } else { down_weights[r] };
            // A row of the result is along the motion (cos, -sin) in (column, row); its rows go down along (sin, cos).
            let (down, first) = (r as f64 - middle(out_rows), -middle(out_columns));
            let mut x = fixed(first * cos + down * sin + middle(columns) + MARGIN as f64);
            let mut y = fixed(-first * sin + down * cos + middle(rows) + MARGIN as f64);
            let (dx, dy) = (fixed(cos), fixed(-sin));
            for (value, &along_weight) in out_row.iter_mut().zip(along_weights) {
                let point = sample(
                    &self.padded,
                    stride,
                    &self.kernel,
                    y.clamp(first_point, last_y),
                    x.clamp(first_point, last_x),
                );
                *value = if upright { point } else { point * (row_weight * along_weight) };
                x += dx;
                y += dy;
            }
        }
    }

    /// Fills `padded`: the border values go on around an upright picture, zeros around a turned one, which has faded to
    /// nothing there.
    fn pad(&mut self, clamp: bool) {
        let (rows, columns) = self.standardised.dim();
        let stride = columns + 2 * MARGIN;
        for (r, padded) in self.padded.chunks_exact_mut(stride).enumerate() {
            let inside = (MARGIN..MARGIN + rows).contains(&r);
            if !inside && !clamp {
                padded.fill(0.0);
                continue;
            }
            let source = self.standardised.row((r.max(MARGIN) - MARGIN).min(rows - 1));
            let border = |value: f32| if clamp { value } else { 0.0 };
            padded[..MARGIN].fill(border(source[0]));
            padded[MARGIN + columns..].fill(border(source[columns - 1]));
            for (value, &pixel) in padded[MARGIN..].iter_mut().zip(source) {
                *value = pixel;
            }
        }
    }
}

fn is_steep(angle: AxialAngle) -> bool {
    (45.0..135.0).contains(&angle.deg())
}

/// Coordinates of points are fixed-point numbers: whole pixels and [`FRACTION_BITS`] bits of fraction. Their steps along
/// a row add up without rounding, and taking them apart costs two shifts.
const FRACTION_BITS: u32 = 32;
/// Weights are tabulated at this many fractions of a pixel: a point is off by at most 1/1024 pixel.
const PHASES: usize = 512;

fn fixed(pixels: f64) -> i64 {
    (pixels * (1_i64 << FRACTION_BITS) as f64).round() as i64
}

/// Cubic convolution at row `y` and column `x` of a padded picture, both at least 1 and three neighbours from its end.
fn sample(padded: &[f32], stride: usize, kernel: &[[f32; 4]], y: i64, x: i64) -> f32 {
    let phase = |at: i64| (at >> (FRACTION_BITS - PHASES.ilog2())) as usize % PHASES;
    let (row, column) = ((y >> FRACTION_BITS) as usize, (x >> FRACTION_BITS) as usize);
    let (weights_y, weights_x) = (&kernel[phase(y)], &kernel[phase(x)]);
    let start = (row - 1) * stride + column - 1;
    let block = &padded[start..start + 3 * stride + 4];
    let mut sums = [0.0_f32; 4];
    for (i, wy) in weights_y.iter().enumerate() {
        for (sum, pixel) in sums.iter_mut().zip(&block[i * stride..i * stride + 4]) {
            *sum += wy * pixel;
        }
    }
    (sums[0] * weights_x[0] + sums[1] * weights_x[1]) + (sums[2] * weights_x[2] + sums[3] * weights_x[3])
}

/// Weights of the four neighbours at the fraction `t` in `[0, 1)` (Keys 1981, eq. 4 with a = -1/2).
fn keys(t: f32) -> [f32; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [-0.5 * t3 + t2 - 0.5 * t, 1.5 * t3 - 2.5 * t2 + 1.0, -1.5 * t3 + 2.0 * t2 + 0.5 * t, 0.5 * t3 - 0.5 * t2]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wave along `angle` with a period of 16 pixels, as seen with y up.
    fn wave(rows: usize, columns: usize, angle_deg: f64) -> Array2<f32> {
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        Array2::from_shape_fn((rows, columns), |(r, c)| {
            let (x, y) = (c as f64 - (columns as f64 - 1.0) / 2.0, r as f64 - (rows as f64 - 1.0) / 2.0);
            (std::f64::consts::TAU / 16.0 * (x * cos - y * sin)).cos() as f32
        })
    }

    #[test]
    fn a_wave_along_the_motion_runs_along_the_rows_afterwards() {
        for (rows, columns) in [(96, 96), (101, 80)] {
            for angle in [0.0, 12.0, 45.0, 90.0, 118.5, 170.0] {
                let axis = AxialAngle::from_deg(angle);
                let mut rotation = Rotation::new(Some(Window::None), rows, columns);
                let mut out = Array2::zeros(rotation.canvas_dim(axis));
                rotation.apply(wave(rows, columns, angle).view(), axis, &mut out);
                let (out_rows, out_columns) = out.dim();
                // In the middle, where nothing is cut, every row is the same wave.
                let (r0, c0) = (out_rows / 2, out_columns / 2);
                let amplitude = 2.0_f64.sqrt();
                for dr in 0..10 {
                    for dc in 0..20 {
                        let along = (c0 + dc) as f64 - (out_columns as f64 - 1.0) / 2.0;
                        let expected = amplitude * (std::f64::consts::TAU / 16.0 * along).cos();
                        let found = f64::from(out[[r0 + dr, c0 + dc]]);
                        assert!(
                            (found - expected).abs() < 0.08,
                            "{angle} {rows}x{columns} +{dr} +{dc}: {found} {expected}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn upright_pictures_are_only_standardised() {
        let picture = Array2::from_shape_fn((40, 52), |(r, c)| ((r * 31 + c * c * 17) % 101) as f32);
        let mut rotation = Rotation::new(None, 40, 52);
        let mut out = Array2::zeros((40, 52));
        rotation.apply(picture.view(), AxialAngle::from_deg(0.0), &mut out);
        let mean = picture.mean().unwrap();
        let std = picture.std(0.0);
        for (a, b) in out.iter().zip(&picture) {
            assert!((a - (b - mean) / std).abs() < 1e-4);
        }
        let mut turned = Array2::zeros((52, 40));
        rotation.apply(picture.view(), AxialAngle::from_deg(90.0), &mut turned);
        // The motion up the picture becomes the motion to the right.
        for ((r, c), value) in turned.indexed_iter() {
            assert!((value - out[[39 - c, r]]).abs() < 1e-6);
        }
    }

    #[test]
    fn a_turned_picture_fades_to_nothing_at_its_borders() {
        let picture = Array2::from_shape_fn((64, 64), |(r, c)| ((r * 13 + c * 29) % 17) as f32);
        let mut rotation = Rotation::new(None, 64, 64);
        let mut out = Array2::zeros((64, 64));
        rotation.apply(picture.view(), AxialAngle::from_deg(33.0), &mut out);
        assert!(out.row(0).iter().chain(out.column(63)).all(|x| x.abs() < 0.1));
    }
}
