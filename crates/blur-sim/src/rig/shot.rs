//! One picture of the rig: what is true of it, before it is taken.

use super::{POSTERS, Preset, Rig};
use crate::motion::Motion;
use crate::rng::Rng;
use crate::{Error, Result, check};
use blur_core::estimate::AxialAngle;

/// Streams of the seed: the shots and the stills from here on, one each.
const SHOT_STREAM: u64 = 0x0716_0001_0000_0000;
const STILL_STREAM: u64 = 0x0716_0002_0000_0000;

/// What differs from picture to picture, whatever moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// Displacement to the right of the picture's content when the shutter opens, in pixels.
    pub right_px: f64,
    /// Displacement downwards of the picture's content when the shutter opens, in pixels.
    pub down_px: f64,
    /// Gain of the sensor.
    pub gain: f64,
    /// Vignetting: the share of the light that the corners lose.
    pub kappa: f64,
    /// Seed of the noise.
    pub noise_seed: u64,
}

/// A still background.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Still {
    /// Number of the poster in [`POSTERS`].
    pub poster: usize,
    /// Number of the still among those of its poster, from 0.
    pub index: usize,
    /// What differs from picture to picture.
    pub setting: Setting,
}

/// A blurred picture: the truth about it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shot {
    /// Number of the poster in [`POSTERS`].
    pub poster: usize,
    /// Number of the preset acceleration in [`Rig::presets`].
    pub preset: usize,
    /// Number of the shot among those of its poster and preset, from 0.
    pub index: usize,
    /// Preset acceleration in m/s².
    pub preset_accel_m_s2: f64,
    /// True acceleration in m/s².
    pub accel_m_s2: f64,
    /// Distance in metres from the release of the carriage to where the shutter opens.
    pub release_m: f64,
    /// Speed in m/s when the shutter opens.
    pub v0_m_s: f64,
    /// Mean speed in m/s during the exposure.
    pub speed_m_s: f64,
    /// Length of the blur in pixels.
    pub length_px: f64,
    /// Acceleration ratio `r` of the [`Motion`], from 0 to 1.
    pub accel_ratio: f64,
    /// What differs from picture to picture.
    pub setting: Setting,
}

impl Shot {
    /// The motion of the picture's content, along +x.
    ///
    /// # Errors
    /// None for a shot that comes from [`Rig::shots`]; those of [`Motion::new`] otherwise.
    pub fn motion(&self) -> Result<Motion> {
        Motion::new(self.length_px, AxialAngle::from_deg(0.0), self.accel_ratio)
    }
}

/// How long the blur of a shot is.
#[derive(Debug, Clone, Copy)]
pub(super) enum Start {
    /// It follows from the distance in metres over which the carriage has accelerated.
    Release(f64),
    /// It is this number of pixels, from which that distance follows.
    Length(f64),
}

impl Rig {
    /// The still number `index` (from 0, as many as are wanted) of a poster. Every still of a `seed` has a setting of its
    /// own.
    ///
    /// # Errors
    /// [`Error::NoPoster`] when there is none of this number, [`Error::Parameter`] when the rig's own values are out of
    /// their ranges.
    pub fn still(&self, poster: usize, index: usize, seed: u64) -> Result<Still> {
        check_poster(poster)?;
        self.check()?;
        let number = (index as u64).wrapping_mul(POSTERS.len() as u64).wrapping_add(poster as u64);
        let mut rng = Rng::new(seed, STILL_STREAM.wrapping_add(number));
        Ok(Still { poster, index, setting: self.setting(&mut rng) })
    }

    /// One shot. Its true acceleration and its setting depend on the seed and the three numbers only, not on `start`.
    pub(super) fn shot(&self, poster: usize, preset: usize, index: usize, start: Start, seed: u64) -> Result<Shot> {
        check_poster(poster)?;
        let Preset { accel_m_s2: preset_accel_m_s2, expanded_m_s2 } = self.presets[preset];
        let number = (index * self.presets.len() + preset) * POSTERS.len() + poster;
        let mut rng = Rng::new(seed, SHOT_STREAM + number as u64);
        let accel = preset_accel_m_s2 + 0.5 * expanded_m_s2 * rng.gaussian();
        check::range("true acceleration in m/s2", accel, f64::MIN_POSITIVE, f64::MAX, "above 0")?;
        let (exposure, scale) = (self.exposure_s, self.scale_m_per_px);
        let (release_m, v0_m_s, length_px) = match start {
            Start::Release(release) => {
                let v0 = (2.0 * accel * release).sqrt();
                (release, v0, (v0 * exposure + 0.5 * accel * exposure * exposure) / scale)
            }
            Start::Length(length) => {
                let v0 = length * scale / exposure - 0.5 * accel * exposure;
                check::range("speed in m/s when the shutter opens", v0, 0.0, f64::MAX, "0 or more: a longer blur")?;
                (0.5 * v0 * v0 / accel, v0, length)
            }
        };
        let speed_m_s = length_px * scale / exposure;
        Ok(Shot {
            poster,
            preset,
            index,
            preset_accel_m_s2,
            accel_m_s2: accel,
            release_m,
            v0_m_s,
            speed_m_s,
            length_px,
            accel_ratio: 0.5 * accel * exposure / speed_m_s,
            setting: self.setting(&mut rng),
        })
    }

    pub(super) fn setting(&self, rng: &mut Rng) -> Setting {
        let mut within = |mean: f64, half_width: f64| rng.uniform_in(mean - half_width, mean + half_width);
        Setting {
            right_px: within(0.0, self.misalignment_px),
            down_px: within(0.0, self.misalignment_px),
            gain: within(1.0, self.gain_half_width),
            kappa: within(self.kappa, self.kappa_half_width),
            noise_seed: rng.bits(),
        }
    }

    /// Every value is in its range.
    pub(super) fn check(&self) -> Result<()> {
        for preset in &self.presets {
            check::range("preset acceleration in m/s2", preset.accel_m_s2, 1e-9, 1e9, "1e-9 to 1e9")?;
            check::range("its expanded uncertainty in m/s2", preset.expanded_m_s2, 0.0, 1e9, "0 to 1e9")?;
        }
        check::range("exposure in s", self.exposure_s, 1e-9, 1e9, "1e-9 to 1e9")?;
        check::range("scale in m/px", self.scale_m_per_px, 1e-12, 1e9, "1e-12 to 1e9")?;
        check::range("half width of the gain", self.gain_half_width, 0.0, 0.99, "0 to 0.99")?;
        check::range("mean of the vignetting kappa", self.kappa, 0.0, 1.0, "0 to 1")?;
        let widest = self.kappa.min(1.0 - self.kappa);
        let expected = "0 or more, and kappa from 0 to 1 all over it";
        check::range("half width of the vignetting kappa", self.kappa_half_width, 0.0, widest, expected)?;
        check::range("misalignment in px", self.misalignment_px, 0.0, 1e3, "0 to 1000")?;
        Ok(())
    }
}

/// There is a poster of this number.
pub(super) fn check_poster(poster: usize) -> Result<()> {
    let last = POSTERS.len() - 1;
    if poster <= last { Ok(()) } else { Err(Error::NoPoster { poster, last }) }
}
