//! Arrays as pictures inside the page.

use std::io::Cursor;

use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, GrayImage, ImageFormat, RgbaImage};
use ndarray::{Array2, ArrayView2, Axis, Slice};

use crate::{Error, Result};

const JPEG_QUALITY: u8 = 85;
/// Quantiles of the grey values that become black and white.
const BLACK: f64 = 0.001;
const WHITE: f64 = 0.999;

/// A photograph as a grey JPEG.
pub fn photograph(picture: &Array2<u8>) -> Result<String> {
    let (rows, columns) = picture.dim();
    let pixels = picture.iter().copied().collect();
    let grey = GrayImage::from_raw(columns as u32, rows as u32, pixels).ok_or_else(|| cannot_hold(rows, columns))?;
    let mut bytes = Vec::new();
    grey.write_with_encoder(JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY)).map_err(Error::Encode)?;
    Ok(data_uri("image/jpeg", &bytes))
}

/// A picture in its own colours as a JPEG of 8 bits, without its alpha.
pub fn picture(picture: &DynamicImage) -> Result<String> {
    let mut bytes = Vec::new();
    picture
        .to_rgb8()
        .write_with_encoder(JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY))
        .map_err(Error::Encode)?;
    Ok(data_uri("image/jpeg", &bytes))
}

/// Values as a PNG, a pixel each; `colour` gives red, green, blue and opacity.
pub fn values(values: &Array2<f64>, colour: impl Fn(f64) -> [u8; 4]) -> Result<String> {
    let (rows, columns) = values.dim();
    let pixels = values.iter().flat_map(|&value| colour(value)).collect();
    let picture = RgbaImage::from_raw(columns as u32, rows as u32, pixels).ok_or_else(|| cannot_hold(rows, columns))?;
    let mut bytes = Cursor::new(Vec::new());
    DynamicImage::from(picture).write_to(&mut bytes, ImageFormat::Png).map_err(Error::Encode)?;
    Ok(data_uri("image/png", bytes.get_ref()))
}

fn cannot_hold(height: usize, width: usize) -> Error {
    blur_picture::Error::SampleCount { samples: 0, width, height }.into()
}

/// Grey between `black` and `white`; what is not a number is transparent.
pub fn grey(black: f64, white: f64) -> impl Fn(f64) -> [u8; 4] {
    move |value| {
        if value.is_nan() {
            return [0; 4];
        }
        let level = level((value - black) / (white - black));
        [level, level, level, 255]
    }
}

/// Grey values for the eye: blocks of pixels averaged until no side is longer than `most_side`, contrast from the
/// quantiles 0.1 % to 99.9 %, the tone curve of sRGB put back where the picture is `linear` light.
pub fn preview(picture: ArrayView2<'_, f32>, most_side: usize, linear: bool) -> Array2<u8> {
    let (rows, columns) = picture.dim();
    let block = rows.max(columns).div_ceil(most_side.max(1)).max(1);
    let small = Array2::from_shape_fn((rows.div_ceil(block), columns.div_ceil(block)), |(row, column)| {
        let span = |at: usize, end: usize| Slice::from(at * block..((at + 1) * block).min(end));
        let mut part = picture;
        part.slice_axis_inplace(Axis(0), span(row, rows));
        part.slice_axis_inplace(Axis(1), span(column, columns));
        part.iter().map(|&x| f64::from(x)).sum::<f64>() / part.len() as f64
    });
    let (black, white) = (quantile(&small, BLACK), quantile(&small, WHITE));
    small.mapv(|value| {
        let share = (value - black) / (white - black);
        level(if linear { srgb(share.clamp(0.0, 1.0)) } else { share })
    })
}

/// The value below which this share of those that are numbers lies; 0 when there is none.
pub fn quantile(values: &Array2<f64>, share: f64) -> f64 {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    if sorted.is_empty() {
        return 0.0;
    }
    let at = ((sorted.len() - 1) as f64 * share).round() as usize;
    *sorted.select_nth_unstable_by(at, f64::total_cmp).1
}

/// IEC 61966-2-1, from light to signal.
fn srgb(light: f64) -> f64 {
    if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 }
}

fn level(share: f64) -> u8 {
    (255.0 * share).round().clamp(0.0, 255.0) as u8
}

fn data_uri(kind: &str, bytes: &[u8]) -> String {
    format!("data:{kind};base64,{}", base64(bytes))
}

/// RFC 4648, with padding.
pub fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let byte = |i: usize| u32::from(chunk.get(i).copied().unwrap_or(0));
        let group = byte(0) << 16 | byte(1) << 8 | byte(2);
        for digit in 0..4 {
            let is_used = digit <= chunk.len();
            let index = (group >> (18 - 6 * digit)) & 63;
            text.push(if is_used { char::from(DIGITS[index as usize]) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_gives_the_test_vectors_of_rfc_4648() {
        let vectors = ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"];
        for (length, expected) in vectors.into_iter().enumerate() {
            assert_eq!(base64(&b"foobar"[..length]), expected);
        }
    }

    #[test]
    fn a_preview_keeps_the_ends_of_the_scale_and_shrinks_in_whole_blocks() {
        let picture = Array2::from_shape_fn((300, 1001), |(_, column)| column as f32 * 1e-3 - 7.0);
        let preview = preview(picture.view(), 500, false);
        assert_eq!(preview.dim(), (100, 334));
        assert_eq!((preview[[50, 0]], preview[[50, 333]]), (0, 255));
        assert!(preview.row(3).windows(2).into_iter().all(|pair| pair[0] <= pair[1]));
    }

    #[test]
    fn light_is_shown_by_the_curve_of_srgb() {
        // IEC 61966-2-1: 18 % grey is the signal 0.4614, 117.6 of 255.
        assert_eq!(level(srgb(0.18)), 118);
        let picture = Array2::from_shape_fn((40, 101), |(_, column)| column as f32);
        assert_eq!(preview(picture.view(), 200, true)[[0, 18]], 118);
    }
}
