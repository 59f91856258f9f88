//! Separate dark squares on white (Zhang 2000): their corners, from lines along their edges.

use nalgebra::Vector2;
use ndarray::{Array2, ArrayView2};

use super::grid::{Grid, Misfit, Place};
use super::{edge, smooth};
use crate::{Error, Result};

/// Corners of a square in units of its side, in turn around it.
pub(super) const CORNERS: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

/// Reaches of the local mean that tells dark from bright, as parts of the picture's longer side.
const MEAN_REACHES: [f64; 3] = [1.0 / 16.0, 1.0 / 8.0, 1.0 / 32.0];
/// Dark is less than this part of the local mean of the picture above its darkest.
const DARK: f32 = 0.8;
/// Fewest pixels of a square.
const MIN_PIXELS: usize = 36;
/// A quadrilateral and its pixels may differ in area by this part.
const AREA_TOLERANCE: f64 = 0.2;

/// The corners of `columns` by `rows` squares, row by row, four for each. `pitch` is in sides of a square.
pub(super) fn find(picture: ArrayView2<'_, f32>, columns: usize, rows: usize, pitch: f64) -> Result<Vec<[f64; 2]>> {
    let needed = 4 * columns * rows;
    let mut best = 0;
    let mut is_larger = false;
    for part in MEAN_REACHES {
        let reach = part * picture.nrows().max(picture.ncols()) as f64;
        let squares: Vec<[Vector2<f64>; 4]> = blobs(&dark(picture, reach as usize))
            .iter()
            .filter_map(|blob| edge::refine(picture, quadrilateral(blob)?))
            .collect();
        match assemble(&squares, columns, rows, pitch) {
            Ok(corners) => return Ok(corners),
            Err(Misfit::Incomplete(found)) => best = best.max(found),
            Err(Misfit::Larger) => is_larger = true,
        }
    }
    if is_larger {
        Err(Error::BoardLarger { columns, rows })
    } else {
        Err(Error::BoardNotFound { columns, rows, found: 4 * best, needed })
    }
}

fn assemble(
    squares: &[[Vector2<f64>; 4]],
    columns: usize,
    rows: usize,
    pitch: f64,
) -> std::result::Result<Vec<[f64; 2]>, Misfit> {
    let centres: Vec<Vector2<f64>> = squares.iter().map(|s| s.iter().sum::<Vector2<f64>>() / 4.0).collect();
    let mut misfit = Misfit::Incomplete(0);
    let mut most = 0;
    for (seed, square) in squares.iter().enumerate() {
        let steps = [(square[1] - square[0]) * pitch, (square[3] - square[0]) * pitch];
        let grid = Grid::grow(&centres, seed, steps, columns.max(rows), |_, _| true);
        match grid.part(&centres, columns, rows) {
            Ok(places) => return Ok(corners(&grid, squares, &centres, &places, columns)),
            Err(Misfit::Larger) => return Err(Misfit::Larger),
            Err(Misfit::Incomplete(_)) if grid.len() > most => {
                most = grid.len();
                misfit = Misfit::Incomplete(most);
            }
            Err(Misfit::Incomplete(_)) => {}
        }
    }
    Err(misfit)
}

/// The corners of all squares, each from the one nearest to the board's origin onwards.
fn corners(
    grid: &Grid,
    squares: &[[Vector2<f64>; 4]],
    centres: &[Vector2<f64>],
    places: &[Place],
    columns: usize,
) -> Vec<[f64; 2]> {
    let order: Vec<usize> = places.iter().filter_map(|&place| grid.index(place)).collect();
    let toward = |from: Option<&usize>, to: Option<&usize>| match (from, to) {
        (Some(&from), Some(&to)) => Some(centres[to] - centres[from]),
        _ => None,
    };
    let mut found = Vec::with_capacity(4 * order.len());
    for (at, &index) in order.iter().enumerate() {
        let is_last = (at + 1) % columns == 0;
        let along =
            if is_last { toward(order.get(at - 1), Some(&index)) } else { toward(Some(&index), order.get(at + 1)) };
        let down = toward(Some(&index), order.get(at + columns))
            .or_else(|| toward(at.checked_sub(columns).and_then(|above| order.get(above)), Some(&index)));
        let (Some(along), Some(down)) = (along, down) else { continue };
        for [i, j] in CORNERS {
            let outwards = along * (i - 0.5) + down * (j - 0.5);
            let nearest = squares[index]
                .iter()
                .max_by(|a, b| (*a - centres[index]).dot(&outwards).total_cmp(&(*b - centres[index]).dot(&outwards)));
            found.extend(nearest.map(|&corner| <[f64; 2]>::from(corner)));
        }
    }
    found
}

/// Which pixels are darker than their surroundings within `reach` pixels.
fn dark(picture: ArrayView2<'_, f32>, reach: usize) -> Array2<bool> {
    let darkest = picture.iter().copied().fold(f32::INFINITY, f32::min);
    let mean = smooth::box_mean(picture, reach);
    let mut dark = Array2::from_elem(picture.dim(), false);
    ndarray::Zip::from(&mut dark)
        .and(picture)
        .and(&mean)
        .for_each(|dark, &value, &mean| *dark = value - darkest < DARK * (mean - darkest));
    dark
}

/// Connected dark regions that do not touch the border, as lists of pixel centres.
fn blobs(dark: &Array2<bool>) -> Vec<Vec<Vector2<f64>>> {
    let (rows, columns) = dark.dim();
    let mut seen = Array2::from_elem(dark.dim(), false);
    let mut blobs = Vec::new();
    for start in ndarray::indices_of(dark) {
        if seen[start] || !dark[start] {
            continue;
        }
        seen[start] = true;
        let mut open = vec![start];
        let mut pixels = Vec::new();
        let mut touches = false;
        while let Some((v, u)) = open.pop() {
            pixels.push(Vector2::new(u as f64, v as f64));
            if v == 0 || u == 0 || v + 1 == rows || u + 1 == columns {
                touches = true;
                continue;
            }
            for next in [(v - 1, u), (v + 1, u), (v, u - 1), (v, u + 1)] {
                if dark[next] && !seen[next] {
                    seen[next] = true;
                    open.push(next);
                }
            }
        }
        if !touches && pixels.len() >= MIN_PIXELS {
            blobs.push(pixels);
        }
    }
    blobs
}

/// The corners of a region in turn, if it is a quadrilateral: the point farthest from the middle, the point farthest from
/// that, and those farthest to both sides of the line between.
fn quadrilateral(pixels: &[Vector2<f64>]) -> Option<[Vector2<f64>; 4]> {
    let farthest =
        |score: &dyn Fn(&Vector2<f64>) -> f64| pixels.iter().copied().max_by(|a, b| score(a).total_cmp(&score(b)));
    let middle = pixels.iter().sum::<Vector2<f64>>() / pixels.len() as f64;
    let first = farthest(&|p| (p - middle).norm_squared())?;
    let third = farthest(&|p| (p - first).norm_squared())?;
    let diagonal = third - first;
    let second = farthest(&|p| (p - first).perp(&diagonal))?;
    let fourth = farthest(&|p| diagonal.perp(&(p - first)))?;
    let corners = [first, second, third, fourth];
    // Pixel centres span a quadrilateral that is half a pixel smaller all around.
    let area = 0.5 * diagonal.perp(&(fourth - second)).abs();
    let perimeter: f64 = (0..4).map(|i| (corners[(i + 1) % 4] - corners[i]).norm()).sum();
    let filled = pixels.len() as f64 / (area + 0.5 * perimeter + 1.0);
    ((filled - 1.0).abs() <= AREA_TOLERANCE).then_some(corners)
}
