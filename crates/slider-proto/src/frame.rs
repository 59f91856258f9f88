//! Frames: COBS, version, sequence number, CRC-32.

use core::marker::PhantomData;

use crate::message::Message;
use crate::wire::{Reader, Writer};

/// Version of the format, the first byte of every frame.
pub const VERSION: u8 = 1;

/// Most bytes of a payload; the largest batch of edges takes 46.
pub const MAX_PAYLOAD: usize = 48;

/// Version, sequence number and kind.
const HEADER: usize = 3;
const CHECKSUM: usize = 4;
/// Most bytes of a body.
const MAX_BODY: usize = HEADER + MAX_PAYLOAD + CHECKSUM;

/// Most bytes of a frame on the wire: a body, one byte of COBS and the zero at the end.
pub const MAX_FRAME: usize = MAX_BODY + 2;

// Without a table: it would take a quarter of the microcontroller's memory.
const CRC: crc::Crc<u32, crc::NoTable> = crc::Crc::<u32, crc::NoTable>::new(&crc::CRC_32_ISO_HDLC);

/// What is wrong with received bytes. The bytes are gone; the next frame is read as usual.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ProtoError {
    /// Two ends of a frame with nothing between them.
    #[error("an empty frame: a zero byte was doubled or its frame was lost")]
    Empty,
    /// More bytes than any frame has without an end of frame.
    #[error("more than {MAX_FRAME} bytes without the end of a frame")]
    TooLong,
    /// The bytes are not a COBS encoding.
    #[error("the {0} bytes of a frame are not COBS: a byte was lost, added or changed")]
    Cobs(u8),
    /// Fewer bytes than header and checksum take.
    #[error("a frame of {0} bytes is shorter than header and checksum")]
    TooShort(u8),
    /// The checksum differs.
    #[error("checksum {found:#010x} where the bytes give {computed:#010x}: the frame was damaged")]
    Checksum {
        /// The checksum in the frame.
        found: u32,
        /// The checksum of its bytes.
        computed: u32,
    },
    /// Another version of the format.
    #[error("format version {0}, this program knows version {VERSION}: update the older side")]
    Version(u8),
    /// A kind of message that this version does not have.
    #[error("unknown kind of message {0}")]
    Kind(u8),
    /// The payload does not have the form that its kind asks for.
    #[error("the payload does not fit its kind of message")]
    Payload,
}

/// A message with what its frame told about the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Frame<M> {
    /// Sequence number of the sender.
    pub sequence: u8,
    /// Frames lost since the last good one, modulo 256: how far the sequence number is ahead of the expected one.
    pub lost: u8,
    /// The message.
    pub message: M,
}

/// Encodes one message with its `sequence` number into `buffer` and returns the bytes to send, the zero at the end
/// included.
///
/// ```
/// use slider_proto::{Command, Decoder, MAX_FRAME, encode};
/// let mut buffer = [0; MAX_FRAME];
/// let bytes = encode(&Command::Stop, 41, &mut buffer);
/// let mut decoder = Decoder::<Command>::default();
/// let frame = bytes.iter().find_map(|&byte| decoder.push(byte)).unwrap().unwrap();
/// assert_eq!((frame.message, frame.sequence), (Command::Stop, 41));
/// ```
pub fn encode<'a, M: Message>(message: &M, sequence: u8, buffer: &'a mut [u8; MAX_FRAME]) -> &'a [u8] {
    let mut body = [0; MAX_BODY];
    let mut writer = Writer::new(&mut body);
    writer.u8(VERSION);
    writer.u8(sequence);
    message.write(&mut writer);
    let checksum = CRC.checksum(writer.written().unwrap_or_default());
    writer.u32(checksum);
    // Both lengths are bounded by the constants above, which a test confirms with the largest message.
    let body = writer.written().unwrap_or_default();
    let length = cobs::try_encode(body, buffer.split_last_mut().map_or(&mut [], |(_, rest)| rest)).unwrap_or(0);
    if let Some(end) = buffer.get_mut(length) {
        *end = 0;
    }
    buffer.get(..=length).unwrap_or_default()
}

/// Finds frames in a stream of bytes.
#[derive(Debug, Clone)]
pub struct Decoder<M> {
    bytes: [u8; MAX_FRAME],
    length: usize,
    /// Whether an end of frame has been seen, so that what follows is the beginning of one.
    aligned: bool,
    expected: Option<u8>,
    message: PhantomData<M>,
}

impl<M> Default for Decoder<M> {
    fn default() -> Self {
        Self { bytes: [0; MAX_FRAME], length: 0, aligned: false, expected: None, message: PhantomData }
    }
}

impl<M: Message> Decoder<M> {
    /// Takes the next byte; at the end of a frame, returns what it held.
    ///
    /// A zero before anything else only marks the beginning of the stream. A frame cut or damaged is an error, and the
    /// frame after it is read as usual.
    pub fn push(&mut self, byte: u8) -> Option<Result<Frame<M>, ProtoError>> {
        if byte != 0 {
            if let Some(slot) = self.bytes.get_mut(self.length) {
                *slot = byte;
            }
            // One more than fits marks a frame that is too long.
            self.length = (self.length + 1).min(MAX_FRAME + 1);
            return None;
        }
        let length = core::mem::take(&mut self.length);
        let first = !core::mem::replace(&mut self.aligned, true);
        match length {
            0 if first => None,
            0 => Some(Err(ProtoError::Empty)),
            MAX_FRAME.. => Some(Err(ProtoError::TooLong)),
            _ => Some(self.decode(length)),
        }
    }

    fn decode(&mut self, length: usize) -> Result<Frame<M>, ProtoError> {
        let frame = self.bytes.get_mut(..length).unwrap_or_default();
        let length = cobs::decode_in_place(frame).map_err(|_| ProtoError::Cobs(length as u8))?;
        let body = self.bytes.get(..length).unwrap_or_default();
        let (content, checksum) = body.split_last_chunk::<CHECKSUM>().ok_or(ProtoError::TooShort(length as u8))?;
        let found = u32::from_le_bytes(*checksum);
        let computed = CRC.checksum(content);
        if found != computed {
            return Err(ProtoError::Checksum { found, computed });
        }
        let (&[version, sequence, kind], payload) =
            content.split_first_chunk::<HEADER>().ok_or(ProtoError::TooShort(length as u8))?;
        if version != VERSION {
            return Err(ProtoError::Version(version));
        }
        let lost = self.expected.map_or(0, |expected| sequence.wrapping_sub(expected));
        self.expected = Some(sequence.wrapping_add(1));
        let mut reader = Reader::new(payload);
        let message = M::read(kind, &mut reader)?;
        reader.finish()?;
        Ok(Frame { sequence, lost, message })
    }
}
