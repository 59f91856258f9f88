//! What any bytes have to bear; shared by the fuzz target and `tests/fuzz_seed.rs`.

#[path = "../tests/naive/mod.rs"]
pub(crate) mod naive;

use slider_proto::{Command, Decoder, Frame, MAX_FRAME, MAX_PAYLOAD, Message, Report, encode};

/// Decodes `bytes` as a line of commands and as one of reports, and again as the content of an intact frame, which no
/// search would find: its checksum is in the way. Whatever is received, encoded again, is received again, in a frame
/// with one zero, at its end.
pub(crate) fn decode(bytes: &[u8]) {
    decode_as::<Command>(bytes);
    decode_as::<Report>(bytes);
    // Version, sequence number, kind and payload.
    if bytes.len() <= 3 + MAX_PAYLOAD {
        let frame = naive::frame(bytes);
        decode_as::<Command>(&frame);
        decode_as::<Report>(&frame);
    }
}

fn decode_as<M: Message + Copy + PartialEq + std::fmt::Debug>(bytes: &[u8]) {
    let mut decoder = Decoder::<M>::default();
    for frame in bytes.iter().filter_map(|&byte| decoder.push(byte)).flatten() {
        let mut buffer = [0; MAX_FRAME];
        let bytes = encode(&frame.message, frame.sequence, &mut buffer);
        assert_eq!(bytes.iter().position(|&byte| byte == 0), Some(bytes.len() - 1), "{frame:?}");
        let mut again = Decoder::<M>::default();
        let received = bytes.iter().find_map(|&byte| again.push(byte));
        assert_eq!(received, Some(Ok(Frame { lost: 0, ..frame })));
    }
}
