//! The same posters in front of the motor belt driven slider of chapter 5: constant speed, any direction.

use super::shot::check_poster;
use super::{POSTERS, Rig, Setting};
use crate::motion::Motion;
use crate::rng::Rng;
use crate::{Result, check};
use blur_core::estimate::AxialAngle;

/// Distance of the posters in metres (thesis section 5.3.8).
pub const DISTANCE_M: f64 = 1.21;

/// Metres on the poster for each pixel at [`DISTANCE_M`], from the calibration of the camera (thesis section 5.3.8).
pub const SCALE_M_PER_PX: f64 = 0.7789e-3;

/// Preset speeds V0 to V9 in m/s (thesis table 5.1).
pub const SPEEDS_M_S: [f64; 10] = [0.2243, 0.2871, 0.3454, 0.3935, 0.4303, 0.4674, 0.5109, 0.5329, 0.5444, 0.6021];

/// Stream of the passes, apart from those of the accelerated shots.
const STREAM: u64 = 0x0715_0001_0000_0000;

/// A picture taken at constant speed: the truth about it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pass {
    /// Number of the poster in [`POSTERS`].
    pub poster: usize,
    /// Number of the picture among those of its poster, from 0.
    pub index: usize,
    /// Speed in m/s.
    pub speed_m_s: f64,
    /// The blur: its length is `v T / k`.
    pub motion: Motion,
    /// What differs from picture to picture.
    pub setting: Setting,
}

impl Rig {
    /// The rig of chapter 5: posters at [`DISTANCE_M`], [`SCALE_M_PER_PX`], and the rest as by default.
    pub fn belt_driven() -> Self {
        Self { scale_m_per_px: SCALE_M_PER_PX, ..Self::default() }
    }

    /// The picture number `index` of a poster, taken at `speed_m_s` while the content moves along `angle`. Every number
    /// of a `seed` has a setting of its own, whatever the speed and the direction.
    ///
    /// # Errors
    /// [`Error::NoPoster`](crate::Error::NoPoster) when there is none of this number,
    /// [`Error::Parameter`](crate::Error::Parameter) for a negative speed or a value of the rig out of its range.
    pub fn pass(&self, poster: usize, index: usize, speed_m_s: f64, angle: AxialAngle, seed: u64) -> Result<Pass> {
        check_poster(poster)?;
        self.check()?;
        check::range("speed in m/s", speed_m_s, 0.0, 1e9, "0 to 1e9")?;
        let number = (index as u64).wrapping_mul(POSTERS.len() as u64).wrapping_add(poster as u64);
        let mut rng = Rng::new(seed, STREAM.wrapping_add(number));
        Ok(Pass {
            poster,
            index,
            speed_m_s,
            motion: Motion::uniform(speed_m_s * self.exposure_s / self.scale_m_per_px, angle)?,
            setting: self.setting(&mut rng),
        })
    }
}
