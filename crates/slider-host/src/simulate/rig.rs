//! The sheet that passes the sensor, and what is known of it.

use serde::{Deserialize, Serialize};
use slider_proto::{Level, TICK_HZ};

use super::motion::Motion;
use super::random::Random;
use crate::{Error, sheet::Sheet};

/// Streams of one seed: the sheet, and from this one on one for each pass.
const SHEET_STREAM: u64 = 0;
const FIRST_PASS_STREAM: u64 = 1;
/// Least time between two edges whose order the jitter would change, s.
const LEAST_GAP_S: f64 = 1e-6;

/// What the sensor does to the edges.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sensor {
    /// The light barrier opens when the end of a tooth is so far behind it, m: the width of its window that has to be
    /// free, which shifts rising edges against falling ones. Below 0 it opens early.
    pub rising_shift_m: f64,
    /// Delay of falling edges (a tooth comes), s.
    pub falling_delay_s: f64,
    /// Delay of rising edges, s.
    pub rising_delay_s: f64,
    /// Standard deviation of the Gaussian jitter of every edge, s.
    pub jitter_std_s: f64,
    /// Short pulses in a pass, at random places between its first and its last edge.
    pub glitches: usize,
    /// Their width, s.
    pub glitch_s: f64,
}

/// The board's clock.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Clock {
    /// How much it is fast, in parts per million.
    pub ppm: f64,
    /// Its count at time 0, ticks.
    pub start_tick: u64,
}

impl Clock {
    fn rate_hz(&self) -> f64 {
        f64::from(TICK_HZ) * (1.0 + self.ppm * 1e-6)
    }

    /// What the clock counts at `time_s` (0 or more), rounded to the nearest tick. The counter on the wire is this
    /// modulo 2^32.
    pub fn tick(&self, time_s: f64) -> u64 {
        self.start_tick.saturating_add((time_s * self.rate_hz()).round() as u64)
    }

    /// The time, s, at which it counts `tick`; 0 before [`Clock::start_tick`].
    pub fn time_s(&self, tick: u64) -> f64 {
        tick.saturating_sub(self.start_tick) as f64 / self.rate_hz()
    }
}

/// A change of the sensor's output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// When, s after the start of the carriage.
    pub time_s: f64,
    /// The level after it.
    pub level: Level,
}

/// What was true in one pass, for those who check what was measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// Number of the pass, from 1.
    pub pass: u32,
    /// Number that the host gave the run; unknown if the firmware runs in a program of its own.
    pub run: Option<u16>,
    /// Speed at the first edge of the sheet, m/s; the motor's without its ripple.
    pub v0_m_s: f64,
    /// Acceleration, m/s^2; 0 for the motor.
    pub accel_m_s2: f64,
    /// Widths of teeth and slits, m, as they are, a missing tooth included.
    pub widths_m: Vec<f64>,
    /// The tooth that is missing, counted from 1.
    pub missing_tooth: Option<usize>,
    /// Times, s, from the first edge of the sheet, at which its edges were at the sensor, as far as the carriage came: no
    /// shift, no delay, no jitter, no missing tooth.
    pub edges_s: Vec<f64>,
    /// Times, s, from the same moment, at which the sensor's output changed.
    pub crossings_s: Vec<f64>,
    /// How much the board's clock is fast, in parts per million.
    pub clock_ppm: f64,
}

/// One pass of the sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct Pass {
    /// Changes of the sensor's output, in order; it is high before the first one.
    pub crossings: Vec<Crossing>,
    /// When the end of travel is reached, s after the start of the carriage.
    pub limit_s: Option<f64>,
    /// What was true.
    pub truth: Truth,
}

/// The slider as far as the sensor sees it.
#[derive(Debug, Clone, PartialEq)]
pub struct Rig {
    widths_m: Vec<f64>,
    sensor: Sensor,
    clock: Clock,
    missing_tooth: Option<usize>,
    seed: u64,
}

impl Rig {
    /// A slider whose sheet is exactly as `sheet` says. All that is random comes from `seed`.
    pub fn exact(sheet: &Sheet, sensor: Sensor, clock: Clock, seed: u64) -> Result<Self, Error> {
        for (what, value) in [
            ("falling_delay_s", sensor.falling_delay_s),
            ("rising_delay_s", sensor.rising_delay_s),
            ("jitter_std_s", sensor.jitter_std_s),
            ("glitch_s", sensor.glitch_s),
        ] {
            if !(value.is_finite() && value >= 0.0) {
                return Err(Error::Simulation(format!("{what} {value} must be 0 or more")));
            }
        }
        if !sensor.rising_shift_m.is_finite() {
            return Err(Error::Simulation(format!("rising_shift_m {} must be a number", sensor.rising_shift_m)));
        }
        if !(clock.ppm.is_finite() && clock.ppm.abs() <= 1e5) {
            return Err(Error::Simulation(format!("a clock that is off by {} ppm: at most 100000", clock.ppm)));
        }
        let widths_m: Vec<_> = sheet.sections.iter().map(|width| width.value_m).collect();
        if let Some((index, width)) = (0..).zip(&widths_m).find(|(_, width)| !(width.is_finite() && **width > 0.0)) {
            return Err(Error::Simulation(format!("section {} of the sheet is {width} m wide", index + 1)));
        }
        Ok(Self { widths_m, sensor, clock, missing_tooth: None, seed })
    }

    /// A slider whose sheet is one of those that `sheet` may be: each width is drawn from a Gaussian with its standard
    /// uncertainty, and all are scaled by one factor with the standard uncertainty of the scale.
    pub fn drawn(sheet: &Sheet, sensor: Sensor, clock: Clock, seed: u64) -> Result<Self, Error> {
        let mut random = Random::new(seed, SHEET_STREAM);
        let scale = 1.0 + sheet.scale_std * random.gaussian();
        let mut sheet = sheet.clone();
        for width in &mut sheet.sections {
            width.value_m = scale * (width.value_m + width.std_m * random.gaussian());
        }
        Self::exact(&sheet, sensor, clock, seed)
    }

    /// The same slider with a tooth broken off, counted from 1.
    pub fn without_tooth(self, tooth: usize) -> Result<Self, Error> {
        let teeth = self.widths_m.len().div_ceil(2);
        if !(1..=teeth).contains(&tooth) {
            return Err(Error::Simulation(format!("tooth {tooth} cannot be missing: there are teeth 1 to {teeth}")));
        }
        if teeth == 1 {
            return Err(Error::Simulation("the only tooth cannot be missing".to_owned()));
        }
        Ok(Self { missing_tooth: Some(tooth), ..self })
    }

    /// Widths of teeth and slits, m, as they are.
    pub fn widths_m(&self) -> &[f64] {
        &self.widths_m
    }

    /// The board's clock.
    pub fn clock(&self) -> Clock {
        self.clock
    }

    /// Length of the sheet, m.
    pub fn length_m(&self) -> f64 {
        self.widths_m.iter().sum()
    }

    /// Pass number `index`, from 0, in this `motion`; the same number gives the same pass.
    pub fn pass(&self, motion: &Motion, index: u32) -> Pass {
        let mut random = Random::new(self.seed, FIRST_PASS_STREAM + u64::from(index));
        let mut positions_m = vec![0.0];
        positions_m.extend(self.widths_m.iter().scan(0.0, |position, width| {
            *position += width;
            Some(*position)
        }));
        let start_s = motion.time_s(0.0);
        let edges_s: Vec<f64> = positions_m.iter().map_while(|position| motion.time_s(*position)).collect();
        let mut crossings = Vec::with_capacity(positions_m.len() + 2 * self.sensor.glitches);
        for (index, position) in positions_m.iter().enumerate() {
            let falling = index.is_multiple_of(2);
            let (level, shift, delay) = if falling {
                (Level::Low, 0.0, self.sensor.falling_delay_s)
            } else {
                (Level::High, self.sensor.rising_shift_m, self.sensor.rising_delay_s)
            };
            let jitter = self.sensor.jitter_std_s * random.gaussian();
            if self.missing_tooth == Some(index / 2 + 1) {
                continue;
            }
            let Some(time_s) = motion.time_s(position + shift) else { break };
            let before = crossings.last().map_or(0.0, |last: &Crossing| last.time_s + LEAST_GAP_S);
            crossings.push(Crossing { time_s: (time_s + delay + jitter).max(before), level });
        }
        self.glitch(&mut crossings, &mut random);
        let from_first = |time_s: f64| time_s - start_s.unwrap_or(0.0);
        let truth = Truth {
            pass: index + 1,
            run: None,
            v0_m_s: motion.v0_m_s(),
            accel_m_s2: motion.accel_m_s2(),
            widths_m: self.widths_m.clone(),
            missing_tooth: self.missing_tooth,
            edges_s: edges_s.into_iter().map(from_first).collect(),
            crossings_s: crossings.iter().map(|crossing| from_first(crossing.time_s)).collect(),
            clock_ppm: self.clock.ppm,
        };
        let limit_s = if motion.end_m().is_finite() { motion.time_s(motion.end_m()) } else { None };
        Pass { crossings, limit_s, truth }
    }

    /// Adds the sensor's glitches, none over an edge; where there is no room for one there are fewer.
    fn glitch(&self, crossings: &mut Vec<Crossing>, random: &mut Random) {
        for _ in 0..self.sensor.glitches {
            let (Some(first), Some(last)) = (crossings.first(), crossings.last()) else { return };
            let from_s = first.time_s + (last.time_s - first.time_s) * random.unit();
            let to_s = from_s + self.sensor.glitch_s;
            let behind = crossings.partition_point(|crossing| crossing.time_s <= from_s);
            let Some([before, after]) = crossings.get(behind.saturating_sub(1)..=behind) else { continue };
            let level = before.level;
            if before.time_s + LEAST_GAP_S < from_s && to_s + LEAST_GAP_S < after.time_s && from_s < to_s {
                let pulse = [(from_s, level.inverse()), (to_s, level)];
                crossings.splice(behind..behind, pulse.map(|(time_s, level)| Crossing { time_s, level }));
            }
        }
    }
}
