//! Grey values of decoded samples.

use blur_core::image::{bt601_luma, linear_from_srgb};
use image::DynamicImage;
use ndarray::Array2;

use crate::{Error, Result};

/// Full scale of the grey values that come from integer samples, whatever their depth.
const FULL_SCALE: f32 = 255.0;

/// Grey values of a decoded picture, see [`Picture::luma`](super::Picture::luma).
pub(super) fn luma(picture: &DynamicImage, linear: bool) -> Result<Array2<f32>> {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let channels = usize::from(picture.color().channel_count());
    let grey = match picture {
        DynamicImage::ImageLuma8(p) => from_u8(p.as_raw(), channels, linear),
        DynamicImage::ImageLumaA8(p) => from_u8(p.as_raw(), channels, linear),
        DynamicImage::ImageRgb8(p) => from_u8(p.as_raw(), channels, linear),
        DynamicImage::ImageRgba8(p) => from_u8(p.as_raw(), channels, linear),
        DynamicImage::ImageLuma16(p) => from_u16(p.as_raw(), channels, linear),
        DynamicImage::ImageLumaA16(p) => from_u16(p.as_raw(), channels, linear),
        DynamicImage::ImageRgb16(p) => from_u16(p.as_raw(), channels, linear),
        DynamicImage::ImageRgba16(p) => from_u16(p.as_raw(), channels, linear),
        DynamicImage::ImageRgb32F(p) => grey_values(p.as_raw(), channels, linear, |x| x),
        DynamicImage::ImageRgba32F(p) => grey_values(p.as_raw(), channels, linear, |x| x),
        other => return Err(Error::Samples { kind: format!("{:?}", other.color()) }),
    };
    picture_of(grey, width, height)
}

/// Rows and columns of `grey`, row by row from the top.
pub(super) fn picture_of(grey: Vec<f32>, width: usize, height: usize) -> Result<Array2<f32>> {
    let samples = grey.len();
    Array2::from_shape_vec((height, width), grey).map_err(|_| Error::SampleCount { samples, width, height })
}

fn from_u8(samples: &[u8], channels: usize, linear: bool) -> Vec<f32> {
    let levels = levels(u8::MAX.into(), linear);
    grey_values(samples, channels, linear, |x| levels[usize::from(x)])
}

fn from_u16(samples: &[u16], channels: usize, linear: bool) -> Vec<f32> {
    let levels = levels(u16::MAX, linear);
    grey_values(samples, channels, linear, |x| levels[usize::from(x)])
}

/// The value on the common scale of every code `0..=max`: a table, since the sRGB curve is too slow for every pixel.
fn levels(max: u16, linear: bool) -> Vec<f32> {
    let max_f = f32::from(max);
    (0..=max)
        .map(|code| {
            let code = f32::from(code);
            // The product is exact in f32 (255 * 65535 < 2^24), so 8 and 16 bit codes of one grey give one value.
            if linear { FULL_SCALE * linear_from_srgb(code / max_f) } else { code * FULL_SCALE / max_f }
        })
        .collect()
}

/// One grey value for each pixel of `channels` samples: grey, grey + alpha, RGB or RGB + alpha.
fn grey_values<T: Copy>(samples: &[T], channels: usize, linear: bool, level: impl Fn(T) -> f32) -> Vec<f32> {
    if channels < 3 {
        return samples.iter().step_by(channels.max(1)).map(|&x| level(x)).collect();
    }
    let weigh = if linear { bt709_luminance } else { bt601_luma };
    samples.chunks_exact(channels).map(|pixel| weigh(level(pixel[0]), level(pixel[1]), level(pixel[2]))).collect()
}

/// Relative luminance of linear light by ITU-R BT.709, whose primaries are those of sRGB.
fn bt709_luminance(red: f32, green: f32, blue: f32) -> f32 {
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}

#[cfg(test)]
mod tests {
    use image::{ImageBuffer, Luma, LumaA, Rgb, Rgba};

    use super::*;

    fn first(picture: impl Into<DynamicImage>, linear: bool) -> f32 {
        luma(&picture.into(), linear).unwrap()[[0, 0]]
    }

    #[test]
    fn depth_and_channels_do_not_change_a_grey() {
        let grey16 = 77_u16 * 257;
        assert_eq!(first(ImageBuffer::from_pixel(2, 3, Luma([77_u8])), false), 77.0);
        assert_eq!(first(ImageBuffer::from_pixel(2, 3, LumaA([77_u8, 3])), false), 77.0);
        assert_eq!(first(ImageBuffer::from_pixel(2, 3, Luma([grey16])), false), 77.0);
        for value in [
            first(ImageBuffer::from_pixel(2, 3, Rgb([77_u8; 3])), false),
            first(ImageBuffer::from_pixel(2, 3, Rgba([77_u8, 77, 77, 0])), false),
            first(ImageBuffer::from_pixel(2, 3, Rgba([grey16, grey16, grey16, 5])), false),
            first(ImageBuffer::from_pixel(2, 3, Rgb([77.0_f32; 3])), false),
        ] {
            assert!((value - 77.0).abs() < 1e-4, "{value}");
        }
    }

    #[test]
    fn colours_weigh_by_their_standard() {
        let green = Rgb([0_u8, 255, 0]);
        assert!((first(ImageBuffer::from_pixel(1, 1, green), false) - 0.587 * 255.0).abs() < 1e-3);
        assert!((first(ImageBuffer::from_pixel(1, 1, green), true) - 0.7152 * 255.0).abs() < 1e-3);
    }

    #[test]
    fn linear_light_decodes_the_srgb_curve() {
        // IEC 61966-2-1: code 188/255 is ((188/255 + 0.055)/1.055)^2.4 of the light.
        let expected = 255.0 * ((188.0_f64 / 255.0 + 0.055) / 1.055).powf(2.4);
        let found = first(ImageBuffer::from_pixel(1, 1, Luma([188_u8])), true);
        assert!((f64::from(found) - expected).abs() < 1e-3, "{found} {expected}");
    }

    #[test]
    fn floats_stay_as_they_are() {
        assert!(first(ImageBuffer::from_pixel(1, 1, Rgb([f32::NAN; 3])), false).is_nan());
        assert!((first(ImageBuffer::from_pixel(1, 1, Rgb([0.25_f32; 3])), true) - 0.25).abs() < 1e-6);
    }
}
