//! What a camera wrote into a picture file: orientation, exposure time, focal length.

use std::io::Cursor;

use ::exif::{Error as ExifError, Field, In, Reader, Tag, Value};
use image::metadata::Orientation;

/// The part of a picture's EXIF data that a measurement uses. Damaged EXIF is never an error: what can be read is
/// used, and [`note`](Self::note) says what is wrong.
#[derive(Debug, Clone, PartialEq)]
pub struct Exif {
    /// How the stored pixels must be turned to be upright.
    pub orientation: Orientation,
    /// Exposure time in seconds, greater than 0; `None` when the file states none.
    pub exposure_s: Option<f64>,
    /// What tells a focal length in pixels.
    pub focal: Focal,
    /// Why some of the EXIF data were ignored.
    pub note: Option<String>,
}

/// What a camera tells of its focal length; all numbers are greater than 0.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Focal {
    /// Focal length in millimetres.
    pub length_mm: Option<f64>,
    /// Pixels on the sensor for each millimetre, along a row.
    pub pixels_per_mm: Option<f64>,
    /// Focal length in millimetres that gives the same picture on 35 mm film.
    pub film_length_mm: Option<f64>,
    /// Columns that the picture had when the camera wrote it.
    pub columns: Option<f64>,
}

impl Default for Exif {
    fn default() -> Self {
        Self { orientation: Orientation::NoTransforms, exposure_s: None, focal: Focal::default(), note: None }
    }
}

impl Exif {
    /// Reads the EXIF data of a PNG, JPEG or TIFF file.
    pub fn from_file_bytes(bytes: &[u8]) -> Self {
        let mut note = None;
        let parsed =
            Reader::new().continue_on_error(true).read_from_container(&mut Cursor::new(bytes)).or_else(|error| {
                error.distill_partial_result(|errors| {
                    note = errors.first().map(|first| format!("damaged EXIF data, used as far as they go: {first}"));
                })
            });
        let exif = match parsed {
            Ok(exif) => exif,
            Err(ExifError::NotFound(_)) => return Self::default(),
            Err(error) => return Self { note: Some(format!("EXIF data ignored: {error}")), ..Self::default() },
        };
        let field = |tag| exif.get_field(tag, In::PRIMARY);
        Self {
            orientation: field(Tag::Orientation).and_then(orientation).unwrap_or(Orientation::NoTransforms),
            exposure_s: field(Tag::ExposureTime).and_then(positive),
            focal: Focal {
                length_mm: field(Tag::FocalLength).and_then(positive),
                pixels_per_mm: pixels_per_mm(field(Tag::FocalPlaneXResolution), field(Tag::FocalPlaneResolutionUnit)),
                film_length_mm: field(Tag::FocalLengthIn35mmFilm).and_then(positive),
                columns: field(Tag::PixelXDimension).and_then(positive),
            },
            note,
        }
    }
}

fn orientation(field: &Field) -> Option<Orientation> {
    u8::try_from(field.value.get_uint(0)?).ok().and_then(Orientation::from_exif)
}

/// A number greater than 0.
fn positive(field: &Field) -> Option<f64> {
    let number = match &field.value {
        Value::Rational(ratios) => ratios.first()?.to_f64(),
        value => f64::from(value.get_uint(0)?),
    };
    (number.is_finite() && number > 0.0).then_some(number)
}

/// EXIF 2.32, tags 0xA20E and 0xA210: pixels for each inch, unless the unit is the centimetre or (by some cameras) the
/// millimetre.
fn pixels_per_mm(resolution: Option<&Field>, unit: Option<&Field>) -> Option<f64> {
    let unit_mm = match unit.and_then(|field| field.value.get_uint(0)) {
        None | Some(2) => 25.4,
        Some(3) => 10.0,
        Some(4) => 1.0,
        Some(_) => return None,
    };
    Some(positive(resolution?)? / unit_mm)
}
