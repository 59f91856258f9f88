//! Arrays of `NumPy` as pictures.

use std::borrow::Cow;

use blur_core::image::{Channels, PixelFormat, Pixels, SampleType};
use numpy::{PyArrayDescrMethods, PyUntypedArray, PyUntypedArrayMethods, dtype};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::data;
use crate::error::refuse;

/// A picture in an array that lives as long as this.
pub(crate) struct Image<'py> {
    array: Bound<'py, PyUntypedArray>,
    format: PixelFormat,
    /// Whether the tone curve was undone before, when the picture was read.
    pub(crate) linearized: bool,
}

impl<'py> Image<'py> {
    /// An array of rows x columns, or rows x columns x channels with the colours in `order`, or a picture that was read.
    ///
    /// Samples of `uint8`, `uint16` and `float32` are used where they are if those of each row follow each other; other
    /// layouts and floats are copied.
    pub(crate) fn new(image: &Bound<'py, PyAny>, order: &str) -> PyResult<Self> {
        let py = image.py();
        if image.is_instance(data::picture_class(py)?)? {
            let luma = Self::new(&image.getattr(intern!(py, "luma"))?, order)?;
            return Ok(Self { linearized: image.getattr(intern!(py, "linearized"))?.extract()?, ..luma });
        }
        let array = array_of(image)?;
        let channels = channels(array.shape(), order)?;
        let (sample, is_native) = sample(&array)?;
        let format = PixelFormat { sample, channels };
        let array = if is_native && rows_are_whole(&array, format) { array } else { copied(&array, sample)? };
        Ok(Self { array, format, linearized: false })
    }

    /// The pixels. The array must not be written to while they are read.
    pub(crate) fn pixels(&self) -> blur_core::Result<Pixels<'_>> {
        let (height, width, row_bytes) = self.layout();
        let bytes = match height {
            0 => 0,
            rows => (rows - 1) * row_bytes + width * self.format.bytes(),
        };
        Pixels::new(self.bytes(bytes), width, height, row_bytes, self.format)
    }

    fn layout(&self) -> (usize, usize, usize) {
        let (height, width) = (self.array.shape()[0], self.array.shape()[1]);
        let packed = width * self.format.bytes();
        // The way from one row to the next means nothing where there is one row only.
        let row_bytes = if height > 1 { self.array.strides()[0].unsigned_abs() } else { packed };
        (height, width, row_bytes)
    }

    /// `length` bytes from the first sample on.
    fn bytes(&self, length: usize) -> &[u8] {
        if length == 0 {
            return &[];
        }
        // SAFETY: `new` made sure that the array, which `self` keeps alive, has rows of contiguous samples that do not overlap
        // and follow each other upwards in memory; `length` ends with its last sample. Every byte is a valid `u8`.
        #[expect(unsafe_code, reason = "the samples are NumPy's")]
        unsafe {
            std::slice::from_raw_parts((*self.array.as_array_ptr()).fields.data.cast::<u8>(), length)
        }
    }
}

fn array_of<'py>(image: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyUntypedArray>> {
    image.cast::<PyUntypedArray>().cloned().map_err(|_| {
        let kind = image.get_type().name().map_or_else(|_| "object".to_owned(), |name| name.to_string());
        refuse(format!("a picture is an array of NumPy, not of type {kind}: numpy.asarray may convert it"))
    })
}

fn channels(shape: &[usize], order: &str) -> PyResult<Channels> {
    let is_blue_first = match order {
        "rgb" => false,
        "bgr" => true,
        other => return Err(refuse(format!("there is no order of colours '{other}': give 'rgb' or 'bgr'"))),
    };
    match (shape, is_blue_first) {
        ([_, _] | [_, _, 1], _) => Ok(Channels::Grey),
        ([_, _, 2], _) => Ok(Channels::GreyAlpha),
        ([_, _, 3], false) => Ok(Channels::Rgb),
        ([_, _, 3], true) => Ok(Channels::Bgr),
        ([_, _, 4], false) => Ok(Channels::Rgba),
        ([_, _, 4], true) => Ok(Channels::Bgra),
        _ => Err(refuse(format!(
            "an array of shape {shape:?} is no picture: give rows x columns, or rows x columns x channels with 1 to 4 channels"
        ))),
    }
}

/// The type that the samples are measured as, and whether they are of it already.
fn sample(array: &Bound<'_, PyUntypedArray>) -> PyResult<(SampleType, bool)> {
    let (py, found) = (array.py(), array.dtype());
    let native =
        [(SampleType::U8, dtype::<u8>(py)), (SampleType::U16, dtype::<u16>(py)), (SampleType::F32, dtype::<f32>(py))];
    if let Some((sample, _)) = native.iter().find(|(_, dtype)| found.is_equiv_to(dtype)) {
        return Ok((*sample, true));
    }
    match (found.kind(), found.itemsize()) {
        // In the other order of bytes.
        (b'u', 2) => Ok((SampleType::U16, false)),
        (b'f', _) => Ok((SampleType::F32, false)),
        _ => Err(refuse(format!(
            "samples of type {found} have no known full scale: convert them to uint8, uint16 or float32"
        ))),
    }
}

/// Whether the rows can be read where they are.
fn rows_are_whole(array: &Bound<'_, PyUntypedArray>, format: PixelFormat) -> bool {
    let (shape, strides) = (array.shape(), array.strides());
    let (sample, pixel) = (format.sample.bytes() as isize, format.bytes() as isize);
    let channels_follow = strides.get(2).is_none_or(|&stride| stride == sample || shape[2] == 1);
    let pixels_follow = strides[1] == pixel || shape[1] <= 1;
    let rows_follow = strides[0] >= shape[1] as isize * pixel || shape[0] <= 1;
    channels_follow && pixels_follow && rows_follow
}

/// A copy with all samples one after the other.
fn copied<'py>(array: &Bound<'py, PyUntypedArray>, sample: SampleType) -> PyResult<Bound<'py, PyUntypedArray>> {
    let py = array.py();
    let dtype = match sample {
        SampleType::U8 => dtype::<u8>(py),
        SampleType::U16 => dtype::<u16>(py),
        SampleType::F32 => dtype::<f32>(py),
    };
    let options = PyDict::new(py);
    options.set_item(intern!(py, "order"), "C")?;
    let copy = array.call_method(intern!(py, "astype"), (dtype,), Some(&options))?;
    Ok(copy.cast_into::<PyUntypedArray>()?)
}

/// A name of the options of a call, for messages.
pub(crate) fn shown(value: &Bound<'_, PyAny>) -> Cow<'static, str> {
    value.repr().map_or(Cow::Borrowed("this value"), |text| Cow::Owned(text.to_string()))
}
