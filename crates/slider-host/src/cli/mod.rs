//! The command line: one file a command.

mod calibrate;
mod connect;
mod evaluate;
mod fit;
mod listen;
mod live;
mod outcome;
mod output;
mod page;
mod ports;
mod preset;
mod simulate;
mod status;
mod tell;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use slider_host::Error;

use output::Output;

/// Measures the motion of the slider: reads its encoder timer, saves every edge, fits x(t).
#[derive(Parser)]
#[command(name = "slider", version, after_long_help = GUIDE, max_term_width = 110)]
struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// List the serial ports of this computer
    Ports(ports::Args),
    /// Take runs: arm the timer, receive the edges of each pass, save and fit them
    Listen(listen::Args),
    /// Fit a saved run, or points of any instrument
    Fit(fit::Args),
    /// Make a sheet and budgets of readings of widths, times and accelerations
    Calibrate(Box<slider_host::calibrate::Options>),
    /// Be a slider without hardware, on a pseudo-terminal that `slider listen` reads like a port
    Simulate(Box<slider_host::simulate::Options>),
    /// Ask a board what it is doing
    Status(status::StatusArgs),
    /// End the run or stop the motor
    Stop(status::StopArgs),
    /// Let the timer measure its own reference signal
    Selftest(status::SelftestArgs),
    /// Set the drive's presets and move at one of them
    #[command(subcommand)]
    Preset(preset::Command),
}

const GUIDE: &str = "\
Output:
  Results on standard output, everything else on standard error. With --json
  there is one JSON object a line on standard output and nothing else.

Exit status:
  0  done
  1  failed; the reason is on standard error
  2  the command line is wrong

Examples:
  slider ports
  slider listen --port /dev/ttyUSB0 --save runs
  slider listen --port /dev/ttyUSB0 --sheet encoder5.toml --once --json
  slider preset set 3 --duty 129 --direction forward --port /dev/ttyUSB1
  slider preset go 3 --port /dev/ttyUSB1";

/// Runs the command and tells what is wrong.
pub(crate) fn main() -> ExitCode {
    let args = Args::parse();
    let mut output = Output::default();
    match run(args.command, &mut output) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            output.tell(&error.to_string());
            ExitCode::FAILURE
        }
    }
}

/// Whether all went well; a command that returns false has told why not.
fn run(command: Command, output: &mut Output) -> Result<bool, Error> {
    match command {
        Command::Ports(args) => ports::run(&args, output),
        Command::Listen(args) => listen::run(&args, output),
        Command::Fit(args) => fit::run(&args, output),
        Command::Calibrate(options) => calibrate::run(&options),
        Command::Simulate(options) => simulate::run(&options),
        Command::Status(args) => status::status(&args, output),
        Command::Stop(args) => status::stop(&args, output),
        Command::Selftest(args) => status::selftest(&args, output),
        Command::Preset(command) => preset::run(&command, output),
    }
}
