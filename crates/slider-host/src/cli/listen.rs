//! `slider listen`.

use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use slider_host::live::{self, Event as Shown, Request};
use slider_host::log::{Recorder, Source};
use slider_host::port::{Greeting, SerialLine};
use slider_host::reader::{Ended, Event, Missing, reset_cause};
use slider_host::{Error, error};
use slider_proto::{ArmSettings, Command, ProtoError, Refusal, Report, Unit};

use super::connect::PortArgs;
use super::evaluate::{Evaluation, EvaluationArgs};
use super::live::View;
use super::outcome;
use super::output::Output;
use super::page::Page;
use super::tell::{Received, report_run};

/// How often a board that is not ready is asked again, and a port that is gone looked for.
const AGAIN: Duration = Duration::from_millis(500);
/// How long the status may take.
const ANSWER: Duration = Duration::from_secs(2);

#[derive(clap::Args)]
#[expect(clippy::struct_excessive_bools, reason = "switches of a command line")]
pub(crate) struct Args {
    #[command(flatten)]
    port: PortArgs,

    #[command(flatten)]
    evaluation: EvaluationArgs,

    /// Save each run in this folder, with every edge as it comes
    #[arg(long, value_name = "DIR")]
    save: Option<PathBuf>,

    /// End after one run, with status 1 if it is incomplete or the line goes away
    #[arg(long)]
    once: bool,

    /// Arm the timer before each run (the default)
    #[arg(long, overrides_with = "no_arm")]
    arm: bool,

    /// Leave the timer as it is: something else arms it
    #[arg(long, overrides_with = "arm")]
    no_arm: bool,

    /// Length of the camera's trigger pulse in ms
    #[arg(long, value_name = "MS", default_value_t = 100, value_parser = clap::value_parser!(u16).range(1..))]
    trigger_ms: u16,

    /// A run ends when no edge came for so many ms
    #[arg(long, value_name = "MS", default_value_t = 2000, value_parser = clap::value_parser!(u16).range(1..))]
    quiet_ms: u16,

    /// Show runs in the terminal as they come: q quits, a arms, s stops
    #[arg(long, conflicts_with = "json")]
    live: bool,

    /// One JSON object a run on standard output
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args, output: &mut Output) -> Result<bool, Error> {
    output.json = args.json;
    let evaluation = args.evaluation.read()?;
    for signal in [SIGINT, SIGTERM] {
        // The second time it ends the program at once.
        let registered = flag::register_conditional_shutdown(signal, 130, output.stop.clone())
            .and_then(|_| flag::register(signal, output.stop.clone()));
        registered.map_err(|source| Error::File { path: PathBuf::from("signals"), source })?;
    }
    if !args.live {
        return Listener::new(args, output, evaluation).listen();
    }
    let (shown, events) = mpsc::channel();
    let (requests, asked) = mpsc::channel();
    let stop = output.stop.clone();
    let shown = Output { json: false, stop: stop.clone(), view: Some(View::new(shown, asked, &evaluation.sheet)) };
    thread::scope(|scope| {
        // What the view is shown by belongs to the thread: when the listener ends, so do the events.
        let listener = scope.spawn(move || {
            let listened = Listener::new(args, &shown, evaluation).listen();
            if let Err(error) = &listened {
                // The user looks at the view, and standard error comes after it.
                shown.tell(&error.to_string());
            }
            listened
        });
        let viewed = live::run(&events, &requests);
        stop.store(true, Ordering::Relaxed);
        let listened = listener.join().unwrap_or(Ok(false));
        viewed.and(listened)
    })
}

struct Listener<'a> {
    args: &'a Args,
    output: &'a Output,
    evaluation: Evaluation,
    recorder: Option<Recorder>,
    page: Option<Page>,
    arm: bool,
    /// Number of the next run, once it is known.
    next_run: Option<u16>,
    armed: bool,
    /// The last reason why the timer could not be armed, which is told once.
    told: Option<Refusal>,
}

/// How a run or the listening ended.
enum Done {
    /// The command is done; whether all went well.
    Command(bool),
    /// The line went away.
    Lost,
}

impl<'a> Listener<'a> {
    fn new(args: &'a Args, output: &'a Output, evaluation: Evaluation) -> Self {
        let recorder = args.save.as_ref().map(|folder| Recorder::new(folder, Source::default()));
        let arm = args.arm || !args.no_arm;
        Self {
            args,
            output,
            evaluation,
            recorder,
            page: args.evaluation.page(),
            arm,
            next_run: None,
            armed: false,
            told: None,
        }
    }

    /// Serves the port, and waits for it if it goes away.
    fn listen(&mut self) -> Result<bool, Error> {
        let (mut line, greeting) = match self.args.port.open(Some(Unit::Timer), self.output) {
            Err(Error::Stopped) => return Ok(!self.args.once),
            opened => opened?,
        };
        self.begin(greeting);
        loop {
            match self.serve(&mut line)? {
                Done::Command(well) => return Ok(well),
                Done::Lost if self.args.once => return Ok(false),
                Done::Lost => {}
            }
            drop(line);
            line = match self.wait_for_port()? {
                Some(line) => line,
                None => return Ok(true),
            };
        }
    }

    fn begin(&mut self, greeting: Greeting) {
        let (port, unit, firmware) = (&self.args.port.port, error::unit_name(greeting.unit), greeting.version());
        self.output.tell(&format!("{port}: {unit}, firmware {firmware}"));
        if let Some(recorder) = &mut self.recorder {
            let sheet = Some(self.evaluation.sheet.name.clone());
            recorder.set_source(Source { port: port.clone(), unit: unit.to_owned(), firmware, sheet });
        }
        self.armed = false;
    }

    /// The line once it is back; `None` if the user does not want to wait.
    fn wait_for_port(&mut self) -> Result<Option<SerialLine>, Error> {
        self.output.tell(&format!("{}: waiting for it to come back; Ctrl-C ends", self.args.port.port));
        let mut told = String::new();
        while !self.output.stopped() {
            std::thread::sleep(AGAIN);
            match self.args.port.open(Some(Unit::Timer), self.output) {
                Ok((line, greeting)) => {
                    self.begin(greeting);
                    return Ok(Some(line));
                }
                Err(Error::Stopped) => break,
                Err(error @ (Error::WrongUnit { .. } | Error::FormatVersion { .. })) => return Err(error),
                Err(error) => {
                    let text = error.to_string();
                    if !matches!(error, Error::NoPort { .. }) && text != told {
                        self.output.tell(&text);
                        told = text;
                    }
                }
            }
        }
        Ok(None)
    }

    /// Takes runs until the line goes away or the command is done.
    fn serve(&mut self, line: &mut SerialLine) -> Result<Done, Error> {
        let mut next_try = Instant::now();
        loop {
            self.obey(line)?;
            let step = if self.arm && !self.armed && line.open_run().is_none() && Instant::now() >= next_try {
                next_try = Instant::now() + AGAIN;
                self.arm(line).map(|()| None)
            } else {
                line.event()
            };
            match step {
                Ok(Some(event)) => {
                    if let Some(well) = self.event(&event)? {
                        return Ok(Done::Command(well));
                    }
                }
                Ok(None) => {
                    if let Some(recorder) = &mut self.recorder {
                        recorder.sync_if_due()?;
                    }
                }
                // The reset is told as an event as well, in its turn.
                Err(Error::Reset { .. }) => {}
                Err(Error::Stopped) => {
                    let armed = self.armed;
                    let well = self.close(line, Missing::Stopped)?;
                    if armed {
                        // Without an answer, the timer stays armed until it is switched off.
                        let _ = line.send(Command::Stop);
                    }
                    return Ok(Done::Command(well.unwrap_or(!self.args.once)));
                }
                Err(error @ (Error::LineLost { .. } | Error::NoAnswer { .. })) => {
                    let well = self.close(line, Missing::Line)?;
                    self.output.tell(&error.to_string());
                    return Ok(if well == Some(true) && self.args.once { Done::Command(true) } else { Done::Lost });
                }
                Err(error) => return Err(error),
            }
        }
    }

    /// Does what the user of the view asks for.
    fn obey(&mut self, line: &mut SerialLine) -> Result<(), Error> {
        let Some(view) = &self.output.view else { return Ok(()) };
        while let Some(request) = view.request() {
            match request {
                Request::Quit => {
                    self.output.stop.store(true, Ordering::Relaxed);
                    return Ok(());
                }
                Request::Arm => (self.arm, self.armed) = (true, false),
                Request::Stop => {
                    self.arm = false;
                    line.ask(Command::Stop)?;
                }
            }
        }
        Ok(())
    }

    /// Tells what was received before the line went away, and ends the run that is open. Whether the first run that
    /// ended is complete.
    fn close(&mut self, line: &mut SerialLine, missing: Missing) -> Result<Option<bool>, Error> {
        let mut first = None;
        while let Some(event) = line.received() {
            let well = self.event(&event)?;
            first = first.or(well);
        }
        if let Some(ended) = line.close(missing) {
            let well = self.event(&Event::Ended(ended))?;
            first = first.or(well);
        }
        Ok(first)
    }

    /// Arms the timer for the next run, if it is ready.
    fn arm(&mut self, line: &mut SerialLine) -> Result<(), Error> {
        let run = match self.next_run {
            Some(run) => run,
            None => line.answer(Command::Status, ANSWER, |report| match *report {
                Report::Status { run, .. } => Some(run.wrapping_add(1)),
                _ => None,
            })?,
        };
        self.next_run = Some(run);
        let (trigger_ms, quiet_ms) = (self.args.trigger_ms, self.args.quiet_ms);
        match line.ask(Command::Arm(ArmSettings { run, trigger_ms, quiet_ms })) {
            Ok(()) => {
                self.armed = true;
                self.told = None;
                self.next_run = Some(run.wrapping_add(1));
                self.output.tell(&format!("armed for run {run}"));
                Ok(())
            }
            // A run of before goes on, or its trigger pulse.
            Err(Error::Refused { reason: Refusal::Busy, .. }) => Ok(()),
            Err(refused @ Error::Refused { reason: Refusal::SensorBlocked, .. }) => {
                if self.told.replace(Refusal::SensorBlocked).is_none() {
                    self.output.tell(&refused.to_string());
                }
                Ok(())
            }
            Err(error) => Err(error),
        }
    }

    /// Saves and tells what happened; whether all went well if the command is done.
    fn event(&mut self, event: &Event) -> Result<Option<bool>, Error> {
        if let Some(view) = &self.output.view {
            view.follow(event);
        }
        let mut saved = match &mut self.recorder {
            Some(recorder) => recorder.record(event)?,
            None => None,
        };
        match event {
            Event::Ended(Ended { run, missing }) => {
                self.armed = false;
                let file = saved.as_ref().map(|saved| saved.path().to_owned());
                let incomplete = missing.map(|missing| missing.to_string());
                let received = Received { run, incomplete, file: file.as_deref() };
                let fitted = report_run(&received, &self.evaluation, self.output)?;
                if let (Some(saved), Some(fitted)) = (&mut saved, &fitted) {
                    saved.result(&outcome::fields(fitted))?;
                }
                if let (Some(view), Some(fitted)) = (&self.output.view, &fitted) {
                    view.show(Shown::Outcome(Box::new(fitted.outcome.clone())));
                }
                if let (Some(page), Some(fitted)) = (&mut self.page, fitted) {
                    page.add(fitted, &self.evaluation)?;
                }
                return Ok(self.args.once.then(|| run.is_complete()));
            }
            Event::Began { run, .. } => self.tell(&format!("run {run} begins")),
            Event::Reset(cause) => {
                self.armed = false;
                self.tell(&format!("the board was reset ({})", reset_cause(*cause)));
            }
            Event::Lost(frames) => self.tell(&format!("{frames} frames were lost or came twice (modulo 256)")),
            // A zero too many is the beginning of a reset.
            Event::Damaged(ProtoError::Empty) => {}
            Event::Damaged(error) => self.tell(&error.to_string()),
            Event::Stray(Report::Edges(batch)) => {
                let (run, first, count) = (batch.run, batch.first_index, batch.edges().len());
                self.tell(&format!("run {run}: {count} edges from index {first} on belong to no run and are left out"));
            }
            Event::Stray(Report::RunEnd { run, edges, .. }) => {
                self.tell(&format!("run {run}: the timer says that it had {edges} edges"));
            }
            Event::Message(frame) if matches!(frame.message, Report::LimitHit { .. }) => {
                self.tell("the end of travel was reached");
            }
            _ => {}
        }
        Ok(None)
    }

    fn tell(&self, message: &str) {
        self.output.tell(&format!("{}: {message}", self.args.port.port));
    }
}
