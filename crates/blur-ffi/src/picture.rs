//! A picture in the memory of a program.

use std::mem::offset_of;

use blur_core::image::{self, PixelFormat, Pixels, SampleType};
use ndarray::{ArrayView2, ShapeBuilder};

use crate::versioned::{self, Versioned};
use crate::{Error, Result};

/// Type of one sample.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sample {
    /// Integer, 0 to 255.
    U8 = 0,
    /// Integer, 0 to 65535, in the machine's order of bytes.
    U16 = 1,
    /// float, already linear in light. Every one must be finite.
    F32 = 2,
}

/// The samples of one pixel, in their order. Alpha is not looked at.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channels {
    /// Grey.
    Grey = 0,
    /// Grey, then alpha.
    GreyAlpha = 1,
    /// Red, green, blue.
    Rgb = 2,
    /// Red, green, blue, alpha.
    Rgba = 3,
    /// Blue, green, red: the order of OpenCV.
    Bgr = 4,
    /// Blue, green, red, alpha.
    Bgra = 5,
}

/// A picture in the memory of the caller, upright, the top row first. It is only read, during the call. Grey float samples
/// at addresses and distances of rows that are multiples of 4 are not even copied. Begin with
/// mb_picture picture = {sizeof picture};
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Picture {
    /// Its size in bytes: sizeof(mb_picture).
    pub struct_size: usize,
    /// The first sample of the top row.
    pub data: *const core::ffi::c_void,
    /// Columns, at least 32.
    pub width: usize,
    /// Rows, at least 32.
    pub height: usize,
    /// Bytes from the start of a row to the start of the next, at least those of a row. What lies between is not read.
    pub row_bytes: isize,
    /// One of mb_sample.
    pub sample: i32,
    /// One of mb_channels.
    pub channels: i32,
}

// SAFETY: `repr(C)`, the size first, and numbers and a raw pointer only.
unsafe impl Versioned for Picture {
    const NAME: &'static str = "mb_picture";
    const LEAST_BYTES: usize = offset_of!(Self, channels) + size_of::<i32>();
}

/// The samples of a picture, as the meter takes them.
#[derive(Debug)]
pub(crate) enum Samples<'a> {
    /// Grey floats, which need no copy.
    Grey(ArrayView2<'a, f32>),
    /// All others.
    Stored(Pixels<'a>),
}

/// The samples of a picture that a program described.
///
/// # Safety
/// `from` is null or points to as many readable bytes as its first field says; for the time `'a` nobody writes to the memory
/// that it describes.
pub(crate) unsafe fn samples<'a>(from: *const Picture) -> Result<Samples<'a>> {
    // SAFETY: as promised by the caller.
    let picture = unsafe { versioned::read(from) }?;
    let layout = Layout::of(&picture)?;
    if picture.data.is_null() {
        return Err(Error::NullPointer { name: "mb_picture.data" });
    }
    let (width, height) = (picture.width, picture.height);
    if layout.format == GREY_FLOATS && layout.row_bytes.is_multiple_of(FLOAT) && picture.data.cast::<f32>().is_aligned()
    {
        let shape = (height, width).strides((layout.row_bytes / FLOAT, 1));
        // SAFETY: the caller promises the memory, the layout that it can be addressed and rows do not overlap, and the
        // pointer is aligned.
        return Ok(Samples::Grey(unsafe { ArrayView2::from_shape_ptr(shape, picture.data.cast::<f32>()) }));
    }
    // SAFETY: the caller promises the memory, and the layout that it can be addressed.
    let bytes = unsafe { std::slice::from_raw_parts(picture.data.cast::<u8>(), layout.bytes) };
    Pixels::new(bytes, width, height, layout.row_bytes, layout.format).map(Samples::Stored).map_err(Error::Picture)
}

const GREY_FLOATS: PixelFormat = PixelFormat { sample: SampleType::F32, channels: image::Channels::Grey };
/// Bytes of a float.
const FLOAT: usize = size_of::<f32>();

/// Where the samples of a picture lie.
#[derive(Debug, PartialEq, Eq)]
struct Layout {
    format: PixelFormat,
    row_bytes: usize,
    /// From the first byte of the first row to the last of the last.
    bytes: usize,
}

impl Layout {
    fn of(picture: &Picture) -> Result<Self> {
        let format = PixelFormat { sample: sample(picture.sample)?, channels: channels(picture.channels)? };
        let Picture { width, height, row_bytes, .. } = *picture;
        let too_large = Error::TooLarge { width, height, row_bytes };
        let Some(needed) = width.checked_mul(format.bytes()) else { return Err(too_large) };
        let Ok(apart) = usize::try_from(row_bytes) else {
            return Err(Error::RowBytes { row_bytes, width, needed });
        };
        if apart < needed {
            return Err(Error::RowBytes { row_bytes, width, needed });
        }
        let bytes = match height {
            0 => Some(0),
            rows => (rows - 1).checked_mul(apart).and_then(|before| before.checked_add(needed)),
        };
        match bytes {
            // No object is larger, and no two of its bytes are further apart.
            Some(bytes) if isize::try_from(bytes).is_ok() => Ok(Self { format, row_bytes: apart, bytes }),
            _ => Err(too_large),
        }
    }
}

fn sample(value: i32) -> Result<SampleType> {
    const U8: i32 = Sample::U8 as i32;
    const U16: i32 = Sample::U16 as i32;
    const F32: i32 = Sample::F32 as i32;
    match value {
        U8 => Ok(SampleType::U8),
        U16 => Ok(SampleType::U16),
        F32 => Ok(SampleType::F32),
        _ => Err(Error::UnknownValue { field: "mb_picture.sample", value, most: F32, enumeration: "mb_sample" }),
    }
}

fn channels(value: i32) -> Result<image::Channels> {
    const GREY: i32 = Channels::Grey as i32;
    const GREY_ALPHA: i32 = Channels::GreyAlpha as i32;
    const RGB: i32 = Channels::Rgb as i32;
    const RGBA: i32 = Channels::Rgba as i32;
    const BGR: i32 = Channels::Bgr as i32;
    const BGRA: i32 = Channels::Bgra as i32;
    match value {
        GREY => Ok(image::Channels::Grey),
        GREY_ALPHA => Ok(image::Channels::GreyAlpha),
        RGB => Ok(image::Channels::Rgb),
        RGBA => Ok(image::Channels::Rgba),
        BGR => Ok(image::Channels::Bgr),
        BGRA => Ok(image::Channels::Bgra),
        _ => Err(Error::UnknownValue { field: "mb_picture.channels", value, most: BGRA, enumeration: "mb_channels" }),
    }
}

#[cfg(test)]
mod tests;
