//! Judges a method on pictures of known truth: `reproduce --help`.

mod args;

use std::io::{self, Write};
use std::process::ExitCode;

use blur_cli::reproduce::report::Report;
use blur_cli::reproduce::{Table, boxplot};
use blur_cli::{Error, Result};
use clap::error::ErrorKind;
use clap::{CommandFactory, Parser};

use args::Args;

fn main() -> ExitCode {
    let args = Args::parse();
    let plan = match args.plan() {
        Ok(plan) => plan,
        Err(error) => Args::command().error(ErrorKind::ValueValidation, error.one_line()).exit(),
    };
    match make(&args, &plan).and_then(|report| finish(&args, &report)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            complain(&error.one_line());
            ExitCode::FAILURE
        }
    }
}

fn make(args: &Args, plan: &blur_cli::reproduce::Plan) -> Result<Report> {
    let table = Table::named(&args.table)?;
    let threads = rayon::ThreadPoolBuilder::new().num_threads(args.jobs.map_or(0, std::num::NonZeroUsize::get));
    threads.build()?.install(|| table.make(plan))
}

/// Results on standard output, everything else on standard error.
fn finish(args: &Args, report: &Report) -> Result<()> {
    for note in &report.notes {
        complain(note);
    }
    if let Some(folder) = &args.plots {
        boxplot::write_all(&report.boxplots, folder)?;
    }
    match if args.json { print_json(args, report) } else { print_text(args, report) } {
        // The reader has seen enough, as in `reproduce ... | head -1`.
        Err(Error::Write(error)) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        outcome => outcome,
    }
}

fn print_json(args: &Args, report: &Report) -> Result<()> {
    let mut out = io::stdout().lock();
    for row in &report.rows {
        writeln!(out, "{row}").map_err(Error::Write)?;
    }
    if args.pictures {
        for outcome in &report.outcomes {
            let line = serde_json::to_string(outcome)?;
            writeln!(out, "{line}").map_err(Error::Write)?;
        }
        for answer in &report.answers {
            let line = serde_json::to_string(answer)?;
            writeln!(out, "{line}").map_err(Error::Write)?;
        }
    }
    Ok(())
}

fn print_text(args: &Args, report: &Report) -> Result<()> {
    let mut out = io::stdout().lock();
    write!(out, "{}", report.text).map_err(Error::Write)?;
    let listed = if args.pictures { &report.outcomes } else { &report.listed };
    let answers = if args.pictures { report.answers.as_slice() } else { &[] };
    if !listed.is_empty() || !answers.is_empty() {
        writeln!(out).map_err(Error::Write)?;
    }
    listed.iter().try_for_each(|outcome| writeln!(out, "{outcome}")).map_err(Error::Write)?;
    answers.iter().try_for_each(|answer| writeln!(out, "{answer}")).map_err(Error::Write)
}

fn complain(message: &str) {
    // A closed standard error leaves nobody to tell.
    let _ = writeln!(io::stderr(), "reproduce: {message}");
}
