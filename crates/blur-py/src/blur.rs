//! The kernel of a blur, and pictures without it.

use blur_core::psf::accelerated_line_kernel;
use blur_core::restore::{LineBlur, Method, Restorer};
use ndarray::{Array2, Array3, Axis, s};
use numpy::{PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::intern;
use pyo3::prelude::*;

use crate::array;
use crate::error::refuse;

/// The kernel of a motion over `length_px` pixels along `angle_deg`, on the pixel grid: float64, sum 1, odd sides.
///
/// `accel_ratio` is r = a T / (2 v) in -1 to 1. `size` is the odd side of a square kernel with the motion in its middle; without
/// it the kernel is just large enough. Each weight is the share of the exposure spent in the pixel.
#[pyfunction]
#[pyo3(signature = (length_px, angle_deg, accel_ratio = 0.0, size = None))]
pub(crate) fn psf(
    py: Python<'_>,
    length_px: f64,
    angle_deg: f64,
    accel_ratio: f64,
    size: Option<usize>,
) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let kernel = accelerated_line_kernel(length_px, accel_ratio, angle_deg).map_err(refuse)?;
    array::of_plane(py, size.map_or_else(|| Ok(kernel.clone()), |size| centred(&kernel, size))?)
}

/// The kernel in the middle of a square.
fn centred(kernel: &Array2<f64>, size: usize) -> PyResult<Array2<f64>> {
    let (rows, columns) = kernel.dim();
    if size.is_multiple_of(2) || size < rows.max(columns) {
        return Err(refuse(format!(
            "a kernel of {columns}x{rows} pixels cannot be put in the middle of {size}x{size}: give an odd size, at least {}",
            rows.max(columns)
        )));
    }
    let (top, left) = ((size - rows) / 2, (size - columns) / 2);
    let mut square = Array2::zeros((size, size));
    square.slice_mut(s![top..top + rows, left..left + columns]).assign(kernel);
    Ok(square)
}

/// The scene behind a blurred picture, as float32 on the scale of the picture, which must be linear in light.
///
/// `image` is an array of rows x columns or rows x columns x channels; each channel is restored. `blur` is a Record or a Blur.
/// `method` is 'wiener', 'richardson-lucy' or 'sliding-dct'.
#[pyfunction]
#[pyo3(signature = (image, blur, method = "wiener"))]
pub(crate) fn restore<'py>(
    py: Python<'py>,
    image: &Bound<'py, PyAny>,
    blur: &Bound<'py, PyAny>,
    method: &str,
) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
    let method = match method {
        "wiener" => Method::Wiener,
        "richardson-lucy" => Method::RichardsonLucy,
        "sliding-dct" => Method::SlidingDct,
        other => {
            return Err(refuse(format!(
                "there is no restoration '{other}': give 'wiener', 'richardson-lucy' or 'sliding-dct'"
            )));
        }
    };
    let blur = line_blur(blur)?;
    let array = array::numbers::<f32>(image)?;
    let shape = array.shape().to_vec();
    let [rows, columns, channels] = match *shape {
        [rows, columns] => [rows, columns, 1],
        [rows, columns, channels] if channels > 0 => [rows, columns, channels],
        _ => return Err(refuse(format!("an array of shape {shape:?} is no picture"))),
    };
    let samples = array.to_vec().map_err(refuse)?;
    let mut planes = Array3::from_shape_vec((rows, columns, channels), samples).map_err(refuse)?;
    py.detach(|| restored(&mut planes, &blur, method)).map_err(refuse)?;
    PyArray1::from_iter(py, planes).reshape(shape)
}

/// Replaces the channels by their scenes.
fn restored(planes: &mut Array3<f32>, blur: &LineBlur, method: Method) -> blur_core::Result<()> {
    let (rows, columns, _) = planes.dim();
    let mut restorer = Restorer::new((rows, columns), blur, method)?;
    let channels: Vec<_> = planes.axis_iter(Axis(2)).collect();
    restorer.learn(&channels)?;
    let mut scene = Array2::zeros((rows, columns));
    for mut channel in planes.axis_iter_mut(Axis(2)) {
        restorer.restore(channel.view(), scene.view_mut())?;
        channel.assign(&scene);
    }
    Ok(())
}

/// The blur of a `Record` or a `Blur`, by the rule of [`LineBlur::measured`].
fn line_blur(found: &Bound<'_, PyAny>) -> PyResult<LineBlur> {
    let py = found.py();
    let length_px: f64 = found.getattr(intern!(py, "length_px"))?.extract()?;
    let angle_deg: f64 = found.getattr(intern!(py, "angle_deg"))?.extract()?;
    let ratio: Option<f64> = found.getattr(intern!(py, "accel_ratio"))?.extract()?;
    let Some(status) = found.getattr_opt(intern!(py, "status"))? else {
        return LineBlur::accelerated(length_px, angle_deg, ratio.unwrap_or(0.0)).map_err(refuse);
    };
    if status.extract::<&str>()? == "no_motion_blur" {
        return Err(refuse("the record tells of no motion blur: there is nothing to undo"));
    }
    let direction_deg: Option<f64> = found.getattr(intern!(py, "direction_deg"))?.extract()?;
    let detected: Option<bool> = found.getattr(intern!(py, "accel_detected"))?.extract()?;
    let ratio = ratio.filter(|_| detected == Some(true)).unwrap_or(0.0).clamp(-1.0, 1.0);
    LineBlur::accelerated(length_px, direction_deg.unwrap_or(angle_deg), ratio).map_err(refuse)
}
