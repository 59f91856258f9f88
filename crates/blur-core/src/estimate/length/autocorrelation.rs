//! Autocorrelation of the derivative along the motion.

use std::fmt;
use std::sync::Arc;

use ndarray::{Array2, ArrayView2};
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::num_complex::Complex32;

use super::oriented::Oriented;
use super::{from_trough, range_along};
use crate::estimate::per_size::PerSize;
use crate::estimate::{AxialAngle, LengthEstimate, LengthEstimator, Settings};
use crate::spectrum::Trough;
use crate::{Result, image};

/// `autocorrelation`: the lag of the minimum of the autocorrelation of the picture's derivative along the motion.
///
/// A uniform blur of a sharp edge is a ramp: its derivative begins with a positive and ends with a negative step `L`
/// pixels on, so the autocorrelation of the derivative has its minimum there. Rows of the turned picture are averaged.
///
/// # Uncertainty
///
/// None is stated.
///
/// # When it fails
///
/// The derivative amplifies noise; a minimum from the picture's own structure (texture, repeated objects) is as good
/// as the blur's. The thesis finds tens of pixels of error, and so do we on noisy pictures.
///
/// # Reference
///
/// Y. Yitzhaky and N. S. Kopeika, "Identification of blur parameters from motion blurred images", Graphical Models and
/// Image Processing 59(5), 1997. Thesis section 4.4.1.
#[derive(Debug)]
pub struct Autocorrelation {
    settings: Settings,
    plan: PerSize<Oriented<Plan>>,
}

/// Contrast below which a minimum is doubtful.
const CONTRAST_NEEDED: f64 = 4.0;

impl Autocorrelation {
    /// A new estimator; plans are made when the first picture comes.
    pub fn new(settings: &Settings) -> Self {
        Self { settings: *settings, plan: PerSize::new() }
    }
}

impl LengthEstimator for Autocorrelation {
    fn estimate(&mut self, image: ArrayView2<'_, f32>, angle: AxialAngle) -> Result<LengthEstimate> {
        image::check(image)?;
        let range = range_along(&self.settings, image.dim(), angle);
        let window = self.settings.window;
        let oriented = self.plan.get(image.dim(), |dim| Oriented::new(window, dim, Plan::new));
        let plan = oriented.turn(image, angle, |plan| &mut plan.canvas);
        plan.correlate();
        let estimate = from_trough(plan.minimum(range.min_px(), range.max_px()), range, CONTRAST_NEEDED);
        Ok(LengthEstimate { std_px: None, ..estimate })
    }
}

/// Buffers for turned pictures of one size.
struct Plan {
    canvas: Array2<f32>,
    forward: Arc<dyn RealToComplex<f32>>,
    inverse: Arc<dyn ComplexToReal<f32>>,
    /// A row's derivative, padded with as many zeros against wrap-around; later the autocorrelation.
    padded: Vec<f32>,
    spectrum: Vec<Complex32>,
    power: Vec<f32>,
    scratch: Vec<Complex32>,
    sorted: Vec<f32>,
}

impl Plan {
    fn new((rows, columns): (usize, usize)) -> Self {
        let mut planner = RealFftPlanner::new();
        let (forward, inverse) = (planner.plan_fft_forward(2 * columns), planner.plan_fft_inverse(2 * columns));
        let scratch = forward.get_scratch_len().max(inverse.get_scratch_len());
        Self {
            canvas: Array2::zeros((rows, columns)),
            padded: vec![0.0; 2 * columns],
            spectrum: vec![Complex32::default(); columns + 1],
            power: vec![0.0; columns + 1],
            scratch: vec![Complex32::default(); scratch],
            sorted: Vec::with_capacity(columns),
            forward,
            inverse,
        }
    }

    /// Leaves the mean autocorrelation of the rows' derivatives in `padded`.
    fn correlate(&mut self) {
        let columns = self.canvas.ncols();
        self.power.fill(0.0);
        for row in self.canvas.rows() {
            self.padded.fill(0.0);
            for (slot, (left, right)) in self.padded.iter_mut().zip(row.iter().zip(row.iter().skip(1))) {
                *slot = right - left;
            }
            let done = self.forward.process_with_scratch(&mut self.padded, &mut self.spectrum, &mut self.scratch);
            debug_assert!(done.is_ok());
            for (power, value) in self.power.iter_mut().zip(&self.spectrum) {
                *power += value.norm_sqr();
            }
        }
        for (value, &power) in self.spectrum.iter_mut().zip(&self.power) {
            *value = Complex32::new(power, 0.0);
        }
        let done = self.inverse.process_with_scratch(&mut self.spectrum, &mut self.padded, &mut self.scratch);
        debug_assert!(done.is_ok());
        // Unbiased: as many products go into a lag as pixels overlap.
        for (lag, value) in self.padded.iter_mut().enumerate().take(columns) {
            *value /= (columns - lag) as f32;
        }
    }

    /// The lowest point between two lags, placed by a parabola.
    fn minimum(&mut self, least_px: f64, most_px: f64) -> Option<Trough> {
        let (first, last) = (least_px.ceil() as usize, (most_px as usize).min(self.canvas.ncols().saturating_sub(2)));
        if first == 0 || last < first {
            return None;
        }
        let lowest = (first..=last).min_by(|&a, &b| self.padded[a].total_cmp(&self.padded[b]))?;
        self.sorted.clear();
        self.sorted.extend(self.padded[first..=last].iter().map(|c| c.abs()));
        let middle = self.sorted.len() / 2;
        let (_, &mut median, _) = self.sorted.select_nth_unstable_by(middle, f32::total_cmp);
        if median <= 0.0 {
            return None;
        }
        let [before, at, after] = [lowest - 1, lowest, lowest + 1].map(|lag| f64::from(self.padded[lag]));
        let curvature = before - 2.0 * at + after;
        let shift = if curvature > 0.0 { (0.5 * (before - after) / curvature).clamp(-1.0, 1.0) } else { 0.0 };
        let contrast = -at / (f64::from(median) / 0.6745);
        Some(Trough { lag_px: lowest as f64 + shift, contrast, std_px: 0.0 })
    }
}

impl fmt::Debug for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Plan").field("canvas", &self.canvas.dim()).finish_non_exhaustive()
    }
}
