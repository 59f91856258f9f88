//! Learns what the spectra of sharp pictures look like: the constants `MEAN` and `STD` of the estimator `whittle`.

use std::process::ExitCode;

use blur_core::estimate::joint::{SCENE_TERMS, scene_prior, scene_terms};
use blur_core::image::{Taper, Window, centre_square};
use blur_core::spectrum::Dft2;
use e2e_tests::data;
use ndarray::Array2;

/// The design pictures besides the odd-numbered ones of kodak; all others are left for tests.
const DESIGN: [&str; 5] = ["astronaut", "coffee", "gravel", "scipy_ascent", "hubble_deep_field"];
/// Side of the sharp middle that is learnt from, at most.
const MOST_SIDE: usize = 512;
const WINDOW: Window = Window::Tukey { taper: 0.25 };
/// Radii used, from this many bins of the side to this frequency in cycles per pixel.
const LEAST_BINS: f64 = 3.0;
const MOST_FREQUENCY: f64 = 0.5;
/// Whitening: powers are multiplied by `(f / 0.1)^2.2`.
const FALL: f64 = 2.2;
/// The mean of the logarithm of an exponential variable of mean 1 is minus this.
const EULER_GAMMA: f64 = 0.577_215_664_901_532_9;
/// Rounding to whole code values adds this power.
const ROUNDING: f64 = 1.0 / 12.0;
/// The spread over few pictures of few kinds is widened by this factor, and by this in quadrature.
const WIDENING: f64 = 1.3;
const LEAST_STD: f64 = 0.02;

type Amplitudes = [f64; SCENE_TERMS];

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("learn-prior: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn std::error::Error>> {
    let folder = data::folder().ok_or("the prior is learnt from the pictures of the data folder")?;
    let mut all = Vec::new();
    for picture in data::sharp_pictures(&folder)?.iter().filter(|picture| is_design(&picture.name)) {
        let amplitudes = amplitudes(&picture.luma.mapv(|luma| luma as f32)).ok_or("a spectrum has no unique fit")?;
        println!("// {:24}{}", picture.name, row(&amplitudes));
        all.push(amplitudes);
    }
    if all.len() < 2 {
        return Err("fewer than two design pictures".into());
    }
    let count = all.len() as f64;
    let mean: Amplitudes = std::array::from_fn(|k| all.iter().map(|a| a[k]).sum::<f64>() / count);
    let std: Amplitudes = std::array::from_fn(|k| {
        let variance = all.iter().map(|a| (a[k] - mean[k]).powi(2)).sum::<f64>() / (count - 1.0);
        (WIDENING * variance.sqrt()).hypot(LEAST_STD)
    });
    let (current_mean, current_std) = scene_prior();
    println!("// {} pictures; the level, the first term, is free", all.len());
    println!("MEAN     [{}]", row(&mean));
    println!("current  [{}]", row(&current_mean));
    println!("STD      [{}]", row(&std));
    println!("current  [{}]", row(&current_std));
    Ok(())
}

fn row(amplitudes: &Amplitudes) -> String {
    amplitudes.map(|amplitude| format!("{amplitude:6.2}")).join(", ")
}

fn is_design(name: &str) -> bool {
    let stem = name.split('.').next().unwrap_or_default();
    let odd = |number: &str| number.parse::<u32>().is_ok_and(|number| number % 2 == 1);
    DESIGN.contains(&stem) || stem.strip_prefix("kodim").is_some_and(odd)
}

/// The amplitudes that fit the whitened log periodogram of the middle of `luma` best, equal radii on a logarithmic scale
/// weighing equally.
fn amplitudes(luma: &Array2<f32>) -> Option<Amplitudes> {
    let view = centre_square(luma.view(), MOST_SIDE);
    let (rows, columns) = view.dim();
    let side = rows.min(columns) as f64;
    let mut dft = Dft2::new(rows, columns);
    Taper::new(WINDOW, rows, columns).apply(view, dft.input());
    let square = |n: usize| (0..n).map(|i| WINDOW.weight(i, n).powi(2)).sum::<f64>();
    let variance = f64::from(view.std(0.0)).powi(2);
    // The taper scales the picture to variance 1, and with it what rounding adds.
    let scale = 1.0 / (square(rows) * square(columns));
    let spectrum = dft.transform();
    let bins: Vec<(f64, f64, f64)> = spectrum
        .indexed_iter()
        .filter_map(|((row, column), value)| {
            let y = if row <= rows / 2 { row as f64 } else { row as f64 - rows as f64 };
            let (u, v) = (column as f64 / columns as f64, y / rows as f64);
            let radius = u.hypot(v);
            // The column u = 0 holds each bin twice.
            let is_used = (column > 0 || v > 0.0) && radius > LEAST_BINS / side && radius < MOST_FREQUENCY;
            is_used.then(|| (u, v, f64::from(value.norm_sqr()) * scale))
        })
        .collect();
    // Mean power of each ring of one bin, from which the share of rounding is told.
    let ring = |u: f64, v: f64| (u.hypot(v) * side) as usize;
    let mut rings = vec![(0.0, 0.0); (MOST_FREQUENCY * side) as usize + 1];
    for &(u, v, power) in &bins {
        let (sum, count) = &mut rings[ring(u, v)];
        *sum += power;
        *count += 1.0;
    }
    let rounding = ROUNDING / variance;
    let mut system = vec![[0.0; SCENE_TERMS + 1]; SCENE_TERMS];
    for &(u, v, power) in bins.iter().filter(|bin| bin.2 > 0.0) {
        let (sum, count) = rings[ring(u, v)];
        let signal = 1.0 - rounding * count / sum;
        if signal < 0.5 {
            continue;
        }
        let radius = u.hypot(v);
        let y = power.ln() + EULER_GAMMA + signal.ln() + FALL * (radius / 0.1).ln();
        let weight = radius.powi(-2);
        let terms = scene_terms(u, v);
        for (line, &a) in system.iter_mut().zip(&terms) {
            for (cell, &b) in line.iter_mut().zip(&terms) {
                *cell += weight * a * b;
            }
            line[SCENE_TERMS] += weight * a * y;
        }
    }
    solved(system)
}

/// Gauss's elimination of symmetric positive equations; `None` when they are singular.
fn solved(mut system: Vec<[f64; SCENE_TERMS + 1]>) -> Option<Amplitudes> {
    for k in 0..SCENE_TERMS {
        let pivot = system[k];
        if pivot[k].is_nan() || pivot[k] <= 0.0 {
            return None;
        }
        for (_, line) in system.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let factor = line[k] / pivot[k];
            for (cell, value) in line.iter_mut().zip(&pivot) {
                *cell -= factor * value;
            }
        }
    }
    Some(std::array::from_fn(|k| system[k][SCENE_TERMS] / system[k][k]))
}
