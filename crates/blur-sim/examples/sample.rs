//! Writes the sample picture of the program `estimate` as an 8-bit grey PNG.
//!
//! `cargo run -p blur-sim --example sample -- FILE`; `cargo xtask goldens` calls it for `fixtures/sample.png`. The file
//! depends on nothing but the sources and `Cargo.lock`.

use std::error::Error;
use std::fs;
use std::path::PathBuf;

use blur_sim::sample::sample_picture;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args_os().nth(1).map(PathBuf::from).ok_or("usage: sample FILE")?;
    let picture = sample_picture()?;
    let (rows, columns) = picture.dim();
    let pixels: Vec<u8> = picture.iter().copied().collect();
    let mut png = Vec::new();
    PngEncoder::new_with_quality(&mut png, CompressionType::Best, FilterType::Adaptive).write_image(
        &pixels,
        u32::try_from(columns)?,
        u32::try_from(rows)?,
        ExtendedColorType::L8,
    )?;
    fs::write(&path, png)?;
    println!("{}: {columns}x{rows} pixels", path.display());
    Ok(())
}
