//! Picture files as grey values.
//!
//! From bytes that claim to be a picture ([`Format`]) to the grey values that are measured, upright ([`Picture`]), with what
//! the camera wrote beside them ([`Exif`]). Bytes come from outside: whatever they are, the answer is a picture or an
//! [`Error`] that names what is wrong with them, and memory is taken only for what can be a picture.

mod error;
mod exif;
mod format;
mod frame;
mod luma;
mod orientation;

use std::fs::File;
use std::io::{Cursor, Read};
use std::path::Path;

use image::{ImageDecoder, ImageReader, Limits};
use ndarray::Array2;
use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult};

pub use error::{Error, Result};
pub use exif::{Exif, Focal};
pub use format::Format;
pub use frame::{RowsRun, StoredFrame};
pub use image::DynamicImage;
pub use image::metadata::Orientation;

/// Most pixels of a picture: 8192x8192.
pub const MAX_PIXELS: u64 = 1 << 26;

/// Most bytes of a decoded picture: [`MAX_PIXELS`] of RGB + alpha with 16 bit each.
pub const MAX_BYTES: u64 = 8 * MAX_PIXELS;

/// Most bytes of a file: an uncompressed picture and generous metadata.
const MAX_FILE_BYTES: u64 = MAX_BYTES + (1 << 26);

/// When to undo the tone curve of sRGB, so that grey values are proportional to light. Motion blur mixes light; the
/// curve that a camera applies afterwards bends the mixture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Linearize {
    /// On for JPEG files, whose samples follow the sRGB curve unless they say otherwise (nearly all are photographs, many
    /// of them stripped of what their camera wrote); off for all others.
    #[default]
    Auto,
    /// Always.
    On,
    /// Never.
    Off,
}

/// A decoded picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Grey values, row 0 at the top, upright by the EXIF orientation.
    ///
    /// Integer samples come on the scale 0..255 whatever their depth, as BT.601 luma or, when
    /// [`linearized`](Self::linearized), as BT.709 luminance of the decoded sRGB light. Float samples are taken as
    /// linear and keep their scale, with NaN and infinities if there are any. Alpha is ignored: the colour counts as
    /// it is stored.
    pub luma: Array2<f32>,
    /// The samples as they are stored, upright; `None` for grey floats, which [`luma`](Self::luma) holds.
    pub stored: Option<DynamicImage>,
    /// Whether the tone curve was undone.
    pub linearized: bool,
    /// What the camera wrote.
    pub exif: Exif,
}

impl Picture {
    /// Where its points are among the pixels as stored.
    pub fn stored_frame(&self) -> StoredFrame {
        StoredFrame::new(self.exif.orientation, self.luma.dim())
    }
}

/// Reads a picture file in PNG, JPEG or TIFF format, which its content tells and not its name.
pub fn read(path: &Path, linearize: Linearize) -> Result<Picture> {
    decode(&load(path)?, linearize)
}

/// The content of a picture file, whose first bytes say that it is one.
pub fn load(path: &Path) -> Result<Vec<u8>> {
    let mut file = File::open(path).map_err(Error::Read)?;
    let mut bytes = Vec::new();
    file.by_ref().take(format::SIGNATURE_BYTES as u64).read_to_end(&mut bytes).map_err(Error::Read)?;
    // Before the rest is read, so that a video of some gigabytes is refused at once.
    Format::of(&bytes)?;
    file.take(MAX_FILE_BYTES).read_to_end(&mut bytes).map_err(Error::Read)?;
    if bytes.len() as u64 > MAX_FILE_BYTES {
        return Err(Error::FileTooLarge { limit: MAX_FILE_BYTES });
    }
    Ok(bytes)
}

/// Decodes the content of a picture file. A header that announces more than [`MAX_PIXELS`] or [`MAX_BYTES`] is refused
/// before memory is taken.
pub fn decode(bytes: &[u8], linearize: Linearize) -> Result<Picture> {
    let format = Format::of(bytes)?;
    if format == Format::Jpeg && !format::jpeg_is_complete(bytes) {
        return Err(Error::Truncated { format: "JPEG" });
    }
    let exif = Exif::from_file_bytes(bytes);
    let linear = match linearize {
        Linearize::Auto => format == Format::Jpeg,
        Linearize::On => true,
        Linearize::Off => false,
    };
    let (grey, mut stored, linearized) = decode_pixels(bytes, format, linear)?;
    if let Some(stored) = &mut stored {
        stored.apply_orientation(exif.orientation);
    }
    Ok(Picture { luma: orientation::upright(grey, exif.orientation), stored, linearized, exif })
}

/// Grey values, samples, both as they lie in the file, and whether the tone curve was undone: floats have none.
fn decode_pixels(bytes: &[u8], format: Format, linear: bool) -> Result<(Array2<f32>, Option<DynamicImage>, bool)> {
    if format == Format::Tiff
        && let Some(stored) = decode_grey_float(bytes)?
    {
        return Ok((stored, None, false));
    }
    let decoded = decode_samples(bytes)?;
    let is_float = matches!(decoded, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_));
    Ok((luma::luma(&decoded, linear)?, Some(decoded), linear && !is_float))
}

fn decode_samples(bytes: &[u8]) -> Result<DynamicImage> {
    let mut limits = Limits::default();
    limits.max_alloc = Some(2 * MAX_BYTES);
    let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(Error::Read)?;
    reader.limits(limits);
    let decoder = reader.into_decoder()?;
    let (width, height) = decoder.dimensions();
    check_size(width, height, decoder.total_bytes())?;
    Ok(DynamicImage::from_decoder(decoder)?)
}

/// Pixels of a TIFF with one float sample a pixel, which `image` does not read; `None` for any other TIFF.
fn decode_grey_float(bytes: &[u8]) -> Result<Option<Array2<f32>>> {
    let mut decoder = Decoder::new(Cursor::new(bytes))?;
    let ColorType::Gray(bits @ (32 | 64)) = decoder.colortype()? else { return Ok(None) };
    let (width, height) = decoder.dimensions()?;
    let size = u64::from(width) * u64::from(height) * u64::from(bits / 8);
    check_size(width, height, size)?;
    let mut limits = tiff::decoder::Limits::default();
    limits.decoding_buffer_size = MAX_BYTES as usize;
    let grey = match decoder.with_limits(limits).read_image()? {
        DecodingResult::F32(samples) => samples,
        DecodingResult::F64(samples) => samples.into_iter().map(|x| x as f32).collect(),
        _ => return Err(Error::Samples { kind: format!("{bits} bit integer") }),
    };
    luma::picture_of(grey, width as usize, height as usize).map(Some)
}

fn check_size(width: u32, height: u32, bytes: u64) -> Result<()> {
    let (max_pixels, max_bytes) = (MAX_PIXELS, MAX_BYTES);
    if u64::from(width) * u64::from(height) > max_pixels || bytes > max_bytes {
        return Err(Error::TooLarge { width, height, bytes, max_pixels, max_bytes });
    }
    Ok(())
}
