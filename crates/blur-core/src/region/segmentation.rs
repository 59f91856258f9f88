//! Which pixel stands still, which follows which motion, and which tells nothing.

use ndarray::{Array2, ArrayView2};

use super::candidates::{Candidate, candidates};
use super::components::{fill_holes, flood, spread};
use super::each::each;
use super::expansion;
use super::likeness::log_odds;
use super::texture::{STEP_PX, Texture};
use super::tiles::TileBlur;
use super::weights::inside;
use crate::estimate::joint::Whittle;
use crate::estimate::{MotionBlur, Settings, Status};
use crate::{Error, Result, image};

/// Label of pixels that stand still.
pub const STILL: u8 = 0;
/// Label of pixels whose surroundings have no texture that would tell.
pub const UNKNOWN: u8 = 255;

/// Least area of a moving region, in squares of the least side that can be measured.
const LEAST_SQUARES: usize = 4;
/// Share of the blur by which the border of a region, as its texture shows it, is moved outwards along the motion. Over the
/// length of the blur the background shows through by and by; half of it is seen at the border proper, and no more than about
/// a quarter where the texture already looks still.
const SHOWN_THROUGH: f64 = 0.25;
/// Pixels by which a border is moved outwards in any case: a window that reaches over it sees the sharp texture outside
/// rather than the blurred one inside. On streets of odd kodak pictures and of dead leaves regions then miss about as much as
/// they add.
const OVERLOOKED_PX: f64 = 4.0;

/// A part of the picture that moves as one.
#[derive(Debug, Clone, PartialEq)]
pub struct MovingRegion {
    /// Its label, from 1.
    pub label: u8,
    /// Pixels that have it.
    pub area_px: usize,
    /// Column and row of their centre.
    pub centroid: (f64, f64),
    /// The blur of the whole region, measured well inside it.
    pub blur: MotionBlur,
}

/// A picture in parts.
#[derive(Debug, Clone, PartialEq)]
pub struct Segmentation {
    /// [`STILL`], [`UNKNOWN`] or the label of a moving region, for each pixel.
    pub labels: Array2<u8>,
    /// What moves, in the order of the labels.
    pub moving: Vec<MovingRegion>,
}

impl Segmentation {
    /// Share of the pixels that have `label`, 0 to 1.
    pub fn share(&self, label: u8) -> f64 {
        self.labels.iter().filter(|&&other| other == label).count() as f64 / self.labels.len() as f64
    }
}

/// Divides `image` by the motions that its `tiles` show.
///
/// Tiles whose blurs agree make a motion. Every point of a grid of 4 pixels is then judged by its surroundings of 5 and
/// 12 pixels: a motion takes the fine scales along its direction away, leaves those across it and makes the two ends of
/// the blur correlate negatively. Of all divisions one with short borders is taken that the points bear out; a region hangs
/// together and contains the centre of a tile that moves as it does. Each is measured again as a whole, well inside its
/// border. A region whose measurement is neither certain nor that of its tiles is given up: its pixels are unknown. Pixels
/// without texture stand still only as far as one can tell, which is not at all: they are unknown too.
///
/// Of the `settings` only the range of lengths counts.
///
/// # Errors
/// Those of [`image::check`]; [`Error::Parameter`] when the picture has less than 32 pixels a side.
pub fn segment(image: ArrayView2<'_, f32>, tiles: &[TileBlur], settings: &Settings) -> Result<Segmentation> {
    image::check(image)?;
    let texture = Texture::new(image);
    let settings = Settings { length_range: settings.length_range, ..Settings::default() };
    let candidates = confirmed(image, &texture, candidates(tiles), &settings)?;
    let mut labels = to_pixels(&moving_points(&texture, &candidates), &texture, &candidates, image.dim());
    let mut moving: Vec<MovingRegion> = Vec::new();
    for (number, region) in measure_all(image, &labels, &candidates, &settings)?.into_iter().enumerate() {
        let (found, label) = (number as u8 + 1, moving.len() as u8 + 1);
        let region = match region {
            Some(region) => {
                moving.push(MovingRegion { label, ..region });
                label
            }
            None => UNKNOWN,
        };
        labels.mapv_inplace(|other| if other == found { region } else { other });
    }
    Ok(Segmentation { labels, moving })
}

/// The motions that a whole region bears out, as they were measured there: only these compete in the end.
fn confirmed(
    image: ArrayView2<'_, f32>,
    texture: &Texture,
    candidates: Vec<Candidate>,
    settings: &Settings,
) -> Result<Vec<Candidate>> {
    let labels = to_pixels(&moving_points(texture, &candidates), texture, &candidates, image.dim());
    let regions = measure_all(image, &labels, &candidates, settings)?;
    let confirmed = candidates.into_iter().zip(regions).filter_map(|(candidate, region)| {
        let MotionBlur { length_px, angle, .. } = region?.blur;
        Some(Candidate { length_px, angle, ..candidate })
    });
    Ok(confirmed.collect())
}

/// The region of each candidate, which has its number from 1 as its label.
fn measure_all(
    image: ArrayView2<'_, f32>,
    labels: &Array2<u8>,
    candidates: &[Candidate],
    settings: &Settings,
) -> Result<Vec<Option<MovingRegion>>> {
    let numbered: Vec<(u8, &Candidate)> = (1..).zip(candidates).collect();
    let measured =
        each(&numbered, |&(label, candidate)| measure(image, labels, label, candidate, &mut Whittle::new(settings)));
    measured.into_iter().collect()
}

/// Labels of the points of the grid: 0, or the number of a candidate from 1.
fn moving_points(texture: &Texture, candidates: &[Candidate]) -> Array2<u8> {
    if candidates.is_empty() {
        return Array2::zeros(texture.dim());
    }
    let mut odds = vec![Array2::zeros(texture.dim())];
    odds.extend(each(candidates, |candidate| log_odds(texture, candidate)));
    let mut labels = expansion::labels(&odds);
    for (number, candidate) in candidates.iter().enumerate() {
        keep_seeded(&mut labels, number as u8 + 1, candidate);
    }
    for number in 0..candidates.len() {
        fill_holes(&mut labels, number as u8 + 1);
    }
    labels
}

/// Of the parts that have `label`, those stay that contain the centre of one of the candidate's tiles.
fn keep_seeded(labels: &mut Array2<u8>, label: u8, candidate: &Candidate) {
    const KEPT: u8 = UNKNOWN;
    for &(x, y) in &candidate.seeds {
        flood(labels, (y as usize / STEP_PX, x as usize / STEP_PX), label, KEPT);
    }
    labels.mapv_inplace(|other| match other {
        KEPT => label,
        other if other == label => 0,
        other => other,
    });
}

/// Labels of the pixels: each has that of the nearest point of the grid. Of what does not move, textured parts stand still.
fn to_pixels(grid: &Array2<u8>, texture: &Texture, candidates: &[Candidate], dim: (usize, usize)) -> Array2<u8> {
    let (rows, columns) = grid.dim();
    let mut labels = Array2::from_shape_fn(dim, |(row, column)| {
        let at = ((row / STEP_PX).min(rows - 1), (column / STEP_PX).min(columns - 1));
        match grid[at] {
            0 if texture.is_textured(at) => STILL,
            0 => UNKNOWN,
            moving => moving,
        }
    });
    for (number, candidate) in candidates.iter().enumerate() {
        let (sin, cos) = candidate.angle.rad().sin_cos();
        let moves = |other| other != STILL && other != UNKNOWN;
        let along = OVERLOOKED_PX + SHOWN_THROUGH * candidate.length_px;
        for (half_px, direction) in [(along, (cos, -sin)), (OVERLOOKED_PX, (sin, cos))] {
            spread(&mut labels, number as u8 + 1, half_px, direction, moves);
        }
    }
    labels
}

/// The region of the pixels that have `label`; `None` when it shows no motion.
fn measure(
    image: ArrayView2<'_, f32>,
    labels: &Array2<u8>,
    label: u8,
    candidate: &Candidate,
    whittle: &mut Whittle,
) -> Result<Option<MovingRegion>> {
    let (mut area_px, mut x, mut y) = (0, 0.0, 0.0);
    for ((row, column), _) in labels.indexed_iter().filter(|(_, other)| **other == label) {
        (area_px, x, y) = (area_px + 1, x + column as f64, y + row as f64);
    }
    if area_px < LEAST_SQUARES * image::MIN_SIDE * image::MIN_SIDE {
        return Ok(None);
    }
    let weights = inside(labels.view(), label, candidate.length_px);
    let blur = match whittle.estimate_weighted(image, weights.view()) {
        Ok(blur) => blur,
        Err(Error::RegionTooNarrow { .. } | Error::Constant { .. } | Error::NoWeight { .. }) => return Ok(None),
        Err(error) => return Err(error),
    };
    let confirmed = match blur.status {
        Status::Ok => true,
        Status::LowConfidence(_) => candidate.is_near(&blur),
        Status::NoMotionBlur(_) => false,
    };
    if !confirmed {
        return Ok(None);
    }
    let centroid = (x / area_px as f64, y / area_px as f64);
    Ok(Some(MovingRegion { label, area_px, centroid, blur }))
}
