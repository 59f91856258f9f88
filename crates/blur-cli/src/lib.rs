//! The command-line tools as a library: from files on a disk to printed measurements.
//!
//! The modules are the path that the data takes:
//!
//! [`input`] (files, folders, patterns) → [`picture`] (decode, luma, orientation, EXIF) → [`measure`]
//! (options, estimator, record; with [`method`], [`metric`], [`mod@camera`] and [`map`]) → [`restore`] (the picture without
//! its blur) → [`pipeline`] (many pictures on several threads, results in order) → [`record`] (JSON), [`text`] (for
//! people) and [`report`] (a page with figures). [`units`] reads quantities such as `1/250s` and `0.7789mm/px`.
//! [`bag`] measures the pictures of a ROS 2 bag one after the other.
//! [`reproduce`] judges the methods on pictures of known truth, and [`accel`] learns from them.
//!
//! Nothing here prints or ends the process; only the programs in `src/bin` do.

pub mod accel;
pub mod bag;
pub mod camera;
mod error;
pub mod input;
pub mod map;
mod masked;
pub mod measure;
pub mod method;
pub mod metric;
pub mod pipeline;
pub mod record;
pub mod report;
pub mod reproduce;
pub mod restore;
pub mod sample;
pub mod stills;
pub mod text;
pub mod units;

pub use blur_picture as picture;
pub use error::{Error, Result};

/// The example in the README compiles and runs.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
