//! Calibrated cameras.

use blur_core::camera::{self, Board, Intrinsics, Lens, Model, PARAMETER_NAMES, PARAMETERS, Pattern, View};
use blur_core::image::Grey;
use numpy::{PyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::array;
use crate::error::refuse;
use crate::image::Image;

/// A pinhole camera with lens distortion (the model of OpenCV), in pixels of the picture as stored, and how well it is known.
///
/// Keyword arguments: fx_px, fy_px, cx_px, cy_px, and optionally skew_px, k1, k2, p1, p2, k3 and `covariance`, the 10 x 10 matrix
/// of the parameters in this order, 0 where nothing is given.
#[pyclass(frozen, eq, module = "motion_blur")]
#[derive(PartialEq)]
pub(crate) struct Camera(pub(crate) Intrinsics);

#[pymethods]
impl Camera {
    #[new]
    #[pyo3(signature = (width_px, height_px, *, covariance = None, **parameters))]
    fn new(
        width_px: usize,
        height_px: usize,
        covariance: Option<&Bound<'_, PyAny>>,
        parameters: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let mut values = [0.0; PARAMETERS];
        for (name, value) in parameters.into_iter().flatten() {
            let name: String = name.extract()?;
            let place = PARAMETER_NAMES.iter().position(|known| *known == name);
            let place = place.ok_or_else(|| PyTypeError::new_err(format!("unexpected keyword argument '{name}'")))?;
            values[place] = value.extract()?;
        }
        let covariance = covariance.map_or(Ok([[0.0; PARAMETERS]; PARAMETERS]), matrix)?;
        Intrinsics::new(values, covariance, width_px, height_px).map(Self).map_err(refuse)
    }

    /// Columns of the pictures.
    #[getter]
    fn width_px(&self) -> usize {
        self.0.width_px()
    }

    /// Rows of the pictures.
    #[getter]
    fn height_px(&self) -> usize {
        self.0.height_px()
    }

    /// The parameters by name.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        named(py, self.0.parameters())
    }

    /// Their standard uncertainties by name.
    #[getter]
    fn stds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        named(py, &self.0.stds())
    }

    /// Their covariance, 10 x 10, in the order of `parameters`.
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        array::of_points(py, &self.0.covariance())
    }

    /// Where points (X, Y, Z) of the camera's own frame are seen: an array of (u, v) in pixels.
    fn project<'py>(&self, py: Python<'py>, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let seen: blur_core::Result<Vec<_>> =
            rows::<3>(points)?.into_iter().map(|point| self.0.project(point)).collect();
        array::of_points(py, &seen.map_err(refuse)?)
    }

    /// The ideal points (X/Z, Y/Z) of the rays seen at (u, v) in pixels: the inverse of `project`.
    fn unproject<'py>(&self, py: Python<'py>, pixels: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rays: blur_core::Result<Vec<_>> =
            rows::<2>(pixels)?.into_iter().map(|pixel| self.0.unproject(pixel)).collect();
        array::of_points(py, &rays.map_err(refuse)?)
    }

    fn __repr__(&self) -> String {
        let parameters: Vec<_> =
            PARAMETER_NAMES.iter().zip(self.0.parameters()).map(|(name, value)| format!("{name}={value}")).collect();
        format!("Camera({}, {}, {})", self.0.width_px(), self.0.height_px(), parameters.join(", "))
    }

    /// For pickle.
    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<((usize, usize), Bound<'py, PyDict>)> {
        let options = self.parameters(py)?;
        options.set_item("covariance", self.covariance(py)?)?;
        Ok(((self.width_px(), self.height_px()), options))
    }
}

/// A calibrated camera and how well it explains the views.
#[pyclass(frozen, get_all, module = "motion_blur")]
pub(crate) struct Calibration {
    /// The camera, with the covariance of the fit.
    camera: Py<Camera>,
    /// Root mean square distance in pixels of the points from where the camera would see them.
    rms_px: f64,
    /// The same for each view.
    view_rms_px: Vec<f64>,
    /// Angle in degrees between the board's normal and the optical axis, for each view.
    view_tilt_deg: Vec<f64>,
    /// Points in all views.
    points: usize,
}

#[pymethods]
impl Calibration {
    fn __repr__(&self) -> String {
        let (rms, points, views) = (self.rms_px, self.points, self.view_rms_px.len());
        format!("Calibration(rms_px={rms}, points={points}, views={views})")
    }
}

/// Calibrates a camera, whose pictures are `width_px` x `height_px`, from views of a plane board (Zhang 2000).
///
/// `board` is an array of points (X, Y) on the board in any one unit, or one for each view; `views` holds for each view the points
/// (u, v) in pixels where they are seen. `distortion` is the number of coefficients, 2, 4 or 5.
#[pyfunction]
#[pyo3(signature = (board, views, width_px, height_px, *, distortion = 5, skew = false))]
pub(crate) fn calibrate(
    py: Python<'_>,
    board: &Bound<'_, PyAny>,
    views: &Bound<'_, PyAny>,
    width_px: usize,
    height_px: usize,
    distortion: u8,
    skew: bool,
) -> PyResult<Calibration> {
    let lens = match distortion {
        2 => Lens::Two,
        4 => Lens::Four,
        5 => Lens::Five,
        other => return Err(refuse(format!("distortion = {other} is not allowed: it must be 2, 4 or 5"))),
    };
    let views = views
        .try_iter()?
        .map(|view| Ok(View { board: rows::<2>(board)?, image_px: rows::<2>(&view?)? }))
        .collect::<PyResult<Vec<_>>>()?;
    let found = py.detach(|| camera::calibrate(&views, width_px, height_px, Model { skew, lens })).map_err(refuse)?;
    Ok(Calibration {
        camera: Py::new(py, Camera(found.intrinsics))?,
        rms_px: found.rms_px,
        view_rms_px: found.view_rms_px,
        view_tilt_deg: found.view_tilt_deg,
        points: found.points,
    })
}

/// Finds a calibration board of `columns` x `rows` inner corners (or, with `pitch`, separate squares) in a picture.
///
/// `square` is the side of a square and `pitch` the way from one to the next, in one unit. Returns two arrays of points for
/// `calibrate`: (X, Y) on the board in that unit, and (u, v) in pixels.
#[pyfunction]
#[pyo3(signature = (image, columns, rows, square, *, pitch = None, order = "rgb"))]
pub(crate) fn find_board<'py>(
    py: Python<'py>,
    image: &Bound<'py, PyAny>,
    columns: usize,
    rows: usize,
    square: f64,
    pitch: Option<f64>,
    order: &str,
) -> PyResult<Bound<'py, PyTuple>> {
    let pattern = match pitch {
        None => Pattern::Checkerboard { square },
        Some(pitch) => Pattern::Squares { square, pitch },
    };
    let board = Board::new(pattern, columns, rows).map_err(refuse)?;
    let image = Image::new(image, order)?;
    let found = {
        let pixels = image.pixels().map_err(refuse)?;
        py.detach(|| board.find(Grey::new(false).convert(&pixels).view())).map_err(refuse)?
    };
    (array::of_points(py, &board.points())?, array::of_points(py, &found)?).into_pyobject(py)
}

fn named<'py>(py: Python<'py>, values: &[f64; PARAMETERS]) -> PyResult<Bound<'py, PyDict>> {
    let named = PyDict::new(py);
    for (name, value) in PARAMETER_NAMES.iter().zip(values) {
        named.set_item(name, value)?;
    }
    Ok(named)
}

/// The rows of an array with `N` columns.
fn rows<const N: usize>(points: &Bound<'_, PyAny>) -> PyResult<Vec<[f64; N]>> {
    let array = array::numbers::<f64>(points)?;
    if !matches!(*array.shape(), [_, columns] if columns == N) {
        return Err(refuse(format!("an array of shape {:?} is no list of points of {N} numbers each", array.shape())));
    }
    Ok(array.as_slice().map_err(refuse)?.as_chunks::<N>().0.to_vec())
}

fn matrix(covariance: &Bound<'_, PyAny>) -> PyResult<[[f64; PARAMETERS]; PARAMETERS]> {
    let rows = rows::<PARAMETERS>(covariance)?;
    let found = rows.len();
    rows.try_into().map_err(|_| refuse(format!("a covariance has {PARAMETERS} rows, not {found}")))
}
