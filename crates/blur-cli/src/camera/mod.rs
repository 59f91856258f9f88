//! Calibrated cameras: made from pictures of a board, kept in a file, used on blurred pictures.
//!
//! [`views`] (pictures or lists of points) → [`blur_core::camera::calibrate`] → [`report`] (for people) and [`mod@file`]
//! (`camera.json`); then [`seen`]: the blur of a picture as the camera saw it, with [`rough`] where only the EXIF data tell
//! a focal length.

pub mod file;
pub mod report;
pub mod rough;
pub mod seen;
pub mod views;
