//! The messages of ROS 2 that are read and written here, and what identifies their types.

mod camera_info;
mod diagnostics;
mod header;
mod image;
mod twist;

pub use camera_info::{CameraInfo, RegionOfInterest};
pub use diagnostics::{DiagnosticArray, DiagnosticStatus, KeyValue, Level};
pub use header::{Header, Time};
pub use image::{CompressedImage, Image};
pub use twist::TwistWithCovarianceStamped;

use crate::Result;
use crate::cdr::{ByteOrder, Reader, Writer};

/// What identifies the type of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MessageType {
    /// The package that defines it.
    pub package: &'static str,
    /// Its name in the package.
    pub name: &'static str,
    /// Hash of its description (ROS enhancement proposal 2016).
    pub hash: &'static str,
    /// Its definition and those of all types in it, as bags hold them in the format `ros2msg`.
    pub definition: &'static str,
}

impl MessageType {
    /// The name in ROS 2, such as `sensor_msgs/msg/Image`.
    pub fn ros(&self) -> String {
        format!("{}/msg/{}", self.package, self.name)
    }

    /// The name on the wire, such as `sensor_msgs::msg::dds_::Image_`.
    pub fn dds(&self) -> String {
        format!("{}::msg::dds_::{}_", self.package, self.name)
    }

    /// Whether this is the type of a name in ROS 2.
    pub fn is(&self, ros: &str) -> bool {
        ros.strip_prefix(self.package).and_then(|rest| rest.strip_prefix("/msg/")) == Some(self.name)
    }
}

/// A message: its type and the order of its fields. Texts and bytes are borrowed from the message that was read.
pub trait Message<'a>: Sized {
    /// Its type.
    const TYPE: MessageType;

    /// Reads the fields.
    fn read(reader: &mut Reader<'a>) -> Result<Self>;

    /// Writes the fields.
    fn write(&self, writer: &mut Writer);

    /// The message in CDR of either order of bytes.
    ///
    /// # Errors
    /// [`Error::CdrEnd`](crate::Error::CdrEnd), [`Error::CdrRepresentation`](crate::Error::CdrRepresentation) and
    /// [`Error::CdrText`](crate::Error::CdrText).
    fn from_cdr(bytes: &'a [u8]) -> Result<Self> {
        Self::read(&mut Reader::new(bytes)?)
    }

    /// The message as CDR.
    fn to_cdr(&self, order: ByteOrder) -> Vec<u8> {
        let mut writer = Writer::new(order);
        self.write(&mut writer);
        writer.into_bytes()
    }
}
