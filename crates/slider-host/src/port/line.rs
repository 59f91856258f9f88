//! An open line.

use std::collections::VecDeque;
use std::io::{ErrorKind, Read, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use serialport::SerialPort;
use slider_proto::{Command, MAX_FRAME, Refusal, Report, encode};

use crate::Error;
use crate::reader::{Counts, Ended, Event, Missing, Reader};

/// How long an answer is awaited before the command is sent once more.
const ANSWER: Duration = Duration::from_secs(1);
/// How often a command is sent.
const ATTEMPTS: u32 = 3;

/// A line to a board through a port of this computer.
pub type SerialLine = Line<Box<dyn SerialPort>>;

/// A line to a board.
///
/// Whatever comes while an answer is awaited is kept, and [`Line::event`] tells it later in its order.
#[derive(Debug)]
pub struct Line<P> {
    port: P,
    pub(super) name: String,
    pub(super) baud: u32,
    reader: Reader,
    pub(super) events: VecDeque<Event>,
    sequence: u8,
    /// Whether a zero was sent, which ends what the board may have heard before.
    aligned: bool,
    stop: Option<Arc<AtomicBool>>,
}

impl SerialLine {
    /// Opens the port `name` for this program alone, with 8 data bits, no parity and one stop bit.
    pub fn open(name: &str, baud: u32) -> Result<Self, Error> {
        Ok(Self::new(super::open(name, baud)?, name, baud))
    }
}

impl<P: Read + Write> Line<P> {
    /// A line through `port`, whose reads time out after a while. Its `name` and `baud` are for messages.
    pub fn new(port: P, name: &str, baud: u32) -> Self {
        Self {
            port,
            name: name.to_owned(),
            baud,
            reader: Reader::default(),
            events: VecDeque::new(),
            sequence: 0,
            aligned: false,
            stop: None,
        }
    }

    /// Once `stop` is set, whatever waits ends with [`Error::Stopped`].
    pub fn stop_on(&mut self, stop: Arc<AtomicBool>) {
        self.stop = Some(stop);
    }

    /// What happened next; `None` if nothing did for as long as a read waits.
    ///
    /// # Errors
    ///
    /// [`Error::LineLost`] when the line is gone, [`Error::Stopped`]; everything received before has been told then.
    pub fn event(&mut self) -> Result<Option<Event>, Error> {
        if self.events.is_empty() {
            self.pump()?;
        }
        Ok(self.events.pop_front())
    }

    /// What has been received and not yet told, without waiting for more.
    pub fn received(&mut self) -> Option<Event> {
        self.events.pop_front()
    }

    /// Ends the run that is open, if any.
    pub fn close(&mut self, missing: Missing) -> Option<Ended> {
        self.reader.close(missing)
    }

    /// Number of the run that is open.
    pub fn open_run(&self) -> Option<u16> {
        self.reader.open_run()
    }

    /// What was received so far.
    pub fn counts(&self) -> Counts {
        self.reader.counts()
    }

    /// Sends a command and returns its sequence number, which is never 0: that is the number of a garbled command.
    pub fn send(&mut self, command: Command) -> Result<u8, Error> {
        self.sequence = self.sequence.checked_add(1).unwrap_or(1);
        let mut buffer = [0; MAX_FRAME];
        let frame = encode(&command, self.sequence, &mut buffer);
        let mut bytes = Vec::with_capacity(frame.len() + 1);
        if !std::mem::replace(&mut self.aligned, true) {
            bytes.push(0);
        }
        bytes.extend_from_slice(frame);
        self.port.write_all(&bytes).map_err(|error| self.lost(&error))?;
        Ok(self.sequence)
    }

    /// Sends a command and waits until it is accepted.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`], [`Error::NoAnswer`] after three attempts, [`Error::Reset`] if the board was reset meanwhile,
    /// and those of [`Line::event`].
    pub fn ask(&mut self, command: Command) -> Result<(), Error> {
        self.accepted(command).map(|_| ())
    }

    /// As [`Line::ask`]; returns the place in the queue of what came after the answer.
    fn accepted(&mut self, command: Command) -> Result<usize, Error> {
        let (name, what) = (self.name.clone(), command_name(command));
        for _ in 0..ATTEMPTS {
            let sent = self.send(command)?;
            let accepted = self.wait(self.events.len(), ANSWER, |event| match *event {
                Event::Reset(cause) => Some(Err(Error::Reset { port: name.clone(), cause })),
                Event::Message(frame) => match frame.message {
                    Report::Ack { sequence } if sequence == sent => Some(Ok(())),
                    // Another attempt will do.
                    Report::Nak { sequence: 0, reason: Refusal::Garbled } => None,
                    Report::Nak { sequence, reason } if sequence == sent => {
                        Some(Err(Error::Refused { port: name.clone(), command: what, reason }))
                    }
                    _ => None,
                },
                _ => None,
            })?;
            if let Some(((), place)) = accepted {
                return Ok(place);
            }
        }
        Err(Error::NoAnswer { port: name, command: what })
    }

    /// Sends a command and waits, once it is accepted, for the report that `pick` chooses, at most `limit`.
    pub fn answer<T>(
        &mut self,
        command: Command,
        limit: Duration,
        mut pick: impl FnMut(&Report) -> Option<T>,
    ) -> Result<T, Error> {
        let place = self.accepted(command)?;
        let name = self.name.clone();
        let answer = self.wait(place, limit, |event| match event {
            Event::Message(frame) => pick(&frame.message).map(Ok),
            Event::Reset(cause) => Some(Err(Error::Reset { port: name.clone(), cause: *cause })),
            _ => None,
        })?;
        let (answer, _) = answer.ok_or(Error::NoAnswer { port: name, command: command_name(command) })?;
        Ok(answer)
    }

    /// Waits for an event of which `pick` makes something, from place `seen` of the queue on. Takes it out of the queue and
    /// returns what was made of it and the place where it was; `None` if it does not come within `limit`. If what was made
    /// is an error, the event stays.
    pub(super) fn wait<T>(
        &mut self,
        mut seen: usize,
        limit: Duration,
        mut pick: impl FnMut(&Event) -> Option<Result<T, Error>>,
    ) -> Result<Option<(T, usize)>, Error> {
        let end = Instant::now() + limit;
        loop {
            while let Some(event) = self.events.get(seen) {
                if let Some(made) = pick(event) {
                    let made = made?;
                    self.events.remove(seen);
                    return Ok(Some((made, seen)));
                }
                seen += 1;
            }
            if Instant::now() >= end {
                return Ok(None);
            }
            self.pump()?;
        }
    }

    /// Reads once.
    fn pump(&mut self) -> Result<(), Error> {
        if self.stop.as_ref().is_some_and(|stop| stop.load(Ordering::Relaxed)) {
            return Err(Error::Stopped);
        }
        let mut bytes = [0; 1024];
        match self.port.read(&mut bytes) {
            Ok(0) => Err(Error::LineLost { port: self.name.clone(), why: "the system has hung it up".to_owned() }),
            Ok(count) => {
                let events = &mut self.events;
                self.reader.push(bytes.get(..count).unwrap_or_default(), |event| events.push_back(event));
                Ok(())
            }
            Err(error)
                if matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::Interrupted | ErrorKind::WouldBlock) =>
            {
                Ok(())
            }
            Err(error) => Err(self.lost(&error)),
        }
    }

    fn lost(&self, error: &std::io::Error) -> Error {
        Error::LineLost { port: self.name.clone(), why: error.to_string() }
    }
}

/// A command in words.
pub(super) fn command_name(command: Command) -> &'static str {
    match command {
        Command::Hello => "hello",
        Command::Status => "status",
        Command::Arm(_) => "arm",
        Command::Stop => "stop",
        Command::SetPreset { .. } => "set preset",
        Command::Go { .. } => "go",
        Command::SelfTest => "self-test",
        _ => "the command",
    }
}
