//! Which pixel stands still, which follows which motion, and which tells nothing.

use ndarray::{Array2, ArrayView2, Axis, Slice};

use super::borders::Borders;
use super::candidates::{Candidate, candidates};
use super::components::{fill_holes, flood};
use super::expansion;
use super::grid::Grid;
use super::likeness::{Detail, log_odds};
use super::texture::Texture;
use super::tiles::TileBlur;
use super::weights::inside;
use crate::each::each;
use crate::estimate::joint::{MOST_FREQUENCY, Whittle};
use crate::estimate::{Doubt, MotionBlur, Settings, Status};
use crate::{Error, Result, image};

/// Label of pixels that stand still.
pub const STILL: u8 = 0;
/// Label of pixels whose surroundings have no texture that would tell.
pub const UNKNOWN: u8 = 255;

/// Least area of a moving region, in squares of the least side that can be measured.
const LEAST_SQUARES: usize = 4;
/// Rows and columns of a region that are measured, at most: those about its centre, as of a whole picture.
const MOST_MEASURED_PX: usize = 1024;

/// A motion that a region of its own bears out.
struct BorneOut {
    candidate: Candidate,
    /// The blur of that region.
    blur: MotionBlur,
    /// Whether that is beyond doubt, or in doubt only because of another blur that the tiles do not show.
    is_certain: bool,
    /// That region, with the label [`ALONE`].
    labels: Array2<u8>,
    /// Logarithms of its odds at the points.
    odds: Array2<f32>,
}

/// Label of a motion that has the picture to itself.
const ALONE: u8 = 1;
/// A region that overlaps by this much, as a share of both together, with one that was measured is not measured again.
const SAME_REGION: f64 = 0.9;

impl BorneOut {
    /// Whether the pixels that have `label` are as good as the region that bore it out.
    fn is_region(&self, labels: &Array2<u8>, label: u8) -> bool {
        let (mut both, mut either) = (0, 0);
        for (&own, &other) in self.labels.iter().zip(labels) {
            both += usize::from(own == ALONE && other == label);
            either += usize::from(own == ALONE || other == label);
        }
        both as f64 >= SAME_REGION * either as f64
    }
}

/// By how much the blur of a region may differ from that of its candidate, as a share of the length.
#[derive(Debug, Clone, Copy)]
struct Tolerance {
    /// When it is certain.
    certain: f64,
    /// When it is in doubt.
    doubtful: f64,
}

impl Tolerance {
    /// Whether the blur of a region may be that of the candidate.
    fn allows(self, candidate: &Candidate, blur: &MotionBlur) -> bool {
        match blur.status {
            Status::Ok => candidate.is_near(blur, self.certain),
            Status::LowConfidence(_) => candidate.is_near(blur, self.doubtful),
            Status::NoMotionBlur(_) => false,
        }
    }
}

/// Tiles reach over borders, so that a whole region corrects them ...
const OF_TILES: Tolerance = Tolerance { certain: f64::INFINITY, doubtful: 0.15 };
/// ... but the region that is found with the correction must bear it out.
const OF_REGIONS: Tolerance = Tolerance { certain: 0.15, doubtful: 0.1 };
/// Closer than this, blurs are the same.
const SAME: f64 = 0.04;

/// A part of the picture that moves as one.
#[derive(Debug, Clone, PartialEq)]
pub struct MovingRegion {
    /// Its label, from 1.
    pub label: u8,
    /// Pixels that have it.
    pub area_px: usize,
    /// Column and row of their centre.
    pub centroid: (f64, f64),
    /// The blur of the whole region, measured well inside it; of a large one its middle, 1024 pixels square. It is in doubt when
    /// it explains the low frequencies alone.
    pub blur: MotionBlur,
}

impl MovingRegion {
    /// The region, in doubt unless its blur explains the whole spectrum. Of a still picture, parts are found that look blurred:
    /// bars, folds, waves. Their low frequencies do, the others disagree.
    fn in_doubt_when_narrow(mut self) -> Self {
        let band = self.blur.evidence.map(|evidence| evidence.band_cycles_per_px);
        if let (Status::Ok, Some(cycles_per_px)) = (self.blur.status, band.filter(|&band| band < MOST_FREQUENCY)) {
            self.blur.status = Status::LowConfidence(Doubt::NarrowBand { cycles_per_px, needed: MOST_FREQUENCY });
        }
        self
    }

    /// The region when its blur is that of `motion`. When it is in doubt and another, the motion keeps what it was measured with
    /// certainty by itself, in doubt now too. One of the two measurements has to be certain: a still picture has parts that look
    /// blurred enough to be doubted.
    fn bears_out(self, motion: &BorneOut) -> Option<Self> {
        if self.blur.status != Status::Ok && !motion.is_certain {
            return None;
        }
        if OF_REGIONS.allows(&motion.candidate, &self.blur) {
            return Some(self);
        }
        match self.blur.status {
            Status::LowConfidence(_) if motion.is_certain => {
                Some(Self { blur: MotionBlur { status: self.blur.status, ..motion.blur }, ..self })
            }
            _ => None,
        }
    }
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
/// Tiles whose blurs agree make a motion. Every point of a grid, sixteen to the side of a tile, is then judged by its surroundings:
/// how much likelier the spectra of windows of 32 and 64 pixels are if the scene moves so, however its own spectrum falls and
/// whatever its anisotropy; what derivatives of four scales have left along the motion and across it; and whether the two ends of
/// the blur correlate negatively. Of all divisions one with short borders, best along edges, is taken that the points bear out; a
/// region hangs together and contains the centre of a tile that moves as it does. Each is measured again as a whole, well inside
/// its border: first for every motion by itself, which corrects the tiles; then, where regions have changed by more than a tenth,
/// for all that are left, which compete. A region
/// whose measurement is not that of its motion is given up: its pixels are unknown. Pixels without texture stand still only as
/// far as one can tell, which is not at all: they are unknown too.
///
/// Of the `settings` only the range of lengths counts.
///
/// # Errors
/// Those of [`image::check`]; [`Error::Parameter`] when the picture has less than 32 pixels a side.
pub fn segment(image: ArrayView2<'_, f32>, tiles: &[TileBlur], settings: &Settings) -> Result<Segmentation> {
    image::check(image)?;
    let settings = Settings { length_range: settings.length_range, ..Settings::default() };
    let points = Points::new(image, tiles);
    let motions = points.borne_out(image, candidates(tiles), &settings)?;
    let competing: Vec<(&Candidate, &Array2<f32>)> =
        motions.iter().map(|motion| (&motion.candidate, &motion.odds)).collect();
    let mut labels = points.divide(&competing);
    let numbered: Vec<(u8, &BorneOut)> = (1..).zip(&motions).collect();
    let regions = each(&numbered, |&(label, motion)| {
        let Some(place) = Place::of(&labels, label) else { return Ok(None) };
        let blur = if motion.is_region(&labels, label) {
            Some(motion.blur)
        } else {
            measure(image, &labels, label, place, motion.candidate.length_px, &settings)?
        };
        let region = blur.map(|blur| MovingRegion { label, area_px: place.area_px, centroid: place.centroid, blur });
        Ok(region.and_then(|region| region.bears_out(motion)).map(MovingRegion::in_doubt_when_narrow))
    });
    let mut moving: Vec<MovingRegion> = Vec::new();
    for (number, region) in regions.into_iter().collect::<Result<Vec<_>>>()?.into_iter().enumerate() {
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
    points.tell_unknown(&mut labels);
    Ok(Segmentation { labels, moving })
}

/// The points of a picture, and what is known of them whatever moves.
struct Points {
    dim: (usize, usize),
    texture: Texture,
    grid: Grid,
    borders: Borders,
}

impl Points {
    fn new(image: ArrayView2<'_, f32>, tiles: &[TileBlur]) -> Self {
        let texture = Texture::new(image);
        let grid = Grid::new(&texture, tiles.iter().map(|tile| tile.tile.width).max().unwrap_or_default());
        let borders = Borders::new(&texture, grid);
        Self { dim: image.dim(), texture, grid, borders }
    }

    /// The motions that a whole region bears out, as they were measured there. Each has the picture to itself: one that nothing
    /// follows must not take from others what they need.
    fn borne_out(
        &self,
        image: ArrayView2<'_, f32>,
        candidates: Vec<Candidate>,
        settings: &Settings,
    ) -> Result<Vec<BorneOut>> {
        let odds_of = |candidate: &Candidate, detail| log_odds(image, &self.texture, self.grid, candidate, detail);
        let regions = each(&candidates, |candidate| {
            // Many motions are tried, few borne out.
            let labels = self.divide(&[(candidate, &odds_of(candidate, Detail::Coarse))]);
            let Some(place) = Place::of(&labels, ALONE) else { return Ok(None) };
            let blur = measure(image, &labels, ALONE, place, candidate.length_px, settings)?;
            Ok(blur.filter(|blur| OF_TILES.allows(candidate, blur)).map(|blur| (blur, labels)))
        });
        let regions: Vec<Option<(MotionBlur, Array2<u8>)>> = regions.into_iter().collect::<Result<_>>()?;
        let mut found: Vec<BorneOut> = Vec::new();
        for (candidate, region) in candidates.into_iter().zip(regions) {
            let Some((blur, labels)) = region else { continue };
            let is_certain = match blur.status {
                Status::Ok => true,
                Status::LowConfidence(Doubt::RivalBlur { .. }) => OF_REGIONS.allows(&candidate, &blur),
                Status::LowConfidence(_) | Status::NoMotionBlur(_) => false,
            };
            if let Some(other) = found.iter_mut().find(|other| other.candidate.is_near(&blur, SAME)) {
                // Tiles that disagreed about one motion: it reaches whatever any of them does.
                other.candidate.seeds.extend(candidate.seeds);
                continue;
            }
            let candidate = if candidate.is_near(&blur, SAME) {
                candidate
            } else {
                Candidate { length_px: blur.length_px, angle: blur.angle, ..candidate }
            };
            found.push(BorneOut { candidate, blur, is_certain, labels, odds: Array2::default((0, 0)) });
        }
        let odds = each(&found, |motion| odds_of(&motion.candidate, Detail::Fine));
        for (motion, odds) in found.iter_mut().zip(odds) {
            motion.odds = odds;
        }
        Ok(found)
    }

    /// Labels of the pixels, of which a candidate has its number from 1: those that are likely by the logarithms of its odds.
    fn divide(&self, motions: &[(&Candidate, &Array2<f32>)]) -> Array2<u8> {
        if motions.is_empty() {
            return Array2::zeros(self.dim);
        }
        let still = Array2::zeros(self.grid.dim());
        let odds: Vec<Array2<f32>> =
            std::iter::once(&still).chain(motions.iter().map(|motion| motion.1)).cloned().collect();
        let mut labels = expansion::labels(&odds, &self.borders);
        for (number, (candidate, _)) in motions.iter().enumerate() {
            self.keep_seeded(&mut labels, number as u8 + 1, candidate);
        }
        for number in 0..motions.len() {
            fill_holes(&mut labels, number as u8 + 1);
        }
        self.grid.to_pixels(&labels, self.dim)
    }

    /// Of the parts that have `label`, those stay that contain the centre of one of the candidate's tiles.
    fn keep_seeded(&self, labels: &mut Array2<u8>, label: u8, candidate: &Candidate) {
        const KEPT: u8 = UNKNOWN;
        for &seed in &candidate.seeds {
            flood(labels, self.grid.nearest(seed), label, KEPT);
        }
        labels.mapv_inplace(|other| match other {
            KEPT => label,
            other if other == label => 0,
            other => other,
        });
    }

    /// Of what does not move, textured parts stand still; of the others one cannot tell.
    fn tell_unknown(&self, labels: &mut Array2<u8>) {
        for (pixel, label) in labels.indexed_iter_mut() {
            if *label == STILL && !self.texture.is_textured(pixel) {
                *label = UNKNOWN;
            }
        }
    }
}

/// The part of `count` rows or columns that is measured of a region with its centre at `centre`.
fn about(centre: f64, count: usize) -> Slice {
    let length = MOST_MEASURED_PX.min(count);
    let first = ((centre - 0.5 * length as f64).max(0.0) as usize).min(count - length);
    Slice::from(first..first + length)
}

/// Where a region is.
#[derive(Debug, Clone, Copy)]
struct Place {
    area_px: usize,
    /// Column and row.
    centroid: (f64, f64),
}

impl Place {
    /// That of the pixels that have `label`; `None` when they are too few to be measured.
    fn of(labels: &Array2<u8>, label: u8) -> Option<Self> {
        let (mut area_px, mut x, mut y) = (0, 0.0, 0.0);
        for ((row, column), _) in labels.indexed_iter().filter(|(_, other)| **other == label) {
            (area_px, x, y) = (area_px + 1, x + column as f64, y + row as f64);
        }
        let is_enough = area_px >= LEAST_SQUARES * image::MIN_SIDE * image::MIN_SIDE;
        is_enough.then(|| Self { area_px, centroid: (x / area_px as f64, y / area_px as f64) })
    }
}

/// The blur of the pixels that have `label`, which lie at `place` and may be blurred by `length_px`; `None` when they are too
/// narrow.
fn measure(
    image: ArrayView2<'_, f32>,
    labels: &Array2<u8>,
    label: u8,
    Place { area_px, centroid }: Place,
    length_px: f64,
    settings: &Settings,
) -> Result<Option<MotionBlur>> {
    // Of a large region its middle counts, if it has one.
    let (rows, columns) = labels.dim();
    let middle = (about(centroid.1, rows), about(centroid.0, columns));
    let of_middle = labels.slice_axis(Axis(0), middle.0);
    let of_middle = of_middle.slice_axis(Axis(1), middle.1);
    let is_there = of_middle.iter().filter(|&&other| other == label).count() >= area_px / 4;
    let (labels, image) = if is_there {
        let mut image = image;
        image.slice_axis_inplace(Axis(0), middle.0);
        image.slice_axis_inplace(Axis(1), middle.1);
        (of_middle, image)
    } else {
        (labels.view(), image)
    };
    let weights = inside(labels, label, length_px);
    match Whittle::new(settings).estimate_weighted(image, weights.view()) {
        Ok(blur) => Ok(Some(blur)),
        Err(Error::RegionTooNarrow { .. } | Error::Constant { .. } | Error::NoWeight { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::{AxialAngle, Evidence};

    fn region(band_cycles_per_px: f64, status: Status) -> MovingRegion {
        let evidence = Evidence {
            gain: 60.0,
            gain_per_bin: 0.1,
            rival_share: 0.0,
            gain_over_defocus: 50.0,
            incoherent_share: 0.01,
            peakedness: 1.0,
            misfit: 0.5,
            band_cycles_per_px,
            rows: 200,
            columns: 300,
        };
        let blur = MotionBlur {
            angle: AxialAngle::from_deg(100.0),
            angle_std_deg: Some(0.4),
            length_px: 26.0,
            length_std_px: Some(0.5),
            correlation: Some(0.0),
            direction_deg: None,
            status,
            evidence: Some(evidence),
            acceleration: None,
        };
        MovingRegion { label: 1, area_px: 40_000, centroid: (100.0, 80.0), blur }
    }

    #[test]
    fn a_region_whose_high_frequencies_disagree_is_in_doubt() {
        assert_eq!(region(0.5, Status::Ok).in_doubt_when_narrow(), region(0.5, Status::Ok));
        let narrow = region(0.225, Status::Ok).in_doubt_when_narrow().blur.status;
        assert_eq!(narrow, Status::LowConfidence(Doubt::NarrowBand { cycles_per_px: 0.225, needed: 0.5 }));
        // What is in doubt already keeps its reason.
        let doubtful = Status::LowConfidence(Doubt::SmallGain { gain: 3.0, needed: 18.0 });
        assert_eq!(region(0.1, doubtful).in_doubt_when_narrow().blur.status, doubtful);
    }
}
