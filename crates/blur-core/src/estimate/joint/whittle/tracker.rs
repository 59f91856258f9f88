//! `whittle` on frames that follow each other.

use ndarray::ArrayView2;

use super::view::Outcome;
use super::{Plan, verdict};
use crate::estimate::per_size::PerSize;
use crate::estimate::{MotionBlur, Settings, Status};
use crate::{Result, image};

/// Least evidence for a bin of signal, relative to that of the last search, for the mode that the search chose to count as
/// still the right one.
const LEAST_KEPT: f64 = 0.5;

/// [`Whittle`](super::Whittle) on frames that follow each other: the fit starts from the result of the frame before, without
/// the search and without the comparison with disks, which make half of the work.
///
/// It goes back to the search at once, for the same frame, when the fit leaves the mode it started in, when it is in doubt by
/// any of `whittle`'s own rules, or when its evidence for a bin of signal is less than half of that which the last search
/// found. What is measured is the same likelihood, so result and uncertainty are those of `whittle` up to the tolerance of
/// the fit; of the [`Evidence`](crate::estimate::Evidence), the shares of rivals and the gain over a disk are those of the
/// last search.
#[derive(Debug)]
pub struct Tracker {
    settings: Settings,
    plan: PerSize<Plan>,
    last: Option<Last>,
}

/// What is kept of the frame before.
#[derive(Debug, Clone, Copy)]
struct Last {
    dim: (usize, usize),
    outcome: Outcome,
    /// Evidence for a bin of signal that the last search found.
    searched: f64,
}

/// The blur of one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tracked {
    /// The blur.
    pub blur: MotionBlur,
    /// Whether the fit started from the frame before and no search was needed.
    pub tracked: bool,
}

impl Tracker {
    /// A tracker with these settings. Plans are made with the first frame.
    pub fn new(settings: &Settings) -> Self {
        Self { settings: *settings, plan: PerSize::new(), last: None }
    }

    /// Forgets the frame before, so that the next one is searched.
    pub fn reset(&mut self) {
        self.last = None;
    }

    /// Direction and length of the blur in the next frame. A frame of another size than the last is searched.
    ///
    /// # Errors
    /// Those of [`JointEstimator::estimate`](crate::estimate::JointEstimator::estimate).
    pub fn estimate(&mut self, image: ArrayView2<'_, f32>) -> Result<Tracked> {
        let last = self.last.take();
        image::check(image)?;
        let dim = image.dim();
        let settings = self.settings;
        let plan = self.plan.get(dim, |dim| Plan::new(&settings, dim));
        plan.set(image);
        if let Some(last) = last.filter(|last| last.dim == dim)
            && let Some(outcome) = plan.follow(&last.outcome)
            && outcome.density >= LEAST_KEPT * last.searched
            && verdict::status(&outcome, plan.range) == Status::Ok
        {
            self.last = Some(Last { outcome, ..last });
            let blur = plan.result(&outcome, image, settings.acceleration);
            return Ok(Tracked { blur, tracked: true });
        }
        let Some(outcome) = plan.search(&mut |_| ()) else {
            return Ok(Tracked { blur: super::no_pattern(plan.range), tracked: false });
        };
        if verdict::status(&outcome, plan.range) == Status::Ok {
            self.last = Some(Last { dim, outcome, searched: outcome.density });
        }
        Ok(Tracked { blur: plan.result(&outcome, image, settings.acceleration), tracked: false })
    }
}
