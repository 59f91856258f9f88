//! `slider preset`.

use clap::{Subcommand, ValueEnum};
use slider_host::Error;
use slider_proto::drive::PRESETS;
use slider_proto::{Command as Ask, Direction, Preset, Unit};

use super::connect::PortArgs;
use super::output::Output;

#[derive(Subcommand)]
pub(crate) enum Command {
    /// Set a preset; motion in that preset ends
    ///
    /// It stays until the drive is reset, which opening a USB port does, also for the next command: over USB, use
    /// 'preset go N --duty DUTY'. Over Bluetooth it stays until the drive is switched off.
    Set {
        /// Number of the preset, 0 to 9
        #[arg(value_name = "N", value_parser = clap::value_parser!(u8).range(..PRESETS as i64))]
        index: u8,

        /// Share of the time that the motor is on, from 0 (never) to 255 (always)
        #[arg(long, value_name = "DUTY")]
        duty: u8,

        /// Direction of travel: forward is towards the limit switch
        #[arg(long, value_name = "WAY", default_value = "forward")]
        direction: Way,

        #[command(flatten)]
        port: PortArgs,
    },
    /// Move at a preset
    Go {
        /// Number of the preset, 0 to 9
        #[arg(value_name = "N", value_parser = clap::value_parser!(u8).range(..PRESETS as i64))]
        index: u8,

        /// Set the preset first: share of the time that the motor is on, from 0 (never) to 255 (always)
        #[arg(long, value_name = "DUTY")]
        duty: Option<u8>,

        /// Direction of travel, with --duty
        #[arg(long, value_name = "WAY", default_value = "forward", requires = "duty")]
        direction: Way,

        #[command(flatten)]
        port: PortArgs,
    },
}

#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum Way {
    Forward,
    Reverse,
}

impl Way {
    fn set(self, index: u8, duty: u8) -> Ask {
        let direction = match self {
            Self::Forward => Direction::Forward,
            Self::Reverse => Direction::Reverse,
        };
        Ask::SetPreset { index, preset: Preset { duty, direction } }
    }
}

pub(crate) fn run(command: &Command, output: &Output) -> Result<bool, Error> {
    let (asks, port) = match command {
        Command::Set { index, duty, direction, port } => ([Some(direction.set(*index, *duty)), None], port),
        Command::Go { index, duty, direction, port } => {
            ([duty.map(|duty| direction.set(*index, duty)), Some(Ask::Go { index: *index })], port)
        }
    };
    let (mut line, _) = port.open(Some(Unit::Drive), output)?;
    asks.into_iter().flatten().try_for_each(|ask| line.ask(ask))?;
    Ok(true)
}
