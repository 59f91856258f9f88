//! Motion blur measured from C and C++.
//!
//! `include/motion_blur.h` is the interface: an opaque handle over [`blur_core::meter::Meter`], flat structures of numbers
//! for pictures, configurations and records, and codes for what can go wrong. Nothing is computed here; the same picture
//! gives the same record as in Rust, bit for bit.
//!
//! A call passes `border` (no panic leaves it), reads its structures through `versioned` (programs may be built with an
//! older or a newer header), and then does what its module says: `configuration` with `camera`, `picture`, `meter`, `record`.
//!
//! What panics is a defect: the call answers with a code, the place goes to standard error as for every Rust program, and
//! the handle refuses to go on.

mod border;
mod camera;
mod configuration;
mod error;
mod meter;
mod picture;
mod record;
mod versioned;

use std::ffi::{CStr, c_char};

pub use border::mb_error_message;
pub use camera::Camera;
pub use configuration::{Configuration, Geometry, Window, mb_configuration_default};
pub use error::{Code, Error, Result};
pub use meter::{
    Meter, mb_meter_free, mb_meter_measure, mb_meter_method, mb_meter_new, mb_meter_reason, mb_meter_reset,
};
pub use picture::{Channels, Picture, Sample};
pub use record::{Record, Status, mb_status_name};

/// The version of the library that runs, such as "0.1.0"; MB_VERSION is that of the header.
#[unsafe(no_mangle)]
pub extern "C" fn mb_version() -> *const c_char {
    const VERSION: &CStr = match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
        Ok(version) => version,
        Err(_) => c"",
    };
    VERSION.as_ptr()
}
