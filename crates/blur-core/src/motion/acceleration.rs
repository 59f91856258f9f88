//! Acceleration of a motion along its path.

use metrology::{Measurement, combined_std};

use super::{COVERAGE_K, Exposure};
use crate::camera::Scale;

/// A ratio of acceleration and the blur length that it belongs to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AcceleratedPath {
    /// `r = a T / (2 vbar)`, -1 to 1, with its standard uncertainty.
    pub ratio: Measurement,
    /// Blur length in pixels, at least 0, with its standard uncertainty.
    pub length_px: Measurement,
    /// Correlation coefficient of the two errors, -1 to 1.
    pub correlation: f64,
}

/// The acceleration during the exposure, in metres per second squared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathAcceleration {
    /// `a = 2 r vbar / T = 2 r k L / T^2`, of the sign of `r`.
    pub value_m_s2: f64,
    /// Combined standard uncertainty, first order.
    pub std_m_s2: f64,
}

impl PathAcceleration {
    /// Acceleration from a ratio, a length, a scale `k` and an exposure `T`; scale and exposure are independent of all
    /// others.
    pub fn from_blur(path: &AcceleratedPath, scale: Scale, exposure: Exposure) -> Self {
        let (k, t) = (scale.m_per_px(), exposure.seconds());
        let AcceleratedPath { ratio, length_px, correlation } = path;
        let per_ratio = 2.0 * k.value() * length_px.value() / (t.value() * t.value());
        let value_m_s2 = per_ratio * ratio.value();
        let by_length = 2.0 * k.value() / (t.value() * t.value()) * ratio.value() * length_px.std();
        // The two errors are one of the length, shared, and what is left of that of the ratio.
        let shared = by_length + correlation * per_ratio * ratio.std();
        let rest = (1.0 - correlation * correlation).max(0.0).sqrt() * per_ratio * ratio.std();
        let std_m_s2 = combined_std([
            (1.0, shared),
            (1.0, rest),
            (value_m_s2 / k.value(), k.std()),
            (-2.0 * value_m_s2 / t.value(), t.std()),
        ]);
        Self { value_m_s2, std_m_s2 }
    }

    /// Expanded uncertainty `U = k u` with [`COVERAGE_K`].
    pub fn expanded_m_s2(&self) -> f64 {
        COVERAGE_K * self.std_m_s2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(value: f64, std: f64) -> Measurement {
        Measurement::new(value, std).unwrap()
    }

    fn path(ratio: Measurement, length_px: Measurement, correlation: f64) -> PathAcceleration {
        let scale = Scale::new(measured(1.1e-3, 0.0)).unwrap();
        let exposure = Exposure::new(measured(0.1, 0.0)).unwrap();
        PathAcceleration::from_blur(&AcceleratedPath { ratio, length_px, correlation }, scale, exposure)
    }

    #[test]
    fn it_is_that_of_the_motion() {
        // From 0.5 m/s with 2.463 m/s2 for 0.1 s: 0.062315 m, a mean of 0.62315 m/s.
        let (v0, a, t, k) = (0.5, 2.463, 0.1, 1.1e-3);
        let way = v0 * t + 0.5 * a * t * t;
        let ratio = a * t / (2.0 * way / t);
        let found = path(measured(ratio, 0.0), measured(way / k, 0.0), 0.0);
        assert!((found.value_m_s2 - a).abs() < 1e-12);
        assert_eq!(found.std_m_s2, 0.0);
        let braking = path(measured(-ratio, 0.0), measured(way / k, 0.0), 0.0);
        assert!((braking.value_m_s2 + a).abs() < 1e-12);
    }

    #[test]
    fn relative_uncertainties_add_in_squares_and_that_of_time_twice() {
        let input = AcceleratedPath { ratio: measured(0.2, 0.002), length_px: measured(50.0, 1.0), correlation: 0.0 };
        let scale = Scale::new(measured(1e-3, 3e-5)).unwrap();
        let exposure = Exposure::new(measured(0.1, 0.002)).unwrap();
        let found = PathAcceleration::from_blur(&input, scale, exposure);
        let relative = (0.01_f64.powi(2) + 0.02_f64.powi(2) + 0.03_f64.powi(2) + 0.04_f64.powi(2)).sqrt();
        assert!((found.std_m_s2 / found.value_m_s2 - relative).abs() < 1e-12);
        assert!((found.expanded_m_s2() - 2.0 * found.std_m_s2).abs() < 1e-15);
    }

    #[test]
    fn errors_that_go_together_add_and_those_that_oppose_cancel() {
        let relative = |correlation| {
            let found = path(measured(0.2, 0.004), measured(50.0, 1.0), correlation);
            found.std_m_s2 / found.value_m_s2
        };
        assert!((relative(1.0) - 0.04).abs() < 1e-12);
        assert!(relative(-1.0).abs() < 1e-12);
        assert!((relative(0.5) - (2.0 * 0.02_f64.powi(2) * 1.5).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn without_acceleration_the_uncertainty_is_that_of_the_ratio() {
        let found = path(measured(0.0, 0.01), measured(50.0, 5.0), 0.3);
        assert_eq!(found.value_m_s2, 0.0);
        assert!((found.std_m_s2 - 2.0 * 1.1e-3 * 50.0 / 0.01 * 0.01).abs() < 1e-12);
    }
}
