//! `whittle`: the likelihood of the whole spectrum.

mod fit;
mod periodogram;
mod response;
mod scene;
mod search;
mod verdict;
mod view;

use ndarray::ArrayView2;

use self::view::{Outcome, View};
use crate::estimate::per_size::PerSize;
use crate::estimate::{
    Acceleration, AxialAngle, Doubt, Evidence, JointEstimator, LengthRange, MotionBlur, Settings, Status,
};
use crate::image::{Window, centre_square};
use crate::{Result, image};

/// Pictures up to this shorter side are measured whole.
const WHOLE_PX: usize = 768;
/// Larger ones are measured in their middle first.
const MIDDLE_PX: usize = 1024;
/// A picture whose middle is coherent is then measured in a square of at most this side.
const LARGEST_PX: usize = 2048;
/// Most light outside the kernel, as a logarithm, for one blur to be expected all over the picture.
const UNIFORM: f64 = -5.0;
/// The whole may differ from its middle by this many standard deviations.
const AGREEMENT: f64 = 5.0;
/// The least flat of the common windows: little variance lost, leakage low enough for clean 8-bit pictures.
const WHOLE_WINDOW: Window = Window::Tukey { taper: 0.25 };

/// `whittle`: maximum likelihood of direction, length and scene, from all powers of the spectrum at once.
#[derive(Debug)]
pub struct Whittle {
    settings: Settings,
    plan: PerSize<Plan>,
}

#[derive(Debug)]
struct Plan {
    range: LengthRange,
    first: View,
    /// The part of a large picture that is measured when one blur fills it.
    whole: Option<View>,
}

impl Whittle {
    /// An estimator with these settings. Plans are made with the first picture.
    pub fn new(settings: &Settings) -> Self {
        Self { settings: *settings, plan: PerSize::new() }
    }
}

impl JointEstimator for Whittle {
    fn estimate(&mut self, image: ArrayView2<'_, f32>) -> Result<MotionBlur> {
        image::check(image)?;
        let settings = self.settings;
        let plan = self.plan.get(image.dim(), |dim| Plan::new(&settings, dim));
        Ok(plan.measure(image, settings.acceleration))
    }
}

impl Plan {
    fn new(settings: &Settings, (rows, columns): (usize, usize)) -> Self {
        let side = rows.min(columns);
        let range = settings.lengths_in(side.min(MIDDLE_PX) as f64);
        if side <= WHOLE_PX {
            let window = settings.window.unwrap_or(WHOLE_WINDOW);
            return Self { range, first: View::new((rows, columns), window, range), whole: None };
        }
        let middle = side.min(MIDDLE_PX);
        let largest = side.min(LARGEST_PX);
        Self {
            range,
            first: View::new((middle, middle), settings.window.unwrap_or(Window::Hann), range),
            whole: (largest > middle)
                .then(|| View::new((largest, largest), settings.window.unwrap_or(WHOLE_WINDOW), range)),
        }
    }

    fn measure(&mut self, image: ArrayView2<'_, f32>, acceleration: bool) -> MotionBlur {
        let side = image.nrows().min(image.ncols());
        let view = if side <= WHOLE_PX { image } else { centre_square(image, MIDDLE_PX) };
        self.first.set(view);
        let Some(outcome) = self.first.measure() else { return no_pattern(self.range) };
        let status = verdict::status(&outcome, self.range);
        if let Some(whole) = self.whole.as_mut().filter(|_| status == Status::Ok && is_uniform(&outcome)) {
            let view = centre_square(image, LARGEST_PX);
            whole.set(view);
            if let Some(refined) = whole.refine(&outcome).filter(|refined| agree(&outcome, refined)) {
                let ratio2 = acceleration.then(|| whole.acceleration(&refined)).flatten();
                return result(&refined, status, view.dim(), ratio2);
            }
        }
        let ratio2 = acceleration.then(|| self.first.acceleration(&outcome)).flatten();
        result(&outcome, status, view.dim(), ratio2)
    }
}

/// Whether one blur fills the middle of a picture so well that it may be expected to fill it all.
fn is_uniform(outcome: &Outcome) -> bool {
    outcome.log_share < UNIFORM
}

fn agree(middle: &Outcome, whole: &Outcome) -> bool {
    let within = |shift: f64, i: usize| {
        shift * shift <= AGREEMENT * AGREEMENT * (middle.covariance[i][i] + whole.covariance[i][i])
    };
    within((whole.length / middle.length).ln(), 0)
        && within(whole.angle - middle.angle, 1)
        && is_uniform(whole)
        && whole.covariance[0][0] < middle.covariance[0][0]
}

fn result(
    outcome: &Outcome,
    status: Status,
    (rows, columns): (usize, usize),
    ratio2: Option<(f64, f64)>,
) -> MotionBlur {
    let covariance = &outcome.covariance;
    let (log_length_std, angle_std) = (covariance[0][0].sqrt(), covariance[1][1].sqrt());
    MotionBlur {
        angle: AxialAngle::from_deg(outcome.angle.to_degrees()),
        angle_std_deg: Some(angle_std.to_degrees()),
        length_px: outcome.length,
        length_std_px: Some(outcome.length * log_length_std),
        correlation: Some(covariance[0][1] / (log_length_std * angle_std)),
        status,
        evidence: Some(Evidence {
            gain: outcome.gain,
            gain_per_bin: outcome.density,
            rival_share: outcome.rival,
            gain_over_defocus: outcome.over_disk,
            incoherent_share: outcome.log_share.exp(),
            peakedness: outcome.peaks,
            misfit: outcome.misfit,
            band_cycles_per_px: outcome.band,
            rows,
            columns,
        }),
        acceleration: ratio2.map(|(ratio2, std)| Acceleration::from_square(ratio2, std)),
    }
}

fn no_pattern(range: LengthRange) -> MotionBlur {
    MotionBlur {
        angle: AxialAngle::from_deg(0.0),
        angle_std_deg: None,
        length_px: range.min_px(),
        length_std_px: None,
        correlation: None,
        status: Status::NoMotionBlur(Doubt::NoPattern),
        evidence: None,
        acceleration: None,
    }
}
