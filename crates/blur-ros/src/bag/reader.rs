//! Messages of MCAP files, one after the other.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;
use std::ops::ControlFlow;
use std::path::Path;

use mcap::records::op;
use mcap::{McapError, McapResult};

use super::content;
use super::records::records;
use crate::{Error, Result};

/// A message as it lies in a bag.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Message<'a> {
    /// Name of the topic.
    pub topic: &'a str,
    /// Name of its type in ROS 2.
    pub type_name: &'a str,
    /// When it was recorded, in nanoseconds.
    pub log_ns: i64,
    /// When it was published, in nanoseconds.
    pub publish_ns: i64,
    /// The message in CDR.
    pub data: &'a [u8],
}

struct Channel {
    topic: String,
    type_name: String,
}

/// Calls `take` for every message in CDR of one MCAP file, in the order of the file, until it breaks. Only one record is held
/// in memory, and a file without its end is read up to where it breaks off.
///
/// # Errors
/// [`Error::Read`], [`Error::NotABag`] and [`Error::Damaged`], after the messages before the damage.
pub fn read(path: &Path, mut take: impl FnMut(&Message<'_>) -> ControlFlow<()>) -> Result<()> {
    let file = File::open(path).map_err(|source| Error::Read { path: path.to_owned(), source })?;
    let mut channels = Channels::default();
    records(BufReader::new(file), |opcode, content| channels.record(opcode, content, &mut take)).map_err(|source| {
        let path = path.to_owned();
        match source {
            McapError::BadMagic => Error::NotABag { path },
            source => Error::Damaged { path, source },
        }
    })
}

/// The channels of a file with their types.
#[derive(Default)]
struct Channels {
    schemas: BTreeMap<u16, String>,
    channels: BTreeMap<u16, Channel>,
}

impl Channels {
    fn record(
        &mut self,
        opcode: u8,
        content: &[u8],
        take: &mut impl FnMut(&Message<'_>) -> ControlFlow<()>,
    ) -> McapResult<ControlFlow<()>> {
        match opcode {
            op::SCHEMA => {
                let schema = content::Schema::new(content)?;
                self.schemas.insert(schema.id, schema.name.to_owned());
            }
            op::CHANNEL => {
                let channel = content::Channel::new(content)?;
                // Other encodings are not of ROS 2.
                if channel.encoding == "cdr" {
                    let type_name = self.schemas.get(&channel.schema_id).cloned().unwrap_or_default();
                    self.channels.insert(channel.id, Channel { topic: channel.topic.to_owned(), type_name });
                }
            }
            op::MESSAGE => {
                let message = content::Message::new(content)?;
                if let Some(channel) = self.channels.get(&message.channel_id) {
                    return Ok(take(&Message {
                        topic: &channel.topic,
                        type_name: &channel.type_name,
                        log_ns: message.log_ns.try_into().unwrap_or(i64::MAX),
                        publish_ns: message.publish_ns.try_into().unwrap_or(i64::MAX),
                        data: message.data,
                    }));
                }
            }
            _ => {}
        }
        Ok(ControlFlow::Continue(()))
    }
}
