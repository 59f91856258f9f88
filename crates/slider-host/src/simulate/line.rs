//! The board's serial line as a terminal of the host.

use std::fs::File;
use std::io::{self, ErrorKind, Read, Write};

use rustix::fs::{OFlags, fcntl_getfl, fcntl_setfl};
use rustix::io::ioctl_fionread;
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, ioctl_tiocnxcl, tcgetattr, tcsetattr};

/// A pseudo-terminal whose other end any program may open like a board's port.
///
/// As on a real line nothing waits for the other side: what nobody reads is lost once the system's buffer is full.
#[derive(Debug)]
pub(super) struct Line {
    controller: File,
    /// Held open so that hosts may come and go.
    terminal: File,
    path: String,
}

impl Line {
    /// Opens a pair; raw, so that bytes pass as they are.
    pub(super) fn open() -> io::Result<Self> {
        let controller = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY)?;
        grantpt(&controller)?;
        unlockpt(&controller)?;
        let path = ptsname(&controller, Vec::new())?.to_string_lossy().into_owned();
        let terminal = File::options().read(true).write(true).open(&path)?;
        let mut settings = tcgetattr(&terminal)?;
        settings.make_raw();
        tcsetattr(&terminal, OptionalActions::Now, &settings)?;
        let flags = fcntl_getfl(&controller)?;
        fcntl_setfl(&controller, flags | OFlags::NONBLOCK)?;
        Ok(Self { controller: controller.into(), terminal, path })
    }

    /// What the host opens.
    pub(super) fn path(&self) -> &str {
        &self.path
    }

    /// What the host has written since the last call.
    pub(super) fn read(&mut self) -> io::Result<Vec<u8>> {
        // A host that opened the line for itself alone and was killed leaves it so; the next one must get in.
        ioctl_tiocnxcl(&self.terminal)?;
        let mut bytes = Vec::new();
        let mut part = [0; 1024];
        loop {
            match self.controller.read(&mut part) {
                Ok(0) => return Ok(bytes),
                Ok(length) => bytes.extend(part.iter().take(length)),
                Err(error) if error.kind() == ErrorKind::WouldBlock => return Ok(bytes),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
    }

    /// Writes to the host what the system's buffer takes.
    pub(super) fn write(&mut self, mut bytes: &[u8]) -> io::Result<()> {
        while !bytes.is_empty() {
            match self.controller.write(bytes) {
                Ok(length) => bytes = bytes.get(length..).unwrap_or_default(),
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Bytes that the host has not read yet.
    pub(super) fn unread(&self) -> io::Result<u64> {
        Ok(ioctl_fionread(&self.terminal)?)
    }
}
