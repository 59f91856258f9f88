//! Learns how a point looks that moves: the constants `WEIGHTS` and `INTERCEPT` of `blur_core::region`.
//!
//! Streets with two moving objects show three design pictures each; points of an object and points of all else count alike. Of the
//! pictures that are left, the share of points on the right side is printed.

use std::process::ExitCode;

use blur_core::region::{LIKENESS_TERMS, likeness_terms, likeness_weights};
use blur_sim::rng::Rng;
use blur_sim::scene::{DeadLeaves, dead_leaves};
use blur_sim::sensor::{Sensor, f32_from_u8};
use blur_sim::street::{expose_street, two_movers};
use e2e_tests::data;
use image::ExtendedColorType;
use image::codecs::jpeg::JpegEncoder;
use nalgebra::{DMatrix, DVector};
use ndarray::Array2;

/// The design pictures besides the odd-numbered ones of kodak, as far as they are large enough; all others are left for tests.
const DESIGN: [&str; 5] = ["astronaut", "coffee", "brick", "gravel", "hubble_deep_field"];
const STREETS: u64 = 60;
/// Every so-many-th street is made of dead leaves.
const LEAVES: u64 = 6;
/// Noise of the streets, in turn.
const PSNR_DB: [f64; 3] = [34.0, 40.0, 46.0];
/// Every second street is compressed to JPEG of this quality, as most photographs are.
const JPEG_QUALITY: u8 = 90;
/// Rows and columns of a street, and the side of the tiles, which makes the grid.
const DIM: (usize, usize) = (512, 768);
const TILE_PX: usize = 128;
const SEED: u64 = 7000;
const STREAM: u64 = 0x11ce_0001;
/// Ridge of the regression, in terms of one standard deviation each.
const RIDGE: f64 = 1.0;
const STEPS: usize = 30;

type Terms = [f32; LIKENESS_TERMS];

/// A point with what it is and what it counts.
struct Point {
    terms: Terms,
    moves: bool,
    weight: f64,
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("learn-likeness: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn std::error::Error>> {
    let folder = data::folder().ok_or("the weights are learnt from the pictures of the data folder")?;
    let textures: Vec<Array2<f64>> = data::sharp_pictures(&folder)?
        .iter()
        .filter(|picture| is_design(&picture.name))
        .filter_map(|picture| texture(&picture.luma))
        .collect();
    if textures.len() < 6 {
        return Err("fewer than six design pictures of 512 x 768 pixels".into());
    }
    // Weights learnt from one half of the pictures are judged by the other.
    let (first, second) = textures.split_at(textures.len() / 2);
    let halves = [points(first, 0)?, points(second, STREETS)?];
    for (learnt, judged) in [(&halves[0], &halves[1]), (&halves[1], &halves[0])] {
        let weights = regression(&learnt.iter()).ok_or("the points of half the pictures do not tell the weights")?;
        println!("// right by the weights of the other half: {:.3}", share_right(&weights, judged));
    }
    let weights = regression(&halves.iter().flatten()).ok_or("the points do not tell the weights")?;
    let current = likeness_weights();
    println!("INTERCEPT {:.2}, currently {:.2}", weights.0, current.0);
    println!("WEIGHTS [{}]", row(&weights.1));
    println!("current [{}]", row(&current.1));
    let all = |weights| f64::midpoint(share_right(weights, &halves[0]), share_right(weights, &halves[1]));
    println!("// right: {:.3}, currently {:.3}", all(&weights), all(&current));
    Ok(())
}

fn row(weights: &Terms) -> String {
    weights.map(|weight| format!("{weight:.2}")).join(", ")
}

fn is_design(name: &str) -> bool {
    let stem = name.split('.').next().unwrap_or_default();
    let odd = |number: &str| number.parse::<u32>().is_ok_and(|number| number % 2 == 1);
    DESIGN.contains(&stem) || stem.strip_prefix("kodim").is_some_and(odd)
}

/// The upper left part of a picture, as large as a street, lying if the picture stands; smaller pictures are mirrored.
fn texture(luma: &Array2<f64>) -> Option<Array2<f64>> {
    let (rows, columns) = luma.dim();
    let lying = if rows > columns { luma.t() } else { luma.view() };
    let (rows, columns) = lying.dim();
    if 2 * rows < DIM.0 || 2 * columns < DIM.1 {
        return None;
    }
    let mirrored = |i: usize, n: usize| if i < n { i } else { 2 * n - 1 - i };
    Some(Array2::from_shape_fn(DIM, |(r, c)| lying[(mirrored(r, rows), mirrored(c, columns))]))
}

/// Points of streets that show the `textures`.
fn points(textures: &[Array2<f64>], first: u64) -> Result<Vec<Point>, Box<dyn std::error::Error>> {
    let mut points = Vec::new();
    for seed in SEED + first..SEED + first + STREETS {
        let mut rng = Rng::new(seed, STREAM);
        let mut picked: Vec<usize> = (0..textures.len()).collect();
        for i in 0..3 {
            let other = i + (rng.uniform() * (picked.len() - i) as f64) as usize;
            picked.swap(i, other);
        }
        let mut layers = Vec::new();
        for (layer, &number) in picked.iter().take(3).enumerate() {
            layers.push(if seed % LEAVES == 0 {
                dead_leaves(3 * seed + layer as u64, DIM.0, DIM.1, &DeadLeaves::default())?
            } else {
                textures[number].clone()
            });
        }
        let movers = two_movers(seed, DIM.0, DIM.1)?;
        let street = expose_street(layers[0].view(), &[(movers[0], layers[1].view()), (movers[1], layers[2].view())])?;
        let sensor = Sensor::ideal().with_psnr_db(PSNR_DB[(seed % 3) as usize])?;
        let recorded = sensor.record(street.light.view(), seed)?;
        let stored = if seed % 2 == 0 { recorded } else { compressed(&recorded)? };
        let picture = f32_from_u8(stored.view());
        for (mover, label) in movers.iter().zip(1..) {
            let blur = (mover.motion.length_px(), mover.motion.angle());
            let seen = likeness_terms(picture.view(), blur, TILE_PX)?;
            let moving = seen.iter().filter(|point| street.labels[point.pixel] == label).count();
            let still = seen.len() - moving;
            if moving == 0 {
                continue;
            }
            let half = 0.5 * seen.len() as f64;
            points.extend(seen.into_iter().map(|point| {
                let moves = street.labels[point.pixel] == label;
                Point { terms: point.terms, moves, weight: half / (if moves { moving } else { still }) as f64 }
            }));
        }
    }
    Ok(points)
}

/// What is left of a picture after compression.
fn compressed(picture: &Array2<u8>) -> Result<Array2<u8>, Box<dyn std::error::Error>> {
    let mut bytes = Vec::new();
    let pixels: Vec<u8> = picture.iter().copied().collect();
    let (rows, columns) = picture.dim();
    JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY).encode(
        &pixels,
        u32::try_from(columns)?,
        u32::try_from(rows)?,
        ExtendedColorType::L8,
    )?;
    let decoded = image::load_from_memory(&bytes)?.into_luma8().into_raw();
    Ok(Array2::from_shape_vec((rows, columns), decoded)?)
}

/// Intercept and weights of the logistic regression, by Newton's method on standardised terms.
fn regression<'a>(points: &(impl Iterator<Item = &'a Point> + Clone)) -> Option<(f32, Terms)> {
    const ALL: usize = LIKENESS_TERMS + 1;
    let (mut total, mut mean, mut square) = (0.0, [0.0; LIKENESS_TERMS], [0.0; LIKENESS_TERMS]);
    for point in points.clone() {
        total += point.weight;
        for (i, &term) in point.terms.iter().enumerate() {
            mean[i] += point.weight * f64::from(term);
            square[i] += point.weight * f64::from(term).powi(2);
        }
    }
    let mean = mean.map(|sum| sum / total);
    let std: Vec<f64> = square.iter().zip(mean).map(|(sum, mean)| (sum / total - mean * mean).sqrt()).collect();
    let standardised = |terms: &Terms| {
        let mut all = [1.0; ALL];
        for (i, &term) in terms.iter().enumerate() {
            all[i + 1] = (f64::from(term) - mean[i]) / std[i];
        }
        all
    };
    let mut weights = DVector::<f64>::zeros(ALL);
    for _ in 0..STEPS {
        let (mut slope, mut curvature) = (DVector::zeros(ALL), DMatrix::<f64>::zeros(ALL, ALL));
        for point in points.clone() {
            let terms = standardised(&point.terms);
            let odds: f64 = terms.iter().zip(weights.iter()).map(|(term, weight)| term * weight).sum();
            let probability = 1.0 / (1.0 + (-odds).exp());
            let (off, spread) =
                (point.weight * (f64::from(u8::from(point.moves)) - probability), probability * (1.0 - probability));
            for i in 0..ALL {
                slope[i] += off * terms[i];
                for j in 0..=i {
                    curvature[(i, j)] += point.weight * spread * terms[i] * terms[j];
                }
            }
        }
        for i in 0..ALL {
            if i > 0 {
                slope[i] -= RIDGE * weights[i];
                curvature[(i, i)] += RIDGE;
            }
            for j in i + 1..ALL {
                curvature[(i, j)] = curvature[(j, i)];
            }
        }
        let step = curvature.cholesky()?.solve(&slope);
        weights += &step;
        if step.amax() < 1e-6 {
            break;
        }
    }
    let terms: Terms = std::array::from_fn(|i| (weights[i + 1] / std[i]) as f32);
    let intercept = weights[0] - (0..LIKENESS_TERMS).map(|i| weights[i + 1] / std[i] * mean[i]).sum::<f64>();
    Some((intercept as f32, terms))
}

/// Weighted share of the points that lie on the right side.
fn share_right((intercept, weights): &(f32, Terms), points: &[Point]) -> f64 {
    let (mut right, mut total) = (0.0, 0.0);
    for point in points {
        let odds = intercept + point.terms.iter().zip(weights).map(|(term, weight)| term * weight).sum::<f32>();
        total += point.weight;
        right += if (odds > 0.0) == point.moves { point.weight } else { 0.0 };
    }
    right / total
}
