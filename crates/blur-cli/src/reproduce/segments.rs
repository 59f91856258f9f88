//! Segments of moved pictures, cut with soft or hard edges, and the errors of the lengths measured in them.

use blur_core::estimate::{AxialAngle, Settings, Status, registry};
use blur_core::image::{Region, Window};
use blur_sim::expose::Exposer;
use blur_sim::motion::Motion;
use ndarray::{Array2, ArrayView2, Axis, Slice};
use rayon::prelude::*;

use super::outcome::GROSS_SHARE;
use super::pictures::{self, Sharp};
use super::shots::{centre_square, leaves, record};
use super::{Plan, simulating};
use crate::{Error, Result};

/// Side of the pictures.
pub(super) const SIDE_PX: usize = 256;

/// A moved picture.
pub(super) struct Shot {
    picture: String,
    luma: Array2<f32>,
}

/// How a moved picture is cut for a measurement.
#[derive(Debug, Clone, Copy)]
pub(super) enum Cut {
    /// Its middle of so many pixels under a window.
    Soft { width: usize, height: usize, window: Window },
    /// A disk of the whole picture's width, black outside, with a hard edge.
    HardDisk,
}

/// One answer.
pub(super) struct Answer<'a> {
    pub(super) picture: &'a str,
    /// Percent of the true length.
    pub(super) error: f64,
    /// Error in stated standard uncertainties.
    pub(super) deviations: Option<f64>,
    pub(super) is_ok: bool,
}

/// The pictures that leave a square after a blur of `length_px`.
pub(super) fn sharp_pictures(plan: &Plan, length_px: f64) -> Result<Vec<Sharp>> {
    let mut sharp = pictures::sharp_pictures(&plan.images)?;
    let motion = along_rows(length_px).map_err(simulating("segments"))?;
    sharp.retain(|picture| leaves(SIDE_PX, picture.luma.dim(), &motion));
    let sharp: Vec<Sharp> = sharp.into_iter().step_by(plan.step.max(1)).collect();
    if sharp.is_empty() { Err(Error::NoSharpPicture) } else { Ok(sharp) }
}

/// The middle of each picture after a motion of `length_px` along the rows.
pub(super) fn moved(sharp: &[Sharp], length_px: f64) -> Result<Vec<Shot>> {
    sharp
        .par_iter()
        .map_init(Exposer::new, |exposer, sharp| {
            let refused = simulating(&sharp.name);
            let motion = along_rows(length_px).map_err(&refused)?;
            // A motion along the rows leaves each row to itself: only those that are kept are exposed.
            let (lost_rows, _) = motion.extent_px();
            let rows = SIDE_PX + lost_rows;
            let first = (sharp.luma.nrows() - rows) / 2;
            let scene = sharp.luma.slice_axis(Axis(0), Slice::from(first..first + rows));
            let exposure = exposer.expose(scene, &motion).map_err(&refused)?;
            let luma = record(centre_square(exposure.view(), SIDE_PX), None, 0).map_err(&refused)?;
            Ok(Shot { picture: sharp.name.clone(), luma })
        })
        .collect()
}

fn along_rows(length_px: f64) -> blur_sim::Result<Motion> {
    Motion::uniform(length_px, AxialAngle::from_deg(0.0))
}

/// The answers of a length method that knows the direction, in the order of `shots`, which are all blurred by `length_px`.
pub(super) fn ask<'a>(method: &str, shots: &'a [Shot], length_px: f64, cut: Cut) -> Result<Vec<Answer<'a>>> {
    let method = registry::length(method)?;
    let mut settings = Settings::default();
    settings.window = Some(match cut {
        Cut::Soft { window, .. } => window,
        Cut::HardDisk => Window::None,
    });
    shots
        .par_iter()
        .map_init(
            || method.build(&settings),
            |estimator, shot| {
                let named = |source| Error::Measuring { image: shot.picture.clone(), source };
                let segment = cut.of(shot.luma.view()).map_err(named)?;
                let found = estimator.estimate(segment.view(), AxialAngle::from_deg(0.0)).map_err(named)?;
                let error_px = (found.length_px - length_px).abs();
                Ok(Answer {
                    picture: &shot.picture,
                    error: 100.0 * error_px / length_px,
                    deviations: found.std_px.map(|std_px| error_px / std_px),
                    is_ok: found.status == Status::Ok,
                })
            },
        )
        .collect()
}

impl Cut {
    /// Name of the edge.
    pub(super) fn edge(self) -> &'static str {
        match self {
            Self::Soft { window: Window::Hann, .. } => "hann",
            Self::Soft { .. } => "tukey 0.25",
            Self::HardDisk => "hard disk",
        }
    }

    fn of(self, shot: ArrayView2<'_, f32>) -> blur_core::Result<Array2<f32>> {
        match self {
            Self::Soft { width, height, .. } => {
                let region = Region { x: (SIDE_PX - width) / 2, y: (SIDE_PX - height) / 2, width, height };
                Ok(region.of(shot)?.to_owned())
            }
            Self::HardDisk => {
                let radius = 0.5 * SIDE_PX as f64;
                let mut disk = shot.to_owned();
                for ((row, column), pixel) in disk.indexed_iter_mut() {
                    if (row as f64 + 0.5 - radius).hypot(column as f64 + 0.5 - radius) >= radius {
                        *pixel = 0.0;
                    }
                }
                Ok(disk)
            }
        }
    }
}

impl Answer<'_> {
    pub(super) fn is_gross(&self) -> bool {
        self.error > 100.0 * GROSS_SHARE
    }
}
