//! A camera loop: one meter, built once, for frame after frame.
//!
//! `cargo run -p blur-core --example camera_loop`
//!
//! The "camera" here passes a random scene at a steady speed; put your own frames where `frame` is called.

mod scene;

use blur_core::camera::Scale;
use blur_core::image::{Channels, PixelFormat, Pixels, SampleType};
use blur_core::meter::{Configuration, Geometry, Meter};
use blur_core::motion::Exposure;
use metrology::Measurement;
use ndarray::Array2;

const WIDTH: usize = 320;
const HEIGHT: usize = 240;
/// Pixels that the picture moves during the exposure, and from frame to frame.
const BLUR_PX: usize = 14;
const STEP_PX: usize = 28;
const FRAMES: usize = 5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut configuration = Configuration::default();
    // Start from the frame before, and let the displacement since tell left from right.
    (configuration.tracking, configuration.directed) = (true, true);
    configuration.exposure = Some(Exposure::new(Measurement::new(10e-3, 0.05e-3)?)?);
    configuration.geometry = Some(Geometry::Scale(Scale::new(Measurement::new(0.5e-3, 0.002e-3)?)?));
    let mut meter = Meter::new(configuration)?;

    let format = PixelFormat { sample: SampleType::U8, channels: Channels::Grey };
    let scene = scene::scene(HEIGHT, WIDTH + FRAMES * STEP_PX + BLUR_PX);
    for number in 0..FRAMES {
        let bytes = frame(&scene, number);
        let record = meter.measure(&Pixels::new(&bytes, WIDTH, HEIGHT, WIDTH, format)?)?;
        println!(
            "frame {number}: {:.2} px along {}, {:.3} m/s +- {:.3} (k = 2), {}{}",
            record.length_px,
            record.direction_deg.map_or_else(
                || format!("the axis at {:.2} deg", record.angle_deg),
                |direction| format!("{direction:.2} deg")
            ),
            record.speed_m_s.unwrap_or(f64::NAN),
            record.speed_expanded_m_s().unwrap_or(f64::NAN),
            record.status.name(),
            if record.tracked { ", tracked" } else { "" },
        );
    }
    Ok(())
}

/// What the camera sees: the scene, averaged over the pixels that pass during the exposure. The content moves to the right.
fn frame(scene: &Array2<f32>, number: usize) -> Vec<u8> {
    let pixel = |row: usize, column: usize| {
        let left = column + (FRAMES - number) * STEP_PX;
        let sum: f32 = (left..left + BLUR_PX).map(|column| scene[[row, column]]).sum();
        (sum / BLUR_PX as f32).round() as u8
    };
    (0..HEIGHT).flat_map(|row| (0..WIDTH).map(move |column| pixel(row, column))).collect()
}
