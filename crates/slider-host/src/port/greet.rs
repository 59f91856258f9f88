//! Who is at the other end.

use std::cmp::Ordering;
use std::io::{Read, Write};
use std::time::{Duration, Instant};

use slider_proto::{Command, ProtoError, Report, Unit};

use crate::Error;
use crate::reader::Event;

use super::line::{Line, command_name};

/// Version of the firmware that this program was written with.
pub const KNOWN_FIRMWARE: [u8; 3] = [0, 1, 0];

/// How long is waited for a board.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Patience {
    /// For a board that was reset because its port was opened, and first runs its bootloader.
    pub reset: Duration,
    /// Then, for the answer to each question.
    pub answer: Duration,
    /// Number of questions.
    pub questions: u32,
}

impl Default for Patience {
    /// 2.5 s, since bootloaders take up to 2 s, then three times 1 s.
    fn default() -> Self {
        Self { reset: Duration::from_millis(2500), answer: Duration::from_secs(1), questions: 3 }
    }
}

/// What a board says of itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Greeting {
    /// Which board.
    pub unit: Unit,
    /// Version of its firmware.
    pub firmware: [u8; 3],
    /// Ticks a second.
    pub tick_hz: u32,
}

impl Greeting {
    /// The version of the firmware, `0.1.0`.
    pub fn version(&self) -> String {
        let [major, minor, patch] = self.firmware;
        format!("{major}.{minor}.{patch}")
    }

    /// What to say if the firmware is newer or older than [`KNOWN_FIRMWARE`], its last number aside. The frames are
    /// understood all the same: otherwise there would be no greeting.
    pub fn note(&self) -> Option<String> {
        let [known, found] = [KNOWN_FIRMWARE, self.firmware].map(|[major, minor, _]| (major, minor));
        let (version, (major, minor)) = (self.version(), known);
        match found.cmp(&known) {
            Ordering::Equal => None,
            Ordering::Greater => Some(format!(
                "firmware {version} is newer than this program knows ({major}.{minor}): update this program"
            )),
            Ordering::Less => Some(format!(
                "firmware {version} is older than {major}.{minor}: flash the board with the newer firmware"
            )),
        }
    }
}

impl<P: Read + Write> Line<P> {
    /// Finds out who is at the other end; `wanted` is the unit that it has to be, if that matters.
    ///
    /// A board that is reset when its port is opened says `Hello` by itself. Another one is asked at once: the reset one
    /// does not hear that, since it waits 65 ms for its clock, and its bootloader is not disturbed.
    ///
    /// # Errors
    ///
    /// [`Error::Silent`], [`Error::NoFrame`], [`Error::FormatVersion`], [`Error::WrongUnit`], [`Error::NoAnswer`] and
    /// those of [`Line::event`].
    pub fn greet(&mut self, wanted: Option<Unit>, patience: Patience) -> Result<Greeting, Error> {
        let (begun, before) = (Instant::now(), self.counts());
        let mut greeting = None;
        for question in 0..=patience.questions {
            self.send(Command::Hello)?;
            let limit = if question == 0 { patience.reset } else { patience.answer };
            greeting = self.hello(limit)?;
            if greeting.is_some() {
                break;
            }
        }
        let port = self.name.clone();
        let Some(greeting) = greeting else {
            let counts = self.counts();
            let bytes = counts.bytes - before.bytes;
            return Err(if bytes == 0 {
                Error::Silent { port, waited_s: begun.elapsed().as_secs_f64() }
            } else if counts.frames == before.frames {
                Error::NoFrame { port, bytes, baud: self.baud }
            } else {
                Error::NoAnswer { port, command: command_name(Command::Hello) }
            });
        };
        // What came before the greeting is the noise of opening, unless it is a run that goes on.
        self.events.retain(|event| matches!(event, Event::Began { .. } | Event::Edges(_) | Event::Ended(_)));
        match wanted {
            Some(wanted) if wanted != greeting.unit => Err(Error::WrongUnit { port, found: greeting.unit, wanted }),
            _ => Ok(greeting),
        }
    }

    fn hello(&mut self, limit: Duration) -> Result<Option<Greeting>, Error> {
        let name = self.name.clone();
        let answer = self.wait(self.events.len(), limit, |event| match *event {
            Event::Message(frame) => match frame.message {
                Report::Hello { unit, firmware, tick_hz, .. } if tick_hz > 0 => {
                    Some(Ok(Greeting { unit, firmware, tick_hz }))
                }
                _ => None,
            },
            // Its checksum is right, so it is no damage.
            Event::Damaged(ProtoError::Version(found)) => Some(Err(Error::FormatVersion { port: name.clone(), found })),
            _ => None,
        })?;
        Ok(answer.map(|(greeting, _)| greeting))
    }
}
