//! Where the carriage is at a time, and when it is at a place.

use std::f64::consts::TAU;

use crate::Error;

/// Gravity, m/s^2: the standard value, which differs from that of any place by at most 0.3 %.
pub const GRAVITY_M_S2: f64 = 9.806_65;

/// Speeds of the ten presets of the motor, m/s.
///
/// *Reference*: Cortés-Osorio, table 5.1.
pub const PRESETS_M_S: [f64; 10] = [0.2243, 0.2871, 0.3454, 0.3935, 0.4303, 0.4674, 0.5109, 0.5329, 0.5444, 0.6021];

/// A sinusoidal modulation of the motor's speed: `v (1 + relative sin(2 pi hz t + phase_rad))`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Ripple {
    /// Amplitude as a share of the speed, from 0 to below 1.
    pub relative: f64,
    /// Frequency, Hz.
    pub hz: f64,
    /// Phase at the end of the soft start, rad.
    pub phase_rad: f64,
}

/// How the carriage is moved.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Force {
    /// From rest evenly to `speed_m_s` in `ramp_s`, then at that speed but for its ripple.
    Motor { speed_m_s: f64, ramp_s: f64, ripple: Ripple },
    /// Evenly accelerated from `start_m_s`; a carriage that comes to rest stays there, held by friction.
    Free { start_m_s: f64, accel_m_s2: f64 },
}

/// The motion of the carriage, from time 0, when it starts, to its end of travel, if it has one.
///
/// Positions are in m from the sheet's first edge and grow in the direction of travel, so that a carriage that starts
/// before the sensor starts at a position below 0.
///
/// ```
/// use slider_host::simulate::motion::Motion;
/// let motion = Motion::accelerated(0.2, 1.5)?;
/// let time_s = motion.time_s(0.05).unwrap();
/// assert!((0.2 * time_s + 1.5 / 2.0 * time_s * time_s - 0.05).abs() < 1e-15);
/// # Ok::<(), slider_host::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    force: Force,
    start_m: f64,
    end_m: f64,
}

fn number(what: &str, value: f64, range: &str, fits: impl Fn(f64) -> bool) -> Result<f64, Error> {
    if value.is_finite() && fits(value) {
        Ok(value)
    } else {
        Err(Error::Simulation(format!("{what} {value} must be {range}")))
    }
}

impl Motion {
    /// The motor at `speed_m_s` (above 0), reached evenly in `ramp_s` (0 or more) `lead_m` (0 or more) before the first
    /// edge, with a `ripple` from then on.
    pub fn motor(speed_m_s: f64, ramp_s: f64, lead_m: f64, ripple: Ripple) -> Result<Self, Error> {
        let speed_m_s = number("speed_m_s", speed_m_s, "above 0", |value| value > 0.0)?;
        let ramp_s = number("ramp_s", ramp_s, "0 or more", |value| value >= 0.0)?;
        let lead_m = number("lead_m", lead_m, "0 or more", |value| value >= 0.0)?;
        number("relative ripple", ripple.relative, "from 0 to below 1", |value| (0.0..1.0).contains(&value))?;
        number("ripple's hz", ripple.hz, "0 or more", |value| value >= 0.0)?;
        number("ripple's phase_rad", ripple.phase_rad, "a number", |_| true)?;
        let start_m = -(speed_m_s * ramp_s / 2.0 + lead_m);
        Ok(Self { force: Force::Motor { speed_m_s, ramp_s, ripple }, start_m, end_m: f64::INFINITY })
    }

    /// Constant speed, m/s (above 0), from the first edge on.
    pub fn constant(speed_m_s: f64) -> Result<Self, Error> {
        Self::motor(speed_m_s, 0.0, 0.0, Ripple::default())
    }

    /// Constant acceleration, m/s^2, with the speed `v0_m_s` (0 or more) at the first edge, where it starts.
    pub fn accelerated(v0_m_s: f64, accel_m_s2: f64) -> Result<Self, Error> {
        let start_m_s = number("v0_m_s", v0_m_s, "0 or more", |value| value >= 0.0)?;
        let accel_m_s2 = number("accel_m_s2", accel_m_s2, "a number", |_| true)?;
        if start_m_s == 0.0 && accel_m_s2 <= 0.0 {
            let (v0, accel) = (start_m_s, accel_m_s2);
            return Err(Error::Simulation(format!("a carriage with v0 {v0} m/s and a {accel} m/s^2 does not move")));
        }
        Ok(Self { force: Force::Free { start_m_s, accel_m_s2 }, start_m: 0.0, end_m: f64::INFINITY })
    }

    /// Released from rest `run_up_m` (0 or more) before the first edge on an incline of `angle_deg` (above 0, to 90) with
    /// the coefficient of Coulomb `friction` (0 or more): `a = g (sin angle - friction cos angle)`.
    pub fn incline(angle_deg: f64, friction: f64, run_up_m: f64) -> Result<Self, Error> {
        let angle_deg = number("angle_deg", angle_deg, "above 0 and at most 90", |value| value > 0.0 && value <= 90.0)?;
        let friction = number("friction", friction, "0 or more", |value| value >= 0.0)?;
        let run_up_m = number("run_up_m", run_up_m, "0 or more", |value| value >= 0.0)?;
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        let accel_m_s2 = GRAVITY_M_S2 * (sin - friction * cos);
        if accel_m_s2 <= 0.0 {
            return Err(Error::Simulation(format!(
                "friction {friction} holds the carriage on an incline of {angle_deg} deg, whose tangent is {}",
                sin / cos
            )));
        }
        Ok(Self { force: Force::Free { start_m_s: 0.0, accel_m_s2 }, start_m: -run_up_m, end_m: f64::INFINITY })
    }

    /// The same motion, stopped dead at `end_m`.
    #[must_use]
    pub fn ending_at(self, end_m: f64) -> Self {
        Self { end_m, ..self }
    }

    /// The same motion with another phase of its ripple, rad; without a motor there is none.
    #[must_use]
    pub fn with_phase(self, phase_rad: f64) -> Self {
        match self.force {
            Force::Motor { speed_m_s, ramp_s, ripple } => {
                Self { force: Force::Motor { speed_m_s, ramp_s, ripple: Ripple { phase_rad, ..ripple } }, ..self }
            }
            Force::Free { .. } => self,
        }
    }

    /// End of travel, m; infinite if there is none.
    pub fn end_m(&self) -> f64 {
        self.end_m
    }

    /// Acceleration, m/s^2, as the sheet passes: 0 for the motor, whose ripple is left out.
    pub fn accel_m_s2(&self) -> f64 {
        match self.force {
            Force::Motor { .. } => 0.0,
            Force::Free { accel_m_s2, .. } => accel_m_s2,
        }
    }

    /// Speed at the first edge, m/s, the motor's without its ripple.
    pub fn v0_m_s(&self) -> f64 {
        match self.force {
            Force::Motor { speed_m_s, .. } => speed_m_s,
            Force::Free { start_m_s, accel_m_s2 } => {
                (start_m_s * start_m_s - 2.0 * accel_m_s2 * self.start_m).max(0.0).sqrt()
            }
        }
    }

    /// Position, m, at `time_s` after the start; before it the carriage waits.
    pub fn position_m(&self, time_s: f64) -> f64 {
        let time = time_s.max(0.0);
        let way = match self.force {
            Force::Motor { speed_m_s, ramp_s, .. } if time < ramp_s => speed_m_s * time * time / (2.0 * ramp_s),
            Force::Motor { speed_m_s, ramp_s, ripple } => speed_m_s * (ramp_s / 2.0 + ripple.integral_s(time - ramp_s)),
            Force::Free { start_m_s, accel_m_s2 } => {
                let time = if accel_m_s2 < 0.0 { time.min(start_m_s / -accel_m_s2) } else { time };
                start_m_s * time + accel_m_s2 / 2.0 * time * time
            }
        };
        (self.start_m + way).min(self.end_m)
    }

    /// Time, s after the start, at which the carriage is first at `position_m`, within 1e-12 s; `None` if it never is.
    ///
    /// The roots of `start t + a t^2 / 2 = way` are written so that nothing cancels: `2 way / (start + speed there)`.
    pub fn time_s(&self, position_m: f64) -> Option<f64> {
        let way = position_m - self.start_m;
        if !(way >= 0.0 && position_m <= self.end_m) {
            return None;
        }
        if way == 0.0 {
            return Some(0.0);
        }
        match self.force {
            Force::Motor { speed_m_s, ramp_s, ripple } => {
                let ramp_m = speed_m_s * ramp_s / 2.0;
                Some(if way < ramp_m {
                    (2.0 * ramp_s * way / speed_m_s).sqrt()
                } else {
                    ramp_s + ripple.inverse_s((way - ramp_m) / speed_m_s)
                })
            }
            Force::Free { start_m_s, accel_m_s2 } => {
                let speed = (start_m_s * start_m_s + 2.0 * accel_m_s2 * way).sqrt();
                let time = 2.0 * way / (start_m_s + speed);
                time.is_finite().then_some(time)
            }
        }
    }
}

impl Ripple {
    /// Integral of `1 + relative sin(...)` from 0 to `time_s`, s.
    fn integral_s(&self, time_s: f64) -> f64 {
        let omega = TAU * self.hz;
        if omega == 0.0 {
            return time_s * (1.0 + self.relative * self.phase_rad.sin());
        }
        // cos p - cos(wt + p) = 2 sin(wt/2 + p) sin(wt/2), in which nothing cancels for a small time.
        let half = omega * time_s / 2.0;
        time_s + self.relative / omega * 2.0 * (half + self.phase_rad).sin() * half.sin()
    }

    /// The time at which the integral is `way_s`, by Newton's method, which falls back to bisection when it leaves the
    /// bracket. The integral differs from the time by at most `2 relative / omega`.
    fn inverse_s(&self, way_s: f64) -> f64 {
        let omega = TAU * self.hz;
        if omega == 0.0 {
            return way_s / (1.0 + self.relative * self.phase_rad.sin());
        }
        let bound = 2.0 * self.relative / omega;
        let (mut low, mut high) = ((way_s - bound).max(0.0), way_s + bound);
        let mut time = way_s;
        // A bisection alone would need no more steps than there are bits in the bracket.
        for _ in 0..100 {
            let error = self.integral_s(time) - way_s;
            if error > 0.0 {
                high = time;
            } else {
                low = time;
            }
            let slope = 1.0 + self.relative * (omega * time + self.phase_rad).sin();
            let newton = time - error / slope;
            let next = if newton >= low && newton <= high { newton } else { f64::midpoint(low, high) };
            if (next - time).abs() < 1e-14 || high - low < 1e-14 {
                return next;
            }
            time = next;
        }
        time
    }
}
