//! Pictures of known truth.

use blur_core::estimate::AxialAngle;
use blur_sim::expose::expose;
use blur_sim::motion::Motion;
use blur_sim::scene::{self, DeadLeaves};
use blur_sim::sensor::{Sensor, quantised};
use ndarray::Array2;
use numpy::{PyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::array;
use crate::error::refuse;

/// A sharp picture of opaque discs of all sizes, `height` x `width`, float64 on the scale 0 to 255: the same for a seed
/// everywhere.
#[pyfunction]
#[pyo3(signature = (height, width, *, seed = 0))]
pub(crate) fn dead_leaves(
    py: Python<'_>,
    height: usize,
    width: usize,
    seed: u64,
) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let leaves = py.detach(|| scene::dead_leaves(seed, height, width, &DeadLeaves::default())).map_err(refuse)?;
    array::of_plane(py, leaves)
}

/// The picture of a scene that moves over `length_px` pixels along `angle_deg` during the exposure.
///
/// `scene` is an array on the scale 0 to 255, or the (height, width) of the picture wanted: then it shows dead leaves. The
/// blur is exact: the spectrum times sinc(L s), or the transform of the path with the ratio `accel_ratio`; only pixels that see
/// nothing but the scene are kept, so the picture is smaller than the scene by ceil|L sin| rows and ceil|L cos| columns.
/// `noise_db` is the PSNR in dB, with the peak 255, of the white noise added. Returns uint8 codes, or float64 before rounding and
/// clipping if not `quantize`.
#[pyfunction]
#[pyo3(signature = (scene, length_px, angle_deg, *, accel_ratio = 0.0, noise_db = None, seed = 0, quantize = true))]
#[expect(clippy::too_many_arguments, reason = "they are keywords in Python")]
pub(crate) fn simulate<'py>(
    py: Python<'py>,
    scene: &Bound<'py, PyAny>,
    length_px: f64,
    angle_deg: f64,
    accel_ratio: f64,
    noise_db: Option<f64>,
    seed: u64,
    quantize: bool,
) -> PyResult<Bound<'py, PyAny>> {
    if !angle_deg.is_finite() {
        return Err(refuse(format!("angle_deg = {angle_deg} is not allowed: it must be a finite number")));
    }
    let motion = Motion::new(length_px, AxialAngle::from_deg(angle_deg), accel_ratio).map_err(refuse)?;
    let mut sensor = Sensor::ideal();
    if let Some(noise_db) = noise_db {
        sensor = sensor.with_psnr_db(noise_db).map_err(refuse)?;
    }
    let scene = match scene.extract::<(usize, usize)>() {
        Ok((height, width)) => {
            let (rows, cols) = motion.extent_px();
            let (rows, cols) = (height.saturating_add(rows), width.saturating_add(cols));
            py.detach(|| scene::dead_leaves(seed, rows, cols, &DeadLeaves::default())).map_err(refuse)?
        }
        Err(_) => plane(scene)?,
    };
    let codes = py
        .detach(|| sensor.code_values(expose(scene.view(), &motion)?.view(), seed))
        .map_err(|error: blur_sim::Error| refuse(error))?;
    if quantize {
        Ok(array::of_plane(py, quantised(codes.view()))?.into_any())
    } else {
        Ok(array::of_plane(py, codes)?.into_any())
    }
}

fn plane(scene: &Bound<'_, PyAny>) -> PyResult<Array2<f64>> {
    let scene = array::numbers::<f64>(scene)?;
    let [rows, columns] = *scene.shape() else {
        return Err(refuse(format!("a scene is rows x columns, not of shape {:?}", scene.shape())));
    };
    Array2::from_shape_vec((rows, columns), scene.as_slice().map_err(refuse)?.to_vec()).map_err(refuse)
}
