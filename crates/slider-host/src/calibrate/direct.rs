//! Widths and accelerations: what is read directly.

use metrology::{Budget, Combined, Correlation, Coverage, Input, TypeA, student_t_quantile, type_b};

use super::instrument::{Instrument, Instruments, correction};
use super::readings::{Pairs, Widths};
use crate::Error;

/// Probability of the intervals beside those of the thesis.
pub(super) const PROBABILITY: f64 = 0.95;
/// Probability that readings without a misreading are suspected of one.
const FALSE_ALARM: f64 = 0.01;

/// The evaluation of one quantity that was read several times.
#[derive(Debug, Clone)]
pub struct Direct {
    /// What it is.
    pub label: String,
    /// Mean of the readings.
    pub mean: f64,
    /// Standard deviation of one reading.
    pub sample_std: f64,
    /// Type A, s / sqrt(N) (eq. 8.2).
    pub type_a: f64,
    /// Type B1, accuracy (eq. 8.3).
    pub type_b1: f64,
    /// Type B2, resolution (eq. 8.4).
    pub type_b2: f64,
    /// Combined (eq. 8.5).
    pub combined: f64,
    /// Expanded by the coverage factor of the instruments, 1.65 in the thesis (eq. 8.6).
    pub expanded: f64,
    /// Deviation from the standard in per cent (eq. 8.7), where there is one.
    pub class_percent: Option<f64>,
    /// The whole budget, expanded by Student's t of 95 % and the effective degrees of freedom.
    pub budget: Budget,
    /// What to look at again.
    pub suspicions: Vec<String>,
    pub(super) inputs: Vec<Input>,
}

impl Direct {
    /// A width of the sheet, mm (eq. 8.2 to 8.6).
    pub fn width(widths: &Widths, instruments: &Instruments) -> Result<Self, Error> {
        let label = widths.section.to_string();
        let mean = TypeA::of(&widths.readings_mm)?.mean();
        let corrections = instruments.caliper.corrections(mean, "mm")?;
        Self::new(label, "mm", &widths.readings_mm, corrections, None, instruments.coverage_k)
    }

    /// An acceleration, m/s^2, beside a standard instrument (eq. 8.2 to 8.7).
    pub fn acceleration(pairs: &Pairs, instruments: &Instruments) -> Result<Self, Error> {
        Self::compared(format!("{}°", pairs.setting), "m/s2", pairs, &instruments.accelerometer, instruments.coverage_k)
    }

    /// Readings beside those of a standard: B1 is their deviation, as if it were an accuracy class (eq. 8.7 in 8.3).
    pub(super) fn compared(
        label: String,
        unit: &str,
        pairs: &Pairs,
        instrument: &Instrument,
        coverage_k: f64,
    ) -> Result<Self, Error> {
        let (system, standard) = (TypeA::of(&pairs.system)?, TypeA::of(&pairs.standard)?);
        let class = type_b::accuracy_class_percent(system.mean(), standard.mean())?;
        let deviation = type_b::accuracy_class_std(class, system.mean())?;
        let corrections = [
            correction("deviation from standard (B1)", deviation, unit)?,
            correction("resolution (B2)", instrument.step_std()?, unit)?,
        ];
        Self::new(label, unit, &pairs.system, corrections, Some(class), coverage_k)
    }

    fn new(
        label: String,
        unit: &str,
        readings: &[f64],
        corrections: [Input; 2],
        class_percent: Option<f64>,
        coverage_k: f64,
    ) -> Result<Self, Error> {
        let repeated = TypeA::of(readings)?;
        let mut inputs = vec![Input::from_observations("mean of the readings (A)", readings)?.with_unit(unit)];
        inputs.extend(corrections);
        let combined = Combined::new(&inputs, &Correlation::independent(3), repeated.mean(), vec![1.0; 3])?;
        let std = |index: usize| inputs.get(index).map_or(0.0, Input::std);
        Ok(Self {
            mean: repeated.mean(),
            sample_std: repeated.sample_std(),
            type_a: std(0),
            type_b1: std(1),
            type_b2: std(2),
            combined: combined.std(),
            expanded: combined.expanded(coverage_k),
            class_percent,
            budget: Budget::new(&label, unit, &inputs, &combined, Coverage::Probability(PROBABILITY))?,
            suspicions: misreading(&label, unit, readings)?.into_iter().collect(),
            label,
            inputs,
        })
    }
}

/// The value of the standard instrument for the same passes: what the slider's reading is when corrected for its
/// deviation, with the scatter of the passes and the standard's resolution.
pub(super) fn standard(pairs: &Pairs, instrument: &Instrument, unit: &str) -> Result<Vec<Input>, Error> {
    let reading = TypeA::of(&pairs.standard)?.mean();
    let mut inputs = vec![Input::from_observations("mean of the standard (A)", &pairs.standard)?.with_unit(unit)];
    inputs.extend(instrument.corrections(reading, unit)?);
    Ok(inputs)
}

/// The reading farthest from the mean, if it is farther than the others explain (Grubbs, *Technometrics* 11 (1969) 1).
fn misreading(label: &str, unit: &str, readings: &[f64]) -> Result<Option<String>, Error> {
    let statistics = TypeA::of(readings)?;
    let n = readings.len();
    if n < 4 || statistics.sample_std() <= 0.0 {
        return Ok(None);
    }
    let distance = |reading: f64| (reading - statistics.mean()).abs() / statistics.sample_std();
    let farthest = readings.iter().copied().enumerate().max_by(|a, b| distance(a.1).total_cmp(&distance(b.1)));
    let Some((index, reading)) = farthest else { return Ok(None) };
    let count = n as f64;
    let t = student_t_quantile(1.0 - FALSE_ALARM / (2.0 * count), count - 2.0)?;
    let limit = (count - 1.0) / count.sqrt() * (t * t / (count - 2.0 + t * t)).sqrt();
    Ok((distance(reading) > limit).then(|| {
        format!(
            "{label}: reading {} ({reading} {unit}) is {:.1} standard deviations from the mean, more than {limit:.1}: \
             is it a misreading?",
            index + 1,
            distance(reading)
        )
    }))
}
