//! Serial ports: which there are, how one is opened, and who answers.
//!
//! What can be wrong with a line is told by [`Error`] in one line that says what to do: no such port, no permission, port
//! in use, nothing received, bytes but no frame, frames of another version of the format, the other board.

mod greet;
mod line;

use std::time::Duration;

use serde::Serialize;
use serialport::{ErrorKind, SerialPort, SerialPortType};

use crate::Error;

pub use greet::{Greeting, KNOWN_FIRMWARE, Patience};
pub use line::{Line, SerialLine};

/// Baud rate of the boards.
pub const BAUD: u32 = 57_600;

/// The longest that one read waits, so that other things get their turn.
const READ_WAIT: Duration = Duration::from_millis(50);

/// A port of this computer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Listed {
    /// What to open, `/dev/ttyUSB0`.
    pub port: String,
    /// `usb`, `bluetooth`, `pci` or `other`.
    pub kind: &'static str,
    /// Vendor and product of a USB device, `1a86:7523`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub usb_id: Option<String>,
    /// What the USB device calls itself: manufacturer, product, serial number.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
}

/// The ports of this computer, sorted by name.
///
/// On Linux these are the devices of `/sys/class/tty` that stand for hardware: USB adapters and boards with their names,
/// bound Bluetooth ports (`rfcomm`), serial ports of the mainboard, whether something is plugged into them or not.
/// Pseudo-terminals are not listed, but can be opened.
pub fn list() -> Result<Vec<Listed>, Error> {
    // serialport panics where this folder is missing.
    if cfg!(target_os = "linux") && !std::path::Path::new("/sys/class/tty").is_dir() {
        return Ok(Vec::new());
    }
    let ports = serialport::available_ports()
        .map_err(|error| Error::Open { port: "list of ports".to_owned(), why: error.to_string() })?;
    let mut listed: Vec<Listed> = ports.into_iter().map(|info| describe(info.port_name, info.port_type)).collect();
    listed.sort_by(|one, other| one.port.cmp(&other.port));
    Ok(listed)
}

fn describe(port: String, kind: SerialPortType) -> Listed {
    match kind {
        SerialPortType::UsbPort(usb) => {
            let serial = usb.serial_number.map(|serial| format!("serial {serial}"));
            let names: Vec<String> = [usb.manufacturer, usb.product, serial].into_iter().flatten().collect();
            let name = if names.is_empty() { None } else { Some(names.join(", ")) };
            Listed { port, kind: "usb", usb_id: Some(format!("{:04x}:{:04x}", usb.vid, usb.pid)), name }
        }
        SerialPortType::BluetoothPort => Listed { port, kind: "bluetooth", usb_id: None, name: None },
        SerialPortType::PciPort => Listed { port, kind: "pci", usb_id: None, name: None },
        SerialPortType::Unknown => Listed { port, kind: "other", usb_id: None, name: None },
    }
}

/// Opens a port for this program alone, with 8 data bits, no parity and one stop bit.
fn open(port: &str, baud: u32) -> Result<Box<dyn SerialPort>, Error> {
    serialport::new(port, baud).timeout(READ_WAIT).open().map_err(|error| refused(port, &error))
}

/// Why a port could not be opened.
pub(crate) fn refused(port: &str, error: &serialport::Error) -> Error {
    let port = port.to_owned();
    match error.kind {
        ErrorKind::Io(std::io::ErrorKind::NotFound) => Error::NoPort { port },
        // Windows says so when another program has the port.
        ErrorKind::Io(std::io::ErrorKind::PermissionDenied) if cfg!(windows) => Error::Busy { port },
        ErrorKind::Io(std::io::ErrorKind::PermissionDenied) => Error::Permission { port },
        ErrorKind::NoDevice if cfg!(windows) => Error::NoPort { port },
        // EBUSY, or the lock of another program.
        ErrorKind::NoDevice => Error::Busy { port },
        _ => Error::Open { port, why: error.description.clone() },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(kind: ErrorKind) -> String {
        refused("/dev/ttyUSB0", &serialport::Error::new(kind, "what the system says")).to_string()
    }

    #[test]
    fn each_refusal_says_what_to_do() {
        assert!(line(ErrorKind::Io(std::io::ErrorKind::NotFound)).contains("no such port"));
        if cfg!(unix) {
            let denied = line(ErrorKind::Io(std::io::ErrorKind::PermissionDenied));
            assert!(denied.contains("permission denied") && denied.contains("dialout"), "{denied}");
            assert!(line(ErrorKind::NoDevice).contains("another program uses this port"));
        }
        assert!(line(ErrorKind::Unknown).contains("what the system says"));
    }

    #[test]
    fn usb_ports_are_listed_with_what_they_call_themselves() {
        let usb = serialport::UsbPortInfo {
            vid: 0x1a86,
            pid: 0x7523,
            serial_number: None,
            manufacturer: None,
            product: Some("USB Serial".to_owned()),
        };
        let listed = describe("/dev/ttyUSB0".to_owned(), SerialPortType::UsbPort(usb));
        assert_eq!((listed.usb_id.as_deref(), listed.name.as_deref()), (Some("1a86:7523"), Some("USB Serial")));
    }
}
