//! The text on the drive's display.

use crate::drive::DriveUnit;
use crate::message::{Direction, DriveState};

/// Columns of the display.
pub const COLUMNS: usize = 16;

/// Its two rows.
pub type Text = [[u8; COLUMNS]; 2];

/// The text for the state of `drive`: `Preset 3  -> 51%` and what it is doing.
#[must_use]
pub fn text(drive: &DriveUnit) -> Text {
    let preset = drive.preset();
    let mut first = *b"Preset    ->   %";
    first[7] = b'0' + drive.index() % 10;
    if preset.direction == Direction::Reverse {
        first[10..12].copy_from_slice(b"<-");
    }
    // Rounded per cent of the duty.
    let percent = ((u16::from(preset.duty) * 100 + 127) / 255) as u8;
    if percent >= 100 {
        first[12] = b'1';
    }
    if percent >= 10 {
        first[13] = b'0' + percent / 10 % 10;
    }
    first[14] = b'0' + percent % 10;
    let second = match drive.state() {
        DriveState::Stopped => *b"stopped         ",
        DriveState::Starting => *b"starting        ",
        DriveState::Running => *b"running         ",
        DriveState::AtLimit => *b"STOP: at limit  ",
    };
    [first, second]
}
