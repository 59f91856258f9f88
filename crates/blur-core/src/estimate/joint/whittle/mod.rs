//! `whittle`: the likelihood of the whole spectrum.

mod along;
mod cells;
mod descent;
mod diagnosis;
mod fit;
mod likelihood;
mod overlay;
mod periodogram;
mod point;
mod response;
mod rows;
mod scene;
mod search;
#[cfg(test)]
mod testing;
mod tracker;
mod verdict;
mod view;
mod weighted;

use ndarray::ArrayView2;

pub use self::diagnosis::{Diagnosis, Surface};
pub(crate) use self::periodogram::{FALL, MOST_FREQUENCY};
pub(crate) use self::scene::{MEAN, STD, TERMS, terms};

pub use self::tracker::{Tracked, Tracker};

pub(in crate::estimate) use self::along::Along;

use self::view::{Accelerated, Outcome, View};
use self::weighted::WeightedPlan;
use super::no_pattern;
use crate::estimate::per_size::PerSize;
use crate::estimate::{Acceleration, AxialAngle, Evidence, JointEstimator, LengthRange, MotionBlur, Settings, Status};
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
/// Little variance lost, leakage low enough for clean 8-bit pictures.
const WHOLE_WINDOW: Window = Window::Tukey { taper: 0.25 };
/// No leakage at all: what leaks from afar into a dark line looks like an acceleration.
const ACCELERATION_WINDOW: Window = Window::Hann;

/// `whittle`: maximum likelihood of direction, length and scene, from all powers of the spectrum at once.
///
/// # Model
///
/// The power at the frequency `f`, of a picture of variance 1 under a window, is an exponential variable with the mean
///
/// `E(f) = S(f) (T(s) + e) + n`,
///
/// - `s = u cos angle - v sin angle` the frequency along the motion (`v` points down) and `T` the power transfer
///   `sinc^2(L s)` as the window shows it: smeared over the window's lobe, more from the side where `S` is higher;
/// - `S` the spectrum of the sharp scene: `ln S` a sum of eighteen smooth terms in radius and direction with a normal prior
///   learnt from sharp photographs, plus the deviation of each of 360 patches of the plane, a normal variable whose
///   scatter is estimated from the picture, octave by octave;
/// - `e` the share of the light that does not follow the motion: a blur that differs over the picture, a curved path,
///   saturated lamps, what a camera's program made of the noise;
/// - `n` the noise.
///
/// Powers are summed into cells one to four bins wide along the motion. A cell's level may scatter by a fifth, so that
/// no single peak decides. The maximum over everything is found by Fisher scoring.
///
/// # Search
///
/// The log spectrum is levelled and held, in bands of frequencies each half as wide as the last, against every direction
/// and length whose dark lines the band shows: there is no local maximum to fall into. What bands agree upon is fitted,
/// in the lowest band that knows the length; the mode with most gain over no blur for a bin of signal wins. Its band is
/// then widened to the whole spectrum, or as far as the wider band agrees: in laboratory pictures that is all of it, in
/// hand-held photographs the low frequencies only, where a blur that differs over the picture is still coherent.
///
/// # Parts of a picture
///
/// Pictures of more than 768 pixels on the shorter side are measured in their middle, 1024 pixels square under a Hann
/// window; when that turns out coherent over the whole spectrum, a square of up to 2048 pixels follows.
///
/// # Uncertainty
///
/// The inverse of the expected information with everything else profiled out, widened by the roughness of the scene's
/// spectrum: deviations seen from patch to patch are there within patches too. The attained coverage is tested
/// (`reproduce coverage`).
///
/// # When it fails
///
/// In strong noise the shortest blurs leave no dark line above the noise. Periodic textures have dark lines of their own.
/// Both are called doubtful. A picture of which most is one straight edge or one striped object can be read wrongly, and
/// where the blur differs over a photograph, the length is the mean over its middle.
///
/// # Reference
///
/// P. Whittle, *Estimation and information in stationary time series*, Arkiv foer Matematik 2 (1953) 423, for the
/// likelihood of a periodogram; the blur's transfer function from thesis eq. 3.27.
#[derive(Debug)]
pub struct Whittle {
    settings: Settings,
    plan: PerSize<Plan>,
    weighted: Option<WeightedPlan>,
}

#[derive(Debug)]
struct Plan {
    range: LengthRange,
    first: Part,
    /// The part of a large picture that is measured when one blur fills it.
    whole: Option<Part>,
}

/// A part of the picture under the windows that it is measured with.
#[derive(Debug)]
struct Part {
    view: View,
    /// Under the window for the acceleration, where that is asked for and another one.
    accelerated: Option<View>,
}

impl Whittle {
    /// An estimator with these settings. Plans are made with the first picture.
    pub fn new(settings: &Settings) -> Self {
        Self { settings: *settings, plan: PerSize::new(), weighted: None }
    }
}

/// The stages of a measurement, in their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Stage {
    /// Taper, transform, powers and the first guess of the noise.
    Spectrum,
    /// Every direction and length against the log spectrum.
    Search,
    /// First fits of the modes found, each against no blur.
    Choice,
    /// The best mode against disks.
    Defocus,
    /// The fit that is reported, in wider and wider bands.
    Fit,
    /// The fit in the whole of a large picture, and that of the acceleration.
    Refinement,
}

impl Whittle {
    /// As [`estimate`](JointEstimator::estimate), and `done` is called at the end of each stage: for benches.
    pub fn estimate_in_stages(
        &mut self,
        image: ArrayView2<'_, f32>,
        done: &mut dyn FnMut(Stage),
    ) -> Result<MotionBlur> {
        image::check(image)?;
        let settings = self.settings;
        let plan = self.plan.get(image.dim(), |dim| Plan::new(&settings, dim));
        plan.set(image);
        done(Stage::Spectrum);
        let Some(outcome) = plan.search(done) else { return Ok(no_pattern(plan.range)) };
        let found = plan.result(&outcome, image, settings.acceleration);
        done(Stage::Refinement);
        Ok(found)
    }
}

impl JointEstimator for Whittle {
    fn estimate(&mut self, image: ArrayView2<'_, f32>) -> Result<MotionBlur> {
        self.estimate_in_stages(image, &mut |_| ())
    }
}

impl Plan {
    fn new(settings: &Settings, (rows, columns): (usize, usize)) -> Self {
        let side = rows.min(columns);
        let range = settings.lengths_in(side.min(MIDDLE_PX) as f64);
        if side <= WHOLE_PX {
            return Self { range, first: Part::new((rows, columns), WHOLE_WINDOW, range, settings), whole: None };
        }
        let middle = side.min(MIDDLE_PX);
        let largest = side.min(LARGEST_PX);
        Self {
            range,
            first: Part::new((middle, middle), Window::Hann, range, settings),
            whole: (largest > middle).then(|| Part::new((largest, largest), WHOLE_WINDOW, range, settings)),
        }
    }

    /// The picture to measure, of the plan's size.
    fn set(&mut self, image: ArrayView2<'_, f32>) {
        self.first.view.set(first_part(image));
    }

    /// Searches everywhere; `None` when there is no pattern.
    fn search(&mut self, done: &mut dyn FnMut(Stage)) -> Option<Outcome> {
        self.first.view.measure(done)
    }

    /// Fits from the outcome of the frame before; `None` when the blur has left that mode.
    fn follow(&mut self, last: &Outcome) -> Option<Outcome> {
        self.first.view.follow(last)
    }

    /// The result that follows from an outcome for the picture that was [`set`](Self::set), which is given again: the
    /// whole of a large picture refines it, and the acceleration is looked for if asked.
    fn result(&mut self, outcome: &Outcome, image: ArrayView2<'_, f32>, acceleration: bool) -> MotionBlur {
        let picture = first_part(image);
        let status = verdict::status(outcome, self.range);
        let mut refined = None;
        if let Some(whole) = self.whole.as_mut().filter(|_| status == Status::Ok && is_uniform(outcome)) {
            let picture = centre_square(image, LARGEST_PX);
            whole.view.set(picture);
            refined = whole.view.refine(outcome).filter(|refined| agree(outcome, refined)).map(|refined| {
                let accelerated = acceleration.then(|| whole.acceleration(picture, &refined)).flatten();
                result(&refined, verdict::status(&refined, self.range), picture.dim(), accelerated)
            });
        }
        refined.unwrap_or_else(|| {
            let accelerated = acceleration.then(|| self.first.acceleration(picture, outcome)).flatten();
            result(outcome, status, picture.dim(), accelerated)
        })
    }
}

/// The part of a picture that is measured first.
fn first_part(image: ArrayView2<'_, f32>) -> ArrayView2<'_, f32> {
    let side = image.nrows().min(image.ncols());
    if side <= WHOLE_PX { image } else { centre_square(image, MIDDLE_PX) }
}

impl Part {
    fn new(dim: (usize, usize), window: Window, range: LengthRange, settings: &Settings) -> Self {
        let accelerated = settings.acceleration && settings.window.is_none() && window != ACCELERATION_WINDOW;
        Self {
            view: View::new(dim, settings.window.unwrap_or(window), range),
            accelerated: accelerated.then(|| View::new(dim, ACCELERATION_WINDOW, range)),
        }
    }

    /// The fit of the accelerated blur to `picture`, which is that of the view, from the view's outcome.
    fn acceleration(&mut self, picture: ArrayView2<'_, f32>, outcome: &Outcome) -> Option<Accelerated> {
        match &mut self.accelerated {
            Some(view) => {
                view.set(picture);
                view.acceleration(outcome)
            }
            None => self.view.acceleration(outcome),
        }
    }
}

/// Whether one blur fills the middle of a picture so well that it may be expected to fill it all.
fn is_uniform(outcome: &Outcome) -> bool {
    outcome.log_share < UNIFORM
}

fn agree(middle: &Outcome, whole: &Outcome) -> bool {
    middle.is_near(whole) && is_uniform(whole) && whole.covariance[0][0] < middle.covariance[0][0]
}

fn result(
    outcome: &Outcome,
    status: Status,
    (rows, columns): (usize, usize),
    accelerated: Option<Accelerated>,
) -> MotionBlur {
    let acceleration = accelerated.map(|found| {
        let std = found.covariance[2][2].sqrt();
        let correlation = found.covariance[0][2] / (found.covariance[0][0].sqrt() * std);
        Acceleration::from_square(found.ratio2, std, found.uniform_std, correlation)
    });
    // A uniform blur fitted to one that accelerates is too long; one that is not known to accelerate counts as uniform.
    let detected = accelerated.filter(|_| acceleration.is_some_and(|acceleration| acceleration.is_detected()));
    let (length, angle, covariance) = match &detected {
        Some(found) => (found.length, found.angle, &found.covariance),
        None => (outcome.length, outcome.angle, &outcome.covariance),
    };
    let (log_length_std, angle_std) = (covariance[0][0].sqrt(), covariance[1][1].sqrt());
    MotionBlur {
        angle: AxialAngle::from_deg(angle.to_degrees()),
        angle_std_deg: Some(angle_std.to_degrees()),
        length_px: length,
        length_std_px: Some(length * log_length_std),
        correlation: Some(covariance[0][1] / (log_length_std * angle_std)),
        direction_deg: None,
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
        acceleration,
    }
}
