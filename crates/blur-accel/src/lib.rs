//! Acceleration from one motion-blurred picture by learning, after chapter 6 of the thesis.
//!
//! The modules are the path of the data: the [`homomorphic`] PSF of a picture, its [`reduce`]d coordinates, one of the
//! nineteen [`regression`]s, together a [`pipeline`], which is [`validate`]d on pictures it has not seen and saved as a
//! [`model`].
//!
//! Matrices hold one observation a row. Accelerations are in m/s². Everything drawn is drawn with a seed.

mod error;
pub mod homomorphic;
pub mod model;
pub mod pipeline;
pub mod reduce;
pub mod regression;
pub mod validate;

use error::check_size;
pub use error::{Error, Result};
