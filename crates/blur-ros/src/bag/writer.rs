//! Bags of velocities and diagnostics.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use mcap::records::MessageHeader;
use mcap::{Compression, McapError, WriteOptions};

use super::{DIAGNOSTICS_TOPIC, TWIST_TOPIC};
use crate::cdr::ByteOrder;
use crate::msg::{DiagnosticArray, Message, MessageType, TwistWithCovarianceStamped};
use crate::{Error, Result};

/// What publishers of both topics offer, in the words of rosbag2: reliable, the last ten messages.
const QOS: &str = "- history: keep_last
  depth: 10
  reliability: reliable
  durability: volatile
  deadline:
    sec: 9223372036
    nsec: 854775807
  lifespan:
    sec: 9223372036
    nsec: 854775807
  liveliness: automatic
  liveliness_lease_duration:
    sec: 9223372036
    nsec: 854775807
  avoid_ros_namespace_conventions: false";

/// Writes an MCAP file as `rosbag2` does.
pub struct Writer {
    path: PathBuf,
    writer: mcap::Writer<BufWriter<File>>,
    twist_channel: u16,
    diagnostics_channel: u16,
    sequence: u32,
}

impl Writer {
    /// A new file, in place of an old one.
    ///
    /// # Errors
    /// [`Error::Write`] and [`Error::Mcap`].
    pub fn create(path: &Path) -> Result<Self> {
        let file = File::create(path).map_err(|source| Error::Write { path: path.to_owned(), source })?;
        let refused = |source| Error::Mcap { path: path.to_owned(), source };
        let mut writer = WriteOptions::new()
            .profile("ros2")
            .compression(Some(Compression::Zstd))
            // Messages are few and small: the threads of the compressor would cost more than they save.
            .compression_threads(0)
            .create(BufWriter::new(file))
            .map_err(refused)?;
        let mut channel = |topic: &str, kind: MessageType| -> std::result::Result<u16, McapError> {
            let schema = writer.add_schema(&kind.ros(), "ros2msg", kind.definition.as_bytes())?;
            let metadata = [("offered_qos_profiles", QOS), ("topic_type_hash", kind.hash)];
            let metadata = BTreeMap::from(metadata.map(|(key, value)| (key.to_owned(), value.to_owned())));
            writer.add_channel(schema, topic, "cdr", &metadata)
        };
        let twist_channel = channel(TWIST_TOPIC, TwistWithCovarianceStamped::TYPE).map_err(refused)?;
        let diagnostics_channel = channel(DIAGNOSTICS_TOPIC, DiagnosticArray::TYPE).map_err(refused)?;
        Ok(Self { path: path.to_owned(), writer, twist_channel, diagnostics_channel, sequence: 0 })
    }

    /// Writes a velocity that became known at a time in nanoseconds.
    ///
    /// # Errors
    /// [`Error::Mcap`].
    pub fn twist(&mut self, log_ns: i64, twist: &TwistWithCovarianceStamped<'_>) -> Result<()> {
        self.write(self.twist_channel, log_ns, &twist.to_cdr(ByteOrder::Little))
    }

    /// Writes diagnostics that became known at a time in nanoseconds.
    ///
    /// # Errors
    /// [`Error::Mcap`].
    pub fn diagnostics(&mut self, log_ns: i64, diagnostics: &DiagnosticArray<'_>) -> Result<()> {
        self.write(self.diagnostics_channel, log_ns, &diagnostics.to_cdr(ByteOrder::Little))
    }

    /// Writes the index and closes the file.
    ///
    /// # Errors
    /// [`Error::Mcap`].
    pub fn finish(mut self) -> Result<()> {
        let Self { path, writer, .. } = &mut self;
        writer.finish().map(drop).map_err(|source| Error::Mcap { path: path.clone(), source })
    }

    fn write(&mut self, channel_id: u16, log_ns: i64, data: &[u8]) -> Result<()> {
        let time = log_ns.max(0).unsigned_abs();
        self.sequence = self.sequence.wrapping_add(1);
        let header = MessageHeader { channel_id, sequence: self.sequence, log_time: time, publish_time: time };
        let written = self.writer.write_to_known_channel(&header, data);
        written.map_err(|source| Error::Mcap { path: self.path.clone(), source })
    }
}
