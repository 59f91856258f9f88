//! `diagnostic_msgs/msg/DiagnosticArray`.

use std::borrow::Cow;

use super::{Header, Message, MessageType};
use crate::Result;
use crate::cdr::{Reader, Writer};

/// What parts of a robot say of themselves.
#[derive(Debug, Clone, PartialEq)]
pub struct DiagnosticArray<'a> {
    /// When.
    pub header: Header<'a>,
    /// One for each part.
    pub status: Vec<DiagnosticStatus<'a>>,
}

/// What one part says.
#[derive(Debug, Clone, PartialEq)]
pub struct DiagnosticStatus<'a> {
    /// How well it is.
    pub level: Level,
    /// Its name.
    pub name: Cow<'a, str>,
    /// How it is, in words.
    pub message: Cow<'a, str>,
    /// The hardware it belongs to.
    pub hardware_id: Cow<'a, str>,
    /// All that it knows.
    pub values: Vec<KeyValue<'a>>,
}

/// How well something is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// As it should be.
    Ok,
    /// To be taken with care.
    Warn,
    /// Not usable.
    Error,
    /// Not heard of for long.
    Stale,
}

/// One thing that is known.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeyValue<'a> {
    /// Its name.
    pub key: Cow<'a, str>,
    /// Its value.
    pub value: Cow<'a, str>,
}

/// Bytes that a status takes at least: the level and four lengths.
const MIN_STATUS_BYTES: usize = 17;
/// Bytes that a pair takes at least: two lengths.
const MIN_PAIR_BYTES: usize = 8;

impl<'a> Message<'a> for DiagnosticArray<'a> {
    const TYPE: MessageType = MessageType {
        package: "diagnostic_msgs",
        name: "DiagnosticArray",
        hash: "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e",
        definition: include_str!("../../msg/DiagnosticArray.msg"),
    };

    fn read(reader: &mut Reader<'a>) -> Result<Self> {
        Ok(Self { header: Header::read(reader)?, status: reader.sequence(MIN_STATUS_BYTES, DiagnosticStatus::read)? })
    }

    fn write(&self, writer: &mut Writer) {
        self.header.write(writer);
        writer.sequence(&self.status, |writer, status| status.write(writer));
    }
}

impl<'a> DiagnosticStatus<'a> {
    fn read(reader: &mut Reader<'a>) -> Result<Self> {
        Ok(Self {
            level: match reader.u8()? {
                0 => Level::Ok,
                1 => Level::Warn,
                2 => Level::Error,
                // Whatever it means, it is not to be relied on.
                _ => Level::Stale,
            },
            name: Cow::Borrowed(reader.string()?),
            message: Cow::Borrowed(reader.string()?),
            hardware_id: Cow::Borrowed(reader.string()?),
            values: reader.sequence(MIN_PAIR_BYTES, |reader| {
                Ok(KeyValue { key: Cow::Borrowed(reader.string()?), value: Cow::Borrowed(reader.string()?) })
            })?,
        })
    }

    fn write(&self, writer: &mut Writer) {
        writer.u8(self.level as u8);
        writer.string(&self.name);
        writer.string(&self.message);
        writer.string(&self.hardware_id);
        writer.sequence(&self.values, |writer, pair| {
            writer.string(&pair.key);
            writer.string(&pair.value);
        });
    }
}
