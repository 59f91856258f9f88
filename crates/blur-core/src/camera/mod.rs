//! Camera geometry: from pixels on the sensor to metres in the scene.
//!
//! A [`Scale`] is known from a rule in the picture, from a [`Pinhole`], or from a calibrated camera: a [`Board`] is found in
//! pictures of it, [`calibrate`] makes [`Intrinsics`] of its corners, and these give the scale at any place of a picture
//! ([`Intrinsics::ideal_blur`]).

mod board;
mod calibration;
mod distortion;
mod intrinsics;
mod local;
mod pinhole;

pub use board::{Board, Pattern};
pub use calibration::{Calibration, Lens, Model, View, calibrate};
pub use intrinsics::{Intrinsics, PARAMETER_NAMES, PARAMETERS};
pub use local::{IdealBlur, LocalBlur};
pub use pinhole::{Pinhole, Scale};
