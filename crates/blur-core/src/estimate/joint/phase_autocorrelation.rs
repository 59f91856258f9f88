//! Autocorrelation of the phase-only image.

use std::f64::consts::PI;

use ndarray::ArrayView2;

use super::lag_peak::{LagPeak, LagPeaks};
use super::no_pattern;
use crate::estimate::length::status_in;
use crate::estimate::per_size::PerSize;
use crate::estimate::{AxialAngle, Doubt, JointEstimator, LengthRange, MotionBlur, Settings, Status};
use crate::image::{Taper, Window};
use crate::spectrum::{Dft2, InverseDft2, PhaseOnly};
use crate::{Result, image};

/// `phase-autocorrelation`: the lag of the highest peak, the origin apart, of the autocorrelation of the modulus of the
/// phase-only image.
///
/// The phase of a uniform blur's `sinc(L s)` is a square wave along the motion, `sign sinc`. As an image it consists of
/// two sharp features at the ends of the kernel and fainter ones beyond; the phase-only image of the blurred picture
/// shows the edges of the scene once at either end. The autocorrelation of a phase-only image is a single point, whatever
/// it shows; that of its modulus has peaks at the origin and at the lags `+-L (cos angle, -sin angle)` pixels in
/// (column, row), between the two ends.
///
/// The peak is sought among lags as long as the range allows, at most half the shorter side of the picture: the
/// autocorrelation is circular. Its place is refined by a paraboloid.
///
/// # Departures from the paper
///
/// - The authors' program transforms the picture as it is and cuts the border of the phase-only image off; here the
///   picture is tapered first, so that its border leaves no mark to cut.
/// - The phase is weighted by radius and by the signal in each ring, see [`PhaseOnly`]: with all bins alike the noise of
///   the high frequencies hides the peaks, at a PSNR of 36 dB already.
/// - The paper names the two highest peaks; the authors' program cuts a histogram of the autocorrelation and takes the
///   brightest points that remain, or a line through them, to whole pixels. Here the autocorrelation minus its mean under
///   a Gaussian of 4 px is divided by its root mean square over lags from 0.7 to 1.4 times as long: the scene makes broad
///   ridges where the ends of the kernel make points, and the lags near the origin scatter most.
///
/// # Uncertainty
///
/// None is stated: how far noise and scene move the peak is not known.
///
/// # When it fails
///
/// In noise: the phase of a bin is lost where the noise is stronger than the blurred scene, at the dark lines first.
/// Blurs shorter than some 12 px bring the ends so close that each hides in the scene's structure around the other, and
/// the fainter copy at twice the length may win. Most of these failures are called doubtful, and many right answers too.
/// Repeated objects have peaks of their own. A scene without edges, such as grass or sand, leaves nothing to correlate: the
/// phase-only image of a Gaussian field is white noise, and so is its modulus.
///
/// # Reference
///
/// L. Pan, R. Hartley, M. Liu and Y. Dai, "Phase-only image based kernel estimation for single image blind deblurring",
/// CVPR 2019, arXiv 1811.10185: the phase-only image `P(B)`, its modulus and the autocorrelation `A(|P(B)|)` as figure 4
/// explains them for a straight kernel. The authors' program is the one published with it. Their refinement of the kernel
/// by deblurring is no part of the measurement.
#[derive(Debug)]
pub struct PhaseAutocorrelation {
    settings: Settings,
    plan: PerSize<Plan>,
}

/// The method's own window.
const DEFAULT_WINDOW: Window = Window::Tukey { taper: 0.25 };
/// Standard deviation in pixels of the Gaussian mean that is taken from the autocorrelation.
const SURROUNDINGS_PX: f64 = 4.0;
/// Contrast below which a peak is doubtful. Sharp photographs reach 8.4, the copy of a blur of 10 px at twice its length
/// nearly 9.
const CONTRAST_NEEDED: f64 = 9.0;
/// A rival lag with more than this share of the highest contrast makes the answer doubtful.
const MOST_RIVAL: f64 = 0.85;

impl PhaseAutocorrelation {
    /// A new estimator; plans are made when the first picture comes.
    pub fn new(settings: &Settings) -> Self {
        Self { settings: *settings, plan: PerSize::new() }
    }
}

impl JointEstimator for PhaseAutocorrelation {
    fn estimate(&mut self, image: ArrayView2<'_, f32>) -> Result<MotionBlur> {
        image::check(image)?;
        let (rows, columns) = image.dim();
        let side = rows.min(columns);
        let wanted = self.settings.lengths_in(side as f64);
        let window = self.settings.window.unwrap_or(DEFAULT_WINDOW);
        let half = ((side - 1) / 2) as f64;
        let Ok(range) = LengthRange::new(wanted.min_px(), wanted.max_px().min(half)) else {
            return Ok(no_pattern(wanted));
        };
        let plan = self.plan.get(image.dim(), |dim| Plan::new(window, dim));
        Ok(plan.peak(image, range).map_or_else(|| no_pattern(range), |peak| from_peak(peak, range)))
    }
}

/// The estimate from a peak found in `range`.
fn from_peak(peak: LagPeak, range: LengthRange) -> MotionBlur {
    let LagPeak { up_px, right_px, contrast, rival } = peak;
    let length_px = up_px.hypot(right_px);
    let status = if contrast < CONTRAST_NEEDED {
        Status::LowConfidence(Doubt::WeakLengthPeak { contrast, needed: CONTRAST_NEEDED })
    } else if rival > MOST_RIVAL {
        Status::LowConfidence(Doubt::RivalLag { share: rival, most: MOST_RIVAL })
    } else {
        Status::Ok
    };
    MotionBlur {
        angle: AxialAngle::from_deg(up_px.atan2(right_px).to_degrees()),
        angle_std_deg: None,
        length_px,
        length_std_px: None,
        correlation: None,
        direction_deg: None,
        status: status_in(range, length_px, status),
        evidence: None,
        acceleration: None,
    }
}

/// Transforms and buffers for pictures of one size.
#[derive(Debug)]
struct Plan {
    taper: Taper,
    dft: Dft2,
    inverse: InverseDft2,
    phase: PhaseOnly,
    /// Transfer function of the Gaussian mean along rows and along columns; that in the plane is their product.
    mean_down: Vec<f32>,
    mean_right: Vec<f32>,
    peaks: LagPeaks,
}

impl Plan {
    fn new(window: Window, (rows, columns): (usize, usize)) -> Self {
        Self {
            taper: Taper::new(window, rows, columns),
            dft: Dft2::new(rows, columns),
            inverse: InverseDft2::new(rows, columns),
            phase: PhaseOnly::new(rows, columns),
            mean_down: gaussian_transfer(rows),
            mean_right: gaussian_transfer(columns),
            peaks: LagPeaks::new(rows, columns),
        }
    }

    /// The highest peak of the levelled autocorrelation of the modulus of the phase-only image.
    fn peak(&mut self, image: ArrayView2<'_, f32>, range: LengthRange) -> Option<LagPeak> {
        self.taper.apply(image, self.dft.input());
        self.phase.apply(self.dft.transform(), self.inverse.input());
        for (modulus, value) in self.dft.input().iter_mut().zip(self.inverse.transform()) {
            *modulus = value.abs();
        }
        let spectrum = self.dft.transform();
        let rows_out = self.inverse.input().rows_mut();
        for ((row, mut row_out), down) in spectrum.rows().into_iter().zip(rows_out).zip(&self.mean_down) {
            for ((value, out), right) in row.iter().zip(&mut row_out).zip(&self.mean_right) {
                *out = (value.norm_sqr() * (1.0 - down * right)).into();
            }
        }
        self.peaks.highest(self.inverse.transform(), range)
    }
}

/// Transfer function of a circular Gaussian mean over `n` pixels, `exp(-2 (pi sigma s)^2)` at the frequencies of a DFT.
fn gaussian_transfer(n: usize) -> Vec<f32> {
    (0..n)
        .map(|k| {
            let s = k.min(n - k) as f64 / n as f64;
            (-2.0 * (PI * SURROUNDINGS_PX * s).powi(2)).exp() as f32
        })
        .collect()
}
