//! The records of an MCAP file, as they stream in.
//!
//! After the specification at <https://mcap.dev/spec>: a record is an opcode, its length and its content; a chunk holds
//! records, compressed or not. Nothing is trusted that has not come: a length takes no memory before its bytes.

use std::io::{self, Read};
use std::ops::ControlFlow;

use mcap::records::op;
use mcap::{MAGIC, McapError, McapResult};

/// The longest record that is read.
const MAX_RECORD_BYTES: u64 = 1 << 28;
/// The longest name of a compression that is read.
const MAX_NAME_BYTES: u32 = 64;
/// Opcode and length.
const HEAD_BYTES: usize = 9;

/// Calls `take` with opcode and content of every record but chunks, whose records it gets instead, until it breaks.
///
/// # Errors
/// [`McapError::BadMagic`] for what is no MCAP file, others for one that is damaged or breaks off, after the records before.
pub(super) fn records(
    mut source: impl Read,
    mut take: impl FnMut(u8, &[u8]) -> McapResult<ControlFlow<()>>,
) -> McapResult<()> {
    let mut magic = [0; MAGIC.len()];
    if source.read_exact(&mut magic).is_err() || magic != MAGIC {
        return Err(McapError::BadMagic);
    }
    let mut content = Vec::new();
    while let Some((opcode, bytes)) = head(&mut source)? {
        let flow = match opcode {
            op::FOOTER => return Ok(()),
            op::CHUNK => chunk(&mut source.by_ref().take(bytes), &mut content, &mut take)?,
            _ => {
                read_content(&mut source, opcode, bytes, &mut content)?;
                take(opcode, &content)?
            }
        };
        if flow.is_break() {
            return Ok(());
        }
    }
    Err(McapError::UnexpectedEof)
}

/// The records of a chunk of which the opcode and the length have been read.
fn chunk(
    source: &mut impl Read,
    content: &mut Vec<u8>,
    take: &mut impl FnMut(u8, &[u8]) -> McapResult<ControlFlow<()>>,
) -> McapResult<ControlFlow<()>> {
    // The times of its first and last message are those of the messages.
    array::<16>(source)?;
    let size = u64::from_le_bytes(array(source)?);
    let saved = u32::from_le_bytes(array(source)?);
    let name_bytes = u32::from_le_bytes(array(source)?);
    if name_bytes > MAX_NAME_BYTES {
        return Err(McapError::UnsupportedCompression(format!("with a name of {name_bytes} bytes")));
    }
    let mut name = String::new();
    source.by_ref().take(name_bytes.into()).read_to_string(&mut name)?;
    let compressed_bytes = u64::from_le_bytes(array(source)?);
    let compressed = source.by_ref().take(compressed_bytes);
    let plain: Box<dyn Read + '_> = match name.as_str() {
        "" => Box::new(compressed),
        "lz4" => Box::new(lz4::Decoder::new(compressed)?),
        "zstd" => Box::new(zstd::stream::read::Decoder::new(compressed)?),
        _ => return Err(McapError::UnsupportedCompression(name)),
    };
    let flow = plain_records(plain.take(size), saved, content, take)?;
    // What follows the records in a chunk means nothing.
    io::copy(source, &mut io::sink())?;
    Ok(flow)
}

/// The records of a chunk without its compression, and with its checksum, for which 0 stands if there is none.
fn plain_records(
    plain: impl Read,
    saved: u32,
    content: &mut Vec<u8>,
    take: &mut impl FnMut(u8, &[u8]) -> McapResult<ControlFlow<()>>,
) -> McapResult<ControlFlow<()>> {
    let mut plain = Summed { inner: plain, sum: crc32fast::Hasher::new() };
    while let Some((opcode, bytes)) = head(&mut plain)? {
        read_content(&mut plain, opcode, bytes, content)?;
        if take(opcode, content)?.is_break() {
            return Ok(ControlFlow::Break(()));
        }
    }
    let calculated = plain.sum.finalize();
    if saved != 0 && saved != calculated {
        return Err(McapError::BadChunkCrc { saved, calculated });
    }
    Ok(ControlFlow::Continue(()))
}

/// Opcode and length of the next record; `None` at the end.
fn head(source: &mut impl Read) -> McapResult<Option<(u8, u64)>> {
    let mut head = Vec::with_capacity(HEAD_BYTES);
    source.by_ref().take(HEAD_BYTES as u64).read_to_end(&mut head)?;
    match *head {
        [] => Ok(None),
        [opcode, a, b, c, d, e, f, g, h] => Ok(Some((opcode, u64::from_le_bytes([a, b, c, d, e, f, g, h])))),
        _ => Err(McapError::UnexpectedEof),
    }
}

fn read_content(source: &mut impl Read, opcode: u8, bytes: u64, content: &mut Vec<u8>) -> McapResult<()> {
    if bytes > MAX_RECORD_BYTES {
        return Err(McapError::RecordTooLarge { opcode, len: bytes });
    }
    content.clear();
    let read = source.by_ref().take(bytes).read_to_end(content)?;
    if (read as u64) < bytes { Err(McapError::UnexpectedEof) } else { Ok(()) }
}

fn array<const N: usize>(source: &mut impl Read) -> McapResult<[u8; N]> {
    let mut bytes = [0; N];
    source.read_exact(&mut bytes)?;
    Ok(bytes)
}

/// A source whose bytes are summed up.
struct Summed<R> {
    inner: R,
    sum: crc32fast::Hasher,
}

impl<R: Read> Read for Summed<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.inner.read(buffer)?;
        self.sum.update(&buffer[..read]);
        Ok(read)
    }
}
