//! A board's end of the serial line.

use std::collections::VecDeque;

use slider_proto::{Command, Decoder, Frame, MAX_FRAME, ProtoError, Report, encode};

/// Bytes on their way and the frames that they make; one byte passes each way in a turn of the main loop.
#[derive(Debug)]
pub(super) struct Wire {
    decoder: Decoder<Command>,
    sequence: u8,
    input: VecDeque<u8>,
    output: VecDeque<u8>,
}

impl Wire {
    /// The line of a board that has just been reset: a zero comes before its first frame.
    pub(super) fn new() -> Self {
        Self { decoder: Decoder::default(), sequence: 0, input: VecDeque::new(), output: VecDeque::from([0]) }
    }

    pub(super) fn receive(&mut self, bytes: &[u8]) {
        self.input.extend(bytes);
    }

    /// Whether no bytes are on their way.
    pub(super) fn is_idle(&self) -> bool {
        self.input.is_empty() && self.output.is_empty()
    }

    /// Whether everything has been sent.
    pub(super) fn is_free(&self) -> bool {
        self.output.is_empty()
    }

    /// The frame that the next received byte ends, if any.
    pub(super) fn command(&mut self) -> Option<Result<Frame<Command>, ProtoError>> {
        self.input.pop_front().and_then(|byte| self.decoder.push(byte))
    }

    pub(super) fn send(&mut self, report: &Report) {
        let mut buffer = [0; MAX_FRAME];
        self.output.extend(encode(report, self.sequence, &mut buffer));
        self.sequence = self.sequence.wrapping_add(1);
    }

    /// The next byte on the line.
    pub(super) fn next(&mut self) -> Option<u8> {
        self.output.pop_front()
    }
}
