//! Blur that differs over the picture: what stands still, what moves, and how.
//!
//! The path of the data: [`tiles`](TileEstimator) that are measured one by one → the motions that several tiles agree
//! upon → the `texture` in every direction, scale by scale, and the `evidence` of the spectra around each point, which make
//! its `likeness` → which pixel follows which motion, with `borders` along edges → each moving region, measured as a whole. A part that the user marks comes as a [`Mask`].
//!
//! Programs with several threads hand out the tiles of a [`TilePlan`] and then call [`segment`] once, which uses all threads of
//! rayon's pool when the crate has the feature `rayon`.

mod borders;
mod candidates;
mod components;
mod cut;
mod evidence;
mod expansion;
mod gaussian;
mod grid;
mod likeness;
mod mask;
mod segmentation;
mod texture;
mod tiles;
mod weights;

pub use likeness::{LIKENESS_TERMS, LikenessPoint, likeness_terms, likeness_weights};
pub use mask::Mask;
pub use segmentation::{MovingRegion, STILL, Segmentation, UNKNOWN, segment};
pub use tiles::{LEAST_TILE_PX, TileBlur, TileEstimator, TilePlan, measure_tiles};
