//! Two-dimensional cepstrum.

use ndarray::ArrayView2;

use super::peak::{Peak, no_direction};
use crate::estimate::front::DftFront;
use crate::estimate::per_size::PerSize;
use crate::estimate::{AngleEstimate, AngleEstimator, Settings};
use crate::spectrum::Cepstrum;
use crate::{Result, image};

/// `dft-cepstrum`: the direction of the most striking trough of the two-dimensional cepstrum.
///
/// The blur puts a pair of troughs at the lags `+-L (cos angle, -sin angle)`; the line through the origin and the
/// trough is the motion. Pictures put their own structure at short lags, so a trough counts by its depth below the mean
/// of the lags of the same length, in their standard deviations. Its place is refined by parabolas along rows and
/// columns.
///
/// # Uncertainty
///
/// None is stated.
///
/// # When it fails
///
/// Everything hangs on one lag: noise and texture make deeper ones. A trough `L` pixels from the origin places the
/// angle to about `1/L` radians at best, so short blurs are coarse.
///
/// # Reference
///
/// B. P. Bogert 1963 (cepstrum); F. Krahmer et al., "Blind image deconvolution: motion blur estimation", IMA 2006;
/// thesis eq. 4.9 and section 4.4.1.
#[derive(Debug)]
pub struct DftCepstrum {
    settings: Settings,
    plan: PerSize<Plan>,
}

#[derive(Debug)]
struct Plan {
    front: DftFront,
    cepstrum: Cepstrum,
    /// Depth of the most striking trough in each degree.
    depths: Vec<f64>,
    rings: Vec<Ring>,
}

/// Lags of one length, to the pixel.
#[derive(Debug, Clone, Copy, Default)]
struct Ring {
    count: f64,
    sum: f64,
    squares: f64,
}

impl Ring {
    fn depth(self, value: f64) -> f64 {
        let mean = self.sum / self.count;
        let variance = self.squares / self.count - mean * mean;
        if variance > 0.0 { (mean - value) / variance.sqrt() } else { 0.0 }
    }
}

/// A rival direction with more than this share of the deepest trough makes the answer doubtful.
const MOST_RIVAL: f64 = 0.8;

impl DftCepstrum {
    /// A new estimator; plans are made when the first picture comes.
    pub fn new(settings: &Settings) -> Self {
        Self { settings: *settings, plan: PerSize::new() }
    }
}

impl AngleEstimator for DftCepstrum {
    fn estimate(&mut self, image: ArrayView2<'_, f32>) -> Result<AngleEstimate> {
        image::check(image)?;
        let settings = self.settings;
        let (rows, columns) = image.dim();
        let Plan { front, cepstrum, depths, rings } = self.plan.get(image.dim(), |dim| Plan {
            front: DftFront::new(settings.window, dim),
            cepstrum: Cepstrum::new(dim.0, dim.1),
            depths: vec![0.0; 180],
            rings: vec![Ring::default(); dim.0 + dim.1],
        });
        let range = settings.lengths_in(rows.min(columns) as f64);
        let lags = cepstrum.of_half_plane(front.set(image).bins());
        let at = |down: isize, right: isize| {
            f64::from(lags[[down.rem_euclid(rows as isize) as usize, right.rem_euclid(columns as isize) as usize]])
        };
        // Lags upwards and to both sides: the others are their mirror images. Half the size is the longest true lag.
        let (most_up, most_aside) = ((rows as isize - 1) / 2, (columns as isize - 1) / 2);
        let places = move || {
            (0..=most_up).flat_map(move |up| {
                (-most_aside..=most_aside).filter_map(move |right| {
                    let lag = (up as f64).hypot(right as f64);
                    (range.min_px()..=range.max_px()).contains(&lag).then_some((up, right, lag as usize))
                })
            })
        };
        rings.fill(Ring::default());
        for (up, right, ring) in places() {
            let value = at(-up, right);
            rings[ring].count += 1.0;
            rings[ring].sum += value;
            rings[ring].squares += value * value;
        }
        depths.fill(0.0);
        let mut deepest = (0.0, 0, 0);
        for (up, right, ring) in places() {
            let depth = rings[ring].depth(at(-up, right));
            let deg = (up as f64).atan2(right as f64).to_degrees() as usize % 180;
            depths[deg] = depths[deg].max(depth);
            if depth > deepest.0 {
                deepest = (depth, up, right);
            }
        }
        let Some(mut peak) = Peak::of(depths, 1.0) else { return Ok(no_direction()) };
        let (_, up, right) = deepest;
        let up_shift = vertex(at(-up + 1, right), at(-up, right), at(-up - 1, right));
        let right_shift = vertex(at(-up, right - 1), at(-up, right), at(-up, right + 1));
        peak.deg = (up as f64 + up_shift).atan2(right as f64 + right_shift).to_degrees();
        Ok(peak.estimate(None, MOST_RIVAL))
    }
}

/// Place of the minimum of the parabola through three neighbours, relative to the middle one.
fn vertex(before: f64, at: f64, after: f64) -> f64 {
    let curvature = before - 2.0 * at + after;
    if curvature > 0.0 { (0.5 * (before - after) / curvature).clamp(-0.5, 0.5) } else { 0.0 }
}
