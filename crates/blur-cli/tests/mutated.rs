//! A thousand damaged files: the program may refuse them, never fall over them.

mod common;

use std::fs;

use blur_cli::picture::{self, Linearize};
use common::*;
use image::{DynamicImage, ImageFormat};

/// Small valid files of every kind that is read.
fn originals() -> Vec<(&'static str, Vec<u8>)> {
    let grey = blurred(48, 40, 8, 1);
    let wide = DynamicImage::from(grey.clone()).into_rgba16();
    let floats: Vec<f32> = grey.as_raw().iter().map(|&p| p.into()).collect();
    vec![
        ("png", png(grey.clone())),
        ("png", png(wide.clone())),
        ("png", png_with_exif(&grey, exif(6, (1, 100)))),
        ("jpg", encode(grey.clone(), ImageFormat::Jpeg)),
        ("jpg", jpeg_with_exif(&grey, &exif(8, (1, 100)))),
        ("jpg", encode(DynamicImage::from(grey.clone()).into_rgb8(), ImageFormat::Jpeg)),
        ("tif", encode(grey.clone(), ImageFormat::Tiff)),
        ("tif", encode(wide, ImageFormat::Tiff)),
        ("tif", float_tiff(48, 40, &floats)),
    ]
}

/// Flips bits, overwrites bytes, cuts the end off, or doubles a piece; half of the damage falls on the header.
fn mutate(bytes: &mut Vec<u8>, random: &mut Random) {
    for _ in 0..=random.below(4) {
        let reach = if random.below(2) == 0 { bytes.len().min(200) } else { bytes.len() };
        if reach == 0 {
            return;
        }
        let at = random.below(reach);
        match random.below(8) {
            0..=3 => bytes[at] ^= 1 << random.below(8),
            4 | 5 => bytes[at] = random.bits() as u8,
            6 => bytes.truncate(at),
            _ => {
                let piece = bytes[at..bytes.len().min(at + 64)].to_vec();
                bytes.splice(at..at, piece);
            }
        }
    }
}

fn mutations(seed: u64, count: usize) -> impl Iterator<Item = (&'static str, Vec<u8>)> {
    let originals = originals();
    let mut random = Random(seed);
    (0..count).map(move |i| {
        let (extension, mut bytes) = originals[i % originals.len()].clone();
        mutate(&mut bytes, &mut random);
        (extension, bytes)
    })
}

#[test]
fn a_thousand_damaged_files_are_decoded_or_refused() {
    let decoded = mutations(1, 1000).filter(|(_, bytes)| picture::decode(bytes, Linearize::Auto).is_ok()).count();
    // Damage in pixel data leaves a picture; damage in headers mostly does not. Both must have been tried.
    assert!((50..950).contains(&decoded), "{decoded} of 1000 decoded");
}

#[test]
fn the_program_survives_a_folder_of_damaged_files() {
    let folder = folder("mutated");
    for (i, (extension, bytes)) in mutations(2, 300).enumerate() {
        fs::write(folder.join(format!("{i:03}.{extension}")), bytes).unwrap();
    }
    let (status, records) = run_json(["--jobs", "2", folder.to_str().unwrap()]);
    assert!(status == 0 || status == 1, "{status}");
    assert_eq!(records.len(), 300);
    for (i, record) in records.iter().enumerate() {
        let start = folder.join(format!("{i:03}."));
        assert!(record["image"].as_str().unwrap().starts_with(start.to_str().unwrap()), "{record}");
        assert!(record["error"].is_string() != record["status"].is_string(), "{record}");
    }
}
