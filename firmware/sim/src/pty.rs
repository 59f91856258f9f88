//! The simulated serial line as a terminal of the host.

use crate::SimError;
use rustix::{
    fs::{OFlags, fcntl_getfl, fcntl_setfl},
    io::ioctl_fionread,
    pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt},
    termios::{OptionalActions, ioctl_tiocnxcl, tcgetattr, tcsetattr},
};
use std::{
    fs::File,
    io::{ErrorKind, Read, Write},
};

/// A pseudo-terminal whose other end a program of the host may open like a board's serial port.
///
/// As on a real line nothing waits for the other side: bytes that nobody reads are lost once the system's buffer (some
/// kilobytes) is full.
#[derive(Debug)]
pub struct Pty {
    controller: File,
    /// Held open so that the host may come and go.
    terminal: File,
    path: String,
}

impl Pty {
    /// Opens a pair; raw, so that bytes pass as they are.
    pub fn open() -> Result<Self, SimError> {
        let controller = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).map_err(std::io::Error::from)?;
        grantpt(&controller).map_err(std::io::Error::from)?;
        unlockpt(&controller).map_err(std::io::Error::from)?;
        let path = ptsname(&controller, Vec::new()).map_err(std::io::Error::from)?;
        let path = path.to_string_lossy().into_owned();
        let terminal = File::options().read(true).write(true).open(&path)?;
        let mut settings = tcgetattr(&terminal).map_err(std::io::Error::from)?;
        settings.make_raw();
        tcsetattr(&terminal, OptionalActions::Now, &settings).map_err(std::io::Error::from)?;
        let flags = fcntl_getfl(&controller).map_err(std::io::Error::from)?;
        fcntl_setfl(&controller, flags | OFlags::NONBLOCK).map_err(std::io::Error::from)?;
        Ok(Self { controller: controller.into(), terminal, path })
    }

    /// What the host opens, `/dev/pts/N`.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// What the host has written since the last call.
    pub fn read(&mut self) -> Result<Vec<u8>, SimError> {
        // A host that opened the line for itself alone leaves it so when it closes; the next one must get in.
        ioctl_tiocnxcl(&self.terminal).map_err(std::io::Error::from)?;
        let mut bytes = Vec::new();
        let mut part = [0; 1024];
        loop {
            match self.controller.read(&mut part) {
                Ok(0) => return Ok(bytes),
                Ok(n) => bytes.extend(&part[..n]),
                Err(error) if error.kind() == ErrorKind::WouldBlock => return Ok(bytes),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error.into()),
            }
        }
    }

    /// Writes to the host; says how many bytes were lost because nobody reads.
    pub fn write(&mut self, bytes: &[u8]) -> Result<usize, SimError> {
        let mut rest = bytes;
        while !rest.is_empty() {
            match self.controller.write(rest) {
                Ok(n) => rest = &rest[n..],
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error.into()),
            }
        }
        Ok(rest.len())
    }

    /// Bytes that the host has not read yet; they are lost when this is dropped.
    pub fn unread(&self) -> Result<u64, SimError> {
        Ok(ioctl_fionread(&self.terminal).map_err(std::io::Error::from)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_pass_both_ways_as_they_are() {
        let mut pty = Pty::open().unwrap();
        let all: Vec<u8> = (0..=255).collect();
        let mut host = File::options().read(true).write(true).open(pty.path()).unwrap();
        host.write_all(&all).unwrap();
        let mut read = Vec::new();
        while read.len() < 256 {
            read.extend(pty.read().unwrap());
        }
        assert_eq!(read, all);
        assert_eq!(pty.write(&all).unwrap(), 0);
        while pty.unread().unwrap() < 256 {}
        let mut back = [0; 256];
        host.read_exact(&mut back).unwrap();
        assert_eq!(back.as_slice(), all);
        assert_eq!(pty.unread().unwrap(), 0);
    }

    #[test]
    fn a_host_that_does_not_read_holds_nobody_up() {
        let mut pty = Pty::open().unwrap();
        let lost = pty.write(&vec![b'x'; 1 << 20]).unwrap();
        assert!(lost > 0);
    }
}
