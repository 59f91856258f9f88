//! A virtual rig: a camera on an inclined slider takes pictures of posters while it accelerates.
//!
//! It is the experiment of chapter 6 of the thesis, done in silico so that the truth is known. The modules are the path
//! of an experiment: [`poster`]s on the wall, a [`design`] that says which accelerations and starts are tried, the
//! [`shot`]s with their kinematics, and the [`studio`] that takes the pictures.
//!
//! # The motion
//!
//! The carriage is released at rest and has run the distance `d` on the incline when the first tooth of its encoder opens
//! the shutter. With the acceleration `a`, the exposure `T` and the scale `k` in metres per pixel
//!
//! - `v0 = sqrt(2 a d)` is its speed when the shutter opens,
//! - `L = (v0 T + a T^2 / 2) / k` the length of the blur in pixels,
//! - `r = a T^2 / (2 k L)` the acceleration ratio of [`Motion`], from 0 (constant speed) to 1 (from rest), so that
//!   `a = 2 r k L / T^2`.
//!
//! The content of the picture moves along +x (direction 0 degrees), and its path *begins* where the still backgrounds
//! show it: the shutter opens at the tooth. At the time `t` it is displaced by `(v0 t + a t^2 / 2) / k`. No picture is
//! aligned with another to better than a fraction of a pixel: every one, still or not, is displaced by a random amount.
//!
//! # The light
//!
//! The blurred light passes, in this order: vignetting `V = 1 - kappa rho^2` (`rho` is the distance from the centre of
//! the picture, 1 at its corners), gain, additive white noise, rounding to eight bits, clipping. Gain and `kappa` change
//! from picture to picture.
//!
//! ```
//! use blur_sim::rig::{Design, Rig, Studio};
//! # fn main() -> blur_sim::Result<()> {
//! let rig = Rig { side_px: 64, ..Rig::default() };
//! let shots = rig.shots(Design::FixedRelease, 1)?;
//! assert_eq!(shots.len(), 125);
//! let mut studio = Studio::new(&rig)?;
//! let blurred = studio.picture(&shots[0])?;
//! let background = studio.background(&rig.still(shots[0].poster, 0, 1)?)?;
//! assert_eq!(blurred.dim(), background.dim());
//! # Ok(())
//! # }
//! ```
//!
//! [`belt`] is the experiment of chapter 5, at constant speed along any direction, with the same posters and light.
//!
//! [`Motion`]: crate::motion::Motion
//!
//! *Reference*: J. A. Cortes-Osorio, *A Contribution to the Estimation of Kinematic Quantities from Linear Motion Blurred
//! Images*, thesis, sections 6.1.1, 6.3.2, 6.3.4 and table 6.1.

pub mod belt;
pub mod design;
pub mod poster;
pub mod shot;
pub mod studio;

pub use belt::Pass;
pub use design::Design;
pub use poster::{POSTERS, Poster};
pub use shot::{Setting, Shot, Still};
pub use studio::Studio;

/// Shots of every poster at every acceleration.
pub const SHOTS: usize = 5;

/// Still backgrounds of every poster.
pub const STILLS: usize = 5;

/// Distance of the posters in metres.
pub const DISTANCE_M: f64 = 1.71;

/// Metres on the poster for each pixel at [`DISTANCE_M`]: 0.7789 mm at 1.21 m, which the calibration of the camera gave,
/// grow with the distance (1.1008 mm).
pub const SCALE_M_PER_PX: f64 = 0.7789e-3 * DISTANCE_M / 1.21;

/// One slope of the slider.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Preset {
    /// Acceleration of the carriage in m/s².
    pub accel_m_s2: f64,
    /// Its expanded uncertainty in m/s², coverage factor 2.
    pub expanded_m_s2: f64,
}

impl Preset {
    /// The five slopes, steepest first: 15, 13.3, 10.1, 7.9 and 4.5 degrees.
    ///
    /// *Reference*: the thesis, accelerations to three decimals as in chapter 8, uncertainties of table 6.1.
    pub const THESIS: [Self; 5] = [
        Self { accel_m_s2: 2.463, expanded_m_s2: 0.0285 },
        Self { accel_m_s2: 2.178, expanded_m_s2: 0.0233 },
        Self { accel_m_s2: 1.541, expanded_m_s2: 0.0161 },
        Self { accel_m_s2: 1.229, expanded_m_s2: 0.0130 },
        Self { accel_m_s2: 0.644, expanded_m_s2: 0.0074 },
    ];
}

/// The rig: everything that stays the same during an experiment.
#[derive(Debug, Clone, PartialEq)]
pub struct Rig {
    /// The slopes that are tried. Every shot's true acceleration is drawn from a Gaussian about its preset, with half the
    /// expanded uncertainty as standard deviation.
    pub presets: Vec<Preset>,
    /// Exposure in seconds, above 0.
    pub exposure_s: f64,
    /// Metres on the poster for each pixel, above 0.
    pub scale_m_per_px: f64,
    /// Rows and columns of the pictures.
    pub side_px: usize,
    /// Peak signal-to-noise ratio of the additive noise in dB; `None` leaves only the rounding.
    pub psnr_db: Option<f64>,
    /// The gain of a picture is uniform within this of 1, from 0 to below 1.
    pub gain_half_width: f64,
    /// Mean of the vignetting `kappa` of the pictures, 0 to 1.
    pub kappa: f64,
    /// The `kappa` of a picture is uniform within this of its mean, by which it stays between 0 and 1.
    pub kappa_half_width: f64,
    /// The displacement of a picture is uniform within this of 0 along its rows and along its columns, in pixels.
    pub misalignment_px: f64,
}

impl Default for Rig {
    /// That of the thesis: 100 ms, 512x512 pixels, [`Preset::THESIS`], [`SCALE_M_PER_PX`]; noise of 40 dB, gain within 5 %,
    /// `kappa` 0.08 to 0.12, half a pixel of misalignment.
    fn default() -> Self {
        Self {
            presets: Preset::THESIS.to_vec(),
            exposure_s: 0.1,
            scale_m_per_px: SCALE_M_PER_PX,
            side_px: 512,
            psnr_db: Some(40.0),
            gain_half_width: 0.05,
            kappa: 0.10,
            kappa_half_width: 0.02,
            misalignment_px: 0.5,
        }
    }
}
