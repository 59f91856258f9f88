//! A picture of which one part moves: the blur tile by tile, and the region that moves as one.
//!
//! `cargo run --release -p blur-core --example map`

mod scene;

use blur_core::estimate::Settings;
use blur_core::region::{TilePlan, measure_tiles, segment};
use ndarray::Array2;

/// Rows, columns and blur of what moves.
const MOVING: (std::ops::Range<usize>, std::ops::Range<usize>) = (96..416, 160..608);
const BLUR_PX: usize = 16;

fn main() -> blur_core::Result<()> {
    let (still, moving) = (scene::scene(512, 768), scene::scene(512, 768 + BLUR_PX));
    let picture = Array2::from_shape_fn((512, 768), |(row, column)| {
        if MOVING.0.contains(&row) && MOVING.1.contains(&column) {
            (0..BLUR_PX).map(|right| moving[[row, column + right]]).sum::<f32>() / BLUR_PX as f32
        } else {
            still[[row, column]]
        }
    });
    let (plan, settings) = (TilePlan::new(picture.dim(), 128)?, Settings::default());
    let tiles = measure_tiles(picture.view(), plan, &settings)?;
    println!("blur length in pixels tile by tile, half a tile apart; . stands still, ? cannot be told");
    for row in tiles.chunks(plan.grid().1) {
        let cells: Vec<_> = row
            .iter()
            .map(|tile| match tile.blur {
                Some(blur) if blur.status.name() == "ok" => format!("{:5.1}", blur.length_px),
                Some(blur) if blur.status.name() == "no_motion_blur" => "    .".to_owned(),
                _ => "    ?".to_owned(),
            })
            .collect();
        println!("{}", cells.join(" "));
    }
    let segmentation = segment(picture.view(), &tiles, &settings)?;
    for (number, region) in segmentation.moving.iter().enumerate() {
        println!(
            "region {}: {:.0} % of the picture moves by {:.2} px along {:.2} deg",
            number + 1,
            100.0 * segmentation.share(number as u8 + 1),
            region.blur.length_px,
            region.blur.angle.deg()
        );
    }
    Ok(())
}
