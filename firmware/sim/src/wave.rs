//! Exact waveforms from a file, played into a pin whenever the firmware arms.
//!
//! # The file
//! Text; a line `cycle level` for each change of the pin, with cycles of 62.5 ns from the moment of arming in rising order
//! and the level, 0 or 1, from then on. The pin is high before. A blank line ends a pass; passes are played in turn, one
//! each time, and from the first one again after the last. Lines that begin with `#` are comments.

use crate::{Mcu, Pin, SimError, millis};
use std::{fs, path::Path};

/// Least cycle of a pass: the player, called once a millisecond, notices the arming within little more than one.
pub const FIRST_CYCLE: u64 = millis(2);

/// Changes of a pin's level: cycles from the beginning of the pass, and the level from then on.
pub type Pass = Vec<(u64, bool)>;

/// Reads the passes from a file.
pub fn read(path: &Path) -> Result<Vec<Pass>, SimError> {
    let text = fs::read_to_string(path).map_err(|source| SimError::Read { path: path.into(), source })?;
    parse(&text).map_err(|(line, reason)| SimError::Wave { path: path.into(), line, reason })
}

/// Parses the passes; the error is the line's number, from 1, and what is wrong with it.
pub fn parse(text: &str) -> Result<Vec<Pass>, (usize, String)> {
    let mut passes = Vec::new();
    let mut pass = Pass::new();
    let mut last = 0;
    for (number, line) in (1..).zip(text.lines()) {
        last = number;
        let line = line.trim();
        if line.is_empty() {
            if !pass.is_empty() {
                passes.push(std::mem::take(&mut pass));
            }
        } else if !line.starts_with('#') {
            let edge = edge(line, pass.last().copied()).map_err(|reason| (number, reason))?;
            pass.push(edge);
        }
    }
    if !pass.is_empty() {
        passes.push(pass);
    }
    if passes.is_empty() { Err((last, "no line of the file is an edge".into())) } else { Ok(passes) }
}

fn edge(line: &str, before: Option<(u64, bool)>) -> Result<(u64, bool), String> {
    let fields: Vec<_> = line.split_whitespace().collect();
    let [cycle, level] = fields[..] else {
        return Err(format!("'{line}' must be two fields: cycle level"));
    };
    let cycle: u64 = cycle.parse().map_err(|_| format!("cycle '{cycle}' must be a whole number"))?;
    let level = match level {
        "0" => false,
        "1" => true,
        _ => return Err(format!("level '{level}' must be 0 or 1")),
    };
    match before {
        None if cycle < FIRST_CYCLE => {
            Err(format!("cycle {cycle}: a pass must begin at {FIRST_CYCLE} (2 ms) at the earliest"))
        }
        Some((earlier, _)) if cycle <= earlier => Err(format!("cycle {cycle} must come after {earlier}")),
        _ if level == before.is_none_or(|(_, level)| level) => Err(format!("the level is {} already", u8::from(level))),
        _ => Ok((cycle, level)),
    }
}

/// When a pass begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    /// When the firmware raises D13, the LED: the timer is armed, or tests itself.
    Armed,
    /// So many cycles after the pass before, and after power-up.
    Every(u64),
}

/// Plays passes into a pin.
#[derive(Debug)]
pub struct Player {
    passes: Vec<Pass>,
    pin: Pin,
    start: Start,
    /// Changes of D13 that have been seen.
    seen: usize,
    /// Cycle from which the next pass counts, once that is known.
    origin: Option<u64>,
    begun: usize,
    /// The firmware is still at work on the last pass that was begun.
    at_work: bool,
    /// Cycle at which it was done with the last pass.
    done: u64,
}

impl Player {
    /// Puts the pin high and begins to watch D13.
    pub fn new(passes: Vec<Pass>, pin: Pin, start: Start, mcu: &mut Mcu) -> Self {
        mcu.set(pin, true);
        mcu.watch(Pin::D13);
        let origin = match start {
            Start::Armed => None,
            Start::Every(cycles) => Some(mcu.cycle() + cycles),
        };
        Self { passes, pin, start, seen: 0, origin, begun: 0, at_work: false, done: 0 }
    }

    /// Passes that are over: all edges played, and D13 low again if it started them.
    pub fn over(&self) -> usize {
        self.begun - usize::from(self.at_work)
    }

    /// Cycle at which the last of them was over.
    pub fn over_at(&self) -> u64 {
        self.done
    }

    /// Whether the firmware is armed or at work on a pass.
    pub fn is_busy(&self) -> bool {
        self.start == Start::Armed && (self.origin.is_some() || self.at_work)
    }

    /// To be called once a millisecond: begins a pass whose first edge comes within the next two. One that comes while the last is
    /// still played waits for it, and counts from its end.
    pub fn act(&mut self, mcu: &mut Mcu) {
        let now = mcu.cycle();
        let playing = mcu.is_playing(self.pin);
        if self.start == Start::Armed {
            self.follow_led(mcu);
        }
        let lit = self.start == Start::Armed && mcu.level(Pin::D13);
        if self.at_work && !playing && !lit {
            self.at_work = false;
            self.done = now;
            // The carriage goes back to its start, before the sensor.
            mcu.set(self.pin, true);
        }
        let (Some(origin), false) = (self.origin, playing || self.at_work) else { return };
        // What should have begun while the last pass was played.
        let origin = if origin < self.done { self.done } else { origin };
        self.origin = Some(origin);
        let Some(pass) = self.begun.checked_rem(self.passes.len()).and_then(|index| self.passes.get(index)) else {
            return;
        };
        let first = pass.first().map_or(0, |(cycle, _)| *cycle);
        if origin + first <= now + FIRST_CYCLE {
            mcu.play(self.pin, pass.iter().map(|(cycle, level)| (origin + cycle, *level)));
            self.begun += 1;
            self.at_work = true;
            self.origin = match self.start {
                Start::Armed => None,
                Start::Every(cycles) => Some(origin + cycles),
            };
        }
    }

    /// A rise of D13 is the origin of a pass, a fall before its first edge calls it off.
    fn follow_led(&mut self, mcu: &Mcu) {
        let changes = mcu.changes(Pin::D13);
        for change in changes.get(self.seen..).unwrap_or_default() {
            self.origin = change.level.then_some(change.cycle);
        }
        self.seen = changes.len();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_are_parted_by_blank_lines() {
        let text = "# two passes\n\n32000 0\n34000 1\n\n\n# the second\n 40000\t0 \r\n";
        assert_eq!(parse(text), Ok(vec![vec![(32_000, false), (34_000, true)], vec![(40_000, false)]]));
    }

    #[test]
    fn errors_name_the_line_and_what_is_wrong() {
        for (text, line, says) in [
            ("", 0, "no line"),
            ("# nothing\n\n", 2, "no line"),
            ("32000\n", 1, "two fields"),
            ("32000 0\n34000 1 D8\n", 2, "two fields"),
            ("# x\n32000.5 0\n", 2, "32000.5"),
            ("-1 0\n", 1, "whole number"),
            ("32000 low\n", 1, "0 or 1"),
            ("31999 0\n", 1, "32000 (2 ms)"),
            ("32000 0\n32000 1\n", 2, "after 32000"),
            ("32000 1\n", 1, "is 1 already"),
            ("32000 0\n34000 0\n", 2, "is 0 already"),
            ("32000 0\n\n34000 1\n", 3, "is 1 already"),
        ] {
            let (found, reason) = parse(text).unwrap_err();
            assert_eq!(found, line, "{text:?}: {reason}");
            assert!(reason.contains(says), "{text:?}: {reason}");
        }
    }
}
