//! The timer's board: the firmware's own logic, on hardware that is simulated to the tick.

use std::collections::VecDeque;

use slider_proto::ring::EdgeRing;
use slider_proto::timer::{Port, REFERENCE_TICKS, TimerUnit};
use slider_proto::{Edge, Level, Report, TimerState};

use super::Track;
use super::motion::Motion;
use super::rig::{Clock, Pass, Truth};
use super::wire::Wire;

/// One turn of the main loop, in which one byte passes each way: 57600 baud are asked for and 57143 made.
pub const TURN_TICKS: u64 = 350;
/// Version of the firmware that it is like.
pub(super) const FIRMWARE: [u8; 3] = [0, 1, 0];
/// Register MCUSR after power came on.
pub(super) const POWER_ON: u8 = 1;
/// Edges of the reference signal that are played for a self-test, which ends after fewer.
const REFERENCE_EDGES: u64 = 64;

/// Sensor, input capture and end of travel.
#[derive(Debug)]
struct Hardware {
    now: u64,
    ring: EdgeRing,
    sensor: Level,
    limit: bool,
    /// The level after the edge that the capture waits for, while it is on.
    awaits: Option<Level>,
    /// Changes of the sensor's output that are to come.
    coming: VecDeque<(u64, Level)>,
    /// When the end of travel will be reached.
    limit_at: Option<u64>,
    /// The reference signal is on.
    reference: bool,
    /// It has been armed, and no pass is planned yet.
    armed_anew: bool,
}

impl Hardware {
    fn new(now: u64) -> Self {
        Self {
            now,
            ring: EdgeRing::new(),
            sensor: Level::High,
            limit: false,
            awaits: None,
            coming: VecDeque::new(),
            limit_at: None,
            reference: false,
            armed_anew: false,
        }
    }

    /// The carriage is put back to its start, before the sensor.
    fn put_back(&mut self) {
        self.coming.clear();
        self.limit_at = None;
        self.limit = false;
        self.sensor = Level::High;
    }

    fn capture(&mut self) {
        self.ring.clear();
        self.awaits = Some(Level::Low);
    }

    /// Lets everything happen up to `now`; returns whether the end of travel was reached.
    fn advance(&mut self, now: u64) -> bool {
        self.now = now;
        while let Some(&(tick, level)) = self.coming.front().filter(|(tick, _)| *tick <= now) {
            self.coming.pop_front();
            self.sensor = level;
            if self.awaits == Some(level) {
                self.awaits = Some(level.inverse());
                // The counter on the wire has 32 bits.
                self.ring.push(Edge { tick: tick as u32, level, late: false });
            }
        }
        let reached = self.limit_at.is_some_and(|tick| tick <= now);
        if reached {
            self.limit_at = None;
            self.limit = true;
        }
        reached
    }
}

impl Port for Hardware {
    fn arm(&mut self) -> Level {
        self.put_back();
        self.capture();
        self.armed_anew = true;
        self.sensor
    }

    /// The wire from the reference signal to the sensor's pin is always there.
    fn start_self_test(&mut self) {
        self.put_back();
        self.capture();
        self.reference = true;
        let level = |n: u64| if n.is_multiple_of(2) { Level::High } else { Level::Low };
        let now = self.now;
        self.coming.extend((1..=REFERENCE_EDGES).map(|n| (now + n * u64::from(REFERENCE_TICKS), level(n))));
    }

    fn stop_capture(&mut self) {
        self.awaits = None;
        if std::mem::take(&mut self.reference) {
            self.put_back();
        }
    }

    fn next_edge(&mut self) -> Option<Edge> {
        self.ring.pop()
    }

    fn waiting(&self) -> u8 {
        self.ring.len()
    }

    fn lost(&self) -> u16 {
        self.ring.lost()
    }

    /// There is no camera.
    fn release_trigger(&mut self) {}

    fn sensor(&self) -> Level {
        self.sensor
    }

    fn limit(&self) -> bool {
        self.limit
    }
}

/// A timer with a carriage that sets out some time after it is armed, in time that passes turn by turn.
///
/// Arming puts the carriage back to its start; a timer that is stopped before the first tooth calls the pass off. An
/// edge is stamped however soon it follows another, and none is late.
#[derive(Debug)]
pub struct Board {
    unit: TimerUnit,
    hardware: Hardware,
    wire: Wire,
    clock: Clock,
    track: Track,
    /// Passes begun.
    begun: u32,
    /// Passes whose end was told.
    ended: u32,
    /// The pass that is planned, until its first edge.
    planned: Option<(u64, Truth)>,
    truths: Vec<Truth>,
}

impl Board {
    /// A timer that has just been reset, and what passes it.
    pub fn new(track: Track) -> Self {
        let clock = track.rig.clock();
        Self {
            unit: TimerUnit::new(FIRMWARE, POWER_ON),
            hardware: Hardware::new(clock.start_tick),
            wire: Wire::new(),
            clock,
            track,
            begun: 0,
            ended: 0,
            planned: None,
            truths: Vec::new(),
        }
    }

    /// What the clock of the board counts, ticks.
    pub fn tick(&self) -> u64 {
        self.hardware.now
    }

    /// Sets how the carriage moves from the next arming on; without a motion it stays where it is.
    pub fn set_motion(&mut self, motion: Option<Motion>) {
        self.track.motions = motion.into_iter().collect();
    }

    /// Bytes from the host; they take their time on the line.
    pub fn receive(&mut self, bytes: &[u8]) {
        self.wire.receive(bytes);
    }

    /// Whether something is going on that a host may wait for: bytes, a pass, a run.
    pub fn is_busy(&self) -> bool {
        !(self.wire.is_idle() && self.hardware.coming.is_empty())
            || matches!(self.unit.state(), TimerState::Running | TimerState::SelfTest)
    }

    /// Runs whose end has been told to the last byte.
    pub fn runs(&self) -> u32 {
        if self.wire.is_free() { self.ended } else { self.ended.saturating_sub(1) }
    }

    /// Takes the truth of the runs that have begun since the last call.
    pub fn take_truths(&mut self) -> Vec<Truth> {
        std::mem::take(&mut self.truths)
    }

    /// Lets [`TURN_TICKS`] pass and returns the byte that was sent in them, if any.
    pub fn turn(&mut self) -> Option<u8> {
        let at = self.hardware.now + TURN_TICKS;
        // What the firmware calls the time.
        let now = at as u32;
        let (unit, hardware) = (&mut self.unit, &mut self.hardware);
        if hardware.advance(at) {
            unit.limit_hit(now, hardware);
        }
        if self.planned.as_ref().is_some_and(|(first, _)| *first <= at) {
            self.begun += 1;
            self.truths.extend(self.planned.take().map(|(_, truth)| truth));
        }
        unit.step(now, hardware);
        if self.wire.is_free() {
            // As in the firmware, a command is read only when its answer can be sent.
            let answer = self.wire.command().map(|frame| unit.command(frame, now, hardware));
            if let Some(report) = answer.or_else(|| unit.report(now, hardware)) {
                self.send(&report);
            }
        }
        self.plan();
        self.wire.next()
    }

    fn send(&mut self, report: &Report) {
        match *report {
            Report::RunStart { run, .. } => {
                for truth in &mut self.truths {
                    truth.run = truth.run.or(Some(run));
                }
            }
            Report::RunEnd { .. } => self.ended += 1,
            _ => {}
        }
        self.wire.send(report);
    }

    /// Lets the carriage set out after the timer was armed, and not if it was stopped since.
    fn plan(&mut self) {
        if std::mem::take(&mut self.hardware.armed_anew) {
            let Some(Pass { crossings, limit_s, truth }) = self.track.pass(self.begun) else { return };
            let start_s = self.clock.time_s(self.hardware.now) + self.track.delay_s;
            let tick = |time_s: f64| self.clock.tick(start_s + time_s);
            self.hardware.coming.extend(crossings.iter().map(|crossing| (tick(crossing.time_s), crossing.level)));
            self.hardware.limit_at = limit_s.map(tick);
            self.planned = self.hardware.coming.front().map(|(first, _)| (*first, truth));
        } else if self.planned.is_some() && self.unit.state() == TimerState::Idle {
            self.planned = None;
            self.hardware.put_back();
        }
    }
}
