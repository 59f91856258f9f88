//! What a user may ask the virtual slider for.

use std::fs;
use std::path::PathBuf;

use clap::Args;
use slider_proto::drive::DEFAULT_PRESETS;
use slider_proto::{Direction, Preset, TICK_HZ};

use super::Track;
use super::motion::{Motion, PRESETS_M_S, Ripple};
use super::rig::{Clock, Rig, Sensor};
use crate::{Error, sheet::Sheet};

/// Way at constant speed before the first tooth, m.
const LEAD_M: f64 = 0.02;
/// The soft start raises the duty by one of 255 in this time, s.
const DUTY_STEP_S: f64 = 1e-3;

/// The options of the virtual slider. Lengths are in mm and times in ms or us, as their help says.
#[derive(Debug, Clone, PartialEq, Args)]
#[command(next_help_heading = "Motion")]
pub struct Options {
    /// Motor presets 0 to 9, used in turn: table 5.1 of the thesis, 0.2243 to 0.6021 m/s
    #[arg(long, value_name = "N,...", value_delimiter = ',', default_value = "5",
        value_parser = clap::value_parser!(u8).range(0..10), conflicts_with_all = ["speed", "incline", "accel"])]
    pub preset: Vec<u8>,

    /// A drive too, whose presets set the speed from the next arming on; its line is the second one told
    #[arg(long, conflicts_with_all = ["preset", "speed", "incline", "accel", "firmware"])]
    pub drive: bool,

    /// Motor at this speed, m/s
    #[arg(long, value_name = "M/S", conflicts_with_all = ["incline", "accel"])]
    pub speed: Option<f64>,

    /// Modulate the motor's speed by so many per cent, with a phase that differs from pass to pass
    #[arg(long, value_name = "PERCENT", default_value_t = 0.0, conflicts_with_all = ["incline", "accel"])]
    pub ripple: f64,

    /// Frequency of that modulation
    #[arg(long, value_name = "HZ", default_value_t = 8.0)]
    pub ripple_hz: f64,

    /// Released from rest on an incline of this angle, degrees
    #[arg(long, value_name = "DEG", conflicts_with = "accel")]
    pub incline: Option<f64>,

    /// Coefficient of friction on the incline; 0.008 is what the thesis's accelerations at 12 to 15 degrees imply
    #[arg(long, value_name = "MU", default_value_t = 0.008, requires = "incline")]
    pub friction: f64,

    /// Way on the incline before the first tooth, mm
    #[arg(long, value_name = "MM", default_value_t = 10.0, requires = "incline")]
    pub run_up: f64,

    /// Constant acceleration, m/s^2
    #[arg(long, value_name = "M/S2", allow_negative_numbers = true)]
    pub accel: Option<f64>,

    /// Speed at the first edge with --accel, m/s
    #[arg(long, value_name = "M/S", default_value_t = 0.0, requires = "accel")]
    pub v0: f64,

    /// End of travel so far behind the last edge, mm; the timer's switch closes there [default: none]
    #[arg(long, value_name = "MM", conflicts_with = "firmware")]
    pub travel: Option<f64>,

    /// Time from the arming of the timer to the start of the carriage, ms
    #[arg(long, value_name = "MS", default_value_t = 300.0)]
    pub delay: f64,

    /// Description of the sheet [default: 13 teeth of 3.1 mm, slits of 4.9 mm]
    #[arg(long, value_name = "FILE", help_heading = "Sheet and sensor")]
    pub sheet: Option<PathBuf>,

    /// The sheet is exactly as described; without this it is one of those that its uncertainties allow
    #[arg(long, help_heading = "Sheet and sensor")]
    pub exact: bool,

    /// A tooth is broken off, counted from 1
    #[arg(long, value_name = "N", help_heading = "Sheet and sensor")]
    pub missing_tooth: Option<usize>,

    /// The sensor opens when a tooth's end is so far behind it, mm
    #[arg(
        long,
        value_name = "MM",
        default_value_t = 0.0,
        allow_negative_numbers = true,
        help_heading = "Sheet and sensor"
    )]
    pub shift: f64,

    /// Standard deviation of the jitter of every edge, us
    #[arg(long, value_name = "US", default_value_t = 0.0, help_heading = "Sheet and sensor")]
    pub jitter: f64,

    /// Short pulses in every pass, at random places
    #[arg(long, value_name = "COUNT", default_value_t = 0, help_heading = "Sheet and sensor")]
    pub glitches: usize,

    /// Their width, us
    #[arg(long, value_name = "US", default_value_t = 20.0, help_heading = "Sheet and sensor")]
    pub glitch_width: f64,

    /// The board's clock is fast by so many parts per million
    #[arg(
        long,
        value_name = "PPM",
        default_value_t = 0.0,
        allow_negative_numbers = true,
        help_heading = "Sheet and sensor"
    )]
    pub ppm: f64,

    /// The board has been on for so long, s; its counter wraps every 2147.5 s
    #[arg(long, value_name = "S", default_value_t = 0.0, conflicts_with = "firmware", help_heading = "Running")]
    pub uptime: f64,

    /// All that is random comes from this number
    #[arg(long, value_name = "N", default_value_t = 1, help_heading = "Running")]
    pub seed: u64,

    /// End after so many runs
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), help_heading = "Running")]
    pub runs: Option<u32>,

    /// As fast as it goes while something happens
    #[arg(long, help_heading = "Running")]
    pub fast: bool,

    /// Write what was true there, a JSON object a line for each run, before the host is told of it; with --firmware for
    /// all runs before the first, without their numbers
    #[arg(long, value_name = "FILE", help_heading = "Running")]
    pub truth: Option<PathBuf>,

    /// Run the real firmware in a simulated chip, from this folder [default: the folder firmware here or above]
    #[arg(long, value_name = "DIR", num_args = 0..=1, help_heading = "Firmware")]
    pub firmware: Option<Option<PathBuf>>,

    /// The program that simulates the chip [default: that of the environment, `SLIDER_BOARD`, or what is built in
    /// the folder]
    #[arg(long, value_name = "PATH", requires = "firmware", help_heading = "Firmware")]
    pub board: Option<PathBuf>,

    /// The firmware [default: what is built in the folder]
    #[arg(long, value_name = "FILE", requires = "firmware", help_heading = "Firmware")]
    pub elf: Option<PathBuf>,
}

/// A number of the user's that has to be 0 or more.
fn at_least_zero(option: &str, value: f64) -> Result<f64, Error> {
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err(Error::Simulation(format!("--{option} {value} must be 0 or more")))
    }
}

impl Options {
    /// The rig and the motions that are asked for.
    ///
    /// # Errors
    /// [`Error::Simulation`] for values that cannot be; [`Error::File`] and [`Error::Sheet`] for the sheet.
    pub fn track(&self) -> Result<Track, Error> {
        let rig = self.rig()?;
        let motions = self.motions()?.into_iter().map(|motion| self.ended(motion, &rig)).collect::<Result<_, _>>()?;
        let delay_s = at_least_zero("delay", self.delay)? / 1e3;
        Ok(Track { rig, motions, delay_s, seed: self.seed })
    }

    /// The motion at a preset of the drive; `None` if it does not bring the carriage to the sensor.
    ///
    /// # Errors
    /// [`Error::Simulation`] for values that cannot be.
    pub fn motion_at(&self, preset: Preset, rig: &Rig) -> Result<Option<Motion>, Error> {
        if preset.duty == 0 || preset.direction == Direction::Reverse {
            return Ok(None);
        }
        let motion =
            Motion::motor(speed_m_s(preset.duty), f64::from(preset.duty) * DUTY_STEP_S, LEAD_M, self.ripple())?;
        self.ended(motion, rig).map(Some)
    }

    fn ended(&self, motion: Motion, rig: &Rig) -> Result<Motion, Error> {
        let Some(travel_mm) = self.travel else { return Ok(motion) };
        Ok(motion.ending_at(rig.length_m() + at_least_zero("travel", travel_mm)? / 1e3))
    }

    fn ripple(&self) -> Ripple {
        Ripple { relative: self.ripple / 100.0, hz: self.ripple_hz, phase_rad: 0.0 }
    }

    fn rig(&self) -> Result<Rig, Error> {
        let sheet = match &self.sheet {
            None => Sheet::nominal(),
            Some(path) => {
                let text = fs::read_to_string(path).map_err(|source| Error::File { path: path.clone(), source })?;
                Sheet::from_toml(&text)?
            }
        };
        let sensor = Sensor {
            rising_shift_m: self.shift / 1e3,
            falling_delay_s: 0.0,
            rising_delay_s: 0.0,
            jitter_std_s: self.jitter / 1e6,
            glitches: self.glitches,
            glitch_s: self.glitch_width / 1e6,
        };
        let start_tick = (at_least_zero("uptime", self.uptime)? * f64::from(TICK_HZ)).round() as u64;
        let clock = Clock { ppm: self.ppm, start_tick };
        let make = if self.exact { Rig::exact } else { Rig::drawn };
        let rig = make(&sheet, sensor, clock, self.seed)?;
        match self.missing_tooth {
            None => Ok(rig),
            Some(tooth) => rig.without_tooth(tooth),
        }
    }

    fn motions(&self) -> Result<Vec<Motion>, Error> {
        if let Some(accel) = self.accel {
            return Ok(vec![Motion::accelerated(self.v0, accel)?]);
        }
        if let Some(angle) = self.incline {
            return Ok(vec![Motion::incline(angle, self.friction, self.run_up / 1e3)?]);
        }
        if let Some(speed) = self.speed {
            // As long a start as that of the fastest preset.
            return Ok(vec![Motion::motor(speed, 255.0 * DUTY_STEP_S, LEAD_M, self.ripple())?]);
        }
        let motion = |&preset: &u8| {
            let number = usize::from(preset);
            let (Some(speed), Some(preset)) = (PRESETS_M_S.get(number), DEFAULT_PRESETS.get(number)) else {
                return Err(Error::Simulation(format!("preset {preset}: there are 0 to 9")));
            };
            Motion::motor(*speed, f64::from(preset.duty) * DUTY_STEP_S, LEAD_M, self.ripple())
        };
        self.preset.iter().map(motion).collect()
    }
}

/// Speed of the motor at a duty of 255, m/s: straight lines between the presets of the thesis, at the duties that the
/// firmware has for them, and below the first of them to standstill at none.
fn speed_m_s(duty: u8) -> f64 {
    let duty = f64::from(duty);
    let (mut below, mut speed_below) = (0.0, 0.0);
    for (preset, speed) in DEFAULT_PRESETS.iter().zip(PRESETS_M_S) {
        let above = f64::from(preset.duty);
        if duty <= above {
            return speed_below + (speed - speed_below) * (duty - below) / (above - below);
        }
        (below, speed_below) = (above, speed);
    }
    speed_below
}
