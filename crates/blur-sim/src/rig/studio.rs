//! Takes the pictures.

use super::shot::check_poster;
use super::{POSTERS, Pass, Rig, Setting, Shot, Still};
use crate::displaced::Displaced;
use crate::expose::{Blur, Exposer};
use crate::motion::Motion;
use crate::sensor::Sensor;
use crate::{Error, Result};
use blur_core::estimate::AxialAngle;
use ndarray::{ArcArray2, Array2, ArrayView2};
use std::fmt;

/// Pixels of a poster beyond the picture on every side: what a motion of 90 pixels brings in, and some more where the
/// surroundings of the poster, which are unknown, would show.
const MARGIN_PX: usize = 112;

/// The rig with its posters on the wall; plans and buffers of the transforms are kept from picture to picture.
///
/// A picture depends on its [`Shot`] or [`Still`] only, not on what was taken before. A clone shares the posters and has
/// plans of its own: use one for each thread.
pub struct Studio {
    rig: Rig,
    posters: Vec<ArcArray2<f64>>,
    exposer: Exposer,
}

impl fmt::Debug for Studio {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Studio").field("rig", &self.rig).finish_non_exhaustive()
    }
}

impl Clone for Studio {
    fn clone(&self) -> Self {
        Self { rig: self.rig.clone(), posters: self.posters.clone(), exposer: Exposer::new() }
    }
}

impl Studio {
    /// Prints the posters of a rig.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a value of the rig out of its range, [`Error::Size`] for pictures that are too small or
    /// too large.
    pub fn new(rig: &Rig) -> Result<Self> {
        rig.check()?;
        let side_px = rig.side_px.saturating_add(2 * MARGIN_PX);
        let posters = POSTERS.iter().map(|poster| Ok(poster.scene(side_px)?.into_shared()));
        Ok(Self { rig: rig.clone(), posters: posters.collect::<Result<_>>()?, exposer: Exposer::new() })
    }

    /// The picture of a shot.
    ///
    /// # Errors
    /// Those of [`photograph`](Self::photograph), [`Error::NoPoster`], and those of [`Shot::motion`].
    pub fn picture(&mut self, shot: &Shot) -> Result<Array2<u8>> {
        self.of_poster(shot.poster, &shot.motion()?, &shot.setting)
    }

    /// The picture of a pass at constant speed.
    ///
    /// # Errors
    /// Those of [`photograph`](Self::photograph) and [`Error::NoPoster`].
    pub fn passing(&mut self, pass: &Pass) -> Result<Array2<u8>> {
        self.of_poster(pass.poster, &pass.motion, &pass.setting)
    }

    /// The picture of a still background.
    ///
    /// # Errors
    /// Those of [`photograph`](Self::photograph) and [`Error::NoPoster`].
    pub fn background(&mut self, still: &Still) -> Result<Array2<u8>> {
        self.of_poster(still.poster, &Motion::uniform(0.0, AxialAngle::from_deg(0.0))?, &still.setting)
    }

    fn of_poster(&mut self, poster: usize, motion: &Motion, setting: &Setting) -> Result<Array2<u8>> {
        check_poster(poster)?;
        // Only counts a reference; it sets the exposer free to be changed.
        let scene = self.posters[poster].clone();
        self.photograph(scene.view(), motion, setting)
    }

    /// A picture of the middle of any `scene`, light on the scale 0..255, that moves along any line.
    ///
    /// When the shutter opens, the middle of the scene is displaced from that of the picture by the setting, and from
    /// there it moves on along the `motion`; a length of 0 is a still. Near the borders of the scene the light is the less
    /// exact (see [`expose`](crate::expose)): leave 16 pixels more than needed where that matters.
    ///
    /// # Errors
    /// [`Error::SceneTooSmall`] when pixels of the picture would see what is beyond the scene, [`Error::NotFinite`] for a
    /// pixel of it that is no number, [`Error::Parameter`] for a setting or a PSNR out of its range.
    pub fn photograph(&mut self, scene: ArrayView2<'_, f64>, motion: &Motion, setting: &Setting) -> Result<Array2<u8>> {
        let (x, y) = motion.direction();
        // A motion is centred on its path; this one begins where the setting says.
        let half = 0.5 * motion.length_px();
        let path = Displaced::new(*motion, setting.right_px + half * x, setting.down_px + half * y)?;
        let ((rows, cols), side_px) = (scene.dim(), self.rig.side_px);
        let (extent_rows, extent_cols) = path.extent_px();
        let (need_rows, need_cols) = (side_px.saturating_add(extent_rows), side_px.saturating_add(extent_cols));
        if rows < need_rows || cols < need_cols {
            return Err(Error::SceneTooSmall { rows, cols, need_rows, need_cols });
        }
        let exposure = self.exposer.expose(scene, &path)?;
        // The first pixel of the exposure is the scene's at half the extent, rounded down.
        let first = |len: usize, extent: usize| (len - side_px) / 2 - extent / 2;
        let (top, left) = (first(rows, extent_rows), first(cols, extent_cols));
        let light = Array2::from_shape_fn((side_px, side_px), |(row, col)| {
            vignetting(setting.kappa, side_px, row, col) * exposure[[row + top, col + left]]
        });
        let mut sensor = Sensor::ideal().with_gain(setting.gain)?;
        if let Some(psnr_db) = self.rig.psnr_db {
            sensor = sensor.with_psnr_db(psnr_db)?;
        }
        sensor.record(light.view(), setting.noise_seed)
    }
}

/// Share of the light that reaches a pixel of a square picture: `1 - kappa rho^2`, with `rho` the distance from the
/// centre of the picture as a share of that of its corners.
fn vignetting(kappa: f64, side_px: usize, row: usize, col: usize) -> f64 {
    let half = 0.5 * side_px as f64;
    let (dy, dx) = ((row as f64 + 0.5 - half) / half, (col as f64 + 0.5 - half) / half);
    1.0 - kappa * 0.5 * (dx * dx + dy * dy)
}
