//! Results on standard output, everything else on standard error.

use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use serde::Serialize;
use slider_host::Error;
use slider_host::live::Event;

use super::live::View;

/// Where results and messages go.
#[derive(Default)]
pub(crate) struct Output {
    /// One JSON object a line instead of text.
    pub(crate) json: bool,
    /// Set when nobody reads the results any more, or by a signal.
    pub(crate) stop: Arc<AtomicBool>,
    /// A view that has the terminal: messages go there, and results are its own.
    pub(crate) view: Option<View>,
}

impl Output {
    /// Writes a result.
    pub(crate) fn result(&self, text: &str, json: &impl Serialize) -> Result<(), Error> {
        if self.view.is_some() {
            return Ok(());
        }
        let written = if self.json {
            serde_json::to_string(json).map_err(io::Error::from).and_then(|line| write_line(&line))
        } else {
            write_line(text)
        };
        match written {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => {
                // The reader has seen enough, as in `slider listen ... | head -1`.
                self.stop.store(true, Ordering::Relaxed);
                Ok(())
            }
            Err(source) => Err(Error::File { path: PathBuf::from("standard output"), source }),
            Ok(()) => Ok(()),
        }
    }

    /// Writes a message.
    pub(crate) fn tell(&self, message: &str) {
        if let Some(view) = &self.view {
            view.show(Event::Note(message.to_owned()));
            return;
        }
        // A closed standard error leaves nobody to tell.
        let _ = writeln!(io::stderr(), "slider: {message}");
    }

    /// Whether to end.
    pub(crate) fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

fn write_line(line: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    writeln!(out, "{line}")?;
    out.flush()
}
