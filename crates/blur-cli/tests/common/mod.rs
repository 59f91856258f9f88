//! Pictures made in the test, and the program run on them.
#![allow(dead_code, reason = "each test file uses its own part")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of tests fails the test")]

use std::ffi::OsStr;
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use image::codecs::png::PngEncoder;
use image::{DynamicImage, ExtendedColorType, GrayImage, ImageEncoder, ImageFormat};
use serde_json::Value;

/// The program under test.
pub(crate) fn estimate() -> Command {
    Command::new(env!("CARGO_BIN_EXE_estimate"))
}

/// Runs the program and checks what holds for every run: it ends by itself and does not panic.
pub(crate) fn run<S: AsRef<OsStr>>(arguments: impl IntoIterator<Item = S>) -> Output {
    let output = estimate().args(arguments).output().unwrap();
    assert!(output.status.code().is_some(), "ended by a signal: {output:?}");
    assert!(!stderr(&output).contains("panicked"), "{}", stderr(&output));
    output
}

/// The exit status and the JSON objects of a run with `--json`.
pub(crate) fn run_json<S: AsRef<OsStr>>(arguments: impl IntoIterator<Item = S>) -> (i32, Vec<Value>) {
    let mut command = estimate();
    let output = command.arg("--json").args(arguments).output().unwrap();
    assert!(!stderr(&output).contains("panicked"), "{}", stderr(&output));
    let objects = stdout(&output).lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    (output.status.code().unwrap(), objects)
}

pub(crate) fn stdout(output: &Output) -> &str {
    std::str::from_utf8(&output.stdout).unwrap()
}

pub(crate) fn stderr(output: &Output) -> &str {
    std::str::from_utf8(&output.stderr).unwrap()
}

/// An empty folder for one test.
pub(crate) fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    path
}

pub(crate) fn write(folder: &Path, name: &str, content: &[u8]) -> PathBuf {
    let path = folder.join(name);
    fs::write(&path, content).unwrap();
    path
}

/// `SplitMix64` (Steele, Lea, Flood 2014): the same numbers everywhere.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in `[0, 1)`.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }
}

/// White noise blurred along its rows by a box of `length` pixels: by construction its angle is 0 degrees and its
/// length is `length`. The mean of `L` uniform numbers has the standard deviation `1 / sqrt(12 L)`, here made 45.
pub(crate) fn blurred(width: u32, height: u32, length: usize, seed: u64) -> GrayImage {
    let mut random = Random(seed);
    let mut picture = GrayImage::new(width, height);
    let gain = 45.0 * (12.0 * length as f64).sqrt();
    for y in 0..height {
        let noise: Vec<f64> = (0..width as usize + length).map(|_| random.unit()).collect();
        for x in 0..width {
            let mean = noise[x as usize..][..length].iter().sum::<f64>() / length as f64;
            picture.get_pixel_mut(x, y).0 = [(128.0 + gain * (mean - 0.5)).round().clamp(0.0, 255.0) as u8];
        }
    }
    picture
}

pub(crate) fn encode(picture: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    picture.into().write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

pub(crate) fn png(picture: impl Into<DynamicImage>) -> Vec<u8> {
    encode(picture, ImageFormat::Png)
}

pub(crate) fn png_with_exif(picture: &GrayImage, exif: Vec<u8>) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = PngEncoder::new(&mut bytes);
    encoder.set_exif_metadata(exif).unwrap();
    encoder.write_image(picture.as_raw(), picture.width(), picture.height(), ExtendedColorType::L8).unwrap();
    bytes
}

/// A JPEG with an APP1 segment after its start marker.
pub(crate) fn jpeg_with_exif(picture: &GrayImage, exif: &[u8]) -> Vec<u8> {
    let plain = encode(picture.clone(), ImageFormat::Jpeg);
    let length = u16::try_from(2 + 6 + exif.len()).unwrap();
    let mut bytes = plain[..2].to_vec();
    bytes.extend([0xFF, 0xE1]);
    bytes.extend(length.to_be_bytes());
    bytes.extend(b"Exif\0\0");
    bytes.extend(exif);
    bytes.extend(&plain[2..]);
    bytes
}

/// EXIF data with a maker, an orientation and an exposure time of `exposure.0 / exposure.1` seconds (EXIF 2.32, 4.6).
pub(crate) fn exif(orientation: u16, exposure: (u32, u32)) -> Vec<u8> {
    let (ascii, short, long, rational) = (2, 3, 4, 5);
    let mut data = b"II*\0".to_vec();
    data.extend(8_u32.to_le_bytes());
    let entry = |tag: u16, kind: u16, count: u32, value: u32| {
        let mut entry = Vec::new();
        entry.extend(tag.to_le_bytes());
        entry.extend(kind.to_le_bytes());
        entry.extend(count.to_le_bytes());
        entry.extend(value.to_le_bytes());
        entry
    };
    data.extend(3_u16.to_le_bytes());
    data.extend(entry(0x010F, ascii, 4, u32::from_le_bytes(*b"Cam\0")));
    data.extend(entry(0x0112, short, 1, orientation.into()));
    let exif_ifd = 8 + 2 + 3 * 12 + 4;
    data.extend(entry(0x8769, long, 1, exif_ifd));
    data.extend(0_u32.to_le_bytes());
    data.extend(1_u16.to_le_bytes());
    data.extend(entry(0x829A, rational, 1, exif_ifd + 2 + 12 + 4));
    data.extend(0_u32.to_le_bytes());
    data.extend(exposure.0.to_le_bytes());
    data.extend(exposure.1.to_le_bytes());
    data
}

/// A grey TIFF with 32 bit float samples.
pub(crate) fn float_tiff(width: u32, height: u32, samples: &[f32]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = tiff::encoder::TiffEncoder::new(&mut bytes).unwrap();
    encoder.write_image::<tiff::encoder::colortype::Gray32Float>(width, height, samples).unwrap();
    bytes.into_inner()
}

/// A PNG chunk by the PNG specification 5.3: length, type, data, CRC-32 of type and data.
pub(crate) fn png_chunk(kind: [u8; 4], data: &[u8]) -> Vec<u8> {
    let body = [&kind[..], data].concat();
    let mut crc = u32::MAX;
    for &byte in &body {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { (crc >> 1) ^ 0xEDB8_8320 } else { crc >> 1 };
        }
    }
    [&u32::try_from(data.len()).unwrap().to_be_bytes(), &body[..], &(!crc).to_be_bytes()].concat()
}

/// A PNG whose header announces a grey 8 bit picture of this size, with next to no data behind it.
pub(crate) fn png_header(width: u32, height: u32) -> Vec<u8> {
    let header = [&width.to_be_bytes()[..], &height.to_be_bytes(), &[8, 0, 0, 0, 0]].concat();
    // An empty zlib stream (RFC 1950, 1951): one final stored block of no bytes.
    let empty = [0x78, 0x01, 0x01, 0, 0, 0xFF, 0xFF, 0, 0, 0, 1];
    [b"\x89PNG\r\n\x1a\n".to_vec(), png_chunk(*b"IHDR", &header), png_chunk(*b"IDAT", &empty), png_chunk(*b"IEND", &[])]
        .concat()
}

pub(crate) fn number(record: &Value, field: &str) -> f64 {
    record[field].as_f64().unwrap_or_else(|| panic!("{field} is not a number in {record}"))
}

/// Checks a record against the truth of [`blurred`]. The bounds are wide for every method on clean noise of 256 pixels
/// (a frequency bin is 1/256, a length of 20 moves its first zero by a bin within 1.6 px) and narrow enough that a
/// wrong axis, unit or picture fails.
pub(crate) fn assert_blur(record: &Value, angle_deg: f64, length_px: f64) {
    let off = (number(record, "angle_deg") - angle_deg + 90.0).rem_euclid(180.0) - 90.0;
    assert!(off.abs() < 3.0, "{angle_deg} deg: {record}");
    assert!((number(record, "length_px") - length_px).abs() < 2.0, "{length_px} px: {record}");
}
