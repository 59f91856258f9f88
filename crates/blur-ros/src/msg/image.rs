//! `sensor_msgs/msg/Image` and `CompressedImage`.

use super::{Header, Message, MessageType};
use crate::Result;
use crate::cdr::{Reader, Writer};

/// A picture of stored samples.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image<'a> {
    /// When and in which optical frame it was taken.
    pub header: Header<'a>,
    /// Rows.
    pub height: u32,
    /// Columns.
    pub width: u32,
    /// What a pixel is made of, such as `mono8`.
    pub encoding: &'a str,
    /// Whether samples of more than one byte have the highest first.
    pub is_bigendian: bool,
    /// Bytes from one row to the next.
    pub step: u32,
    /// The samples, the top row first.
    pub data: &'a [u8],
}

impl<'a> Message<'a> for Image<'a> {
    const TYPE: MessageType = MessageType {
        package: "sensor_msgs",
        name: "Image",
        hash: "RIHS01_d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47",
        definition: include_str!("../../msg/Image.msg"),
    };

    fn read(reader: &mut Reader<'a>) -> Result<Self> {
        Ok(Self {
            header: Header::read(reader)?,
            height: reader.u32()?,
            width: reader.u32()?,
            encoding: reader.string()?,
            is_bigendian: reader.bool()?,
            step: reader.u32()?,
            data: reader.bytes()?,
        })
    }

    fn write(&self, writer: &mut Writer) {
        self.header.write(writer);
        writer.u32(self.height);
        writer.u32(self.width);
        writer.string(self.encoding);
        writer.bool(self.is_bigendian);
        writer.u32(self.step);
        writer.bytes(self.data);
    }
}

/// A picture as a PNG or JPEG file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CompressedImage<'a> {
    /// When and in which optical frame it was taken.
    pub header: Header<'a>,
    /// What the publisher calls the format; the content tells it too.
    pub format: &'a str,
    /// The file.
    pub data: &'a [u8],
}

impl<'a> Message<'a> for CompressedImage<'a> {
    const TYPE: MessageType = MessageType {
        package: "sensor_msgs",
        name: "CompressedImage",
        hash: "RIHS01_15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a",
        definition: include_str!("../../msg/CompressedImage.msg"),
    };

    fn read(reader: &mut Reader<'a>) -> Result<Self> {
        Ok(Self { header: Header::read(reader)?, format: reader.string()?, data: reader.bytes()? })
    }

    fn write(&self, writer: &mut Writer) {
        self.header.write(writer);
        writer.string(self.format);
        writer.bytes(self.data);
    }
}
