//! The way from a picture's DFT to a direction that methods with a bank of patterns share.

use ndarray::ArrayView2;

use super::peak::no_direction;
use super::radon_search::{DIRECTIONS_DEG, RadonSearch};
use crate::estimate::front::DftFront;
use crate::estimate::per_size::PerSize;
use crate::estimate::{AngleEstimate, Settings};
use crate::projection::{PatternBank, Profile};
use crate::{Result, image};

/// Searches the levelled DFT of pictures for the direction that a bank of patterns matches best.
#[derive(Debug)]
pub(super) struct DftPattern {
    settings: Settings,
    /// Makes the bank for a profile and the shortest and longest length in pixels.
    bank: fn(&Profile, f64, f64) -> PatternBank,
    plan: PerSize<(DftFront, RadonSearch)>,
}

/// A rival direction with more than this share of the best match makes the answer doubtful.
pub(super) const MOST_RIVAL: f64 = 0.6;

impl DftPattern {
    pub(super) fn new(settings: &Settings, bank: fn(&Profile, f64, f64) -> PatternBank) -> Self {
        Self { settings: *settings, bank, plan: PerSize::new() }
    }

    pub(super) fn estimate(&mut self, image: ArrayView2<'_, f32>) -> Result<AngleEstimate> {
        image::check(image)?;
        let (settings, bank) = (self.settings, self.bank);
        let (front, search) = self.plan.get(image.dim(), |dim| {
            let front = DftFront::new(settings.window, dim);
            let range = settings.lengths_in(dim.0.max(dim.1) as f64);
            let search = RadonSearch::new(front.levelled(), dim, DIRECTIONS_DEG, |profile| {
                bank(profile, range.min_px(), range.max_px())
            });
            (front, search)
        });
        let found = search.find(front.set(image));
        Ok(found.map_or_else(no_direction, |found| found.peak.estimate(Some(found.std_deg), MOST_RIVAL)))
    }
}
