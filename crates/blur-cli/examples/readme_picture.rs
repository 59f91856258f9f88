//! Draws the picture of the README: `cargo run -p blur-cli --example readme_picture -- FILE`.
//!
//! Left, the middle of the sample; every bar is as long as the motion that the default method found, and lies along
//! it. Right, the log power spectrum of the whole sample, the origin at its centre; the marks are where the dark lines
//! of that motion belong, at `s = k / L` along it.

use std::error::Error;
use std::path::PathBuf;

use blur_cli::{method::Method, sample};
use blur_core::estimate::{MotionBlur, Settings};
use blur_core::image::{Region, Taper, Window};
use blur_core::spectrum::Dft2;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{Rgb, RgbImage};
use ndarray::{Array2, ArrayView2};

/// Side of each of the two pictures.
const SIDE: usize = 384;
const GAP: usize = 12;
/// Grey levels are kept in steps of this, or the noise would make the file large.
const GREY_STEP: f32 = 8.0;
/// The spectrum is shown up to this frequency in cycles per pixel.
const BAND: f64 = 0.22;
const MARK: Rgb<u8> = Rgb([255, 176, 0]);

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args_os().nth(1).map(PathBuf::from).ok_or("usage: readme_picture FILE")?;
    let grey = image::load_from_memory(sample::PNG)?.into_luma8();
    let (columns, rows) = (grey.width() as usize, grey.height() as usize);
    let picture = Array2::from_shape_vec((rows, columns), grey.iter().map(|&p| f32::from(p)).collect())?;
    let blur = Method::recommended().build(&Settings::default()).estimate(picture.view())?;

    let mut canvas = RgbImage::from_pixel((2 * SIDE + GAP) as u32, SIDE as u32, Rgb([255; 3]));
    let middle = Region { x: (columns - SIDE) / 2, y: (rows - SIDE) / 2, width: SIDE, height: SIDE };
    paint(&mut canvas, 0, middle.of(picture.view())?);
    draw_motion(&mut canvas, &blur);
    paint(&mut canvas, SIDE + GAP, log_spectrum(picture.view())?.view());
    draw_dark_lines(&mut canvas, SIDE + GAP, &blur);

    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let file = std::io::BufWriter::new(std::fs::File::create(&path)?);
    canvas.write_with_encoder(PngEncoder::new_with_quality(file, CompressionType::Best, FilterType::Adaptive))?;
    println!("{}: {:.2} deg, {:.2} px", path.display(), blur.angle.deg(), blur.length_px);
    Ok(())
}

fn paint(canvas: &mut RgbImage, left: usize, grey: ArrayView2<'_, f32>) {
    for ((row, column), &value) in grey.indexed_iter() {
        let level = ((value / GREY_STEP).round() * GREY_STEP).clamp(0.0, 255.0) as u8;
        canvas.put_pixel((left + column) as u32, row as u32, Rgb([level; 3]));
    }
}

/// A bar of the blur's length at each point of a grid.
fn draw_motion(canvas: &mut RgbImage, blur: &MotionBlur) {
    let (sin, cos) = blur.angle.rad().sin_cos();
    let each = SIDE / 6;
    for row in (each / 2..SIDE).step_by(each) {
        for column in (each / 2..SIDE).step_by(each) {
            draw_line(canvas, (column as f64, row as f64), (cos, -sin), 0.5 * blur.length_px, 0..SIDE);
        }
    }
}

/// A short piece of every dark line, at both ends of the pattern.
fn draw_dark_lines(canvas: &mut RgbImage, left: usize, blur: &MotionBlur) {
    let (sin, cos) = blur.angle.rad().sin_cos();
    let px_per_cycle = 0.5 * SIDE as f64 / BAND;
    let centre = (left as f64 + 0.5 * SIDE as f64, 0.5 * SIDE as f64);
    let across = 0.42 * SIDE as f64;
    let orders = (BAND * blur.length_px).floor() as i32;
    for order in (-orders..=orders).filter(|&order| order != 0) {
        let along = px_per_cycle * f64::from(order) / blur.length_px;
        // s = u cos(angle) - v sin(angle) is constant along (sin, cos) in (u, v).
        for side in [-across, across] {
            let middle = (centre.0 + along * cos + side * sin, centre.1 - along * sin + side * cos);
            draw_line(canvas, middle, (sin, cos), 14.0, left..left + SIDE);
        }
    }
}

/// A line about two pixels wide through `(x, y)`, where it lies in the `columns` given.
fn draw_line(
    canvas: &mut RgbImage,
    (x, y): (f64, f64),
    (dx, dy): (f64, f64),
    half_length: f64,
    columns: std::ops::Range<usize>,
) {
    let steps = (4.0 * half_length) as i32;
    for step in -steps..=steps {
        let t = half_length * f64::from(step) / f64::from(steps);
        let (column, row) = (x + t * dx, y + t * dy);
        for (column, row) in [(column, row), (column + 0.7, row), (column, row + 0.7)] {
            if columns.contains(&(column as usize)) && row >= 0.0 && (row as usize) < SIDE {
                canvas.put_pixel(column as u32, row as u32, MARK);
            }
        }
    }
}

/// The log power spectrum up to [`BAND`], the origin in the middle, in grey levels.
fn log_spectrum(picture: ArrayView2<'_, f32>) -> Result<Array2<f32>, Box<dyn Error>> {
    let (rows, columns) = picture.dim();
    let mut dft = Dft2::new(rows, columns);
    Taper::new(Window::Hann, rows, columns).apply(picture, dft.input());
    let spectrum = dft.transform();
    let power = |j: i64, k: i64| {
        let (j, k) = if k < 0 { (-j, -k) } else { (j, k) };
        spectrum[[j.rem_euclid(rows as i64) as usize, k as usize]].norm_sqr()
    };
    // Powers of neighbours are averaged: single ones scatter as much as they are large.
    let smooth = |j: i64, k: i64| (-1..=1).flat_map(|a| (-1..=1).map(move |b| power(j + a, k + b))).sum::<f32>();
    let frequency = |pixel: usize| BAND * (2.0 * (pixel as f64 + 0.5) / SIDE as f64 - 1.0);
    let log = Array2::from_shape_fn((SIDE, SIDE), |(row, column)| {
        let (j, k) = ((frequency(row) * rows as f64).round(), (frequency(column) * columns as f64).round());
        smooth(j as i64, k as i64).max(f32::MIN_POSITIVE).ln()
    });
    let mut sorted: Vec<f32> = log.iter().copied().collect();
    sorted.sort_unstable_by(f32::total_cmp);
    let quantile = |share: f64| sorted.get((share * sorted.len() as f64) as usize).copied().ok_or("no pixels");
    let (black, white) = (quantile(0.02)?, quantile(0.995)?);
    Ok(log.mapv(|value| 255.0 * (value - black) / (white - black)))
}
