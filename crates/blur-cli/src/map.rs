//! The blur tile by tile, and what stands still and what moves.

use std::sync::atomic::{AtomicUsize, Ordering};

use blur_core::estimate::Settings;
use blur_core::region::{Segmentation, TileBlur, TileEstimator, TilePlan, segment};
use ndarray::ArrayView2;
use rayon::iter::{IntoParallelIterator, ParallelIterator};

use crate::Result;

/// The map of one picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// How the picture was cut.
    pub plan: TilePlan,
    /// Its tiles, row by row.
    pub tiles: Vec<TileBlur>,
    /// What stands still and what moves.
    pub segmentation: Segmentation,
}

impl Map {
    /// Measures `image` in tiles of `tile_px` on the threads of the present pool, each with its own estimator. The result
    /// does not depend on their number.
    pub fn measure(image: ArrayView2<'_, f32>, tile_px: usize, settings: &Settings) -> Result<Self> {
        blur_core::image::check(image)?;
        let plan = TilePlan::new(image.dim(), tile_px)?;
        let threads = rayon::current_num_threads().min(plan.len());
        let next = AtomicUsize::new(0);
        let measured: Vec<Vec<(usize, TileBlur)>> = (0..threads)
            .into_par_iter()
            .map(|_| {
                // Tiles take longer or shorter: whoever is free takes the next one.
                let taken = || Some(next.fetch_add(1, Ordering::Relaxed)).filter(|&tile| tile < plan.len());
                let Some(mut tile) = taken() else { return Ok(Vec::new()) };
                let mut estimator = TileEstimator::new(plan, settings)?;
                let mut measured = Vec::new();
                loop {
                    measured.push((tile, estimator.estimate(image, tile)?));
                    match taken() {
                        Some(other) => tile = other,
                        None => return Ok(measured),
                    }
                }
            })
            .collect::<blur_core::Result<_>>()?;
        let mut measured: Vec<(usize, TileBlur)> = measured.into_iter().flatten().collect();
        measured.sort_unstable_by_key(|(tile, _)| *tile);
        let tiles: Vec<TileBlur> = measured.into_iter().map(|(_, blur)| blur).collect();
        let segmentation = segment(image, &tiles, settings)?;
        Ok(Self { plan, tiles, segmentation })
    }
}
