//! Calibrates cameras: `calibrate --help`.

mod args;

use std::fs;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use blur_cli::camera::views::{self, SizedView};
use blur_cli::camera::{file, report};
use blur_cli::input::{self, Input};
use blur_cli::{Error, Result};
use blur_core::camera::{Board, View, calibrate};
use clap::error::ErrorKind;
use clap::{CommandFactory, Parser};
use rayon::prelude::*;

use args::Args;

fn main() -> ExitCode {
    let args = Args::parse();
    let board = match args.board() {
        Ok(board) => board,
        Err(error) => Args::command().error(ErrorKind::ValueValidation, error.one_line()).exit(),
    };
    match run(&args, board.as_ref()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            complain(&error.one_line());
            ExitCode::FAILURE
        }
    }
}

/// Whether every input was of use.
fn run(args: &Args, board: Option<&Board>) -> Result<bool> {
    let mut used = Used::default();
    for (name, view) in views_of(input::expand(&args.inputs), args, board)? {
        used.add(name, view);
    }
    let (width_px, height_px) = used.size.unwrap_or_default();
    let calibration = calibrate(&used.views, width_px, height_px, args.model())?;
    for warning in report::warnings(&used.names, &calibration) {
        complain(&format!("warning: {warning}"));
    }
    let json = file::to_json(&calibration)?;
    if let Some(path) = &args.output {
        fs::write(path, &json).map_err(|error| Error::Write(error).in_file(path))?;
    }
    let text = if args.json { json } else { report::table(&used.names, &calibration) };
    match io::stdout().lock().write_all(text.as_bytes()) {
        // The reader has seen enough, as in `calibrate ... | head -1`.
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => return Err(Error::Write(error)),
        _ => {}
    }
    Ok(!used.left_out)
}

/// Names and views of all inputs, in their order.
fn views_of(inputs: Vec<Input>, args: &Args, board: Option<&Board>) -> Result<Vec<(String, Result<SizedView>)>> {
    let listed = match (&args.points, args.size) {
        (Some(model), Some(size)) => Some((views::points(model)?, size)),
        _ => None,
    };
    let view_of = |path: &Path| match (&listed, board) {
        (Some((points, (width_px, height_px))), _) => {
            views::from_points(path, points).map(|view| SizedView { view, width_px: *width_px, height_px: *height_px })
        }
        (None, Some(board)) => views::from_picture(path, board),
        (None, None) => Err(Error::NoMatch),
    };
    Ok(inputs
        .into_par_iter()
        .map(|input| {
            let name = input.name();
            match input {
                Input::File(path) => (name, view_of(&path)),
                Input::Failed { error, .. } => (name, Err(error)),
                Input::Sample => (name, Err(Error::NoMatch)),
            }
        })
        .collect())
}

/// The views that go into the calibration.
#[derive(Default)]
struct Used {
    names: Vec<String>,
    views: Vec<View>,
    size: Option<(usize, usize)>,
    left_out: bool,
}

impl Used {
    fn add(&mut self, name: String, view: Result<SizedView>) {
        match view.and_then(|view| self.check_size(view)) {
            Ok(view) => {
                self.names.push(name);
                self.views.push(view);
            }
            Err(error) => {
                complain(&format!("{name}: left out: {}", error.one_line()));
                self.left_out = true;
            }
        }
    }

    fn check_size(&mut self, SizedView { view, width_px, height_px }: SizedView) -> Result<View> {
        let (first_width, first_height) = *self.size.get_or_insert((width_px, height_px));
        if (first_width, first_height) == (width_px, height_px) {
            Ok(view)
        } else {
            Err(Error::ViewSize { width: width_px, height: height_px, first_width, first_height })
        }
    }
}

fn complain(message: &str) {
    // A closed standard error leaves nobody to tell.
    let _ = writeln!(io::stderr(), "calibrate: {message}");
}
