//! Plain data as objects of Python: the data classes of `motion_blur._data`.

use blur_core::record::{Record, Value};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyType};

const MODULE: &str = "motion_blur._data";

/// A `Record`, with the names of [`Record::fields`].
pub(crate) fn record<'py>(py: Python<'py>, record: &Record) -> PyResult<Bound<'py, PyAny>> {
    static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    let fields = PyDict::new(py);
    for (name, value) in record.fields() {
        match value {
            Value::Count(count) => fields.set_item(name, count)?,
            Value::Number(number) => fields.set_item(name, number)?,
            Value::Flag(flag) => fields.set_item(name, flag)?,
            Value::Text(text) => fields.set_item(name, text)?,
        }
    }
    CLASS.import(py, MODULE, "Record")?.call((), Some(&fields))
}

/// The class `Picture`.
pub(crate) fn picture_class(py: Python<'_>) -> PyResult<&Bound<'_, PyType>> {
    static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    CLASS.import(py, MODULE, "Picture")
}
