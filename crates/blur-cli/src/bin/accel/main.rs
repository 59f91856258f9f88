//! Acceleration from one picture by learning: `accel --help`.

mod evaluate;
mod predict;
mod recipe;
mod simulate;
mod train;

use std::io::{self, Write};
use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Acceleration from one motion-blurred picture by learning, after chapter 6 of the thesis.
#[derive(Parser)]
#[command(name = "accel", version, max_term_width = 110)]
struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Make pictures of known acceleration on a virtual rig
    Simulate(simulate::Args),
    /// Train a model on pictures of known acceleration
    Train(train::Args),
    /// Hold all regressions, the blur length alone and physics against each other
    Evaluate(evaluate::Args),
    /// Measure the acceleration in pictures by a model
    Predict(predict::Args),
}

fn main() -> ExitCode {
    let outcome = match Args::parse().command {
        Command::Simulate(args) => simulate::run(&args).map(|()| ExitCode::SUCCESS),
        Command::Train(args) => train::run(&args).map(|()| ExitCode::SUCCESS),
        Command::Evaluate(args) => evaluate::run(&args).map(|()| ExitCode::SUCCESS),
        Command::Predict(args) => predict::run(&args),
    };
    match outcome {
        Ok(status) => status,
        Err(error) => {
            // A closed standard error leaves nobody to tell.
            let _ = writeln!(io::stderr(), "accel: {}", error.one_line());
            ExitCode::FAILURE
        }
    }
}
