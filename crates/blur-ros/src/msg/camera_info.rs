//! `sensor_msgs/msg/CameraInfo`.

use super::{Header, Message, MessageType};
use crate::Result;
use crate::cdr::{Reader, Writer};

/// The calibration of a camera.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CameraInfo<'a> {
    /// Stamp and optical frame of the pictures.
    pub header: Header<'a>,
    /// Rows of a whole picture.
    pub height: u32,
    /// Columns of a whole picture.
    pub width: u32,
    /// Name of the model of the lens, such as `plumb_bob`.
    pub distortion_model: &'a str,
    /// Its coefficients.
    pub d: Vec<f64>,
    /// Camera matrix of the pictures as taken, row by row.
    pub k: [f64; 9],
    /// Rotation of rectification, row by row.
    pub r: [f64; 9],
    /// Projection matrix of rectified pictures, row by row.
    pub p: [f64; 12],
    /// Columns of the sensor for each column of the picture; 0 stands for 1.
    pub binning_x: u32,
    /// Rows of the sensor for each row of the picture; 0 stands for 1.
    pub binning_y: u32,
    /// The part of the sensor that the picture shows.
    pub roi: RegionOfInterest,
}

/// A part of a sensor; all of it where width and height are 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RegionOfInterest {
    /// Its first column.
    pub x_offset: u32,
    /// Its first row.
    pub y_offset: u32,
    /// Its rows.
    pub height: u32,
    /// Its columns.
    pub width: u32,
    /// Whether rectified pictures show it alone.
    pub do_rectify: bool,
}

impl<'a> Message<'a> for CameraInfo<'a> {
    const TYPE: MessageType = MessageType {
        package: "sensor_msgs",
        name: "CameraInfo",
        hash: "RIHS01_b3dfd68ff46c9d56c80fd3bd4ed22c7a4ddce8c8348f2f59c299e73118e7e275",
        definition: include_str!("../../msg/CameraInfo.msg"),
    };

    fn read(reader: &mut Reader<'a>) -> Result<Self> {
        Ok(Self {
            header: Header::read(reader)?,
            height: reader.u32()?,
            width: reader.u32()?,
            distortion_model: reader.string()?,
            d: reader.sequence(size_of::<f64>(), Reader::f64)?,
            k: reader.f64s()?,
            r: reader.f64s()?,
            p: reader.f64s()?,
            binning_x: reader.u32()?,
            binning_y: reader.u32()?,
            roi: RegionOfInterest {
                x_offset: reader.u32()?,
                y_offset: reader.u32()?,
                height: reader.u32()?,
                width: reader.u32()?,
                do_rectify: reader.bool()?,
            },
        })
    }

    fn write(&self, writer: &mut Writer) {
        self.header.write(writer);
        writer.u32(self.height);
        writer.u32(self.width);
        writer.string(self.distortion_model);
        writer.sequence(&self.d, |writer, &value| writer.f64(value));
        writer.f64s(&self.k);
        writer.f64s(&self.r);
        writer.f64s(&self.p);
        writer.u32(self.binning_x);
        writer.u32(self.binning_y);
        writer.u32(self.roi.x_offset);
        writer.u32(self.roi.y_offset);
        writer.u32(self.roi.height);
        writer.u32(self.roi.width);
        writer.bool(self.roi.do_rectify);
    }
}
