//! The fields of a map of the blur.

use blur_core::estimate::MotionBlur;
use blur_core::image::Window;
use blur_core::motion::{COVERAGE_K, RolledSpeed, Speed};
use blur_core::region::{MovingRegion, STILL, TileBlur, UNKNOWN};
use serde::Serialize;

use super::RolledSpeedFields;
use crate::Result;
use crate::map::Map;

/// The blur over the picture.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MapFields {
    /// Side of a tile.
    pub tile_px: usize,
    /// Distance of neighbouring tiles, at most.
    pub step_px: usize,
    /// The window under which tiles are measured: `hann` or `none`.
    pub window: &'static str,
    /// The tiles, row by row.
    pub tiles: Vec<TileFields>,
    /// What moves.
    pub regions: Vec<RegionFields>,
    /// Share of the pixels that stand still, 0 to 1.
    pub still_share: f64,
    /// Share of those that tell nothing.
    pub unknown_share: f64,
    /// Whether the time between the rows was not taken into account, because the readout is not known.
    pub readout_ignored: bool,
}

/// The blur of one tile; without contrast there is none.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TileFields {
    /// Column of its centre.
    pub x: f64,
    /// Row of its centre.
    pub y: f64,
    /// Its blur.
    #[serde(flatten)]
    pub blur: Option<BlurFields>,
}

/// Direction and length of a blur.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BlurFields {
    /// Axis in degrees, in `[0, 180)`.
    pub angle_deg: f64,
    /// Its standard uncertainty.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle_std_deg: Option<f64>,
    /// Length in pixels.
    pub length_px: f64,
    /// Its standard uncertainty.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub length_std_px: Option<f64>,
    /// Correlation coefficient of angle and length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correlation: Option<f64>,
    /// `ok`, `low_confidence` or `no_motion_blur`.
    pub status: &'static str,
    /// Why it is not `ok`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// A region that moves as one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RegionFields {
    /// Its number, from 1.
    pub label: u8,
    /// `moving`.
    pub kind: &'static str,
    /// Its pixels.
    pub area_px: usize,
    /// Column of the centre of its pixels.
    pub centroid_x: f64,
    /// Row of it.
    pub centroid_y: f64,
    /// Its blur.
    #[serde(flatten)]
    pub blur: BlurFields,
    /// Mean speed in metres per second.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed_m_s: Option<f64>,
    /// Its combined standard uncertainty.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed_std_m_s: Option<f64>,
    /// Its expanded uncertainty.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed_expanded_m_s: Option<f64>,
    /// Coverage factor of that.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coverage_k: Option<f64>,
    /// The speeds that a rolling shutter allows, when its readout is known.
    #[serde(flatten)]
    pub rolled: Option<RolledSpeedFields>,
}

/// What the blur of a region was in the scene.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RegionSpeed {
    /// Its speed.
    pub speed: Option<Speed>,
    /// Its speeds downwards and upwards under a rolling shutter.
    pub rolled: Option<[RolledSpeed; 2]>,
}

impl MapFields {
    /// The fields of `map`, measured under `window` in the part of the picture whose top left pixel is `origin`; `speed`
    /// turns a blur about a place, column and row, into a speed where that is possible. `readout_ignored` tells that nothing
    /// is known of the time between the rows.
    pub fn new(
        map: &Map,
        window: Option<Window>,
        origin: (usize, usize),
        readout_ignored: bool,
        speed: impl Fn(&MotionBlur, [f64; 2]) -> Result<RegionSpeed>,
    ) -> Result<Self> {
        let place = |(x, y): (f64, f64)| [x + origin.0 as f64, y + origin.1 as f64];
        let regions = map.segmentation.moving.iter().map(|region| {
            let centroid = place(region.centroid);
            Ok(region_fields(region, centroid, speed(&region.blur, centroid)?))
        });
        Ok(Self {
            tile_px: map.plan.tile_px(),
            step_px: map.plan.step_px(),
            window: if window == Some(Window::None) { "none" } else { "hann" },
            tiles: map.tiles.iter().map(|tile| tile_fields(tile, place(tile.centre()))).collect(),
            regions: regions.collect::<Result<_>>()?,
            still_share: map.segmentation.share(STILL),
            unknown_share: map.segmentation.share(UNKNOWN),
            readout_ignored,
        })
    }
}

fn tile_fields(tile: &TileBlur, [x, y]: [f64; 2]) -> TileFields {
    TileFields { x, y, blur: tile.blur.map(BlurFields::from) }
}

impl From<MotionBlur> for BlurFields {
    fn from(blur: MotionBlur) -> Self {
        Self {
            angle_deg: blur.angle.deg(),
            angle_std_deg: blur.angle_std_deg,
            length_px: blur.length_px,
            length_std_px: blur.length_std_px,
            correlation: blur.correlation,
            status: blur.status.name(),
            reason: blur.status.doubt().map(|doubt| doubt.to_string()),
        }
    }
}

fn region_fields(region: &MovingRegion, [centroid_x, centroid_y]: [f64; 2], found: RegionSpeed) -> RegionFields {
    let speed = found.speed;
    let speed_std_m_s = speed.and_then(|speed| speed.std_m_s);
    RegionFields {
        label: region.label,
        kind: "moving",
        area_px: region.area_px,
        centroid_x,
        centroid_y,
        blur: region.blur.into(),
        speed_m_s: speed.map(|speed| speed.value_m_s),
        speed_std_m_s,
        speed_expanded_m_s: speed.and_then(|speed| speed.expanded_m_s()),
        coverage_k: speed_std_m_s.map(|_| COVERAGE_K),
        rolled: found.rolled.map(RolledSpeedFields::new),
    }
}
