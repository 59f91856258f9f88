//! Calibration of a camera from pictures of a plane board (Z. Zhang, "A flexible new technique for camera calibration",
//! IEEE Trans. Pattern Anal. Mach. Intell. 22(11), 2000).
//!
//! The way of the data: [`View`]s → homographies → closed form → refinement of everything → [`Calibration`].

mod closed_form;
mod homography;
mod pose;
mod refine;

use super::Intrinsics;
use super::intrinsics::{DISTORTION, PARAMETERS, SKEW};
use crate::{Error, Result};
use pose::Pose;

/// Least number of points in a view.
const MIN_POINTS: usize = 4;

/// A focal length must be so many standard uncertainties away from 0.
const MIN_FOCAL_SIGMAS: f64 = 3.0;

/// One picture of a board: points of the board, in a plane, and where they are seen.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// `(X, Y)` on the board, in any one unit for all views.
    pub board: Vec<[f64; 2]>,
    /// `(u, v)` in pixels, in the same order.
    pub image_px: Vec<[f64; 2]>,
}

/// How many coefficients describe the distortion of a lens.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Lens {
    /// `k1 k2`.
    Two,
    /// `k1 k2 p1 p2`.
    Four,
    /// `k1 k2 p1 p2 k3`.
    #[default]
    Five,
}

/// Which parameters of a camera are fitted; the others stay 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Model {
    /// Whether the axes of the sensor may be oblique.
    pub skew: bool,
    /// The distortion.
    pub lens: Lens,
}

impl Model {
    /// Which of the parameters are fitted, in the order of [`PARAMETER_NAMES`](super::PARAMETER_NAMES).
    pub fn fitted(self) -> [bool; PARAMETERS] {
        let coefficients = match self.lens {
            Lens::Two => 2,
            Lens::Four => 4,
            Lens::Five => 5,
        };
        std::array::from_fn(|i| if i == SKEW { self.skew } else { i < DISTORTION + coefficients })
    }

    fn min_views(self) -> usize {
        if self.skew { 3 } else { 2 }
    }
}

/// A calibrated camera and how well it explains the views.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// The camera. Its covariance is that of the fit: the scatter of the residuals, over both coordinates of all points
    /// less the number of parameters, times the inverse of the normal matrix.
    pub intrinsics: Intrinsics,
    /// What was fitted.
    pub model: Model,
    /// Root mean square distance in pixels of a point from where the camera would see it.
    pub rms_px: f64,
    /// The same for each view.
    pub view_rms_px: Vec<f64>,
    /// Angle in degrees between the normal of the board and the optical axis, for each view.
    pub view_tilt_deg: Vec<f64>,
    /// Number of points in all views.
    pub points: usize,
}

/// Calibrates a camera whose pictures have `width_px` columns and `height_px` rows.
///
/// # Errors
/// [`Error::TooFewViews`], [`Error::View`] for a view whose points are too few, on a line or no numbers, and
/// [`Error::ViewsTooAlike`] when the views do not fix the focal length, as when all are parallel.
pub fn calibrate(views: &[View], width_px: usize, height_px: usize, model: Model) -> Result<Calibration> {
    let needed = model.min_views();
    if views.len() < needed {
        return Err(Error::TooFewViews { views: views.len(), needed });
    }
    let mut homographies = Vec::with_capacity(views.len());
    for (index, view) in views.iter().enumerate() {
        let refuse = |reason| Error::View { number: index + 1, points: view.board.len(), reason };
        homographies.push(homography::fit(view).map_err(refuse)?);
    }
    let start = closed_form::intrinsics(&homographies, width_px, height_px, model.skew)?;
    let poses: Option<Vec<Pose>> = homographies.iter().map(|h| closed_form::pose(&start, h)).collect();
    let poses = poses.ok_or_else(|| too_alike(start[0], f64::INFINITY))?;
    let refined = refine::refine(views, start, poses, model)?;

    let focal = refined.parameters[0];
    let std = refined.covariance[(0, 0)].sqrt();
    let is_fixed = focal > MIN_FOCAL_SIGMAS * std;
    if !is_fixed {
        return Err(too_alike(focal, std));
    }
    let points: usize = views.iter().map(|view| view.board.len()).sum();
    let total: f64 = refined.view_squares.iter().sum();
    Ok(Calibration {
        intrinsics: Intrinsics::from_parts(refined.parameters, &refined.covariance, width_px, height_px)?,
        model,
        rms_px: (total / points as f64).sqrt(),
        view_rms_px: views
            .iter()
            .zip(&refined.view_squares)
            .map(|(view, squares)| (squares / view.board.len() as f64).sqrt())
            .collect(),
        view_tilt_deg: refined.poses.iter().map(Pose::tilt_deg).collect(),
        points,
    })
}

fn too_alike(focal_px: f64, std_px: f64) -> Error {
    Error::ViewsTooAlike { focal_px, std_px }
}
