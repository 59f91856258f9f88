//! From messages with pictures to samples.

use blur_core::image::{Channels, PixelFormat, Pixels, SampleType};

use crate::cdr::ByteOrder;
use crate::msg::{CompressedImage, Header, Image, Message};
use crate::{Error, Result};

/// A message with a picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Frame<'a> {
    /// Stored samples.
    Raw(Image<'a>),
    /// A PNG or JPEG file.
    Compressed(CompressedImage<'a>),
}

/// The types of messages with pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrameKind {
    /// `sensor_msgs/msg/Image`.
    Raw,
    /// `sensor_msgs/msg/CompressedImage`.
    Compressed,
}

impl FrameKind {
    /// The kind of messages of a type, if they hold pictures.
    pub fn of_type(ros: &str) -> Option<Self> {
        if Image::TYPE.is(ros) {
            Some(Self::Raw)
        } else if CompressedImage::TYPE.is(ros) {
            Some(Self::Compressed)
        } else {
            None
        }
    }
}

impl<'a> Frame<'a> {
    /// The picture in a message.
    ///
    /// # Errors
    /// Those of [`Message::from_cdr`].
    pub fn from_cdr(kind: FrameKind, message: &'a [u8]) -> Result<Self> {
        Ok(match kind {
            FrameKind::Raw => Self::Raw(Image::from_cdr(message)?),
            FrameKind::Compressed => Self::Compressed(CompressedImage::from_cdr(message)?),
        })
    }

    /// When and in which optical frame it was taken.
    pub fn header(&self) -> Header<'a> {
        match self {
            Self::Raw(image) => image.header,
            Self::Compressed(image) => image.header,
        }
    }
}

/// Gives the samples of raw pictures; its buffer is for those whose bytes are in the order of other machines.
#[derive(Debug, Clone, Default)]
pub struct Samples {
    swapped: Vec<u8>,
}

impl Samples {
    /// The samples of a picture, which are not copied unless their bytes must be turned round.
    ///
    /// # Errors
    /// [`Error::Encoding`] and, for steps and data that are too short, those of [`Pixels::new`].
    pub fn pixels<'a>(&'a mut self, image: &Image<'a>) -> Result<Pixels<'a>> {
        let format = pixel_format(image.encoding)?;
        let [width, height, step] = [image.width, image.height, image.step].map(|value| value as usize);
        let is_native = image.is_bigendian == (ByteOrder::NATIVE == ByteOrder::Big);
        let sample_bytes = format.sample.bytes();
        let data = if is_native || sample_bytes == 1 {
            image.data
        } else {
            self.swapped.clear();
            self.swapped.extend_from_slice(image.data);
            // Rows that begin at other bytes than samples do are turned one by one.
            for row in self.swapped.chunks_mut(step.max(1)) {
                row.chunks_exact_mut(sample_bytes).for_each(<[u8]>::reverse);
            }
            &self.swapped
        };
        Ok(Pixels::new(data, width, height, step, format)?)
    }
}

/// What the pixels of an encoding of `sensor_msgs/image_encodings.hpp` are made of.
fn pixel_format(encoding: &str) -> Result<PixelFormat> {
    let (sample, channels) = match encoding {
        "mono8" | "8UC1" => (SampleType::U8, Channels::Grey),
        "mono16" | "16UC1" => (SampleType::U16, Channels::Grey),
        "32FC1" => (SampleType::F32, Channels::Grey),
        "rgb8" => (SampleType::U8, Channels::Rgb),
        "rgba8" => (SampleType::U8, Channels::Rgba),
        "bgr8" => (SampleType::U8, Channels::Bgr),
        "bgra8" => (SampleType::U8, Channels::Bgra),
        "rgb16" => (SampleType::U16, Channels::Rgb),
        "rgba16" => (SampleType::U16, Channels::Rgba),
        "bgr16" => (SampleType::U16, Channels::Bgr),
        "bgra16" => (SampleType::U16, Channels::Bgra),
        _ => {
            let advice = if encoding.starts_with("bayer_") {
                "make colours of the mosaic first, for instance with image_proc"
            } else {
                "publish mono8, mono16, 8UC1, 16UC1, 32FC1, or rgb, rgba, bgr, bgra with 8 or 16 bits"
            };
            return Err(Error::Encoding { encoding: encoding.chars().take(64).collect(), advice });
        }
    };
    Ok(PixelFormat { sample, channels })
}

#[cfg(test)]
mod tests {
    use blur_core::image::Grey;

    use super::*;

    fn image<'a>(encoding: &'a str, is_bigendian: bool, step: u32, data: &'a [u8]) -> Image<'a> {
        Image { header: Header::default(), height: 2, width: 1, encoding, is_bigendian, step, data }
    }

    fn greys(image: &Image<'_>) -> Vec<f32> {
        let mut samples = Samples::default();
        let pixels = samples.pixels(image).unwrap();
        Grey::new(false).convert(&pixels).iter().copied().collect()
    }

    #[test]
    fn either_order_of_bytes_gives_the_same_samples() {
        // Codes 257 and 514 are 1 and 2 on the scale of 8 bits; rows begin at odd bytes.
        assert_eq!(greys(&image("mono16", false, 3, &[1, 1, 99, 2, 2])), [1.0, 2.0]);
        assert_eq!(greys(&image("16UC1", true, 3, &[0x02, 0x02, 99, 0x01, 0x01])), [2.0, 1.0]);
        let little = [0.5_f32, -3.25].map(f32::to_le_bytes).concat();
        let big = [0.5_f32, -3.25].map(f32::to_be_bytes).concat();
        assert_eq!(greys(&image("32FC1", false, 4, &little)), [0.5, -3.25]);
        assert_eq!(greys(&image("32FC1", true, 4, &big)), [0.5, -3.25]);
        let (little, big) = (0x1234_u16.to_le_bytes(), 0x1234_u16.to_be_bytes());
        let (little, big) = ([little, little].concat(), [big, big].concat());
        assert_eq!(greys(&image("mono16", false, 2, &little)), greys(&image("mono16", true, 2, &big)));
    }

    #[test]
    fn samples_in_the_order_of_the_machine_are_not_copied() {
        let data = [7_u8, 9];
        let image = image("mono8", true, 1, &data);
        let mut samples = Samples::default();
        samples.pixels(&image).unwrap();
        assert_eq!(samples.swapped.capacity(), 0);
    }

    #[test]
    fn what_cannot_be_measured_is_refused_with_advice() {
        let mut samples = Samples::default();
        let message = |image: &Image<'_>, samples: &mut Samples| samples.pixels(image).unwrap_err().to_string();
        assert!(message(&image("bayer_rggb8", false, 1, &[1, 2]), &mut samples).contains("image_proc"));
        assert!(message(&image("yuv422", false, 2, &[1; 4]), &mut samples).contains("mono8"));
        assert!(message(&image("rgb8", false, 2, &[1; 6]), &mut samples).contains("row"));
        assert!(samples.pixels(&image("mono16", true, 2, &[1; 3])).is_err());
        let huge = Image { width: u32::MAX, height: u32::MAX, step: 0, ..image("mono16", true, 0, &[]) };
        assert!(samples.pixels(&huge).is_err());
    }
}
