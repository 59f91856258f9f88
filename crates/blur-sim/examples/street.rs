//! Writes a street in which two objects move as an 8-bit grey PNG, for a look at `estimate --map 128`.
//!
//! `cargo run --release -p blur-sim --example street -- SEED FILE`. The truth of each object is printed.

use std::error::Error;
use std::path::PathBuf;

use blur_sim::scene::{DeadLeaves, dead_leaves};
use blur_sim::sensor::Sensor;
use blur_sim::street::{expose_street, two_movers};
use image::GrayImage;

const ROWS: usize = 600;
const COLUMNS: usize = 900;

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args_os().skip(1);
    let (Some(seed), Some(path)) = (words.next(), words.next().map(PathBuf::from)) else {
        return Err("usage: street SEED FILE".into());
    };
    let seed: u64 = seed.to_string_lossy().parse()?;
    let scene = |stream: u64| dead_leaves(3 * seed + stream, ROWS, COLUMNS, &DeadLeaves::default());
    let (background, textures) = (scene(0)?, [scene(1)?, scene(2)?]);
    let movers = two_movers(seed, ROWS, COLUMNS)?;
    let street = expose_street(background.view(), &[(movers[0], textures[0].view()), (movers[1], textures[1].view())])?;
    let picture = Sensor::ideal().with_psnr_db(40.0)?.record(street.light.view(), seed)?;
    let pixels = picture.iter().copied().collect();
    GrayImage::from_raw(COLUMNS as u32, ROWS as u32, pixels).ok_or("the picture has another size")?.save(&path)?;
    for (number, mover) in movers.iter().enumerate() {
        let (length_px, deg) = (mover.motion.length_px(), mover.motion.angle().deg());
        let (x, y) = (mover.centre_x, mover.centre_y);
        println!("{}: {length_px:.1} px along {deg:.1} degrees about {x:.0}, {y:.0}", number + 1);
    }
    Ok(())
}
