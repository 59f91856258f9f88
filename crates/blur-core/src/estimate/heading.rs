//! Which way along its axis a motion went, from the frame before.

use ndarray::{Array2, ArrayView2};
use rustfft::num_complex::Complex32;

use super::AxialAngle;
use super::per_size::PerSize;
use crate::image::{Taper, Window};
use crate::spectrum::{Dft2, InverseDft2, fast_size};

/// Longest side in pixels of the reduced frames that are compared.
const REDUCED_PX: usize = 400;
/// Frames overlap in part: little is tapered.
const WINDOW: Window = Window::Tukey { taper: 0.25 };
/// Frequencies beyond this, in cycles per reduced pixel, tell the noise.
const NOISE_FROM: f64 = 0.4;
/// Least displacement in reduced pixels, and relative to the blur length: frames begin at least one exposure apart, and a
/// motion may speed up.
const LEAST_PX: f64 = 1.5;
const LEAST_OF_LENGTH: f64 = 0.6;
/// Half width of the sector about the axis in which a displacement counts as one along it: reduced pixels, and the tangent
/// of an angle.
const ACROSS_PX: f64 = 2.0;
const ACROSS: f64 = 0.2;
/// Least height of the peak of a displacement in standard deviations of the surface. White noise on the largest surface
/// reaches 5.
const LEAST_PEAK: f64 = 7.0;
/// Most height of any peak the other way, relative to it.
const MOST_OPPOSITE: f64 = 0.7;

/// Tells a motion from its opposite by the displacement of the picture since the frame before.
///
/// A blur and its reverse are one to a power spectrum; two frames are not. Their phase correlation, weighted by the signal
/// that noise and blur have left, has a peak at the displacement. It must lie along the axis of the blur, be at least 0.6
/// blur lengths away from the origin (an exposure is no longer than the time between frames, and what does not move peaks at
/// the origin), and stand out from the surface and from its like on the other side. Otherwise nothing is said: the frames
/// do not overlap, the content changed, or a frame is missing.
///
/// # Reference
///
/// C. D. Kuglin and D. C. Hines, "The phase correlation image alignment method", Proc. IEEE Int. Conf. on Cybernetics and
/// Society, 1975, 163.
#[derive(Debug)]
pub struct Heading {
    plan: PerSize<Plan>,
    /// Size of the frame before, if there is one.
    last: Option<(usize, usize)>,
}

impl Default for Heading {
    fn default() -> Self {
        Self::new()
    }
}

impl Heading {
    /// Without a frame before.
    pub fn new() -> Self {
        Self { plan: PerSize::new(), last: None }
    }

    /// Forgets the frame before.
    pub fn reset(&mut self) {
        self.last = None;
    }

    /// Where the content moved since the frame before, in degrees counter-clockwise from +x as seen, in `[0, 360)`: along
    /// `angle` or opposite to it; `None` when that cannot be told or `blur`, the axis and the length in pixels of the blur, is
    /// not known. The next call compares with this frame.
    pub fn next(&mut self, image: ArrayView2<'_, f32>, blur: Option<(AxialAngle, f64)>) -> Option<f64> {
        let dim = image.dim();
        let follows = self.last.replace(dim) == Some(dim);
        let plan = self.plan.get(dim, Plan::new);
        plan.transform(image);
        let is_forward = match blur {
            Some((angle, length_px)) if follows => plan.is_forward(angle, length_px),
            _ => None,
        };
        plan.keep();
        let (angle, _) = blur?;
        is_forward.map(|is_forward| if is_forward { angle.deg() } else { angle.deg() + 180.0 })
    }
}

/// Transforms and buffers for frames of one size.
#[derive(Debug)]
struct Plan {
    /// Pixels each way that are joined into one.
    factor: usize,
    reduced: Array2<f32>,
    tapered: Array2<f32>,
    taper: Taper,
    /// Of the reduced frames in twice their size, so that no displacement is taken for another.
    dft: Dft2,
    inverse: InverseDft2,
    now: Array2<Complex32>,
    before: Array2<Complex32>,
}

impl Plan {
    fn new((rows, columns): (usize, usize)) -> Self {
        let factor = rows.max(columns).div_ceil(REDUCED_PX);
        let dim = (rows / factor, columns / factor);
        let padded = (fast_size(2 * dim.0), fast_size(2 * dim.1));
        let half = (padded.0, padded.1 / 2 + 1);
        Self {
            factor,
            reduced: Array2::zeros(dim),
            tapered: Array2::zeros(dim),
            taper: Taper::new(WINDOW, dim.0, dim.1),
            dft: Dft2::new(padded.0, padded.1),
            inverse: InverseDft2::new(padded.0, padded.1),
            now: Array2::zeros(half),
            before: Array2::zeros(half),
        }
    }

    /// The spectrum of a frame, reduced and tapered.
    fn transform(&mut self, image: ArrayView2<'_, f32>) {
        let factor = self.factor;
        for ((row, column), value) in self.reduced.indexed_iter_mut() {
            let mut sum = 0.0;
            for i in 0..factor {
                for j in 0..factor {
                    sum += image[[row * factor + i, column * factor + j]];
                }
            }
            *value = sum;
        }
        self.taper.apply(self.reduced.view(), &mut self.tapered);
        let input = self.dft.input();
        input.fill(0.0);
        for (row, mut out) in self.tapered.rows().into_iter().zip(input.rows_mut()) {
            for (value, out) in row.iter().zip(&mut out) {
                *out = *value;
            }
        }
        self.now.assign(&self.dft.transform());
    }

    /// Makes the frame the one before.
    fn keep(&mut self) {
        std::mem::swap(&mut self.now, &mut self.before);
    }

    /// Whether the content moved along the angle in `[0, 180)` and not opposite to it.
    fn is_forward(&mut self, angle: AxialAngle, length_px: f64) -> Option<bool> {
        self.correlate();
        let (sin, cos) = angle.rad().sin_cos();
        let least = LEAST_PX.max(LEAST_OF_LENGTH * length_px / self.factor as f64);
        let surface = self.inverse.transform();
        let (rows, columns) = surface.dim();
        let (mut squares, mut ahead, mut behind, mut elsewhere) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
        for (row, values) in surface.rows().into_iter().enumerate() {
            let down = signed(row, rows);
            for (column, value) in values.iter().enumerate() {
                let (right, value) = (signed(column, columns), f64::from(*value));
                squares += value * value;
                let (along, across) = (right * cos - down * sin, right * sin + down * cos);
                if along.hypot(across) < least {
                    continue;
                }
                let is_along = across.abs() <= ACROSS_PX + ACROSS * along.abs();
                let best = match (is_along, along > 0.0) {
                    (true, true) => &mut ahead,
                    (true, false) => &mut behind,
                    (false, _) => &mut elsewhere,
                };
                *best = best.max(value);
            }
        }
        let std = (squares / (rows * columns) as f64).sqrt();
        let (highest, opposite) = if ahead > behind { (ahead, behind) } else { (behind, ahead) };
        let stands_out = highest > LEAST_PEAK * std && opposite < MOST_OPPOSITE * highest && elsewhere < highest;
        stands_out.then_some(ahead > behind)
    }

    /// The weighted cross spectrum of the frames in the inverse transform's input: `phase * p / (p + n)` for the power `p`
    /// they share and the noise `n`.
    fn correlate(&mut self) {
        let (rows, columns) = self.dft.dim();
        let is_noise = |row: usize, column: usize| {
            signed(row, rows).abs() / rows as f64 > NOISE_FROM || column as f64 / columns as f64 > NOISE_FROM
        };
        let (mut noise, mut count) = (0.0_f64, 0_u32);
        let out = self.inverse.input();
        for (((at, now), before), out) in self.now.indexed_iter().zip(&self.before).zip(out.iter_mut()) {
            *out = now * before.conj();
            if is_noise(at.0, at.1) {
                noise += f64::from(out.norm());
                count += 1;
            }
        }
        let noise = (noise / f64::from(count.max(1))) as f32;
        for value in out.iter_mut() {
            let power = value.norm();
            *value = if power > 0.0 { *value / (power + noise) } else { Complex32::ZERO };
        }
        out[[0, 0]] = Complex32::ZERO;
    }
}

/// The lag or frequency of index `i` of `n`: the upper half is negative.
fn signed(i: usize, n: usize) -> f64 {
    if 2 * i > n { i as f64 - n as f64 } else { i as f64 }
}
