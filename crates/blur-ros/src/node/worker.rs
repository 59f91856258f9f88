//! What the worker thread does with a frame.

use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, PoisonError};

use blur_core::estimate::Status;
use zenoh::bytes::ZBytes;

use super::Note;
use super::endpoint::Endpoint;
use crate::Result;
use crate::frame::{Frame, FrameKind};
use crate::msg::{CameraInfo, Header, Message};
use crate::observer::{Missing, Observation, Observer};
use crate::sequence::Counts;

/// A message that waits for the worker. Its payload is shared with the transport, not copied.
#[derive(Default)]
pub(super) struct Arrived {
    pub(super) payload: ZBytes,
    pub(super) received_ns: i64,
}

/// What the worker shares with the rest of the node.
#[derive(Default)]
pub(super) struct Shared {
    /// The latest `CameraInfo` that the worker has not seen.
    pub(super) info: Mutex<Option<ZBytes>>,
    /// Numbers of frames.
    pub(super) counts: Mutex<Counts>,
}

pub(super) struct Worker {
    pub(super) kind: FrameKind,
    pub(super) observer: Observer,
    pub(super) twist: Arc<Endpoint>,
    pub(super) diagnostics: Arc<Endpoint>,
    pub(super) shared: Arc<Shared>,
    pub(super) notes: Sender<Note>,
    /// What was missing last for a velocity: told when it changes.
    pub(super) missing: Option<Missing>,
    /// Whether a useless camera was told of.
    pub(super) has_told_info: bool,
}

impl Worker {
    /// Measures a frame and publishes what comes of it.
    pub(super) fn work(&mut self, arrived: &Arrived) {
        self.learn();
        let message = arrived.payload.to_bytes();
        let (header, observation) = match Frame::from_cdr(self.kind, &message) {
            Ok(frame) => (frame.header(), self.observer.observe(&frame, arrived.received_ns)),
            Err(error) => (Header::default(), self.observer.fail(error, arrived.received_ns)),
        };
        *self.shared.counts.lock().unwrap_or_else(PoisonError::into_inner) = self.observer.counts();
        if let Err(error) = self.publish(header, &observation) {
            self.note(Note::Failure(error));
        }
        let Observation { stamp, events, outcome } = observation;
        for event in events {
            self.note(Note::Event { stamp, event });
        }
        if let Some(Err(error)) = outcome {
            self.note(Note::Frame { stamp, error });
        }
    }

    /// Takes the camera that came last.
    fn learn(&mut self) {
        let info = self.shared.info.lock().unwrap_or_else(PoisonError::into_inner).take();
        let Some(info) = info else { return };
        let learned = CameraInfo::from_cdr(&info.to_bytes()).and_then(|info| self.observer.learn(&info));
        if let Err(error) = learned
            && !std::mem::replace(&mut self.has_told_info, true)
        {
            self.note(Note::Failure(error));
        }
    }

    fn publish(&mut self, header: Header<'_>, observation: &Observation) -> Result<()> {
        let Some(outcome) = &observation.outcome else { return Ok(()) };
        let (twist, diagnostics) = self.observer.messages(header, outcome, &observation.events);
        if let (None, Ok(record)) = (&twist, outcome)
            && !matches!(record.status, Status::NoMotionBlur(_))
        {
            let missing = self.observer.missing(record);
            if missing != self.missing
                && let Some(missing) = missing
            {
                self.note(Note::Missing(missing));
            }
            self.missing = missing;
        }
        if let Some(twist) = &twist {
            self.twist.send(twist)?;
        }
        self.diagnostics.send(&diagnostics)
    }

    /// Nobody listens any more when the node ends.
    fn note(&self, note: Note) {
        let _ = self.notes.send(note);
    }
}
