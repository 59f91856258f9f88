//! What the instruments promise.

use metrology::{Distribution, Input, type_b};
use serde::{Deserialize, Serialize};

use crate::Error;

/// One instrument, in the unit that it shows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Instrument {
    /// Its name.
    pub name: String,
    /// Width of one step of its display; type B2 (eq. 8.4).
    pub resolution: f64,
    /// Largest error, either way, that its maker promises; type B1 as `accuracy / sqrt(3)` (GUM 4.3.7).
    #[serde(default)]
    pub accuracy: f64,
    /// Accuracy class in per cent of the reading; type B1 as the thesis has it, `class * reading / (2 sqrt(3))` (eq. 8.3).
    #[serde(default)]
    pub class_percent: f64,
}

/// The instruments of a calibration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Instruments {
    /// Coverage factor of the expanded uncertainties (eq. 8.6).
    pub coverage_k: f64,
    /// What measures widths, mm.
    pub caliper: Instrument,
    /// The slider's clock, s.
    pub timer: Instrument,
    /// The standard that it is compared with, s.
    pub photogate: Instrument,
    /// The slider as a meter of acceleration, m/s^2.
    pub accelerometer: Instrument,
    /// The standard that it is compared with, m/s^2.
    pub acceleration_standard: Instrument,
}

impl Instrument {
    fn new(name: &str, resolution: f64, accuracy: f64) -> Self {
        Self { name: name.to_owned(), resolution, accuracy, class_percent: 0.0 }
    }

    /// B1 and B2 of a reading, as corrections of value 0.
    pub(super) fn corrections(&self, reading: f64, unit: &str) -> Result<[Input; 2], Error> {
        let class = type_b::accuracy_class_std(self.class_percent, reading)?;
        let accuracy = type_b::rectangular_std(self.accuracy)?.hypot(class);
        Ok([correction("accuracy (B1)", accuracy, unit)?, correction("resolution (B2)", self.step_std()?, unit)?])
    }

    /// B2 (eq. 8.4).
    pub(super) fn step_std(&self) -> Result<f64, Error> {
        Ok(type_b::resolution_std(self.resolution)?)
    }

    fn check(&self, table: &str) -> Result<(), Error> {
        let fields =
            [("resolution", self.resolution), ("accuracy", self.accuracy), ("class_percent", self.class_percent)];
        for (field, value) in fields {
            if !(value.is_finite() && (0.0..1e6).contains(&value)) {
                return Err(Error::Instruments(format!("[{table}] {field} {value} must be 0 or more")));
            }
        }
        Ok(())
    }
}

/// A correction of value 0 and rectangular distribution.
pub(super) fn correction(label: &str, std: f64, unit: &str) -> Result<Input, Error> {
    Ok(Input::new(label, 0.0, std)?.with_unit(unit).with_distribution(Distribution::Rectangular)?)
}

/// Those of the thesis. It gives the names, the resolution of the timer (1 us) and that of no other; nor does it give
/// the caliper's accuracy. Assumed are what such instruments usually promise: 0.01 mm and ±0.03 mm for the caliper,
/// 0.1 ms for the photogate, 0.001 m/s^2 for both accelerations.
impl Default for Instruments {
    fn default() -> Self {
        Self {
            coverage_k: metrology::coverage::RECTANGULAR_K,
            caliper: Instrument::new("RM813 Ubermann", 0.01, 0.03),
            timer: Instrument::new("slider", 1e-6, 0.0),
            photogate: Instrument::new("PASCO ME-9215B", 1e-4, 0.0),
            accelerometer: Instrument::new("slider", 1e-3, 0.0),
            acceleration_standard: Instrument::new("PHYWE Cobra4 Acceleration", 1e-3, 0.0),
        }
    }
}

impl Instruments {
    /// Reads a description in TOML: `coverage_k` and the tables `caliper`, `timer`, `photogate`, `accelerometer` and
    /// `acceleration_standard`; what is left out is as in [`Instruments::default`].
    pub fn from_toml(text: &str) -> Result<Self, Error> {
        // Its messages have line and column.
        let found: Self = toml::from_str(text).map_err(|error| Error::Instruments(error.to_string()))?;
        if !(found.coverage_k.is_finite() && found.coverage_k > 0.0) {
            return Err(Error::Instruments(format!("coverage_k {} must be above 0", found.coverage_k)));
        }
        found.caliper.check("caliper")?;
        found.timer.check("timer")?;
        found.photogate.check("photogate")?;
        found.accelerometer.check("accelerometer")?;
        found.acceleration_standard.check("acceleration_standard")?;
        Ok(found)
    }
}
