//! `builtin_interfaces/msg/Time` and `std_msgs/msg/Header`.

use crate::Result;
use crate::cdr::{Reader, Writer};

const NANOSECONDS: i64 = 1_000_000_000;

/// A moment: seconds and nanoseconds since the epoch of the clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Time {
    /// Whole seconds.
    pub sec: i32,
    /// Nanoseconds within the second.
    pub nanosec: u32,
}

impl Time {
    /// The moment that many nanoseconds after the epoch; the nearest one that can be told.
    pub fn from_nanoseconds(nanoseconds: i64) -> Self {
        let sec = nanoseconds.div_euclid(NANOSECONDS).clamp(i32::MIN.into(), i32::MAX.into());
        Self { sec: sec as i32, nanosec: nanoseconds.rem_euclid(NANOSECONDS) as u32 }
    }

    /// Nanoseconds since the epoch.
    pub fn nanoseconds(self) -> i64 {
        i64::from(self.sec) * NANOSECONDS + i64::from(self.nanosec)
    }

    pub(super) fn read(reader: &mut Reader<'_>) -> Result<Self> {
        Ok(Self { sec: reader.i32()?, nanosec: reader.u32()? })
    }

    pub(super) fn write(self, writer: &mut Writer) {
        writer.i32(self.sec);
        writer.u32(self.nanosec);
    }
}

/// When and in which frame something was seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Header<'a> {
    /// When; the epoch itself if nobody says.
    pub stamp: Time,
    /// The frame of coordinates.
    pub frame_id: &'a str,
}

impl<'a> Header<'a> {
    pub(super) fn read(reader: &mut Reader<'a>) -> Result<Self> {
        Ok(Self { stamp: Time::read(reader)?, frame_id: reader.string()? })
    }

    pub(super) fn write(&self, writer: &mut Writer) {
        self.stamp.write(writer);
        writer.string(self.frame_id);
    }
}
