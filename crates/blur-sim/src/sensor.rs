//! From exposure to code values: shot noise, gain and tone curve, additive noise, rounding, clipping.

use crate::rng::Rng;
use crate::{Result, check};
use ndarray::{Array2, ArrayView2};

/// Greatest code value of eight bits, the peak of the PSNR.
pub const PEAK: f64 = 255.0;

/// Streams of the seed, apart from those of the scenes.
const SHOT_STREAM: u64 = 0x5e50_0001;
const ADDITIVE_STREAM: u64 = 0x5e50_0002;

/// The curve from linear light to code values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Tone {
    /// Code values are proportional to the light.
    #[default]
    Linear,
    /// Code values follow the sRGB curve.
    Srgb,
}

/// A camera's sensor and converter.
///
/// A picture passes, in this order: shot noise, gain, tone curve, additive white Gaussian noise, rounding, clipping to
/// `0..=255`. Each step but the last two can be left out; [`Sensor::ideal`] only rounds and clips.
///
/// ```
/// use blur_sim::sensor::Sensor;
/// # fn main() -> blur_sim::Result<()> {
/// let grey = ndarray::Array2::from_elem((4, 4), 100.0);
/// let picture = Sensor::ideal().with_psnr_db(30.0)?.record(grey.view(), 1)?;
/// assert_eq!(picture.dim(), (4, 4));
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensor {
    photons_at_peak: Option<f64>,
    gain: f64,
    tone: Tone,
    psnr_db: Option<f64>,
}

impl Default for Sensor {
    fn default() -> Self {
        Self::ideal()
    }
}

impl Sensor {
    /// No noise, gain 1, linear: only rounding and clipping.
    pub fn ideal() -> Self {
        Self { photons_at_peak: None, gain: 1.0, tone: Tone::Linear, psnr_db: None }
    }

    /// Adds shot noise: a pixel of value `x` counts a Poisson number of photons of mean `photons x / 255`.
    ///
    /// `photons` is the mean count at the value 255, from 1 to 1e9. Pixels below 0 count as dark.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) out of the range.
    pub fn with_photons_at_peak(self, photons: f64) -> Result<Self> {
        check::range("photons at full scale", photons, 1.0, 1e9, "1 to 1e9")?;
        Ok(Self { photons_at_peak: Some(photons), ..self })
    }

    /// Multiplies the light by `gain`, from 1e-6 to 1e6, before the tone curve.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) out of the range.
    pub fn with_gain(self, gain: f64) -> Result<Self> {
        check::range("gain", gain, 1e-6, 1e6, "1e-6 to 1e6")?;
        Ok(Self { gain, ..self })
    }

    /// Applies a tone curve.
    #[must_use]
    pub fn with_tone(self, tone: Tone) -> Self {
        Self { tone, ..self }
    }

    /// Adds white Gaussian noise of [`sigma_from_psnr_db`] code values, for -40 to 200 dB.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) out of the range.
    pub fn with_psnr_db(self, psnr_db: f64) -> Result<Self> {
        check::range("PSNR in dB", psnr_db, -40.0, 200.0, "-40 to 200")?;
        Ok(Self { psnr_db: Some(psnr_db), ..self })
    }

    /// The picture before rounding and clipping, in code values.
    ///
    /// `exposure` is light on the scale 0..255. The same seed gives the same noise; shot noise and additive noise come
    /// from separate streams of it, which the scenes of this crate do not use.
    ///
    /// # Errors
    /// [`Error::NotFinite`](crate::Error::NotFinite) for a pixel that is no number;
    /// [`Error::Parameter`](crate::Error::Parameter) for one so bright that its mean count exceeds 1e12.
    pub fn code_values(&self, exposure: ArrayView2<'_, f64>, seed: u64) -> Result<Array2<f64>> {
        check::finite(exposure)?;
        let mut shot = Rng::new(seed, SHOT_STREAM);
        let mut additive = Rng::new(seed, ADDITIVE_STREAM);
        let sigma = self.psnr_db.map(sigma_from_psnr_db);
        let mut picture = exposure.to_owned();
        for value in &mut picture {
            if let Some(photons) = self.photons_at_peak {
                let count = shot.poisson(photons * value.max(0.0) / PEAK)?;
                *value = count as f64 * PEAK / photons;
            }
            *value *= self.gain;
            if self.tone == Tone::Srgb {
                *value = PEAK * srgb_from_linear(*value / PEAK);
            }
            if let Some(sigma) = sigma {
                *value += sigma * additive.gaussian();
            }
        }
        Ok(picture)
    }

    /// The picture as the camera stores it: [`code_values`](Self::code_values) [`quantised`].
    ///
    /// # Errors
    /// Those of [`code_values`](Self::code_values).
    pub fn record(&self, exposure: ArrayView2<'_, f64>, seed: u64) -> Result<Array2<u8>> {
        Ok(quantised(self.code_values(exposure, seed)?.view()))
    }
}

/// Rounds code values to the nearest integer (halves away from 0) and clips them to `0..=255`. NaN gives 0.
pub fn quantised(code_values: ArrayView2<'_, f64>) -> Array2<u8> {
    code_values.mapv(|value| value.round().clamp(0.0, PEAK) as u8)
}

/// The stored picture as the estimators take it: `f32` code values 0..255.
pub fn f32_from_u8(picture: ArrayView2<'_, u8>) -> Array2<f32> {
    picture.mapv(f32::from)
}

/// Standard deviation in code values of the noise that gives a peak signal-to-noise ratio: `255 x 10^(-PSNR/20)`.
pub fn sigma_from_psnr_db(psnr_db: f64) -> f64 {
    PEAK * libm::pow(10.0, -psnr_db / 20.0)
}

/// Peak signal-to-noise ratio in dB of noise of this standard deviation in code values; infinite for 0.
pub fn psnr_db_from_sigma(sigma: f64) -> f64 {
    20.0 * libm::log10(PEAK / sigma)
}

/// The sRGB code, 0..1, of linear light, 0..1. Light below 0 stays on the linear piece of the curve.
///
/// *Reference*: IEC 61966-2-1:1999, 5.2.
pub fn srgb_from_linear(light: f64) -> f64 {
    if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * libm::pow(light, 1.0 / 2.4) - 0.055 }
}

/// Linear light, 0..1, of an sRGB code, 0..1: the inverse of [`srgb_from_linear`].
///
/// *Reference*: IEC 61966-2-1:1999, 5.2.
pub fn linear_from_srgb(code: f64) -> f64 {
    if code <= 0.040_45 { code / 12.92 } else { libm::pow((code + 0.055) / 1.055, 2.4) }
}
