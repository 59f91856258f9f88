//! The closed form from which the refinement starts (Zhang 2000, section 3.1 and appendices B and C).

use nalgebra::{DMatrix, Matrix3, Vector3};

use super::homography::null_vector;
use super::pose::Pose;
use super::too_alike;
use crate::Result;
use crate::camera::intrinsics::{PARAMETERS, SKEW};

/// The least but one singular value, relative to the largest, below which the views leave the camera open.
const RANK: f64 = 1e-7;

/// Focal lengths, centre and, if asked for, skew; no distortion.
///
/// With noise the closed form may describe no camera; then the centre is taken to be that of the picture.
pub(super) fn intrinsics(
    homographies: &[Matrix3<f64>],
    width_px: usize,
    height_px: usize,
    skew: bool,
) -> Result<[f64; PARAMETERS]> {
    // Pixels in units of the picture's size, from its centre: all entries of the equations are then of the order of 1.
    let unit = 0.5 * (width_px + height_px) as f64;
    let centre = [0.5 * (width_px as f64 - 1.0), 0.5 * (height_px as f64 - 1.0)];
    let to_unit = Matrix3::new(1.0 / unit, 0.0, -centre[0] / unit, 0.0, 1.0 / unit, -centre[1] / unit, 0.0, 0.0, 1.0);
    let scaled: Vec<Matrix3<f64>> = homographies.iter().map(|h| to_unit * h).map(|h| h / h.norm()).collect();
    let full: &[usize] = if skew { &[0, 1, 2, 3, 4, 5] } else { &[0, 2, 3, 4, 5] };
    let found = match conic(&scaled, full)?.and_then(|b| camera_of(&b)) {
        Some(found) => found,
        None => {
            conic(&scaled, &[0, 2, 5])?.and_then(|b| camera_of(&b)).ok_or_else(|| too_alike(f64::NAN, f64::INFINITY))?
        }
    };
    let mut parameters = [0.0; PARAMETERS];
    parameters[0] = found[0] * unit;
    parameters[1] = found[1] * unit;
    parameters[2] = found[2] * unit + centre[0];
    parameters[3] = found[3] * unit + centre[1];
    parameters[SKEW] = found[4] * unit;
    Ok(parameters)
}

/// The image of the absolute conic `B11 B12 B22 B13 B23 B33` from those of its entries that are not 0 (eq. 8 and 9).
fn conic(homographies: &[Matrix3<f64>], entries: &[usize]) -> Result<Option<[f64; 6]>> {
    let mut rows = DMatrix::zeros(2 * homographies.len(), entries.len());
    for (view, h) in homographies.iter().enumerate() {
        let (orthogonal, equal_first, equal_second) = (products(h, 0, 1), products(h, 0, 0), products(h, 1, 1));
        for (column, &entry) in entries.iter().enumerate() {
            rows[(2 * view, column)] = orthogonal[entry];
            rows[(2 * view + 1, column)] = equal_first[entry] - equal_second[entry];
        }
    }
    let Some((values, vector)) = null_vector(&rows) else { return Ok(None) };
    let largest = values.last().copied().unwrap_or(0.0);
    let is_fixed = values.get(1).is_some_and(|&second| second > RANK * largest);
    if !is_fixed {
        return Err(too_alike(f64::NAN, f64::INFINITY));
    }
    let mut b = [0.0; 6];
    for (&entry, value) in entries.iter().zip(vector) {
        b[entry] = value;
    }
    Ok(Some(b))
}

/// The vector `v_ij` of eq. 7 for columns `i` and `j` of a homography.
fn products(h: &Matrix3<f64>, i: usize, j: usize) -> [f64; 6] {
    let (a, b) = (h.column(i), h.column(j));
    [
        a[0] * b[0],
        a[0] * b[1] + a[1] * b[0],
        a[1] * b[1],
        a[2] * b[0] + a[0] * b[2],
        a[2] * b[1] + a[1] * b[2],
        a[2] * b[2],
    ]
}

/// `fx fy cx cy skew` of appendix B; `None` when the conic is that of no camera.
fn camera_of(&[b11, b12, b22, b13, b23, b33]: &[f64; 6]) -> Option<[f64; 5]> {
    let minor = b11 * b22 - b12 * b12;
    let cy = (b12 * b13 - b11 * b23) / minor;
    let scale = b33 - (b13 * b13 + cy * (b12 * b13 - b11 * b23)) / b11;
    let fx = (scale / b11).sqrt();
    let fy = (scale * b11 / minor).sqrt();
    let skew = -b12 * fx * fx * fy / scale;
    let cx = skew * cy / fy - b13 * fx * fx / scale;
    let found = [fx, fy, cx, cy, skew];
    (found.iter().all(|value| value.is_finite()) && fx > 0.0 && fy > 0.0).then_some(found)
}

/// The pose of a board from its homography (section 3.1); the rotation is the nearest one (appendix C).
pub(super) fn pose(parameters: &[f64; PARAMETERS], homography: &Matrix3<f64>) -> Option<Pose> {
    let [fx, fy, cx, cy, skew, ..] = *parameters;
    let camera = Matrix3::new(fx, skew, cx, 0.0, fy, cy, 0.0, 0.0, 1.0);
    let columns = camera.try_inverse()? * homography;
    let size = 0.5 * (columns.column(0).norm() + columns.column(1).norm());
    // The board is in front of the camera.
    let scaled = columns / size.copysign(columns[(2, 2)]);
    let first: Vector3<f64> = scaled.column(0).into();
    let second: Vector3<f64> = scaled.column(1).into();
    let svd = Matrix3::from_columns(&[first, second, first.cross(&second)]).svd(true, true);
    let rotation = svd.u? * svd.v_t?;
    let pose = Pose { rotation, translation: scaled.column(2).into() };
    (rotation.determinant() > 0.0 && pose.translation.iter().all(|value| value.is_finite())).then_some(pose)
}
