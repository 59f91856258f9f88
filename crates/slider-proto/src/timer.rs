//! The timer: what it does with commands, edges and time.

use crate::clock::{TICK_HZ, age, ticks_from_ms};
use crate::frame::{Frame, ProtoError};
use crate::message::{ArmSettings, Command, Edge, EdgeBatch, EndReason, Level, Refusal, Report, TimerState, Unit};
use crate::section::Sections;

/// The hardware as the timer sees it.
pub trait Port {
    /// Forgets all edges, then captures both edges and raises the trigger pin at the first falling one. Returns the
    /// level of the sensor once that is so; if it is [`Level::Low`], a tooth is there already.
    fn arm(&mut self) -> Level;
    /// Forgets all edges, starts the reference signal and captures its edges without a trigger.
    fn start_self_test(&mut self);
    /// Captures nothing more and stops the reference signal; edges captured so far stay.
    fn stop_capture(&mut self);
    /// Takes the oldest edge.
    fn next_edge(&mut self) -> Option<Edge>;
    /// Edges that wait.
    fn waiting(&self) -> u8;
    /// Edges lost since the capture began.
    fn lost(&self) -> u16;
    /// Ends the trigger pulse.
    fn release_trigger(&mut self);
    /// Level of the sensor now.
    fn sensor(&self) -> Level;
    /// Whether the end of travel is reached now.
    fn limit(&self) -> bool;
}

/// Half a period of the reference signal in ticks: 64 x 128 cycles of 8 to a tick.
pub const REFERENCE_TICKS: u32 = 1024;
/// Edges that a self-test measures.
const SELF_TEST_EDGES: u8 = 26;
/// A self-test that has not got them after so long (13.3 ms are needed) ends with what it has.
const SELF_TEST_LIMIT: u32 = ticks_from_ms(100);
/// A batch that is not full is sent when its first edge is so old.
const BATCH_AGE: u32 = ticks_from_ms(20);

/// The self-test so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct SelfTest {
    since: u32,
    sections: Sections,
    edges: u8,
    worst: u32,
}

/// The timer's state. The main loop calls [`TimerUnit::step`] all the time and, when the line is free,
/// [`TimerUnit::command`] for each received frame and [`TimerUnit::report`], and sends what these return.
#[derive(Debug, Clone)]
pub struct TimerUnit {
    firmware: [u8; 3],
    reset_cause: u8,
    hello: bool,
    status: bool,
    state: TimerState,
    settings: ArmSettings,
    self_test: SelfTest,
    batch: EdgeBatch,
    /// Edges of the run taken from the ring, those in `batch` included.
    edges: u16,
    late: u16,
    last_edge: u32,
    /// Time of the first edge, until it is told.
    started: Option<u32>,
    tested: Option<SelfTest>,
    /// When the trigger pin was raised, while it is.
    triggered: Option<u32>,
    limit: Option<u32>,
    ended: Option<EndReason>,
}

impl TimerUnit {
    /// A timer that has just been reset, with the version of the firmware and register MCUSR.
    #[must_use]
    pub const fn new(firmware: [u8; 3], reset_cause: u8) -> Self {
        Self {
            firmware,
            reset_cause,
            hello: true,
            status: false,
            state: TimerState::Idle,
            settings: ArmSettings { run: 0, trigger_ms: 0, quiet_ms: 0 },
            self_test: SelfTest { since: 0, sections: Sections::NEW, edges: 0, worst: 0 },
            batch: EdgeBatch::new(0, 0),
            edges: 0,
            late: 0,
            last_edge: 0,
            started: None,
            tested: None,
            triggered: None,
            limit: None,
            ended: None,
        }
    }

    /// What the timer is doing.
    #[must_use]
    pub const fn state(&self) -> TimerState {
        self.state
    }

    /// Obeys or refuses the command in a received frame at time `now` in ticks; the answer is to be sent.
    pub fn command(&mut self, frame: Result<Frame<Command>, ProtoError>, now: u32, port: &mut impl Port) -> Report {
        let Ok(frame) = frame else {
            return Report::Nak { sequence: 0, reason: Refusal::Garbled };
        };
        let done = match frame.message {
            Command::Hello => {
                self.hello = true;
                Ok(())
            }
            Command::Status => {
                self.status = true;
                Ok(())
            }
            Command::Arm(settings) => self.arm(settings, port),
            Command::Stop => {
                self.stop(port);
                Ok(())
            }
            Command::SelfTest => self.start_self_test(now, port),
            _ => Err(Refusal::NotMine),
        };
        match done {
            Ok(()) => Report::Ack { sequence: frame.sequence },
            Err(reason) => Report::Nak { sequence: frame.sequence, reason },
        }
    }

    /// Still at work, or with the end of a run yet to be told.
    fn is_busy(&self) -> bool {
        matches!(self.state, TimerState::Running | TimerState::SelfTest) || self.ended.is_some()
    }

    fn arm(&mut self, settings: ArmSettings, port: &mut impl Port) -> Result<(), Refusal> {
        if settings.trigger_ms == 0 || settings.quiet_ms == 0 {
            return Err(Refusal::OutOfRange);
        }
        // An armed timer may be armed anew, but not if a first tooth came just now; a trigger pulse is not cut short.
        let begun = self.state == TimerState::Armed && port.waiting() > 0;
        if self.is_busy() || begun || self.triggered.is_some() {
            return Err(Refusal::Busy);
        }
        if port.arm() == Level::Low {
            port.stop_capture();
            self.state = TimerState::Idle;
            // A tooth that came in these microseconds has raised the pin.
            port.release_trigger();
            return Err(Refusal::SensorBlocked);
        }
        self.settings = settings;
        self.batch = EdgeBatch::new(settings.run, 0);
        self.edges = 0;
        self.late = 0;
        self.state = TimerState::Armed;
        Ok(())
    }

    fn stop(&mut self, port: &mut impl Port) {
        port.stop_capture();
        match self.state {
            // A first tooth that came just now is still to be told.
            TimerState::Armed if port.waiting() == 0 => self.state = TimerState::Idle,
            TimerState::Armed | TimerState::Running => self.ended = self.ended.or(Some(EndReason::Stopped)),
            TimerState::Idle => {}
            TimerState::SelfTest => self.state = TimerState::Idle,
        }
    }

    fn start_self_test(&mut self, now: u32, port: &mut impl Port) -> Result<(), Refusal> {
        if self.state != TimerState::Idle || self.ended.is_some() {
            return Err(Refusal::Busy);
        }
        port.start_self_test();
        self.self_test = SelfTest { since: now, sections: Sections::NEW, edges: 0, worst: 0 };
        self.state = TimerState::SelfTest;
        Ok(())
    }

    /// Tells that the end of travel was reached at `tick`; a run ends there.
    pub fn limit_hit(&mut self, tick: u32, port: &mut impl Port) {
        self.limit = Some(tick);
        if self.state == TimerState::Running {
            self.end(EndReason::Limit, port);
        }
    }

    /// Does what is due at time `now` in ticks. To be called all the time, at least every 5 ms.
    pub fn step(&mut self, now: u32, port: &mut impl Port) {
        let pulse = ticks_from_ms(self.settings.trigger_ms);
        if self.triggered.is_some_and(|since| age(since, now) >= pulse) {
            self.triggered = None;
            port.release_trigger();
        }
        match self.state {
            TimerState::Idle => {}
            TimerState::Armed | TimerState::Running => self.gather(now, port),
            TimerState::SelfTest => self.measure_reference(now, port),
        }
    }

    /// Takes edges into the batch, and ends the run when no more will come.
    fn gather(&mut self, now: u32, port: &mut impl Port) {
        while self.batch.edges().len() < EdgeBatch::CAPACITY && self.edges < u16::MAX {
            let Some(edge) = port.next_edge() else { break };
            if self.state == TimerState::Armed {
                self.state = TimerState::Running;
                self.triggered = Some(edge.tick);
                self.started = Some(edge.tick);
            }
            self.last_edge = edge.tick;
            self.edges += 1;
            self.late += u16::from(edge.late);
            // There is room: the loop says so.
            let _ = self.batch.push(edge);
        }
        if self.state != TimerState::Running || self.ended.is_some() {
            return;
        }
        let quiet = ticks_from_ms(self.settings.quiet_ms);
        if self.edges == u16::MAX {
            self.end(EndReason::Full, port);
        } else if port.waiting() == 0 {
            // An edge that comes before the capture has stopped still belongs to the run.
            if port.lost() > 0 {
                self.end(EndReason::Overrun, port);
            } else if age(self.last_edge, now) >= quiet {
                self.end(EndReason::Quiet, port);
            }
        }
    }

    fn end(&mut self, reason: EndReason, port: &mut impl Port) {
        port.stop_capture();
        self.ended = self.ended.or(Some(reason));
    }

    /// The next report to send at time `now` in ticks, if any. To be called when the line can take one.
    pub fn report(&mut self, now: u32, port: &mut impl Port) -> Option<Report> {
        if core::mem::take(&mut self.hello) {
            let Self { firmware, reset_cause, .. } = *self;
            return Some(Report::Hello { unit: Unit::Timer, firmware, tick_hz: TICK_HZ, reset_cause });
        }
        if core::mem::take(&mut self.status) {
            let (sensor, limit) = (port.sensor(), port.limit());
            return Some(Report::Status {
                state: self.state,
                run: self.settings.run,
                edges: self.edges,
                sensor,
                limit,
            });
        }
        if let Some(tick) = self.limit.take() {
            return Some(Report::LimitHit { tick });
        }
        if let Some(SelfTest { edges, worst, .. }) = self.tested.take() {
            let worst_error_ticks = u16::try_from(worst).unwrap_or(u16::MAX);
            return Some(Report::SelfTest { edges, worst_error_ticks });
        }
        if let Some(tick) = self.started.take() {
            return Some(Report::RunStart { run: self.settings.run, tick });
        }
        self.edges_or_end(now, port)
    }

    fn edges_or_end(&mut self, now: u32, port: &mut impl Port) -> Option<Report> {
        let over = self.ended.is_some() && (port.waiting() == 0 || self.edges == u16::MAX);
        if let [first, ..] = self.batch.edges() {
            let full = self.batch.edges().len() == EdgeBatch::CAPACITY;
            if full || over || age(first.tick, now) >= BATCH_AGE {
                let next = EdgeBatch::new(self.settings.run, self.edges);
                return Some(Report::Edges(core::mem::replace(&mut self.batch, next)));
            }
            return None;
        }
        if !over {
            return None;
        }
        let reason = self.ended.take()?;
        self.state = TimerState::Idle;
        let Self { settings: ArmSettings { run, .. }, edges, late, .. } = *self;
        Some(Report::RunEnd { run, edges, late, lost: port.lost(), reason })
    }

    fn measure_reference(&mut self, now: u32, port: &mut impl Port) {
        let test = &mut self.self_test;
        while test.edges < SELF_TEST_EDGES {
            let Some(edge) = port.next_edge() else { break };
            test.edges += 1;
            match test.sections.push(edge) {
                Ok(None) => {}
                Ok(Some(interval)) => test.worst = test.worst.max(interval.ticks.abs_diff(REFERENCE_TICKS)),
                Err(_) => test.worst = u32::MAX,
            }
        }
        if test.edges == SELF_TEST_EDGES || age(test.since, now) >= SELF_TEST_LIMIT {
            self.tested = Some(*test);
            self.state = TimerState::Idle;
            port.stop_capture();
        }
    }
}
