//! Arrays of `NumPy` that this package makes or takes values from.

use ndarray::Array2;
use numpy::{Element, PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, dtype};
use pyo3::intern;
use pyo3::prelude::*;

/// A new array of rows x columns.
pub(crate) fn of_plane<T: Element + Copy>(py: Python<'_>, plane: Array2<T>) -> PyResult<Bound<'_, PyArray2<T>>> {
    let (rows, columns) = plane.dim();
    // Through a flat list, since NumPy's binding may have another ndarray than the rest of the workspace.
    let plane = if plane.is_standard_layout() { plane } else { plane.as_standard_layout().into_owned() };
    PyArray1::from_vec(py, plane.into_raw_vec_and_offset().0).reshape([rows, columns])
}

/// A new array of points, one a row.
pub(crate) fn of_points<'py, const N: usize>(
    py: Python<'py>,
    points: &[[f64; N]],
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    PyArray1::from_slice(py, points.as_flattened()).reshape([points.len(), N])
}

/// Any array of numbers as one of `T`, all of it in order. It is copied only if it has to be.
pub(crate) fn numbers<'py, T: Element>(values: &Bound<'py, PyAny>) -> PyResult<PyReadonlyArrayDyn<'py, T>> {
    let py = values.py();
    let numpy = py.import(intern!(py, "numpy"))?;
    let array = numpy.call_method1(intern!(py, "ascontiguousarray"), (values, dtype::<T>(py)))?;
    Ok(array.cast_into::<PyArrayDyn<T>>()?.readonly())
}
