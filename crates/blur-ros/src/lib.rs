//! Motion blur in the pictures of ROS 2, without an installation of it.
//!
//! The modules are the path that the data takes:
//!
//! [`bag`] (MCAP files) gives messages in [`cdr`], which [`msg`] reads; [`frame`] takes their pictures without copying and
//! [`camera`] their calibration; [`observer`] measures one after the other, minding how they follow each other ([`sequence`]);
//! a record becomes a velocity ([`twist`](mod@twist)) and diagnostics ([`diagnostics`](mod@diagnostics)), which go into a
//! bag again.
//!
//! With the feature `node`, the module `node` does the same with the live pictures of a topic over Zenoh.
//!
//! The record of a frame is that of [`blur_core::meter`]: the same pixels in a PNG file give the same bits.

pub mod bag;
pub mod camera;
pub mod cdr;
pub mod diagnostics;
mod error;
pub mod frame;
pub mod msg;
#[cfg(feature = "node")]
pub mod node;
pub mod observer;
pub mod sequence;
pub mod twist;

pub use error::{Error, Result};
