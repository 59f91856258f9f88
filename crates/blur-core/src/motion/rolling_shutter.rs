//! Sensors whose rows are exposed one after the other.

use crate::camera::Scale;
use crate::estimate::AxialAngle;
use crate::motion::{COVERAGE_K, Exposure};
use crate::{Error, Result};

/// A rolling shutter that reads the rows from top to bottom at a steady rate.
///
/// # Model
///
/// Row `y` is exposed from `y t` to `y t + T`, with `t` the time from one row to the next and `T` the exposure. A point
/// that moves by `(vx, vy)` pixels per second (`vy` downwards) passes the rows `y0 + vy t'`, and is seen while the row it
/// is on is exposed: during `T / (1 - vy t)`. Its trace therefore has the direction of its motion, and the length
///
/// `L = v T / (1 - vy t)`, so that `v = L / (T + L q t)` with `q = vy / v`.
///
/// Content that moves along with the readout is exposed for longer and leaves a longer blur. One picture cannot tell a
/// motion from its opposite, so there are two speeds, that of a motion downwards and that of one upwards; they are equal
/// for a horizontal motion. Upwards, a point that meets the next row before the last has been read leaves a blur of
/// `L < v T`.
///
/// # Reference
///
/// C. Geyer, M. Meingast and S. Sastry, *Geometric models of rolling-shutter cameras*, OMNIVIS 2005, for the times of the
/// rows; the length follows as above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RollingShutter {
    row_s: f64,
}

/// The speed under a rolling shutter, if the content moved one way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RolledSpeed {
    /// Metres per second.
    pub value_m_s: f64,
    /// Its combined standard uncertainty; `None` when the length or the angle has none.
    pub std_m_s: Option<f64>,
}

impl RolledSpeed {
    /// The expanded uncertainty for the coverage factor [`COVERAGE_K`].
    pub fn expanded_m_s(&self) -> Option<f64> {
        self.std_m_s.map(|std| COVERAGE_K * std)
    }
}

/// A blur as the rolling shutter needs it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RolledBlur {
    /// Length in pixels.
    pub length_px: f64,
    /// Its standard uncertainty.
    pub length_std_px: Option<f64>,
    /// Axis of the motion.
    pub angle: AxialAngle,
    /// Its standard uncertainty in degrees.
    pub angle_std_deg: Option<f64>,
    /// Correlation of the two.
    pub correlation: f64,
}

impl RollingShutter {
    /// A sensor that takes `readout_s` seconds, at least 0, for its `rows` rows, at least 1.
    ///
    /// # Errors
    /// [`Error::Parameter`] out of these ranges.
    pub fn new(readout_s: f64, rows: usize) -> Result<Self> {
        if !(readout_s.is_finite() && readout_s >= 0.0) {
            return Err(Error::Parameter { name: "readout (s)", value: readout_s, expected: "a time of at least 0" });
        }
        if rows == 0 {
            return Err(Error::Parameter { name: "rows of the sensor", value: 0.0, expected: "at least 1" });
        }
        Ok(Self { row_s: readout_s / rows as f64 })
    }

    /// Time from one row to the next in seconds.
    pub fn row_s(self) -> f64 {
        self.row_s
    }

    /// The speed if the content moved down the picture, along with the readout.
    pub fn speed_downwards(self, blur: &RolledBlur, scale: Scale, exposure: Exposure) -> RolledSpeed {
        self.speed(blur, scale, exposure, 1.0)
    }

    /// The speed if the content moved up the picture, against the readout. Infinite when the time in which the rows of
    /// the blur are read is as long as the exposure: no speed upwards leaves such a blur.
    pub fn speed_upwards(self, blur: &RolledBlur, scale: Scale, exposure: Exposure) -> RolledSpeed {
        self.speed(blur, scale, exposure, -1.0)
    }

    fn speed(self, blur: &RolledBlur, scale: Scale, exposure: Exposure, sign: f64) -> RolledSpeed {
        let (sin, cos) = blur.angle.rad().sin_cos();
        let (length, seconds, k) = (blur.length_px, exposure.seconds(), scale.m_per_px());
        let during = seconds.value() + sign * length * sin.abs() * self.row_s;
        if during <= 0.0 {
            return RolledSpeed { value_m_s: f64::INFINITY, std_m_s: None };
        }
        let value_m_s = k.value() * length / during;
        let std_m_s = blur.length_std_px.zip(blur.angle_std_deg).map(|(length_std, angle_std_deg)| {
            // First order in length, angle, exposure and scale (GUM eq. 13).
            let by_length = k.value() * seconds.value() / (during * during) * length_std;
            let turn = sign * cos * length * self.row_s;
            let by_angle = -value_m_s * turn / during * angle_std_deg.to_radians();
            let by_exposure = value_m_s / during * seconds.std();
            let by_scale = length / during * k.std();
            let joint = by_length.powi(2) + by_angle.powi(2) + 2.0 * blur.correlation * by_length * by_angle;
            (joint + by_exposure.powi(2) + by_scale.powi(2)).sqrt()
        });
        RolledSpeed { value_m_s, std_m_s }
    }
}
