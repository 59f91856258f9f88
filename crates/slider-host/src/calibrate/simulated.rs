//! Readings as the thesis's instruments would have given them.
//!
//! The thesis prints means and expanded uncertainties but no readings. What its budgets were made of must be inferred:
//!
//! - *Widths.* All but one of the uncertainties lie within 0.035 and 0.038 mm, for teeth of 3.1 mm as for slits of
//!   4.9 mm, so the accuracy of the caliper was not taken relative to the reading, as eq. 8.3 has it. With limits of
//!   ±0.03 mm, usual for such calipers, what is missing is scatter of 0.05 to 0.07 mm of one reading; that is drawn.
//! - *Tooth 5* has 0.107 mm. One reading of twenty that is wrong by 1.23 mm gives just this, and moves the mean by
//!   0.061 mm to the printed 3.164 mm, from 3.103 mm, which is like the other teeth. So one reading is drawn misread;
//!   that it happened is a guess.
//! - *Times.* The uncertainty of the width is too small to matter; that of the time must be 2.8 to 4.2 %. Scatter of the
//!   passes would have to be 13 to 19 % for that, too much for a regulated motor, so most must be the deviation from
//!   the standard, 10 to 15 % (eq. 8.7). Drawn are 2 % scatter, a guess, and a deviation that gives the rest. Its sign is
//!   not known; the slider is taken to read too long.
//! - *Accelerations.* Scatter and deviation cannot be told apart; each is given half of the variance.

use metrology::normal_quantile;
use metrology::type_b::{rectangular_std, resolution_std};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};

use super::figures::{ACCELERATIONS_M_S2, CALIBRATION_TOOTH_MM, READINGS, SPEEDS_M_S, WIDTHS_MM};
use super::instrument::Instruments;
use super::readings::{Pairs, Section, Widths};
use crate::Error;

/// Relative scatter of the time of passage.
const TIME_SCATTER: f64 = 0.02;
/// The uncertainty beyond which one reading is taken for misread, mm.
const MISREAD_FROM_MM: f64 = 0.1;
/// Expanded uncertainty of the other teeth, mm.
const USUAL_EXPANDED_MM: f64 = 0.035;

/// Readings of a whole calibration.
#[derive(Debug, Clone, PartialEq)]
pub struct Readings {
    /// Caliper readings.
    pub widths: Vec<Widths>,
    /// Times of passage, s.
    pub times: Vec<Pairs>,
    /// Accelerations, m/s^2.
    pub accelerations: Vec<Pairs>,
}

/// A calibration with the thesis's results and `instruments`, drawn from `seed`.
pub fn readings(seed: u64, instruments: &Instruments) -> Result<Readings, Error> {
    Ok(Readings {
        widths: widths(&mut Draw::new(seed, 1), instruments)?,
        times: times(&mut Draw::new(seed, 2), instruments)?,
        accelerations: accelerations(&mut Draw::new(seed, 3), instruments)?,
    })
}

fn widths(draw: &mut Draw, instruments: &Instruments) -> Result<Vec<Widths>, Error> {
    let caliper = &instruments.caliper;
    let type_b = rectangular_std(caliper.accuracy)?.hypot(resolution_std(caliper.resolution)?);
    let count = READINGS as f64;
    // What the uncertainty of the mean leaves for it.
    let type_a = |expanded: f64| rest(expanded / instruments.coverage_k, type_b);
    let mut all = Vec::new();
    let calibration = (Section::Calibration, CALIBRATION_TOOTH_MM, USUAL_EXPANDED_MM);
    for (section, mean, expanded) in WIDTHS_MM.into_iter().chain([calibration]) {
        let is_misread = expanded > MISREAD_FROM_MM;
        let usual = type_a(if is_misread { USUAL_EXPANDED_MM } else { expanded });
        // One reading off by d gives the mean of n the standard uncertainty d / n, and moves it by as much.
        let shift = if is_misread { rest(type_a(expanded), usual) } else { 0.0 };
        let mut readings_mm = Vec::with_capacity(READINGS);
        for index in 0..READINGS {
            let wrong = if is_misread && index == READINGS / 2 { shift * count } else { 0.0 };
            let reading = mean - shift + wrong + usual * count.sqrt() * draw.normal()?;
            readings_mm.push(shown(reading, caliper.resolution));
        }
        all.push(Widths { section, readings_mm });
    }
    Ok(all)
}

fn times(draw: &mut Draw, instruments: &Instruments) -> Result<Vec<Pairs>, Error> {
    let width = USUAL_EXPANDED_MM / instruments.coverage_k / CALIBRATION_TOOTH_MM;
    let type_a = TIME_SCATTER / (READINGS as f64).sqrt();
    let mut all = Vec::new();
    for (setting, speed, expanded) in SPEEDS_M_S {
        let deviation = rest(rest(expanded / instruments.coverage_k / speed, width), type_a);
        let time = CALIBRATION_TOOTH_MM / 1e3 / speed;
        let resolutions = [instruments.timer.resolution, instruments.photogate.resolution];
        all.push(pairs(draw, setting, time, TIME_SCATTER, deviation, resolutions)?);
    }
    Ok(all)
}

fn accelerations(draw: &mut Draw, instruments: &Instruments) -> Result<Vec<Pairs>, Error> {
    let resolutions = [instruments.accelerometer.resolution, instruments.acceleration_standard.resolution];
    let mut all = Vec::new();
    for (angle_deg, acceleration, expanded) in ACCELERATIONS_M_S2 {
        let both = rest(expanded / instruments.coverage_k, resolution_std(resolutions[0])?) / acceleration;
        let each = both / 2.0_f64.sqrt();
        let scatter = each * (READINGS as f64).sqrt();
        all.push(pairs(draw, angle_deg, acceleration, scatter, each, resolutions)?);
    }
    Ok(all)
}

/// Passes with a relative scatter, read by the slider as they are and by the standard so that eq. 8.7 in 8.3 gives the
/// relative standard uncertainty `deviation`.
fn pairs(
    draw: &mut Draw,
    setting: f64,
    mean: f64,
    scatter: f64,
    deviation: f64,
    resolutions: [f64; 2],
) -> Result<Pairs, Error> {
    let class = deviation * 2.0 * 3.0_f64.sqrt();
    let (mut system, mut standard) = (Vec::with_capacity(READINGS), Vec::with_capacity(READINGS));
    for _ in 0..READINGS {
        let reading = mean * (1.0 + scatter * draw.normal()?);
        system.push(shown(reading, resolutions[0]));
        standard.push(shown(reading / (1.0 + class), resolutions[1]));
    }
    Ok(Pairs { setting, system, standard })
}

/// What is left of a standard uncertainty without a part of it.
fn rest(whole: f64, part: f64) -> f64 {
    (whole * whole - part * part).max(0.0).sqrt()
}

/// A reading as a display shows it.
fn shown(reading: f64, resolution: f64) -> f64 {
    if resolution <= 0.0 {
        return reading;
    }
    // Dividing by the whole number of steps in a unit keeps decimal fractions what they are.
    let steps = (1.0 / resolution).round();
    if (steps * resolution - 1.0).abs() < 1e-9 {
        (reading * steps).round() / steps
    } else {
        (reading / resolution).round() * resolution
    }
}

/// A stream of random numbers.
struct Draw(ChaCha8Rng);

impl Draw {
    fn new(seed: u64, stream: u64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(stream);
        Self(generator)
    }

    /// Normal, of mean 0 and standard deviation 1.
    fn normal(&mut self) -> Result<f64, Error> {
        // The middle of one of 2^53 equal parts of (0, 1).
        let uniform = ((self.0.next_u64() >> 11) as f64 + 0.5) / 9_007_199_254_740_992.0;
        Ok(normal_quantile(uniform)?)
    }
}

/// The readings as the files that [`super::readings`] reads: names and content.
pub fn files(readings: &Readings) -> [(&'static str, String); 3] {
    let mut widths = String::from("section,reading_mm\n");
    for section in &readings.widths {
        for reading in &section.readings_mm {
            widths.push_str(&line(&[&section.section.to_string(), &reading.to_string()]));
        }
    }
    let pairs = |header: &str, all: &[Pairs]| {
        let mut text = format!("{header}\n");
        for pairs in all {
            for (system, standard) in pairs.system.iter().zip(&pairs.standard) {
                text.push_str(&line(&[&pairs.setting.to_string(), &system.to_string(), &standard.to_string()]));
            }
        }
        text
    };
    [
        ("widths.csv", widths),
        ("times.csv", pairs("speed,t_system_s,t_standard_s", &readings.times)),
        ("accelerations.csv", pairs("angle_deg,a_system_m_s2,a_standard_m_s2", &readings.accelerations)),
    ]
}

fn line(cells: &[&str]) -> String {
    cells.join(",") + "\n"
}
