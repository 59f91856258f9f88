//! How well the parts of a street are found: `street_regions FIRST LAST [PICTURE...]`.
//!
//! Streets FIRST to LAST, by their seeds, each show three of the pictures, a still background and two moving objects, with a noise of 40 dB in eight
//! bits; without pictures it is made of dead leaves. Printed are, object by object, intersection over union and the
//! shares that were missed and added, relative to the object.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a program for the terminal that stops at any error")]

use blur_core::estimate::Settings;
use blur_core::region::{TilePlan, measure_tiles, segment};
use blur_sim::scene::{DeadLeaves, dead_leaves};
use blur_sim::sensor::{Sensor, f32_from_u8};
use blur_sim::street::{expose_street, two_movers};
use ndarray::Array2;
use std::time::Instant;

/// Rows and columns of a street.
const ROWS: usize = 512;
const COLUMNS: usize = 768;
const TILE_PX: usize = 128;

/// Upper left part of a picture, as large as a street: lying if it stands.
fn texture(path: &str) -> Array2<f64> {
    let grey = image::open(path).unwrap().to_luma8();
    let (width, height) = grey.dimensions();
    let upright = Array2::from_shape_vec((height as usize, width as usize), grey.into_raw()).unwrap().mapv(f64::from);
    let lying = if height > width { upright.reversed_axes() } else { upright };
    Array2::from_shape_fn((ROWS, COLUMNS), |place| lying[place])
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let ([first, last], paths) = arguments.split_first_chunk().unwrap();
    for seed in first.parse::<u64>().unwrap()..=last.parse().unwrap() {
        let [still, first, second] = [0, 1, 2].map(|layer| {
            if paths.is_empty() {
                dead_leaves(10 * (layer + 1) + seed, ROWS, COLUMNS, &DeadLeaves::default()).unwrap()
            } else {
                texture(&paths[(seed * 3 + layer) as usize % paths.len()])
            }
        });
        let movers = two_movers(seed, ROWS, COLUMNS).unwrap();
        let truth = expose_street(still.view(), &[(movers[0], first.view()), (movers[1], second.view())]).unwrap();
        let sensor = Sensor::ideal().with_psnr_db(40.0).unwrap();
        let picture = f32_from_u8(sensor.record(truth.light.view(), seed).unwrap().view());
        let plan = TilePlan::new((ROWS, COLUMNS), TILE_PX).unwrap();
        let settings = Settings::default();
        let tiles = measure_tiles(picture.view(), plan, &settings).unwrap();
        let start = Instant::now();
        let found = segment(picture.view(), &tiles, &settings).unwrap();
        println!("street {seed}: {} regions in {:.0?}", found.moving.len(), start.elapsed());
        for (mover, object) in movers.iter().zip(1..) {
            let count = |what: &dyn Fn(u8, u8) -> bool| {
                found.labels.iter().zip(&truth.labels).filter(|(f, t)| what(**f, **t)).count() as f64
            };
            let area = count(&|_, t| t == object);
            let region = found.moving.iter().max_by_key(|r| count(&|f, t| f == r.label && t == object) as usize);
            let (length, angle) = (mover.motion.length_px(), mover.motion.angle());
            let Some(region) = region else {
                println!("  object {object}: {length:.1} px {:.1} deg not found", angle.deg());
                continue;
            };
            let both = count(&|f, t| f == region.label && t == object);
            let added = count(&|f, t| f == region.label && t != object);
            let off = region.blur.length_px - length;
            println!(
                "  object {object}: {length:.1} px {:.1} deg IoU {:.3} missed {:.2} added {:.2}, length {:+.1} % = {:+.1} u, {:.2} deg off",
                angle.deg(),
                both / (area + added),
                1.0 - both / area,
                added / area,
                100.0 * off / length,
                off / region.blur.length_std_px.unwrap_or(f64::NAN),
                region.blur.angle.distance_deg(angle),
            );
        }
    }
}
