//! Measures a synthetic picture whose truth is known, with every method of the registry: `cargo run -p blur-sim
//! --example measure -- [ANGLE_DEG [LENGTH_PX]]`.

use std::error::Error;

use blur_core::estimate::{AngleEstimate, AxialAngle, LengthEstimate, Settings, registry};
use blur_sim::expose::expose;
use blur_sim::motion::Motion;
use blur_sim::scene::{DeadLeaves, dead_leaves};
use blur_sim::sensor::{Sensor, f32_from_u8};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let angle_deg: f64 = arguments.next().map_or(Ok(50.0), |text| text.parse())?;
    let length_px: f64 = arguments.next().map_or(Ok(31.7), |text| text.parse())?;

    let motion = Motion::uniform(length_px, AxialAngle::from_deg(angle_deg))?;
    let (rows, columns) = motion.extent_px();
    let scene = dead_leaves(7, 480 + rows, 640 + columns, &DeadLeaves::default())?;
    let exposure = expose(scene.view(), &motion)?;
    let picture = Sensor::ideal().with_psnr_db(32.0)?.record(exposure.view(), 7)?;
    let picture = f32_from_u8(picture.view());

    println!("truth{:17}  {:6.2} deg  {length_px:6.2} px", "", motion.angle().deg());
    let settings = Settings::default();
    for method in registry::ANGLE {
        let AngleEstimate { angle, status, .. } = method.build(&settings).estimate(picture.view())?;
        println!("{:22}  {:6.2} deg             {}", method.name, angle.deg(), status.name());
    }
    for method in registry::LENGTH {
        let LengthEstimate { length_px, status, .. } =
            method.build(&settings).estimate(picture.view(), motion.angle())?;
        println!("{:22}              {length_px:6.2} px  {}", method.name, status.name());
    }
    for method in registry::JOINT {
        let blur = method.build(&settings).estimate(picture.view())?;
        println!("{:22}  {:6.2} deg  {:6.2} px  {}", method.name, blur.angle.deg(), blur.length_px, blur.status.name());
    }
    Ok(())
}
