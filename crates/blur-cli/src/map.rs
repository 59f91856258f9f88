//! The blur tile by tile, and what stands still and what moves.

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
        let shares: Vec<Vec<TileBlur>> = (0..threads)
            .into_par_iter()
            .map(|thread| {
                let mut estimator = TileEstimator::new(plan, settings)?;
                (thread..plan.len()).step_by(threads).map(|tile| estimator.estimate(image, tile)).collect()
            })
            .collect::<blur_core::Result<_>>()?;
        // Tile `i` is number `i / threads` of thread `i % threads`.
        let tiles: Vec<TileBlur> = (0..plan.len()).map(|tile| shares[tile % threads][tile / threads]).collect();
        let segmentation = segment(image, &tiles, settings)?;
        Ok(Self { plan, tiles, segmentation })
    }
}
