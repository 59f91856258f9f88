//! What a camera wrote into a picture file: orientation, exposure time.

use std::io::Cursor;

use exif::{Error as ExifError, Field, In, Reader, Tag, Value};
use image::metadata::Orientation;

/// The part of a picture's EXIF data that a measurement uses. Damaged EXIF is never an error: what can be read is
/// used, and [`note`](Self::note) says what is wrong.
#[derive(Debug, Clone, PartialEq)]
pub struct Exif {
    /// How the stored pixels must be turned to be upright.
    pub orientation: Orientation,
    /// Exposure time in seconds, greater than 0; `None` when the file states none.
    pub exposure_s: Option<f64>,
    /// Why some of the EXIF data were ignored.
    pub note: Option<String>,
}

impl Default for Exif {
    fn default() -> Self {
        Self { orientation: Orientation::NoTransforms, exposure_s: None, note: None }
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
            exposure_s: field(Tag::ExposureTime).and_then(exposure_s),
            note,
        }
    }
}

fn orientation(field: &Field) -> Option<Orientation> {
    u8::try_from(field.value.get_uint(0)?).ok().and_then(Orientation::from_exif)
}

fn exposure_s(field: &Field) -> Option<f64> {
    let Value::Rational(ratios) = &field.value else { return None };
    let seconds = ratios.first()?.to_f64();
    (seconds.is_finite() && seconds > 0.0).then_some(seconds)
}
