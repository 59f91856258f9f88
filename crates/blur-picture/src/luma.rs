//! Grey values of decoded samples.

use blur_core::image::{Channels, Grey, PixelFormat, Pixels, SampleType};
use image::{ColorType, DynamicImage};
use ndarray::Array2;

use crate::{Error, Result};

/// Grey values of a decoded picture, see [`Picture::luma`](super::Picture::luma).
pub(super) fn luma(picture: &DynamicImage, linear: bool) -> Result<Array2<f32>> {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let format = format(picture.color())?;
    let pixels = Pixels::new(picture.as_bytes(), width, height, width * format.bytes(), format)?;
    let mut grey = Grey::new(linear);
    grey.convert(&pixels);
    Ok(grey.into_values())
}

/// What the pixels of a decoded picture are made of.
fn format(colour: ColorType) -> Result<PixelFormat> {
    let (sample, channels) = match colour {
        ColorType::L8 => (SampleType::U8, Channels::Grey),
        ColorType::La8 => (SampleType::U8, Channels::GreyAlpha),
        ColorType::Rgb8 => (SampleType::U8, Channels::Rgb),
        ColorType::Rgba8 => (SampleType::U8, Channels::Rgba),
        ColorType::L16 => (SampleType::U16, Channels::Grey),
        ColorType::La16 => (SampleType::U16, Channels::GreyAlpha),
        ColorType::Rgb16 => (SampleType::U16, Channels::Rgb),
        ColorType::Rgba16 => (SampleType::U16, Channels::Rgba),
        ColorType::Rgb32F => (SampleType::F32, Channels::Rgb),
        ColorType::Rgba32F => (SampleType::F32, Channels::Rgba),
        other => return Err(Error::Samples { kind: format!("{other:?}") }),
    };
    Ok(PixelFormat { sample, channels })
}

/// Rows and columns of `grey`, row by row from the top.
pub(super) fn picture_of(grey: Vec<f32>, width: usize, height: usize) -> Result<Array2<f32>> {
    let samples = grey.len();
    Array2::from_shape_vec((height, width), grey).map_err(|_| Error::SampleCount { samples, width, height })
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
}
