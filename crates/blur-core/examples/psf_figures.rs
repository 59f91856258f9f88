//! Draws figures 3.1-3.9 of the thesis, the blur of uniform and of accelerated motions in space and in frequency.
//!
//! `cargo run -p blur-core --example psf_figures -- [FOLDER]` writes `figure-3-1.svg` ... `figure-3-9.svg`, by default
//! to `target/psf-figures`.
//!
//! The thesis states the speed of figure 3.9 as 1 m/s in the text and as 1 mm/s in the caption; at 1 m/s the motion is
//! uniform to the eye, so the caption holds. The densities of figures 3.2-3.4 are drawn so that they integrate to 1.

use std::error::Error;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use blur_core::psf::{AcceleratedBlur, UniformBlur};
use plotters::prelude::*;

const SIZE: (u32, u32) = (900, 560);
const POINTS: u32 = 1200;
const LENGTHS_MM: [f64; 3] = [0.05, 0.1, 0.5];
const RATIOS_MM: [f64; 5] = [0.01, 0.02, 0.2, 0.008, 0.001];
/// Colours that stay apart for every eye (Okabe and Ito 2008).
const COLOURS: [RGBColor; 5] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
];
const ACCELERATION_MM_S2: f64 = 1000.0;

type Curve = (String, Box<dyn Fn(f64) -> f64>);

struct Figure {
    name: &'static str,
    title: String,
    x_label: &'static str,
    y_label: &'static str,
    x_end: f64,
    curves: Vec<Curve>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).map_or_else(|| PathBuf::from("target/psf-figures"), PathBuf::from);
    std::fs::create_dir_all(&folder)?;
    for figure in figures()? {
        draw(&folder, &figure)?;
    }
    println!("figures 3.1-3.9 are in {}", folder.display());
    Ok(())
}

fn figures() -> blur_core::Result<Vec<Figure>> {
    let mut figures = vec![transfer_of_uniform()?];
    for (name, length, ratio) in [("3-2", 0.05, 0.001), ("3-3", 0.1, 0.01), ("3-4", 0.5, 0.02)] {
        figures.push(density(name, length, ratio)?);
    }
    for (name, length) in ["3-5", "3-6", "3-7"].into_iter().zip(LENGTHS_MM) {
        figures.push(magnitude(name, length)?);
    }
    figures.push(cosine_of_uniform()?);
    figures.push(cosine_of_accelerated()?);
    Ok(figures)
}

/// The motion of one of the thesis's ratios R = v0²/a.
fn by_ratio(ratio_mm: f64, length_mm: f64) -> blur_core::Result<AcceleratedBlur> {
    AcceleratedBlur::from_path((ratio_mm * ACCELERATION_MM_S2).sqrt(), ACCELERATION_MM_S2, length_mm)
}

fn transfer_of_uniform() -> blur_core::Result<Figure> {
    let mut curves: Vec<Curve> = Vec::new();
    for length in LENGTHS_MM {
        let blur = UniformBlur::new(length)?;
        curves.push((format!("x = {length} mm"), Box::new(move |u| blur.gate_transform(2.0 * PI * u))));
    }
    Ok(Figure {
        name: "3-1",
        title: "Figure 3.1: transfer function of uniform motion, sinc(u x)".into(),
        x_label: "u (cycles/mm)",
        y_label: "L(u)",
        x_end: 60.0,
        curves,
    })
}

fn density(name: &'static str, length: f64, ratio: f64) -> blur_core::Result<Figure> {
    let blur = by_ratio(ratio, length)?;
    Ok(Figure {
        name,
        title: format!("Figure {}: PSF of accelerated motion, x = {length} mm, R = {ratio} mm", name.replace('-', ".")),
        x_label: "s (mm)",
        y_label: "l(s) (1/mm)",
        x_end: length,
        curves: vec![(format!("R = {ratio} mm"), Box::new(move |s| blur.psf(s)))],
    })
}

fn magnitude(name: &'static str, length: f64) -> blur_core::Result<Figure> {
    let mut curves: Vec<Curve> = Vec::new();
    for ratio in RATIOS_MM {
        let blur = by_ratio(ratio, length)?;
        curves.push((format!("R = {ratio} mm, r = {:.3}", blur.ratio()), Box::new(move |u| blur.mtf(u))));
    }
    Ok(Figure {
        name,
        title: format!("Figure {}: MTF of accelerated motion, x = {length} mm", name.replace('-', ".")),
        x_label: "u (cycles/mm)",
        y_label: "M(u)",
        x_end: 5.0 / length,
        curves,
    })
}

fn cosine_of_uniform() -> blur_core::Result<Figure> {
    let (length, height) = (0.5, 1.0);
    let blur = UniformBlur::new(length)?;
    Ok(Figure {
        name: "3-8",
        title: "Figure 3.8: cosine transform of uniform motion, L = 0.5 mm, b = 1 mm/s".into(),
        x_label: "omega (rad/mm)",
        y_label: "F(omega)",
        x_end: 80.0,
        curves: vec![("b L sinc".into(), Box::new(move |omega| height * length * blur.cosine_transform(omega)))],
    })
}

fn cosine_of_accelerated() -> blur_core::Result<Figure> {
    let (length, v0) = (0.5, 1.0_f64);
    let mut curves: Vec<Curve> = Vec::new();
    for a in [1000.0, 100.0, 50.0] {
        let blur = AcceleratedBlur::from_path(v0, a, length)?;
        let duration = ((v0 * v0 + 2.0 * a * length).sqrt() - v0) / a;
        curves.push((format!("a = {a} mm/s²"), Box::new(move |omega| duration * blur.cosine_transform(omega))));
    }
    Ok(Figure {
        name: "3-9",
        title: "Figure 3.9: cosine transform of accelerated motion, x = 0.5 mm, v0 = 1 mm/s".into(),
        x_label: "omega (rad/mm)",
        y_label: "F(omega)",
        x_end: 80.0,
        curves,
    })
}

fn draw(folder: &Path, figure: &Figure) -> Result<(), Box<dyn Error>> {
    let sampled: Vec<Vec<(f64, f64)>> = figure
        .curves
        .iter()
        .map(|(_, f)| {
            (0..=POINTS).map(|k| figure.x_end * f64::from(k) / f64::from(POINTS)).map(|x| (x, f(x))).collect()
        })
        .collect();
    let heights = || sampled.iter().flatten().map(|point| point.1);
    let (low, high) = (heights().fold(0.0, f64::min), heights().fold(0.0, f64::max));
    let margin = 0.05 * (high - low);

    let path = folder.join(format!("figure-{}.svg", figure.name));
    let root = SVGBackend::new(&path, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let bottom = if low < 0.0 { low - margin } else { 0.0 };
    let mut chart = ChartBuilder::on(&root)
        .caption(&figure.title, ("sans-serif", 20))
        .margin(12)
        .x_label_area_size(45)
        .y_label_area_size(65)
        .build_cartesian_2d(0.0..figure.x_end, bottom..high + margin)?;
    chart.configure_mesh().x_desc(figure.x_label).y_desc(figure.y_label).light_line_style(WHITE).draw()?;
    for (((label, _), points), colour) in figure.curves.iter().zip(sampled).zip(COLOURS.iter().cycle()) {
        chart
            .draw_series(LineSeries::new(points, colour.stroke_width(2)))?
            .label(label)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
    }
    chart.configure_series_labels().background_style(WHITE).border_style(BLACK.mix(0.3)).draw()?;
    root.present()?;
    Ok(())
}
