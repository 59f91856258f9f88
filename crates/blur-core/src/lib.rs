//! One motion-blurred picture in; direction, blur length and speed out.
//!
//! ```
//! use blur_core::image::{Channels, PixelFormat, Pixels, SampleType};
//! use blur_core::meter::{Configuration, Meter};
//!
//! # let (width, height) = (96_usize, 64_usize);
//! # let bytes: Vec<u8> = (0..width * height).map(|i| (i * i / 7 % 251) as u8).collect();
//! // Built once, for pictures of any size; the first one of a size makes plans and buffers.
//! let mut meter = Meter::new(Configuration::default())?;
//! let format = PixelFormat { sample: SampleType::U8, channels: Channels::Grey };
//! let record = meter.measure(&Pixels::new(&bytes, width, height, width, format)?)?;
//! println!("{} px along {} deg: {}", record.length_px, record.angle_deg, record.status.name());
//! # Ok::<(), blur_core::Error>(())
//! ```
//!
//! [`Meter`](meter::Meter) turns the pixels of a picture into one flat [`Record`](record::Record), and every program and
//! binding of the project calls it. What it is made of can be used by itself. The modules are the path that the data takes:
//!
//! [`image`] (grey, window, crop, rotate) → [`spectrum`] (DCT, DFT, cepstrum) → [`projection`] (Radon, Hough) →
//! [`psf`] (uniform, accelerated, out of focus) → [`estimate`] (angle, length, joint: one file per method) → [`camera`]
//! (pinhole, calibration, scale) → [`motion`] (speed, acceleration). [`region`] measures blur that differs over the picture,
//! [`restore`] undoes it.
//!
//! Pure computation: no files, no threads, no printing, no panics. The same input gives the same bits on every run.
//!
//! The examples of the crate are a camera loop that reuses one meter (`camera_loop`), a picture against a sharp one of the
//! same scene (`reference_picture`), and a map of a picture of which one part moves (`map`).
//!
//! # Pixels
//!
//! Grey values come as `ndarray::ArrayView2<f32>` of rows x columns, row 0 at the top, on any linear scale (0..255,
//! 0..65535, 0..1), at least [`MIN_SIDE`](image::MIN_SIDE) each way; odd and prime sizes work. Stored samples of 8 or 16 bits
//! or floats, grey or in colour, at any spacing of rows, come as [`Pixels`](image::Pixels). Motion mixes *light*: samples
//! that follow the sRGB curve, as those of photographs do, should be linearised.
//!
//! # Angle
//!
//! Degrees, counter-clockwise from +x *as a person sees the picture* (y up), in `[0, 180)`.
//!
//! # Length
//!
//! The width in pixels of the uniform line PSF, a real number: as many pixels as the content moves during the exposure.
//!
//! # Units
//!
//! They stand in names: `angle_deg`, `length_px`, `exposure_s`, `speed_m_s`. Frequencies `u` (along columns) and `v` (along
//! rows, downwards) are in cycles per pixel. The frequency along the motion is `s = u cos(angle) - v sin(angle)`; the
//! transfer function of a uniform blur is `sinc(L s)`.
//!
//! # Uncertainty
//!
//! `std` is a standard uncertainty, one standard deviation; an expanded one is called so and has the coverage factor
//! [`COVERAGE_K`](motion::COVERAGE_K). A [`Status`](estimate::Status) other than `Ok` says why the numbers beside it are not
//! to be trusted.
//!
//! # Ambiguity
//!
//! A magnitude spectrum cannot tell a motion from its opposite, so [`AxialAngle`](estimate::AxialAngle) is an axis, and an
//! acceleration comes without its sign. A frame before ([`Heading`](estimate::Heading)) or a sharp picture of the same scene
//! ([`Reference`](estimate::joint::Reference)) resolves it: then `direction_deg` is there, in `[0, 360)`.
//!
//! # Features
//!
//! None is on by default; the crate alone pulls in some twenty small ones for arrays, transforms and linear algebra.
//! `serde` adds `Serialize` for [`Record`](record::Record).

pub mod camera;
mod each;
mod error;
pub mod estimate;
pub mod image;
pub mod meter;
pub mod motion;
mod products;
pub mod projection;
pub mod psf;
pub mod record;
pub mod region;
pub mod restore;
pub mod spectrum;

pub use error::{Error, Result};

/// The example in the README compiles.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
