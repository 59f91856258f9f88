//! The inner corners of a checkerboard: saddle points of the brightness that form a grid.

use nalgebra::Vector2;
use ndarray::{Array2, ArrayView2};

use super::grid::{Grid, Misfit, Place};
use super::{corner, smooth};
use crate::image::MIN_SIDE;
use crate::{Error, Result};

/// The board is looked for in pictures of at most this many pixels a side first, then in larger and smaller ones.
const FIRST_SIDE_PX: usize = 900;
/// Smoothing before saddles are looked for: fine for small squares, coarse for blurred or large ones.
const SIGMAS_PX: [f64; 2] = [1.5, 3.0];
/// So many saddles for each corner of the board are looked at, the strongest first.
const SADDLES_A_CORNER: usize = 10;
/// So many neighbours of a saddle are tried as the next of its column and row.
const NEIGHBOURS: usize = 6;
/// Least sine of the angle between columns and rows.
const LEAST_SINE: f64 = 0.2;
/// Part of the distance to the next parallel edge that the window of a corner takes.
const WINDOW: f64 = 0.45;
/// Smoothing before corners are refined: sharp edges, undersampled, would be drawn to the middles of the pixels.
const REFINE_SIGMA_PX: f64 = 1.0;
/// Radii of that window in pixels.
const WINDOW_PX: (f64, f64) = (2.5, 25.0);
/// Radius, in standard deviations of the smoothing, of the ring on which a saddle must look like a corner, and the samples
/// on it.
const RING_SIGMAS: f64 = 2.5;
const RING_SAMPLES: usize = 32;
/// Part of the contrast across a corner that opposite sides may differ by.
const ASYMMETRY: f64 = 0.5;

/// The corners of the board, row by row, each refined in a window of its own or in one of `half_window_px`.
pub(super) fn find(
    picture: ArrayView2<'_, f32>,
    columns: usize,
    rows: usize,
    half_window_px: Option<usize>,
) -> Result<Vec<[f64; 2]>> {
    let mut best = 0;
    let mut is_larger = false;
    let smooth = smooth::gaussian(picture, REFINE_SIGMA_PX);
    for (level, sigma) in attempts(picture) {
        let mut small = picture.to_owned();
        for _ in 0..level {
            small = smooth::halved(small.view());
        }
        match find_at(small.view(), sigma, columns, rows) {
            Ok(corners) => {
                let scale = f64::from(1_u32 << level);
                // Halving puts the pixel x at 2 x + 0.5.
                let whole = |p: Vector2<f64>| (p.add_scalar(0.5) * scale).add_scalar(-0.5);
                let refined: Option<Vec<[f64; 2]>> = corners
                    .iter()
                    .map(|found| {
                        let refined = match half_window_px {
                            None => corner::refine(smooth.view(), whole(found.point), found.window_px * scale),
                            Some(half_px) => corner::refine_in_square(picture, whole(found.point), half_px),
                        };
                        refined.map(<[f64; 2]>::from)
                    })
                    .collect();
                if let Some(refined) = refined {
                    return Ok(refined);
                }
            }
            Err(Misfit::Incomplete(found)) => best = best.max(found),
            Err(Misfit::Larger) => is_larger = true,
        }
    }
    if is_larger {
        Err(Error::BoardLarger { columns, rows })
    } else {
        Err(Error::BoardNotFound { columns, rows, found: best, needed: columns * rows })
    }
}

/// Sizes (as the number of halvings) and smoothings to try.
fn attempts(picture: ArrayView2<'_, f32>) -> Vec<(u32, f64)> {
    let (longest, shortest) = (picture.nrows().max(picture.ncols()), picture.nrows().min(picture.ncols()));
    let levels = |side: usize, least: usize| (0..16).take_while(|level| side >> level > least).count() as u32;
    let first = levels(longest, FIRST_SIDE_PX);
    let last = levels(shortest, 4 * MIN_SIDE).max(first + 1);
    let order = (0..=first).rev().chain(first + 1..last);
    order.flat_map(|level| SIGMAS_PX.map(|sigma| (level, sigma))).collect()
}

struct Corner {
    point: Vector2<f64>,
    window_px: f64,
}

/// A place where the brightness rises one way and falls the other.
struct Saddle {
    point: Vector2<f64>,
    /// Twice the angle of the direction in which it rises most, as a unit vector: neighbours have the opposite.
    rising: Vector2<f64>,
}

fn find_at(
    picture: ArrayView2<'_, f32>,
    sigma_px: f64,
    columns: usize,
    rows: usize,
) -> std::result::Result<Vec<Corner>, Misfit> {
    let needed = columns * rows;
    let smooth = smooth::gaussian(picture, sigma_px);
    let mut saddles = saddles(smooth.view(), needed * SADDLES_A_CORNER);
    saddles.retain(|saddle| is_corner(smooth.view(), saddle.point, RING_SIGMAS * sigma_px));
    let points: Vec<Vector2<f64>> = saddles.iter().map(|saddle| saddle.point).collect();
    let opposite = |a: usize, b: usize| saddles[a].rising.dot(&saddles[b].rising) < 0.0;
    let mut best = 0;
    let mut is_larger = false;
    // Saddles that were part of a grid large enough lead to it again.
    let mut seen = vec![false; points.len()];
    for seed in 0..points.len() {
        if seen[seed] {
            continue;
        }
        for steps in steps_of(&points, seed, opposite) {
            let grid = Grid::grow(&points, seed, steps, columns.max(rows), opposite);
            best = best.max(grid.len());
            match grid.part(&points, columns, rows) {
                Ok(places) => return Ok(places.iter().filter_map(|&place| corner_at(&grid, &points, place)).collect()),
                Err(Misfit::Larger) => is_larger = true,
                Err(Misfit::Incomplete(_)) => {}
            }
            if grid.len() * 2 > needed {
                grid.indices().for_each(|index| seen[index] = true);
            }
        }
    }
    Err(if is_larger { Misfit::Larger } else { Misfit::Incomplete(best) })
}

/// Whether opposite sides of a point are alike and neighbouring ones are not, on a ring around it (Bennett and Lasenby
/// 2014): not so at the outer corners of the board, where three quarters are bright.
fn is_corner(picture: ArrayView2<'_, f32>, centre: Vector2<f64>, radius_px: f64) -> bool {
    let ring: Option<Vec<f64>> = (0..RING_SAMPLES)
        .map(|i| {
            let (sin, cos) = (std::f64::consts::TAU * i as f64 / RING_SAMPLES as f64).sin_cos();
            smooth::at(picture, centre + radius_px * Vector2::new(cos, sin))
        })
        .collect();
    let Some(ring) = ring else { return false };
    let (half, quarter) = (RING_SAMPLES / 2, RING_SAMPLES / 4);
    let around = |i: usize| ring[i % RING_SAMPLES];
    let contrast: f64 = (0..quarter)
        .map(|i| (around(i) + around(i + half) - around(i + quarter) - around(i + half + quarter)).abs())
        .sum();
    let difference: f64 = (0..half).map(|i| (around(i) - around(i + half)).abs()).sum();
    difference < ASYMMETRY * contrast
}

fn corner_at(grid: &Grid, points: &[Vector2<f64>], place: Place) -> Option<Corner> {
    let [along, down] = grid.steps(points, place);
    let area = along.perp(&down).abs();
    let to_next_edge = area / along.norm().max(down.norm());
    let window_px = (WINDOW * to_next_edge).clamp(WINDOW_PX.0, WINDOW_PX.1);
    Some(Corner { point: points[grid.index(place)?], window_px })
}

/// Steps to the next column and the next row that the nearest saddles of the opposite kind suggest.
fn steps_of(points: &[Vector2<f64>], seed: usize, opposite: impl Fn(usize, usize) -> bool) -> Vec<[Vector2<f64>; 2]> {
    let mut around: Vec<Vector2<f64>> =
        (0..points.len()).filter(|&i| i != seed && opposite(seed, i)).map(|i| points[i] - points[seed]).collect();
    around.sort_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()));
    around.truncate(NEIGHBOURS);
    let mut pairs = Vec::new();
    for (first, &a) in around.iter().enumerate() {
        for &b in &around[first + 1..] {
            if a.perp(&b).abs() > LEAST_SINE * a.norm() * b.norm() {
                pairs.push([a, b]);
            }
        }
    }
    pairs
}

/// The strongest saddles of a smooth picture, the strongest first: maxima of `Ixy^2 - Ixx Iyy` (Chen and Zhang 2005).
fn saddles(picture: ArrayView2<'_, f32>, most: usize) -> Vec<Saddle> {
    let (rows, columns) = picture.dim();
    let mut strength = Array2::<f32>::zeros((rows, columns));
    for v in 1..rows - 1 {
        for u in 1..columns - 1 {
            let [xx, xy, yy] = second_derivatives(picture, v, u);
            strength[[v, u]] = xy * xy - xx * yy;
        }
    }
    let mut found = Vec::new();
    for v in 2..rows - 2 {
        for u in 2..columns - 2 {
            let here = strength[[v, u]];
            let is_peak = || (v - 2..=v + 2).all(|row| (u - 2..=u + 2).all(|column| strength[[row, column]] <= here));
            if here > 0.0 && is_peak() {
                found.push((here, v, u));
            }
        }
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found.truncate(most);
    found.iter().map(|&(_, v, u)| saddle(picture, v, u)).collect()
}

fn saddle(picture: ArrayView2<'_, f32>, v: usize, u: usize) -> Saddle {
    let [xx, xy, yy] = second_derivatives(picture, v, u).map(f64::from);
    let gradient = Vector2::new(
        0.5 * f64::from(picture[[v, u + 1]] - picture[[v, u - 1]]),
        0.5 * f64::from(picture[[v + 1, u]] - picture[[v - 1, u]]),
    );
    // Where the gradient of the quadratic is zero, if that is near.
    let offset = nalgebra::Matrix2::new(xx, xy, xy, yy)
        .try_inverse()
        .map(|inverse| -inverse * gradient)
        .filter(|offset| offset.amax() <= 1.5)
        .unwrap_or_default();
    let rising = Vector2::new(xx - yy, 2.0 * xy);
    Saddle { point: Vector2::new(u as f64, v as f64) + offset, rising: rising.try_normalize(0.0).unwrap_or_default() }
}

/// `Ixx`, `Ixy` and `Iyy` by differences.
fn second_derivatives(picture: ArrayView2<'_, f32>, v: usize, u: usize) -> [f32; 3] {
    let centre = 2.0 * picture[[v, u]];
    [
        picture[[v, u - 1]] + picture[[v, u + 1]] - centre,
        0.25 * (picture[[v + 1, u + 1]] + picture[[v - 1, u - 1]] - picture[[v + 1, u - 1]] - picture[[v - 1, u + 1]]),
        picture[[v - 1, u]] + picture[[v + 1, u]] - centre,
    ]
}
