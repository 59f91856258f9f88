//! One picture, or one after the other.

use std::sync::{Mutex, PoisonError};

use blur_core::meter;
use blur_core::record::Record;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::refuse;
use crate::image::Image;
use crate::{data, options};

/// Measures the motion blur of one picture.
///
/// `image` is an array of rows x columns (grey) or rows x columns x channels (1 to 4, colours in `order`) with samples of
/// uint8, uint16 or float, or a Picture from `read`. The keyword arguments are those of `Meter`, but for `tracking` and
/// `directed`. Returns a Record.
#[pyfunction]
#[pyo3(signature = (image, *, order = "rgb", **options))]
pub(crate) fn estimate<'py>(
    py: Python<'py>,
    image: &Bound<'py, PyAny>,
    order: &str,
    options: Option<&Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyAny>> {
    let configuration = options::configuration(options, false)?;
    let image = Image::new(image, order)?;
    let found = {
        let (pixels, linearized) = (image.pixels().map_err(refuse)?, image.linearized);
        py.detach(|| meter::Meter::new(configuration)?.measure(&pixels).map(|found| as_read(&found, linearized)))
    };
    data::record(py, &found.map_err(refuse)?)
}

/// Measures pictures one after the other; plans and buffers are made with the first one of a size.
///
/// Keyword arguments, all optional:
/// method: 'whittle', 'phase-autocorrelation' or a pair 'ANGLE+LENGTH';
/// linearize: whether integer samples follow the sRGB curve, which is then undone;
/// exposure_s, exposure_std_s: exposure time and its standard uncertainty;
/// scale_m_per_px, scale_std_m_per_px: metres per pixel; or
/// camera, distance_m, distance_std_m: a Camera and the distance of the motion from it; or
/// camera, rotating=True: the camera turned in front of a scene at rest;
/// length_range_px: shortest and longest length to look for; window: 'none' or 'hann';
/// acceleration: whether to look for an acceleration too;
/// tracking, directed: whether pictures are frames that follow each other, to start from the frame before and to tell a
/// motion from its opposite.
#[pyclass(frozen, module = "motion_blur")]
pub(crate) struct Meter {
    meter: Mutex<meter::Meter>,
    order: String,
}

#[pymethods]
impl Meter {
    #[new]
    #[pyo3(signature = (*, order = "rgb", **options))]
    fn new(order: &str, options: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let meter = Mutex::new(meter::Meter::new(options::configuration(options, true)?).map_err(refuse)?);
        Ok(Self { meter, order: order.to_owned() })
    }

    /// The Record of a picture. Calls from several threads follow each other.
    fn measure<'py>(&self, py: Python<'py>, image: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let image = Image::new(image, &self.order)?;
        let found = {
            let (pixels, linearized) = (image.pixels().map_err(refuse)?, image.linearized);
            py.detach(|| self.with(|meter| meter.measure(&pixels)).map(|found| as_read(&found, linearized)))
        };
        data::record(py, &found.map_err(refuse)?)
    }

    /// Forgets the frame before: the next picture does not follow it.
    fn reset(&self, py: Python<'_>) {
        py.detach(|| self.with(meter::Meter::reset));
    }
}

impl Meter {
    fn with<T>(&self, work: impl FnOnce(&mut meter::Meter) -> T) -> T {
        // A meter has no state that a panic could leave half done: every buffer is written before it is read.
        work(&mut self.meter.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// The record of grey values whose tone curve was undone when they were read, or not.
pub(crate) fn as_read(found: &Record, linearized: bool) -> Record {
    let mut found = *found;
    found.linearized |= linearized;
    found
}
