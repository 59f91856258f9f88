//! `slider ports`.

use std::fmt::Write;

use slider_host::{Error, port};

use super::output::Output;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// One JSON object a line on standard output
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args, output: &mut Output) -> Result<bool, Error> {
    output.json = args.json;
    let ports = port::list()?;
    for listed in &ports {
        let mut text = format!("{:<16} {}", listed.port, listed.kind);
        for part in [&listed.usb_id, &listed.name].into_iter().flatten() {
            // Writing to a String cannot fail.
            let _ = write!(text, " {part}");
        }
        output.result(&text, listed)?;
    }
    if ports.is_empty() {
        output.tell("no serial ports: plug a board in, or bind its Bluetooth address (rfcomm bind 0 ADDRESS)");
    }
    Ok(true)
}
