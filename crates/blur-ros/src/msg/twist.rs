//! `geometry_msgs/msg/TwistWithCovarianceStamped`.

use super::{Header, Message, MessageType};
use crate::Result;
use crate::cdr::{Reader, Writer};

/// A velocity with its covariance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwistWithCovarianceStamped<'a> {
    /// When, and the frame of the coordinates.
    pub header: Header<'a>,
    /// x, y, z in metres per second.
    pub linear: [f64; 3],
    /// About x, y, z in radians per second.
    pub angular: [f64; 3],
    /// Of linear x, y, z and angular x, y, z, row by row.
    pub covariance: [f64; 36],
}

impl<'a> Message<'a> for TwistWithCovarianceStamped<'a> {
    const TYPE: MessageType = MessageType {
        package: "geometry_msgs",
        name: "TwistWithCovarianceStamped",
        hash: "RIHS01_77b67434531e6529b7a0091357b186b6ebdb17fd9ffd3e0c7ce9d3fb11a44563",
        definition: include_str!("../../msg/TwistWithCovarianceStamped.msg"),
    };

    fn read(reader: &mut Reader<'a>) -> Result<Self> {
        Ok(Self {
            header: Header::read(reader)?,
            linear: reader.f64s()?,
            angular: reader.f64s()?,
            covariance: reader.f64s()?,
        })
    }

    fn write(&self, writer: &mut Writer) {
        self.header.write(writer);
        writer.f64s(&self.linear);
        writer.f64s(&self.angular);
        writer.f64s(&self.covariance);
    }
}
