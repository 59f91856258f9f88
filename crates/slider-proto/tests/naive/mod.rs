//! A frame by the definitions of CRC-32 and COBS, for comparison; it shares nothing with the crate.

/// CRC-32 (IEEE 802.3, clause 3.2.9): the remainder of the polynomial division, bit by bit, low bit of each byte first,
/// with the first 32 bits and the remainder complemented.
fn crc32(bytes: &[u8]) -> u32 {
    let mut remainder = !0_u32;
    for byte in bytes {
        for bit in 0..8 {
            let carry = (remainder & 1) as u8 ^ (byte >> bit & 1);
            remainder >>= 1;
            if carry == 1 {
                remainder ^= 0xedb8_8320;
            }
        }
    }
    !remainder
}

/// The frame with this version, sequence number, kind and payload.
///
/// COBS (Cheshire and Baker 1999): each run of bytes up to a zero, or up to the end, is preceded by its length plus one,
/// and the zeros are left out. Runs of 254 bytes, which are treated otherwise, do not fit into a frame.
pub(crate) fn frame(content: &[u8]) -> Vec<u8> {
    let mut body = content.to_vec();
    body.extend(crc32(content).to_le_bytes());
    let mut bytes = Vec::new();
    for run in body.split(|&byte| byte == 0) {
        assert!(run.len() < 254, "no frame is so long");
        bytes.push(run.len() as u8 + 1);
        bytes.extend(run);
    }
    bytes.push(0);
    bytes
}
