//! Measures motion blur in pictures: `estimate --help`.

mod args;
mod bag;

use std::env;
use std::io::{self, IsTerminal, Write};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::Path;
use std::process::ExitCode;
use std::thread;

use blur_cli::bag::BagOptions;
use blur_cli::input::{self, Input};
use blur_cli::measure::{Finding, Options};
use blur_cli::record::{self, Record};
use blur_cli::report::Report;
use blur_cli::restore::target;
use blur_cli::{Error, pipeline, sample, text};
use clap::error::ErrorKind;
use clap::{CommandFactory, Parser};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use args::Args;

fn main() -> ExitCode {
    let args = Args::parse();
    let options = match args.options() {
        Ok(options) => options,
        Err(error) => Args::command().error(ErrorKind::ValueValidation, error.one_line()).exit(),
    };
    match args.bag() {
        Ok(None) => {}
        Ok(Some((path, bag_options))) => return measure_bag(path, &options, &bag_options, args.json),
        Err(error) => Args::command().error(ErrorKind::ValueValidation, error.one_line()).exit(),
    }
    let inputs = if args.inputs.is_empty() {
        complain(&sample::description());
        vec![Input::Sample]
    } else {
        input::expand(&args.inputs)
    };
    if let Some(Err(error)) = options.restore.as_ref().map(|to| target::targets(&inputs, &to.path)) {
        Args::command().error(ErrorKind::ValueValidation, error.one_line()).exit();
    }
    let report = match options.report.as_deref().map(|folder| Report::new(folder, command())).transpose() {
        Ok(report) => report,
        Err(error) => Args::command().error(ErrorKind::ValueValidation, error.one_line()).exit(),
    };
    let jobs = args.jobs.or_else(|| thread::available_parallelism().ok()).unwrap_or(NonZeroUsize::MIN);
    let mut output = Output { json: args.json, bar: progress_bar(inputs.len()), report, failed: false };
    let finished = pipeline::run(&inputs, &options, jobs, |input, outcome| output.report(&input.name(), outcome));
    output.bar.finish_and_clear();
    for error in [finished.err(), output.report.as_ref().and_then(|report| report.write().err())].into_iter().flatten()
    {
        complain(&error.one_line());
        output.failed = true;
    }
    if output.failed { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

fn measure_bag(path: &Path, options: &Options, bag_options: &BagOptions, json: bool) -> ExitCode {
    match bag::run(path, options, bag_options, json) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error @ Error::NotForBags { .. }) => {
            Args::command().error(ErrorKind::ValueValidation, error.one_line()).exit()
        }
        Err(error) => {
            complain(&error.one_line());
            ExitCode::FAILURE
        }
    }
}

/// Results on standard output, everything else on standard error.
struct Output {
    json: bool,
    bar: ProgressBar,
    report: Option<Report>,
    failed: bool,
}

impl Output {
    fn report(&mut self, image: &str, outcome: Result<&Finding, &Error>) -> ControlFlow<()> {
        self.failed |= outcome.is_err();
        if let Some(report) = &mut self.report {
            report.add(image, outcome);
        }
        let outcome = outcome.map(|finding| &finding.record);
        let written = self.bar.suspend(|| {
            match outcome {
                Ok(Record { note: Some(note), .. }) => complain(&format!("{image}: note: {note}")),
                Ok(_) => {}
                Err(error) => complain(&format!("{image}: {}", error.one_line())),
            }
            write_result(self.json, image, outcome)
        });
        self.bar.inc(1);
        match written {
            Ok(()) => ControlFlow::Continue(()),
            // The reader has seen enough, as in `estimate ... | head -1`.
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => ControlFlow::Break(()),
            Err(error) => {
                complain(&format!("the results cannot be written: {error}"));
                self.failed = true;
                ControlFlow::Break(())
            }
        }
    }
}

fn write_result(json: bool, image: &str, outcome: Result<&Record, &Error>) -> io::Result<()> {
    let mut out = io::stdout().lock();
    if json {
        record::write_json(&mut out, image, outcome)?;
    } else if let Ok(record) = outcome {
        writeln!(out, "{}", text::from_record(record))?;
    }
    out.flush()
}

/// The command line as it was given.
fn command() -> Vec<String> {
    env::args_os().map(|word| word.to_string_lossy().into_owned()).collect()
}

fn complain(message: &str) {
    // A closed standard error leaves nobody to tell.
    let _ = writeln!(io::stderr(), "estimate: {message}");
}

fn progress_bar(pictures: usize) -> ProgressBar {
    if pictures < 2 || !io::stderr().is_terminal() {
        return ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
    }
    let bar = ProgressBar::new(pictures as u64);
    match ProgressStyle::with_template("{bar:40} {pos}/{len} pictures, {eta} left") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
