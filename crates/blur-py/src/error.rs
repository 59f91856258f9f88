//! The exception of the package.

use std::fmt;

use pyo3::PyErr;
use pyo3::create_exception;
use pyo3::exceptions::PyValueError;

create_exception!(
    motion_blur,
    MotionBlurError,
    PyValueError,
    "A picture, file or parameter cannot be used. The message says what is wrong, with the numbers."
);

/// An error of any crate below as the exception.
pub(crate) fn refuse(error: impl fmt::Display) -> PyErr {
    MotionBlurError::new_err(error.to_string())
}
