//! Pictures before their transform: grey values, regions, windows, rotation.

mod check;
mod crop;
mod grey;
mod pixels;
mod rotate;
mod window;

pub use check::{MIN_SIDE, check, check_pixels};
pub use crop::{Region, centre_square};
pub use grey::{bt601_luma, linear_from_srgb, srgb_from_linear};
pub use pixels::{Channels, Grey, PixelFormat, Pixels, SampleType};
pub use rotate::Rotation;
pub use window::{Taper, Window};
