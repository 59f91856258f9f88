//! A blurred picture against a sharp one of the same scene: the most certain way, with the direction and the acceleration.
//!
//! `cargo run -p blur-core --example reference_picture`

mod scene;

use blur_core::estimate::joint::Reference;
use blur_core::estimate::{JointEstimator, Settings};
use ndarray::Array2;

/// Pixels that pass during the exposure.
const BLUR_PX: usize = 21;

fn main() -> blur_core::Result<()> {
    let scene = scene::scene(240 + BLUR_PX, 320);
    let still = Array2::from_shape_fn((240, 320), |at| scene[at]);
    // The content moves up, so that each pixel sees what lies below it.
    let blurred = Array2::from_shape_fn((240, 320), |(row, column)| {
        (0..BLUR_PX).map(|below| scene[[row + below, column]]).sum::<f32>() / BLUR_PX as f32
    });
    let mut reference = Reference::new(&[still.view()], &Settings::default())?;
    let blur = reference.estimate(blurred.view())?;
    println!(
        "{:.3} +- {:.3} px along the axis at {:.3} +- {:.3} deg, {}",
        blur.length_px,
        blur.length_std_px.unwrap_or(f64::NAN),
        blur.angle.deg(),
        blur.angle_std_deg.unwrap_or(f64::NAN),
        blur.status.name()
    );
    if let Some(doubt) = blur.status.doubt() {
        println!("{doubt}");
    }
    if let Some(acceleration) = blur.acceleration {
        println!("acceleration ratio {:.3} +- {:.3}", acceleration.ratio, acceleration.ratio_std);
    }
    Ok(())
}
