//! The tiles that a picture is cut into, and the blur of each.

use ndarray::ArrayView2;

use crate::estimate::joint::Whittle;
use crate::estimate::{JointEstimator, LengthRange, MotionBlur, Settings};
use crate::image::{self, Region, Window};
use crate::{Error, Result};

/// Least side of a tile in pixels.
pub const LEAST_TILE_PX: usize = 64;
/// Longest blur looked for in a tile, as a share of its side: a window must be twice as long as the blur (thesis,
/// table 7.2).
const MOST_OF_TILE: f64 = 0.5;
/// Shortest blur looked for in a tile, in pixels.
const LEAST_LENGTH_PX: f64 = 4.0;

/// A picture cut into square tiles that overlap by half or a little more, so that they reach every border.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TilePlan {
    rows: usize,
    columns: usize,
    tile_px: usize,
    down: usize,
    across: usize,
}

impl TilePlan {
    /// Tiles of `tile_px` pixels each way for a picture of `(rows, columns)`.
    ///
    /// # Errors
    /// [`Error::Parameter`] for tiles of less than [`LEAST_TILE_PX`], [`Error::TileTooLarge`] for such that the picture
    /// cannot hold.
    pub fn new((rows, columns): (usize, usize), tile_px: usize) -> Result<Self> {
        if tile_px < LEAST_TILE_PX {
            return Err(Error::Parameter {
                name: "side of a tile (px)",
                value: tile_px as f64,
                expected: "at least 64",
            });
        }
        if tile_px > rows.min(columns) {
            return Err(Error::TileTooLarge { tile_px, width: columns, height: rows });
        }
        let steps = |side: usize| (side - tile_px).div_ceil(tile_px / 2) + 1;
        Ok(Self { rows, columns, tile_px, down: steps(rows), across: steps(columns) })
    }

    /// Rows and columns of the picture.
    pub fn dim(&self) -> (usize, usize) {
        (self.rows, self.columns)
    }

    /// Tiles from top to bottom and from left to right.
    pub fn grid(&self) -> (usize, usize) {
        (self.down, self.across)
    }

    /// Side of a tile in pixels.
    pub fn tile_px(&self) -> usize {
        self.tile_px
    }

    /// Largest distance in pixels between neighbouring tiles: half a tile, except in a picture of one tile.
    pub fn step_px(&self) -> usize {
        self.tile_px / 2
    }

    /// Number of tiles.
    pub fn len(&self) -> usize {
        self.down * self.across
    }

    /// Never: a plan has at least one tile.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The tile number `index`, row by row from the top left; the last one for any number beyond.
    pub fn tile(&self, index: usize) -> Region {
        let index = index.min(self.len() - 1);
        let place = |i: usize, count: usize, side: usize| {
            if count < 2 { 0 } else { (2 * i * (side - self.tile_px) + count - 1) / (2 * (count - 1)) }
        };
        Region {
            x: place(index % self.across, self.across, self.columns),
            y: place(index / self.across, self.down, self.rows),
            width: self.tile_px,
            height: self.tile_px,
        }
    }
}

/// The blur of one tile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TileBlur {
    /// Where the tile lies.
    pub tile: Region,
    /// Its blur; `None` for a tile without any contrast.
    pub blur: Option<MotionBlur>,
}

impl TileBlur {
    /// Column and row of the tile's centre.
    pub fn centre(&self) -> (f64, f64) {
        let Region { x, y, width, height } = self.tile;
        (x as f64 + 0.5 * (width as f64 - 1.0), y as f64 + 0.5 * (height as f64 - 1.0))
    }
}

/// Measures tiles by [`Whittle`] under a Hann window, or that of the settings. One for each thread; nothing is
/// allocated after the first tile.
#[derive(Debug)]
pub struct TileEstimator {
    plan: TilePlan,
    whittle: Whittle,
}

impl TileEstimator {
    /// For the tiles of `plan`. Of the settings, window and range of lengths count; without a range, lengths up to half
    /// the tile are searched.
    ///
    /// # Errors
    /// None for a plan that could be made.
    pub fn new(plan: TilePlan, settings: &Settings) -> Result<Self> {
        let range = LengthRange::new(LEAST_LENGTH_PX, MOST_OF_TILE * plan.tile_px as f64)?;
        let settings = Settings {
            window: Some(settings.window.unwrap_or(Window::Hann)),
            length_range: Some(settings.length_range.unwrap_or(range)),
            acceleration: false,
        };
        Ok(Self { plan, whittle: Whittle::new(&settings) })
    }

    /// The blur of tile number `index` of `image`, which has the size of the plan.
    ///
    /// # Errors
    /// [`Error::RegionOutside`] for a picture of another size, [`Error::NotFinite`] for a pixel that is no number.
    pub fn estimate(&mut self, image: ArrayView2<'_, f32>, index: usize) -> Result<TileBlur> {
        let tile = self.plan.tile(index);
        let view = tile.of(image)?;
        let blur = match self.whittle.estimate(view) {
            Ok(blur) => Some(blur),
            // A cloudless sky is no error.
            Err(Error::Constant { .. }) => None,
            Err(error) => return Err(error),
        };
        Ok(TileBlur { tile, blur })
    }
}

/// Measures all tiles of `image` one after the other. Programs with several threads give each its own
/// [`TileEstimator`] and take the tiles in any order: the results are the same.
///
/// # Errors
/// Those of [`image::check`] and [`TileEstimator::estimate`].
pub fn measure_tiles(image: ArrayView2<'_, f32>, plan: TilePlan, settings: &Settings) -> Result<Vec<TileBlur>> {
    image::check(image)?;
    let mut estimator = TileEstimator::new(plan, settings)?;
    (0..plan.len()).map(|index| estimator.estimate(image, index)).collect()
}
