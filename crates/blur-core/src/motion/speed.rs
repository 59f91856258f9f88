//! Speed of a uniform motion.

use metrology::{Measurement, combined_std};

use crate::camera::Scale;
use crate::{Error, Result};

/// Coverage factor of the expanded uncertainty: about 95 % for a normal distribution (GUM 6.3.3).
pub const COVERAGE_K: f64 = 2.0;

/// The exposure time `T` of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exposure(Measurement);

impl Exposure {
    /// An exposure in seconds with its standard uncertainty; it must be positive.
    pub fn new(seconds: Measurement) -> Result<Self> {
        if seconds.value() > 0.0 {
            Ok(Self(seconds))
        } else {
            Err(Error::Parameter { name: "exposure (s)", value: seconds.value(), expected: "greater than 0" })
        }
    }

    /// Seconds.
    pub fn seconds(self) -> Measurement {
        self.0
    }
}

/// The mean speed during the exposure, in metres per second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Speed {
    /// `v = k L / T` (thesis eq. 5.7).
    pub value_m_s: f64,
    /// Combined standard uncertainty, first order in independent inputs; `None` when the length has none, since the
    /// uncertainty of the other inputs alone would promise too much.
    pub std_m_s: Option<f64>,
}

impl Speed {
    /// Speed from a blur length in pixels, with its standard uncertainty if known, a scale and an exposure.
    ///
    /// `u(v)^2 = (k u(L) / T)^2 + (L u(k) / T)^2 + (k L u(T) / T^2)^2`
    pub fn from_blur(length_px: f64, length_std_px: Option<f64>, scale: Scale, exposure: Exposure) -> Self {
        let (k, t) = (scale.m_per_px(), exposure.seconds());
        let value_m_s = k.value() * length_px / t.value();
        let std_m_s = length_std_px.map(|std_px| {
            combined_std([
                (k.value() / t.value(), std_px),
                (length_px / t.value(), k.std()),
                (-value_m_s / t.value(), t.std()),
            ])
        });
        Self { value_m_s, std_m_s }
    }

    /// Expanded uncertainty `U = k u` with [`COVERAGE_K`].
    pub fn expanded_m_s(&self) -> Option<f64> {
        self.std_m_s.map(|std| COVERAGE_K * std)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(value: f64, std: f64) -> Measurement {
        Measurement::new(value, std).unwrap()
    }

    #[test]
    fn speed_of_the_thesis_rig() {
        // k = 0.7789 mm/px and T = 100 ms: 55 px are 0.4284 m/s.
        let scale = Scale::new(measured(0.7789e-3, 0.0)).unwrap();
        let exposure = Exposure::new(measured(0.1, 0.0)).unwrap();
        let v = Speed::from_blur(55.0, Some(0.5), scale, exposure);
        assert!((v.value_m_s - 0.428_395).abs() < 1e-12);
        assert!((v.std_m_s.unwrap() - 0.5 * 0.7789e-2).abs() < 1e-15);
        assert!((v.expanded_m_s().unwrap() - 0.7789e-2).abs() < 1e-15);
    }

    #[test]
    fn relative_uncertainties_of_a_product_add_in_squares() {
        let scale = Scale::new(measured(2e-3, 2e-5)).unwrap();
        let exposure = Exposure::new(measured(0.05, 1e-3)).unwrap();
        let v = Speed::from_blur(40.0, Some(1.2), scale, exposure);
        let relative = (0.01_f64.powi(2) + 0.02_f64.powi(2) + 0.03_f64.powi(2)).sqrt();
        assert!((v.std_m_s.unwrap() / v.value_m_s - relative).abs() < 1e-12);
    }

    #[test]
    fn without_an_uncertain_length_there_is_no_uncertain_speed() {
        let scale = Scale::new(measured(2e-3, 2e-5)).unwrap();
        let exposure = Exposure::new(measured(0.05, 1e-3)).unwrap();
        assert_eq!(Speed::from_blur(40.0, None, scale, exposure).std_m_s, None);
        assert!(Exposure::new(measured(0.0, 0.0)).is_err());
    }
}
