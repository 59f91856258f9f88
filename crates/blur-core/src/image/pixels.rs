//! Grey values of stored samples, whatever their type, order and spacing.

use ndarray::Array2;

use super::{bt601_luma, linear_from_srgb};
use crate::{Error, Result};

/// Full scale of the grey values that come from integer samples, whatever their depth.
const FULL_SCALE: f32 = 255.0;

/// Type of one sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SampleType {
    /// Integer, 0 to 255.
    U8,
    /// Integer, 0 to 65535, in the machine's order of bytes.
    U16,
    /// Float, in the machine's order of bytes, already linear in light.
    F32,
}

impl SampleType {
    /// Bytes of one sample.
    pub fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 => 2,
            Self::F32 => 4,
        }
    }

    /// Whether samples are codes and not light itself.
    pub fn is_integer(self) -> bool {
        self != Self::F32
    }
}

/// The samples of one pixel, in their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Channels {
    /// Grey.
    Grey,
    /// Grey, then alpha.
    GreyAlpha,
    /// Red, green, blue.
    Rgb,
    /// Red, green, blue, alpha.
    Rgba,
    /// Blue, green, red.
    Bgr,
    /// Blue, green, red, alpha.
    Bgra,
}

impl Channels {
    /// Samples of one pixel.
    pub fn count(self) -> usize {
        match self {
            Self::Grey => 1,
            Self::GreyAlpha => 2,
            Self::Rgb | Self::Bgr => 3,
            Self::Rgba | Self::Bgra => 4,
        }
    }

    fn has_colour(self) -> bool {
        self.count() >= 3
    }

    fn is_blue_first(self) -> bool {
        matches!(self, Self::Bgr | Self::Bgra)
    }
}

/// What one pixel is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct PixelFormat {
    /// Type of its samples.
    pub sample: SampleType,
    /// Its samples.
    pub channels: Channels,
}

impl PixelFormat {
    /// Bytes of one pixel.
    pub fn bytes(self) -> usize {
        self.sample.bytes() * self.channels.count()
    }
}

/// A picture in somebody else's memory.
#[derive(Debug, Clone, Copy)]
pub struct Pixels<'a> {
    bytes: &'a [u8],
    width: usize,
    height: usize,
    row_bytes: usize,
    format: PixelFormat,
}

impl<'a> Pixels<'a> {
    /// A picture of `height` rows of `width` pixels, the top row first; rows begin `row_bytes` apart and what lies between
    /// them is not read.
    ///
    /// # Errors
    /// [`Error::RowTooShort`] and [`Error::TooFewBytes`], with the numbers.
    pub fn new(bytes: &'a [u8], width: usize, height: usize, row_bytes: usize, format: PixelFormat) -> Result<Self> {
        let needed = width.saturating_mul(format.bytes());
        if row_bytes < needed {
            return Err(Error::RowTooShort { row_bytes, width, needed });
        }
        let needed = match height {
            0 => 0,
            rows => (rows - 1).saturating_mul(row_bytes).saturating_add(needed),
        };
        if bytes.len() < needed {
            return Err(Error::TooFewBytes { bytes: bytes.len(), width, height, needed });
        }
        Ok(Self { bytes, width, height, row_bytes, format })
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// What a pixel is made of.
    pub fn format(&self) -> PixelFormat {
        self.format
    }

    fn rows(&self) -> impl Iterator<Item = &'a [u8]> {
        let (bytes, width, row_bytes) = (self.bytes, self.width * self.format.bytes(), self.row_bytes);
        (0..self.height).map(move |row| &bytes[row * row_bytes..row * row_bytes + width])
    }
}

/// Turns pictures into grey values; its tables and buffers are made once.
///
/// Integer samples come on the scale 0..255 whatever their depth, as BT.601 luma or, when linearised, as BT.709 luminance of
/// the decoded sRGB light. Float samples are taken as linear and keep their scale, with NaN and infinities if there are any.
/// Alpha is ignored: the colour counts as it is stored.
#[derive(Debug, Clone)]
pub struct Grey {
    linear: bool,
    /// Values of the codes of 8 and of 16 bits: tables, since the sRGB curve is too slow for every pixel.
    levels8: Vec<f32>,
    levels16: Vec<f32>,
    values: Array2<f32>,
}

impl Grey {
    /// A converter that undoes the tone curve of sRGB if `linear`.
    pub fn new(linear: bool) -> Self {
        Self { linear, levels8: Vec::new(), levels16: Vec::new(), values: Array2::zeros((0, 0)) }
    }

    /// The grey values of a picture, rows x columns. Allocates for the first picture of a size or of a type of samples only.
    pub fn convert(&mut self, pixels: &Pixels<'_>) -> &Array2<f32> {
        let dim = (pixels.height, pixels.width);
        if self.values.dim() != dim {
            self.values = Array2::zeros(dim);
        }
        let linear = self.linear;
        match pixels.format.sample {
            SampleType::U8 => {
                fill_levels(&mut self.levels8, u8::MAX.into(), linear);
                let levels = &self.levels8;
                convert(pixels, linear, &mut self.values, |[code]: [u8; 1]| levels[usize::from(code)]);
            }
            SampleType::U16 => {
                fill_levels(&mut self.levels16, u16::MAX, linear);
                let levels = &self.levels16;
                convert(pixels, linear, &mut self.values, |code| levels[usize::from(u16::from_ne_bytes(code))]);
            }
            SampleType::F32 => convert(pixels, linear, &mut self.values, f32::from_ne_bytes),
        }
        &self.values
    }

    /// The grey values of the last picture.
    pub fn into_values(self) -> Array2<f32> {
        self.values
    }
}

/// The value on the common scale of every code `0..=max`.
fn fill_levels(levels: &mut Vec<f32>, max: u16, linear: bool) {
    if !levels.is_empty() {
        return;
    }
    let max_f = f32::from(max);
    levels.extend((0..=max).map(|code| {
        let code = f32::from(code);
        // The product is exact in f32 (255 * 65535 < 2^24), so 8 and 16 bit codes of one grey give one value.
        if linear { FULL_SCALE * linear_from_srgb(code / max_f) } else { code * FULL_SCALE / max_f }
    }));
}

/// One grey value for each pixel, of samples of `N` bytes.
fn convert<const N: usize>(
    pixels: &Pixels<'_>,
    linear: bool,
    values: &mut Array2<f32>,
    level: impl Fn([u8; N]) -> f32,
) {
    let channels = pixels.format.channels;
    let weigh = if linear { bt709_luminance } else { bt601_luma };
    let (red, blue) = if channels.is_blue_first() { (2, 0) } else { (0, 2) };
    for (row, mut values) in pixels.rows().zip(values.rows_mut()) {
        let samples = row.as_chunks::<N>().0;
        let of_pixels = samples.chunks_exact(channels.count());
        if channels.has_colour() {
            for (value, pixel) in values.iter_mut().zip(of_pixels) {
                *value = weigh(level(pixel[red]), level(pixel[1]), level(pixel[blue]));
            }
        } else {
            for (value, pixel) in values.iter_mut().zip(of_pixels) {
                *value = level(pixel[0]);
            }
        }
    }
}

/// Relative luminance of linear light by ITU-R BT.709, whose primaries are those of sRGB.
fn bt709_luminance(red: f32, green: f32, blue: f32) -> f32 {
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first(bytes: &[u8], sample: SampleType, channels: Channels, linear: bool) -> f32 {
        let format = PixelFormat { sample, channels };
        let pixels = Pixels::new(bytes, 1, 1, format.bytes(), format).unwrap();
        Grey::new(linear).convert(&pixels)[[0, 0]]
    }

    #[test]
    fn depths_share_one_scale() {
        for code in [0_u8, 1, 77, 188, 255] {
            for linear in [false, true] {
                let deep = (u16::from(code) * 257).to_ne_bytes();
                let shallow = first(&[code], SampleType::U8, Channels::Grey, linear);
                assert_eq!(shallow, first(&deep, SampleType::U16, Channels::Grey, linear), "{code}");
            }
            assert_eq!(first(&[code], SampleType::U8, Channels::Grey, false), f32::from(code));
        }
    }

    #[test]
    fn colours_weigh_by_their_standard_in_either_order() {
        let (rgb, bgra) = ([10_u8, 200, 60], [60_u8, 200, 10, 9]);
        let luma = 0.299 * 10.0 + 0.587 * 200.0 + 0.114 * 60.0;
        for (bytes, channels) in [(&rgb[..], Channels::Rgb), (&bgra[..], Channels::Bgra)] {
            assert!((first(bytes, SampleType::U8, channels, false) - luma).abs() < 1e-3);
        }
        assert!((first(&[0, 255, 0], SampleType::U8, Channels::Bgr, true) - 0.7152 * 255.0).abs() < 1e-3);
    }

    #[test]
    fn linear_light_decodes_the_srgb_curve() {
        // IEC 61966-2-1: code 188/255 is ((188/255 + 0.055)/1.055)^2.4 of the light.
        let expected = 255.0 * ((188.0_f64 / 255.0 + 0.055) / 1.055).powf(2.4);
        let found = first(&[188], SampleType::U8, Channels::Grey, true);
        assert!((f64::from(found) - expected).abs() < 1e-3, "{found} {expected}");
    }

    #[test]
    fn floats_stay_as_they_are() {
        let sample = SampleType::F32;
        assert!(first(&f32::NAN.to_ne_bytes(), sample, Channels::Grey, false).is_nan());
        assert_eq!(first(&0.25_f32.to_ne_bytes(), sample, Channels::Grey, true), 0.25);
    }

    #[test]
    fn what_lies_between_rows_is_not_read() {
        let format = PixelFormat { sample: SampleType::U8, channels: Channels::Grey };
        // The last row needs no padding.
        let pixels = Pixels::new(&[1, 2, 99, 3, 4], 2, 2, 3, format).unwrap();
        assert_eq!(Grey::new(false).convert(&pixels), ndarray::array![[1.0, 2.0], [3.0, 4.0]]);
    }

    #[test]
    fn sizes_that_do_not_fit_are_refused_with_their_numbers() {
        let format = PixelFormat { sample: SampleType::U16, channels: Channels::Rgb };
        let short = Pixels::new(&[0; 100], 4, 2, 23, format).unwrap_err();
        assert_eq!(short, Error::RowTooShort { row_bytes: 23, width: 4, needed: 24 });
        let few = Pixels::new(&[0; 47], 4, 2, 24, format).unwrap_err();
        assert_eq!(few, Error::TooFewBytes { bytes: 47, width: 4, height: 2, needed: 48 });
        assert!(Pixels::new(&[], usize::MAX, usize::MAX, usize::MAX, format).is_err());
    }
}
