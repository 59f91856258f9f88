//! What the view knows.

use std::collections::VecDeque;

use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use slider_proto::TimerState;

use crate::outcome::Outcome;

/// Most runs that are remembered.
const MOST_RUNS: usize = 500;
/// Most messages that are remembered.
const MOST_MESSAGES: usize = 50;
/// Most edges of one run, as many as the timer can number.
const MOST_EDGES: usize = 65_535;

/// What the reader tells the view.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    /// A port has been opened.
    Connected {
        /// Its name.
        port: String,
    },
    /// The port was lost, or could not be opened; it may be tried again.
    Disconnected {
        /// Why.
        reason: String,
    },
    /// So many bytes have come since the last such event.
    Bytes(u64),
    /// The timer told what it is doing.
    Timer(TimerState),
    /// An edge has come.
    Edge {
        /// Its run.
        run: u16,
        /// Time since the first edge of the run, s.
        t_s: f64,
        /// Position of this edge of the sheet, m; `None` behind the end of the sheet.
        x_m: Option<f64>,
    },
    /// A run has ended and was fitted.
    Outcome(Box<Outcome>),
    /// Something to know: a refused command, the file of the log.
    Note(String),
    /// Something is wrong: a damaged frame, a run that cannot be fitted.
    Error(String),
}

/// What the user asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Request {
    /// Arm the timer for the next run.
    Arm,
    /// End the run, stop the motor.
    Stop,
    /// End the program.
    Quit,
}

/// The connection.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Link {
    /// Nothing is known yet.
    Waiting,
    /// The port of this name is open.
    Open(String),
    /// It is not, for this reason.
    Lost(String),
}

/// A line for the user.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Message {
    pub(super) text: String,
    pub(super) is_error: bool,
    pub(super) count: u64,
}

/// A run whose edges are coming.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Passing {
    pub(super) run: u16,
    /// Time in s and position in m of the edges on the sheet.
    pub(super) points: Vec<(f64, f64)>,
    pub(super) edges: u64,
}

impl Passing {
    /// Speed over the last section, m/s, without uncertainty.
    pub(super) fn last_speed_m_s(&self) -> Option<f64> {
        match self.points.as_slice() {
            [.., before, last] if last.0 > before.0 => Some((last.1 - before.1) / (last.0 - before.0)),
            _ => None,
        }
    }
}

/// What the view knows.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    pub(super) link: Link,
    pub(super) timer: Option<TimerState>,
    pub(super) bytes: u64,
    pub(super) errors: u64,
    pub(super) passing: Option<Passing>,
    pub(super) outcomes: VecDeque<Outcome>,
    /// Index of the run shown; `None` is the newest.
    pub(super) chosen: Option<usize>,
    pub(super) messages: VecDeque<Message>,
}

impl Default for State {
    fn default() -> Self {
        Self {
            link: Link::Waiting,
            timer: None,
            bytes: 0,
            errors: 0,
            passing: None,
            outcomes: VecDeque::new(),
            chosen: None,
            messages: VecDeque::new(),
        }
    }
}

impl State {
    /// Takes what the reader tells.
    pub fn apply(&mut self, event: Event) {
        match event {
            Event::Connected { port } => {
                self.say(format!("{port} is open"), false);
                self.link = Link::Open(port);
            }
            Event::Disconnected { reason } => {
                self.say(reason.clone(), true);
                self.link = Link::Lost(reason);
                self.timer = None;
            }
            Event::Bytes(count) => self.bytes = self.bytes.saturating_add(count),
            Event::Timer(state) => self.timer = Some(state),
            Event::Edge { run, t_s, x_m } => self.edge(run, t_s, x_m),
            Event::Outcome(outcome) => self.outcome(*outcome),
            Event::Note(text) => self.say(text, false),
            Event::Error(text) => {
                self.errors = self.errors.saturating_add(1);
                self.say(text, true);
            }
        }
    }

    /// Takes a key: `a` arms, `s` stops, `q`, Escape or Ctrl-C quits, the arrows choose a run.
    pub fn key(&mut self, key: KeyEvent) -> Option<Request> {
        if key.kind == KeyEventKind::Release {
            return None;
        }
        let newest = self.outcomes.len().checked_sub(1);
        match key.code {
            KeyCode::Char('c') if key.modifiers.contains(KeyModifiers::CONTROL) => return Some(Request::Quit),
            KeyCode::Char('q' | 'Q') | KeyCode::Esc => return Some(Request::Quit),
            KeyCode::Char('a' | 'A') => return Some(Request::Arm),
            KeyCode::Char('s' | 'S') => return Some(Request::Stop),
            KeyCode::Up => self.chosen = newest.map(|newest| self.chosen.unwrap_or(newest).saturating_sub(1)),
            // Beyond the newest one the view follows what comes.
            KeyCode::Down => {
                self.chosen =
                    self.chosen.map(|chosen| chosen + 1).filter(|&next| newest.is_some_and(|newest| next < newest));
            }
            KeyCode::End => self.chosen = None,
            _ => {}
        }
        None
    }

    /// Adds a line; the same one again is only counted.
    pub(super) fn say(&mut self, text: String, is_error: bool) {
        if let Some(last) = self.messages.back_mut().filter(|last| last.text == text) {
            last.count = last.count.saturating_add(1);
            return;
        }
        if self.messages.len() == MOST_MESSAGES {
            self.messages.pop_front();
        }
        self.messages.push_back(Message { text, is_error, count: 1 });
    }

    /// The run that is shown, unless one is passing.
    pub(super) fn shown(&self) -> Option<&Outcome> {
        match self.chosen {
            Some(index) => self.outcomes.get(index),
            None if self.passing.is_some() => None,
            None => self.outcomes.back(),
        }
    }

    fn edge(&mut self, run: u16, t_s: f64, x_m: Option<f64>) {
        let is_new = self.passing.as_ref().is_none_or(|passing| passing.run != run);
        if is_new {
            self.passing = Some(Passing { run, points: Vec::new(), edges: 0 });
        }
        if let Some(passing) = &mut self.passing {
            passing.edges += 1;
            if let Some(x_m) = x_m.filter(|x| x.is_finite() && t_s.is_finite() && passing.points.len() < MOST_EDGES) {
                passing.points.push((t_s, x_m));
            }
        }
    }

    fn outcome(&mut self, outcome: Outcome) {
        if self.passing.as_ref().is_some_and(|passing| passing.run == outcome.run) {
            self.passing = None;
        }
        for warning in &outcome.warnings {
            self.say(format!("run {}: {warning}", outcome.run), true);
        }
        if self.outcomes.len() == MOST_RUNS {
            self.outcomes.pop_front();
            self.chosen = self.chosen.map(|chosen| chosen.saturating_sub(1));
        }
        self.outcomes.push_back(outcome);
    }
}
