//! What all commands that talk to a board share.

use slider_host::Error;
use slider_host::port::{BAUD, Greeting, Line, Patience, SerialLine};
use slider_proto::Unit;

use super::output::Output;

/// Where the board is.
#[derive(clap::Args)]
pub(crate) struct PortArgs {
    /// Serial port of the board, for instance /dev/ttyUSB0 or /dev/rfcomm0; 'slider ports' lists them
    #[arg(long, value_name = "PORT")]
    pub(crate) port: String,

    /// Baud rate of the port
    #[arg(long, value_name = "RATE", default_value_t = BAUD, value_parser = clap::value_parser!(u32).range(1..))]
    baud: u32,
}

impl PortArgs {
    /// Opens the port and finds out who is there; `wanted` is the unit that it has to be, if that matters.
    pub(crate) fn open(&self, wanted: Option<Unit>, output: &Output) -> Result<(SerialLine, Greeting), Error> {
        let mut line = Line::open(&self.port, self.baud)?;
        line.stop_on(output.stop.clone());
        let greeting = line.greet(wanted, Patience::default())?;
        if let Some(note) = greeting.note() {
            output.tell(&format!("{}: {note}", self.port));
        }
        Ok((line, greeting))
    }
}
