//! The sample picture that stands in when no input is given. It is part of the program, so it works anywhere.

/// The picture as PNG: 512x512 grey pixels made by blur-sim.
pub const PNG: &[u8] = include_bytes!("../sample.png");

/// What the sample is called in results.
pub const NAME: &str = "fixtures/sample.png";

/// Direction of its blur in degrees.
pub const ANGLE_DEG: f64 = 30.0;

/// Length of its blur in pixels.
pub const LENGTH_PX: f64 = 24.5;

/// What the sample is and what a measurement of it should find.
pub fn description() -> String {
    format!(
        "no input: running on the sample {NAME} made by blur-sim; its truth is {ANGLE_DEG} deg and {LENGTH_PX} px \
         (--help shows how to measure your own pictures)"
    )
}
