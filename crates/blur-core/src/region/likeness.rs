//! How much a point looks as if it moved.

use ndarray::{Array2, ArrayView2};

use super::candidates::Candidate;
use super::evidence::Cells;
use super::grid::Grid;
use super::texture::{CORRELATED, SCALES, Texture, WINDOWS};
use crate::each::each;
use crate::estimate::AxialAngle;
use crate::{Result, image};

/// Windows in which the spectrum around a point is looked at: side in pixels, what the logarithm of the likelihood of a bin counts
/// there, and steps of the grid from one window to the next.
const SPECTRA: [(usize, f64, usize); 2] = [(32, 1.0, 1), (64, 0.25, 2)];
/// The evidence of a spectrum counts once for each of these, up to about which it counts in proportion.
const LIMITS: [f32; 3] = [5.0, 20.0, 80.0];
/// Terms that the logarithm of the odds is a sum of: along and across the motion the logarithms of the energy, by scale, then
/// by window, and at the scales that have one the correlation of the blur's ends; then the evidence of the spectra, limited.
pub const LIKENESS_TERMS: usize = 2 * SCALES * WINDOWS + CORRELATED.len() * WINDOWS + SPECTRA.len() * LIMITS.len();
type Terms = [f32; LIKENESS_TERMS];

/// Logistic regression of "this point moves so", learnt by `cargo run --release -p e2e-tests --bin learn-likeness` from streets
/// (`blur_sim::street`) of design pictures, their objects and their backgrounds weighted alike. That was with half the noise and a third of the incoherent power that
/// `evidence` counts now, which made fewer regions wrong.
const WEIGHTS: Terms = [
    -0.12, 0.05, 0.32, 0.37, -0.08, -0.30, 0.04, -0.51, 0.47, -3.01, 0.30, 0.07, 0.26, -1.46, -0.33, -0.76, 0.15,
    -0.19, 1.41, 0.05, 0.02, 2.26, -0.19, 0.89, 1.71, -2.74,
];
const INTERCEPT: f32 = -0.10;

/// How closely spectra are looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Detail {
    /// Enough to find a region, not its border.
    Coarse,
    /// As closely as they tell something.
    Fine,
}

impl Detail {
    /// Least steps of the grid from one window to the next.
    fn steps(self) -> usize {
        match self {
            Self::Coarse => 2,
            Self::Fine => 1,
        }
    }
}

/// Logarithm of the odds that each point of the grid moves as `candidate`, or minus infinity where it cannot.
pub(super) fn log_odds(
    image: ArrayView2<'_, f32>,
    texture: &Texture,
    grid: Grid,
    candidate: &Candidate,
    detail: Detail,
) -> Array2<f32> {
    let terms = terms(image, texture, grid, candidate, detail);
    terms.mapv(|terms| match terms {
        Some(terms) => INTERCEPT + terms.iter().zip(WEIGHTS).map(|(term, weight)| weight * term).sum::<f32>(),
        None => f32::NEG_INFINITY,
    })
}

/// A point of a picture and what the odds that it moves are a sum of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LikenessPoint {
    /// Row and column of its pixel.
    pub pixel: (usize, usize),
    /// The terms, which are still to be weighted.
    pub terms: [f32; LIKENESS_TERMS],
}

/// What the odds of a motion by `length_px` along `angle` are a sum of, at the points of the grid for tiles of `tile_px`. For
/// learning the weights.
///
/// # Errors
/// Those of [`image::check`](crate::image::check).
pub fn likeness_terms(
    image: ArrayView2<'_, f32>,
    (length_px, angle): (f64, AxialAngle),
    tile_px: usize,
) -> Result<Vec<LikenessPoint>> {
    image::check(image)?;
    let texture = Texture::new(image);
    let grid = Grid::new(&texture, tile_px);
    let everywhere = Candidate { length_px, angle, seeds: vec![(0.0, 0.0)], reach_px: f64::INFINITY };
    let terms = terms(image, &texture, grid, &everywhere, Detail::Fine);
    let points = terms
        .indexed_iter()
        .filter_map(|(point, terms)| terms.map(|terms| LikenessPoint { pixel: grid.pixel(point), terms }));
    Ok(points.collect())
}

/// Intercept and weights of the terms in use.
pub fn likeness_weights() -> (f32, [f32; LIKENESS_TERMS]) {
    (INTERCEPT, WEIGHTS)
}

/// The terms of each point of the grid that `candidate` reaches.
fn terms(
    image: ArrayView2<'_, f32>,
    texture: &Texture,
    grid: Grid,
    candidate: &Candidate,
    detail: Detail,
) -> Array2<Option<Terms>> {
    let (sin, cos) = candidate.angle.rad().sin_cos();
    // Rows count downwards.
    let direction = (cos as f32, -sin as f32);
    let correlations: Vec<Vec<Array2<f32>>> =
        (0..CORRELATED.len()).map(|index| texture.end_correlations(index, candidate.length_px, direction)).collect();
    let spectra = SPECTRA.map(|(side, tempering, every)| {
        let cells = Cells::new(side, tempering, candidate.length_px, candidate.angle);
        evidence(image, texture.noise_variance(), grid, candidate, (&cells, every.max(detail.steps())))
    });
    let (rows, columns) = grid.dim();
    let of_row = |&row: &usize| {
        let of_point = |column: usize| {
            let (point, at) = ((row, column), grid.of_texture((row, column)));
            if !reaches(candidate, grid, point) {
                return None;
            }
            let (mut terms, mut filled) = ([0.0; LIKENESS_TERMS], 0);
            let mut put = |term: f32| {
                terms[filled] = term;
                filled += 1;
            };
            for scale in 0..SCALES {
                let correlations =
                    CORRELATED.iter().position(|&correlated| correlated == scale).map(|i| &correlations[i]);
                for window in 0..WINDOWS {
                    let [along, across] = texture.log_energies((scale, window), at, direction);
                    put(along);
                    put(across);
                    if let Some(correlations) = correlations {
                        put(correlations[window][at]);
                    }
                }
            }
            for evidence in &spectra {
                for limit in LIMITS {
                    put((evidence[point] / limit).tanh());
                }
            }
            Some(terms)
        };
        (0..columns).map(of_point).collect::<Vec<_>>()
    };
    let of_rows: Vec<Vec<Option<Terms>>> = each(&(0..rows).collect::<Vec<_>>(), of_row);
    Array2::from_shape_fn((rows, columns), |(row, column)| of_rows[row][column])
}

fn reaches(candidate: &Candidate, grid: Grid, point: (usize, usize)) -> bool {
    let (row, column) = grid.pixel(point);
    candidate.reaches(column as f64, row as f64)
}

/// The evidence around each point that `candidate` reaches, from windows around every so-many-th point each way: between them it
/// changes linearly.
fn evidence(
    image: ArrayView2<'_, f32>,
    noise_variance: f64,
    grid: Grid,
    candidate: &Candidate,
    (cells, every): (&Cells, usize),
) -> Array2<f32> {
    let (rows, columns) = grid.dim();
    let (coarse_rows, coarse_columns) = (rows.div_ceil(every), columns.div_ceil(every));
    let near = Candidate { reach_px: candidate.reach_px + (every * grid.step_px()) as f64, ..candidate.clone() };
    let of_row = |&row: &usize| {
        let mut workspace = cells.workspace();
        let mut of_point = |column: usize| {
            let point = (row * every, column * every);
            if !reaches(&near, grid, point) {
                return 0.0;
            }
            cells.evidence(&mut workspace, image, noise_variance, grid.pixel(point))
        };
        (0..coarse_columns).map(&mut of_point).collect::<Vec<f32>>()
    };
    let coarse = each(&(0..coarse_rows).collect::<Vec<_>>(), of_row);
    Array2::from_shape_fn((rows, columns), |(row, column)| {
        let (top, left) = (row / every, column / every);
        let (bottom, right) = ((top + 1).min(coarse_rows - 1), (left + 1).min(coarse_columns - 1));
        let (down, across) = ((row % every) as f32 / every as f32, (column % every) as f32 / every as f32);
        let above = coarse[top][left] + across * (coarse[top][right] - coarse[top][left]);
        let below = coarse[bottom][left] + across * (coarse[bottom][right] - coarse[bottom][left]);
        above + down * (below - above)
    })
}
