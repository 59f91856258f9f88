//! Picture files.

use std::path::PathBuf;

use blur_picture::Linearize;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::error::refuse;
use crate::{array, data};

/// Reads a PNG, JPEG or TIFF file, by its path or its bytes, as the command line does.
///
/// `linearize` is 'auto' (the tone curve of JPEG files is undone, other files are taken as they are), True or False.
/// Returns a Picture.
#[pyfunction]
#[pyo3(signature = (source, linearize = Curve(Linearize::Auto)), text_signature = "(source, linearize='auto')")]
pub(crate) fn read<'py>(py: Python<'py>, source: Source<'py>, linearize: Curve) -> PyResult<Bound<'py, PyAny>> {
    let Curve(linearize) = linearize;
    let picture = match source {
        Source::Bytes(bytes) => {
            let bytes = bytes.as_bytes();
            py.detach(|| blur_picture::decode(bytes, linearize)).map_err(refuse)?
        }
        Source::Path(path) => py
            .detach(|| blur_picture::read(&path, linearize))
            .map_err(|error| refuse(format!("{}: {error}", path.display())))?,
    };
    let luma = array::of_plane(py, picture.luma)?;
    luma.getattr(intern!(py, "flags"))?.setattr(intern!(py, "writeable"), false)?;
    data::picture_class(py)?.call1((luma, picture.linearized, picture.exif.exposure_s, picture.exif.note))
}

/// Where a picture is read from.
#[derive(FromPyObject)]
pub(crate) enum Source<'py> {
    /// The content of a file.
    Bytes(Bound<'py, PyBytes>),
    /// Its place.
    Path(PathBuf),
}

/// When to undo the tone curve.
#[derive(Clone, Copy)]
pub(crate) struct Curve(Linearize);

impl<'py> FromPyObject<'_, 'py> for Curve {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        match (value.extract::<bool>(), value.extract::<&str>()) {
            (Ok(true), _) => Ok(Self(Linearize::On)),
            (Ok(false), _) => Ok(Self(Linearize::Off)),
            (_, Ok("auto")) => Ok(Self(Linearize::Auto)),
            _ => Err(refuse(format!("linearize = {} is not allowed: give 'auto', True or False", value.repr()?))),
        }
    }
}
