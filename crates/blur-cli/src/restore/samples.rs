//! The colours of a picture as planes of light, and back.

use blur_core::image::{linear_from_srgb, srgb_from_linear};
use image::{DynamicImage, ImageBuffer, Pixel};
use ndarray::Array2;

use crate::Result;
use crate::picture::Picture;

/// The channels of a picture on the scale 0 to 1, linear light where the tone curve was undone.
pub(super) struct Samples {
    pub(super) channels: Vec<Array2<f32>>,
    /// Alpha on the scale 0 to 1, which no filter touches.
    alpha: Option<Vec<f32>>,
    scale: Scale,
}

/// What a sample of 0 to 1 stands for in the file.
#[derive(Debug, Clone, Copy)]
enum Scale {
    /// Codes, linear light when the tone curve was undone.
    Codes { eight_bit: bool, linearized: bool },
    /// Floats between two values.
    Floats,
}

impl Samples {
    pub(super) fn of(picture: &Picture) -> Result<Self> {
        let dim = picture.luma.dim();
        let linearized = picture.linearized;
        let Some(stored) = &picture.stored else {
            return Ok(Self::from_floats(&picture.luma.iter().copied().collect::<Vec<_>>(), 1, dim));
        };
        let channels = usize::from(stored.color().channel_count());
        Ok(match stored {
            DynamicImage::ImageRgb32F(p) => Self::from_floats(p.as_raw(), channels, dim),
            DynamicImage::ImageRgba32F(p) => Self::from_floats(p.as_raw(), channels, dim),
            DynamicImage::ImageLuma16(p) => Self::from_u16(p.as_raw(), channels, dim, linearized),
            DynamicImage::ImageLumaA16(p) => Self::from_u16(p.as_raw(), channels, dim, linearized),
            DynamicImage::ImageRgb16(p) => Self::from_u16(p.as_raw(), channels, dim, linearized),
            DynamicImage::ImageRgba16(p) => Self::from_u16(p.as_raw(), channels, dim, linearized),
            DynamicImage::ImageLuma8(p) => Self::from_u8(p.as_raw(), channels, dim, linearized),
            DynamicImage::ImageLumaA8(p) => Self::from_u8(p.as_raw(), channels, dim, linearized),
            DynamicImage::ImageRgb8(p) => Self::from_u8(p.as_raw(), channels, dim, linearized),
            DynamicImage::ImageRgba8(p) => Self::from_u8(p.as_raw(), channels, dim, linearized),
            other => return Err(blur_picture::Error::Samples { kind: format!("{:?}", other.color()) }.into()),
        })
    }

    fn from_u8(codes: &[u8], channels: usize, dim: (usize, usize), linearized: bool) -> Self {
        let scale = Scale::Codes { eight_bit: true, linearized };
        Self::new(codes, channels, dim, scale, |code| f32::from(code) / f32::from(u8::MAX))
    }

    fn from_u16(codes: &[u16], channels: usize, dim: (usize, usize), linearized: bool) -> Self {
        let scale = Scale::Codes { eight_bit: false, linearized };
        Self::new(codes, channels, dim, scale, |code| f32::from(code) / f32::from(u16::MAX))
    }

    fn from_floats(samples: &[f32], channels: usize, dim: (usize, usize)) -> Self {
        // Alpha is not light.
        let light = samples.chunks_exact(channels).flat_map(|pixel| &pixel[..colours(channels)]);
        let (low, high) = light.fold((f32::MAX, f32::MIN), |(low, high), &x| (low.min(x), high.max(x)));
        let range = (high - low).max(f32::MIN_POSITIVE);
        Self::new(samples, channels, dim, Scale::Floats, |x| (x - low) / range)
    }

    fn new<T: Copy>(
        samples: &[T],
        channels: usize,
        dim: (usize, usize),
        scale: Scale,
        unit: impl Fn(T) -> f32,
    ) -> Self {
        let plane = |k: usize| samples.iter().skip(k).step_by(channels).map(|&x| unit(x));
        let colours = colours(channels);
        let light = |x: f32| match scale {
            Scale::Codes { linearized: true, .. } => linear_from_srgb(x),
            Scale::Codes { .. } | Scale::Floats => x,
        };
        let planes = (0..colours).map(|k| {
            let mut pixels = plane(k);
            Array2::from_shape_simple_fn(dim, || pixels.next().map_or(0.0, light))
        });
        Self { channels: planes.collect(), alpha: (channels > colours).then(|| plane(colours).collect()), scale }
    }

    /// The picture with the depth that it came with; floats get 16 bits.
    pub(super) fn into_image(self) -> Result<DynamicImage> {
        let (height, width) = self.channels.first().map_or((0, 0), Array2::dim);
        let mut planes: Vec<Vec<f32>> =
            self.channels.into_iter().map(|plane| plane.iter().copied().collect()).collect();
        if let Scale::Codes { linearized: true, .. } = self.scale {
            planes.iter_mut().flatten().for_each(|x| *x = srgb_from_linear(*x));
        }
        planes.extend(self.alpha);
        let size = (width as u32, height as u32);
        let image = if let Scale::Codes { eight_bit: true, .. } = self.scale {
            let codes = interleaved(&planes, |x| (x * f32::from(u8::MAX)).round() as u8);
            match planes.len() {
                1 => buffer(size, codes).map(DynamicImage::ImageLuma8),
                2 => buffer(size, codes).map(DynamicImage::ImageLumaA8),
                3 => buffer(size, codes).map(DynamicImage::ImageRgb8),
                _ => buffer(size, codes).map(DynamicImage::ImageRgba8),
            }
        } else {
            let codes = interleaved(&planes, |x| (x * f32::from(u16::MAX)).round() as u16);
            match planes.len() {
                1 => buffer(size, codes).map(DynamicImage::ImageLuma16),
                2 => buffer(size, codes).map(DynamicImage::ImageLumaA16),
                3 => buffer(size, codes).map(DynamicImage::ImageRgb16),
                _ => buffer(size, codes).map(DynamicImage::ImageRgba16),
            }
        };
        let samples = planes.iter().map(Vec::len).sum();
        image.ok_or_else(|| blur_picture::Error::SampleCount { samples, width, height }.into())
    }
}

/// Channels that are colours, of all of a picture: the others are alpha.
fn colours(channels: usize) -> usize {
    if channels < 3 { 1 } else { 3 }
}

fn buffer<P: Pixel>((width, height): (u32, u32), codes: Vec<P::Subpixel>) -> Option<ImageBuffer<P, Vec<P::Subpixel>>> {
    ImageBuffer::from_raw(width, height, codes)
}

/// Pixel by pixel, limited to 0 and 1; the conversion of a float to an integer does the rest.
fn interleaved<T>(planes: &[Vec<f32>], code: impl Fn(f32) -> T) -> Vec<T> {
    let pixels = planes.first().map_or(0, Vec::len);
    (0..pixels).flat_map(|i| planes.iter().map(move |plane| plane[i])).map(|x| code(x.clamp(0.0, 1.0))).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a picture that cannot be converted fails the test")]

    use image::{ImageFormat, Rgba};

    use super::*;
    use crate::picture::{Linearize, decode};

    fn there_and_back(picture: impl Into<DynamicImage>, linearize: Linearize) -> DynamicImage {
        let mut bytes = std::io::Cursor::new(Vec::new());
        picture.into().write_to(&mut bytes, ImageFormat::Png).unwrap();
        Samples::of(&decode(&bytes.into_inner(), linearize).unwrap()).unwrap().into_image().unwrap()
    }

    #[test]
    fn an_untouched_picture_comes_back_with_its_colours_depth_and_alpha() {
        for linearize in [Linearize::Off, Linearize::On] {
            let codes = |x: u32, y: u32| [(7 * x + y) as u8, (200 - x) as u8, (3 * y) as u8, (x * y) as u8];
            let eight = ImageBuffer::from_fn(20, 10, |x, y| Rgba(codes(x, y)));
            assert_eq!(there_and_back(eight.clone(), linearize), DynamicImage::ImageRgba8(eight));
            let grey = ImageBuffer::from_fn(20, 10, |x, y| image::Luma([(1000 * x + 4001 * y) as u16]));
            assert_eq!(there_and_back(grey.clone(), linearize), DynamicImage::ImageLuma16(grey));
        }
    }
}
