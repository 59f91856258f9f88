//! From a bag with pictures to one with their velocities.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use blur_core::estimate::Status;
use blur_core::record::Record;

use super::reader::{self, Message};
use super::writer::Writer;
use crate::camera::info_topic;
use crate::frame::{Frame, FrameKind};
use crate::msg::{CameraInfo, Header, Message as _, Time};
use crate::observer::{Missing, Observation, Observer, Options};
use crate::sequence::{Counts, Event};
use crate::{Error, Result};

/// What is to be measured in a bag.
#[derive(Debug, Clone)]
pub struct Task {
    /// The files of the bag.
    pub files: Vec<PathBuf>,
    /// The topic with the pictures.
    pub topic: String,
    /// The type of its messages.
    pub kind: FrameKind,
    /// The topic of the camera; `None`: the one beside the pictures.
    pub info_topic: Option<String>,
    /// How to measure.
    pub options: Options,
    /// Where velocities and diagnostics go.
    pub output: Option<PathBuf>,
}

/// One frame of a bag.
#[derive(Debug)]
pub struct FrameReport<'a> {
    /// Its stamp, or the time at which it was recorded if it has none.
    pub stamp: Time,
    /// Its record or why it has none; neither for a repeated frame.
    pub outcome: Option<&'a Result<Record>>,
    /// What is out of the ordinary.
    pub events: &'a [Event],
}

/// What came of a bag.
#[derive(Debug, Default)]
pub struct Summary {
    /// Numbers of frames.
    pub counts: Counts,
    /// Velocities written to the output.
    pub twists: u64,
    /// Why there is no velocity, where a frame with a blur had none.
    pub missing: Option<Missing>,
    /// Why a `CameraInfo` was of no use.
    pub info_error: Option<Error>,
    /// What ended the reading early.
    pub damage: Option<Error>,
}

/// Measures the frames of one topic in the order of the bag and reports each, until `report` breaks.
///
/// The camera is that of the latest `CameraInfo` before a frame; frames before the first one take that, since it is published
/// once (`transient_local`) or together with the first frame by many drivers.
///
/// # Errors
/// [`Error::Read`], [`Error::NotABag`], [`Error::Write`], [`Error::Mcap`] and [`Error::Overwrites`]. What a damaged file or a
/// frame is not good for stands in the summary and in the reports.
pub fn measure(task: &Task, report: impl FnMut(&FrameReport<'_>) -> ControlFlow<()>) -> Result<Summary> {
    let info_topic = task.info_topic.clone().unwrap_or_else(|| info_topic(&task.topic));
    let observer = Observer::new(task.options.clone(), &task.topic)?;
    let writer = task.output.as_deref().map(|path| create(path, &task.files)).transpose()?;
    let summary = Summary::default();
    let mut run = Run { task, info_topic, observer, writer, report, summary, failure: None, is_over: false };
    run.learn_first()?;
    for file in &task.files {
        match reader::read(file, |message| run.message(message)) {
            Ok(()) => {}
            Err(error @ Error::Damaged { .. }) => run.summary.damage = Some(error),
            Err(error) => return Err(error),
        }
        if let Some(failure) = run.failure.take() {
            return Err(failure);
        }
        if run.is_over {
            break;
        }
    }
    run.summary.counts = run.observer.counts();
    if let Some(writer) = run.writer {
        writer.finish()?;
    }
    Ok(run.summary)
}

/// The output, which must not be an input.
fn create(path: &Path, inputs: &[PathBuf]) -> Result<Writer> {
    let place = path.canonicalize().ok();
    if place.is_some() && inputs.iter().any(|input| input.canonicalize().ok() == place) {
        return Err(Error::Overwrites { path: path.to_owned() });
    }
    Writer::create(path)
}

struct Run<'t, R> {
    task: &'t Task,
    info_topic: String,
    observer: Observer,
    writer: Option<Writer>,
    report: R,
    summary: Summary,
    failure: Option<Error>,
    is_over: bool,
}

impl<R: FnMut(&FrameReport<'_>) -> ControlFlow<()>> Run<'_, R> {
    /// Takes the first usable camera of the bag.
    fn learn_first(&mut self) -> Result<()> {
        if !self.observer.wants_info() {
            return Ok(());
        }
        for file in &self.task.files {
            let mut is_known = false;
            let read = reader::read(file, |message| {
                is_known = self.learn(message);
                if is_known { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
            match read {
                // Damage is told when the frames are read.
                Ok(()) | Err(Error::Damaged { .. }) => {}
                Err(error) => return Err(error),
            }
            if is_known {
                break;
            }
        }
        Ok(())
    }

    fn message(&mut self, message: &Message<'_>) -> ControlFlow<()> {
        let flow = if message.topic == self.task.topic {
            self.frame(message)
        } else {
            self.learn(message);
            Ok(ControlFlow::Continue(()))
        };
        let flow = flow.unwrap_or_else(|error| {
            self.failure = Some(error);
            ControlFlow::Break(())
        });
        self.is_over = flow.is_break();
        flow
    }

    /// Whether the message was of use as a camera.
    fn learn(&mut self, message: &Message<'_>) -> bool {
        if message.topic != self.info_topic || !CameraInfo::TYPE.is(message.type_name) {
            return false;
        }
        match CameraInfo::from_cdr(message.data).and_then(|info| self.observer.learn(&info)) {
            Ok(()) => true,
            Err(error) => {
                self.summary.info_error.get_or_insert(error);
                false
            }
        }
    }

    fn frame(&mut self, message: &Message<'_>) -> Result<ControlFlow<()>> {
        let log_ns = message.log_ns;
        let (header, observation) = match Frame::from_cdr(self.task.kind, message.data) {
            Ok(frame) => {
                let observation = self.observer.observe(&frame, log_ns);
                // Velocities have the very stamp of their pictures, even where that is missing.
                (frame.header(), observation)
            }
            Err(error) => (Header::default(), self.observer.fail(error, log_ns)),
        };
        if let Some(outcome) = &observation.outcome {
            self.publish(header, log_ns, outcome, &observation.events)?;
        }
        let Observation { stamp, events, outcome } = &observation;
        Ok((self.report)(&FrameReport { stamp: *stamp, outcome: outcome.as_ref(), events }))
    }

    fn publish(&mut self, header: Header<'_>, log_ns: i64, outcome: &Result<Record>, events: &[Event]) -> Result<()> {
        let (twist, diagnostics) = self.observer.messages(header, outcome, events);
        if let (None, Ok(record)) = (&twist, outcome)
            && !matches!(record.status, Status::NoMotionBlur(_))
        {
            self.summary.missing = self.summary.missing.or(self.observer.missing(record));
        }
        let Some(writer) = &mut self.writer else { return Ok(()) };
        if let Some(twist) = &twist {
            writer.twist(log_ns, twist)?;
            self.summary.twists += 1;
        }
        writer.diagnostics(log_ns, &diagnostics)
    }
}
