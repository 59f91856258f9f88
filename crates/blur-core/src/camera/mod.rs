//! Camera geometry: from pixels on the sensor to metres in the scene.

mod pinhole;

pub use pinhole::{Pinhole, Scale};
