//! Runs from the bytes of a serial line, without any input or output of its own.
//!
//! [`Reader`] takes bytes as they come and tells [`Event`]s. A run is accepted as far as it is beyond doubt and no
//! further: its frames carry checksums and follow each other without a gap in their sequence numbers, its edges follow
//! each other without a gap in their indices, begin with the one that triggered the camera, alternate between tooth and
//! slit and go forward in time, and its end tells as many as were received. At the first exception the run ends with
//! [`End::Missing`](crate::run::End::Missing) and a reason, and keeps what came before; what still comes of it is told as
//! [`Event::Stray`] and belongs to no run.
//!
//! What cannot be noticed: damage that leaves the checksum right (one damaged frame in 2^32), and that exactly 256 frames
//! or a multiple of it are lost between two runs of one number.

mod assembly;
mod missing;

use slider_proto::{Decoder, EdgeBatch, Frame, ProtoError, Report, TICK_HZ};

pub use assembly::Ended;
pub(crate) use assembly::{Assembly, ToldEnd};
pub use missing::Missing;

/// What happened on the line.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Event {
    /// Bytes that are no frame of this format.
    Damaged(ProtoError),
    /// The sequence numbers jump by so many, modulo 256.
    Lost(u8),
    /// The device began anew; bits of its cause as in [`Report::Hello`], which follows as a message.
    Reset(u8),
    /// A message that is not part of a run.
    Message(Frame<Report>),
    /// The first tooth came.
    Began {
        /// Number of the run.
        run: u16,
        /// Time of the first edge.
        tick: u32,
        /// Ticks a second.
        tick_hz: u32,
    },
    /// Edges were accepted, at least one.
    Edges(EdgeBatch),
    /// A run is over.
    Ended(Ended),
    /// Part of a run that is not open, or that does not follow from what was received of it.
    Stray(Report),
}

/// What was received so far.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Bytes.
    pub bytes: u64,
    /// Good frames.
    pub frames: u64,
    /// Pieces that are no frame.
    pub damaged: u64,
    /// Jumps of the sequence numbers.
    pub gaps: u64,
    /// Edges accepted.
    pub edges: u64,
}

/// Reads a stream of bytes.
///
/// ```
/// use slider_host::reader::{Event, Reader};
/// use slider_proto::{Edge, EdgeBatch, EndReason, Level, MAX_FRAME, Report, encode};
/// let mut batch = EdgeBatch::new(7, 0);
/// for (tick, level) in [(100, Level::Low), (400, Level::High)] {
///     batch.push(Edge { tick, level, late: false }).unwrap();
/// }
/// let end = Report::RunEnd { run: 7, edges: 2, late: 0, lost: 0, reason: EndReason::Quiet };
/// let mut reader = Reader::default();
/// let mut runs = Vec::new();
/// for (sequence, report) in [Report::RunStart { run: 7, tick: 100 }, Report::Edges(batch), end].iter().enumerate() {
///     reader.push(encode(report, sequence as u8, &mut [0; MAX_FRAME]), |event| {
///         if let Event::Ended(ended) = event {
///             runs.push(ended.run);
///         }
///     });
/// }
/// assert!(runs[0].is_complete() && runs[0].edges.len() == 2);
/// ```
#[derive(Debug)]
pub struct Reader {
    decoder: Decoder<Report>,
    tick_hz: u32,
    /// Whether a frame was received, so that a sequence number was expected.
    greeted: bool,
    run: Option<Assembly>,
    counts: Counts,
}

impl Default for Reader {
    fn default() -> Self {
        Self { decoder: Decoder::default(), tick_hz: TICK_HZ, greeted: false, run: None, counts: Counts::default() }
    }
}

impl Reader {
    /// Takes the next bytes and tells each event in order.
    pub fn push(&mut self, bytes: &[u8], mut tell: impl FnMut(Event)) {
        self.counts.bytes += bytes.len() as u64;
        for &byte in bytes {
            match self.decoder.push(byte) {
                None => {}
                Some(Ok(frame)) => self.frame(frame, &mut tell),
                Some(Err(error)) => self.damage(error, &mut tell),
            }
        }
    }

    /// Ends the run that is open, if any; the next byte may belong to another stream.
    pub fn close(&mut self, missing: Missing) -> Option<Ended> {
        self.decoder = Decoder::default();
        self.greeted = false;
        Some(self.run.take()?.without_end(missing))
    }

    /// Number of the run that is open.
    pub fn open_run(&self) -> Option<u16> {
        self.run.as_ref().map(Assembly::number)
    }

    /// What was received so far.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    fn end_open(&mut self, missing: Missing, tell: &mut impl FnMut(Event)) {
        if let Some(run) = self.run.take() {
            tell(Event::Ended(run.without_end(missing)));
        }
    }

    fn damage(&mut self, error: ProtoError, tell: &mut impl FnMut(Event)) {
        self.counts.damaged += 1;
        tell(Event::Damaged(error));
        // Of other damage, the next sequence number tells whether it cost a frame; this frame has used up its own.
        if error == ProtoError::Payload {
            self.end_open(Missing::Unreadable(error), tell);
        }
    }

    fn frame(&mut self, frame: Frame<Report>, tell: &mut impl FnMut(Event)) {
        self.counts.frames += 1;
        let first = !std::mem::replace(&mut self.greeted, true);
        if let Report::Hello { tick_hz, reset_cause, .. } = frame.message {
            // A reset sends number 0. In a run nobody asks for a Hello, so there it is a reset even when 0 was due.
            if frame.sequence == 0 && (first || frame.lost != 0 || self.run.is_some()) {
                self.end_open(Missing::Reset(reset_cause), tell);
                tell(Event::Reset(reset_cause));
            } else {
                self.gap(frame.lost, tell);
            }
            if tick_hz > 0 {
                self.tick_hz = tick_hz;
            }
            return tell(Event::Message(frame));
        }
        self.gap(frame.lost, tell);
        match frame.message {
            Report::RunStart { run, tick } => {
                self.end_open(Missing::OtherRun(run), tell);
                self.run = Some(Assembly::new(run, tick, self.tick_hz));
                tell(Event::Began { run, tick, tick_hz: self.tick_hz });
            }
            Report::Edges(ref batch) => self.batch(batch, tell),
            Report::RunEnd { run, edges, late, lost, reason } => match self.run.take() {
                Some(open) if open.number() == run => {
                    tell(Event::Ended(open.end(ToldEnd { reason, edges, late, lost })));
                }
                open => {
                    self.run = open;
                    self.end_open(Missing::OtherRun(run), tell);
                    tell(Event::Stray(frame.message));
                }
            },
            _ => tell(Event::Message(frame)),
        }
    }

    fn gap(&mut self, lost: u8, tell: &mut impl FnMut(Event)) {
        if lost != 0 {
            self.counts.gaps += 1;
            tell(Event::Lost(lost));
            self.end_open(Missing::Frames(lost), tell);
        }
    }

    fn batch(&mut self, batch: &EdgeBatch, tell: &mut impl FnMut(Event)) {
        let Some(open) = &mut self.run else {
            return tell(Event::Stray(Report::Edges(*batch)));
        };
        let (accepted, missing) = open.batch(batch);
        if !accepted.edges().is_empty() {
            self.counts.edges += accepted.edges().len() as u64;
            tell(Event::Edges(accepted));
        }
        if let Some(missing) = missing {
            self.end_open(missing, tell);
            tell(Event::Stray(Report::Edges(*batch)));
        }
    }
}

/// The cause of a reset in words, with what to do; bits as in [`Report::Hello`].
pub fn reset_cause(bits: u8) -> &'static str {
    // A watchdog or brown-out is the news, whatever else is set.
    match bits {
        0 => "cause unknown: the bootloader has cleared it",
        bits if bits & 8 != 0 => "by its watchdog: the firmware hung",
        bits if bits & 4 != 0 => "by low voltage: check its supply",
        bits if bits & 2 != 0 => "from outside: its button, or the port was opened",
        bits if bits & 1 != 0 => "by switching it on",
        _ => "cause unknown",
    }
}
