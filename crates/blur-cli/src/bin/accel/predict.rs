//! `accel predict`.

use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use blur_accel::model::Prediction;
use blur_cli::accel::predict::{self, Predictor};
use blur_cli::input::{self, Input};
use blur_cli::{Error, Result, record, text};
use blur_core::motion::COVERAGE_K;

const GUIDE: &str = "\
The backgrounds show the scene of the pictures, taken by the camera at rest. Pictures and backgrounds have the size of
the pictures that the model was trained on, and the motion is along their rows. A picture that is unlike those of the
training is refused, since no number for it could be trusted. Limit and uncertainty hold for scenes of the training:
train on pictures of the scenes that are to be measured.

Everything after --backgrounds is a background up to the next option or '--', so it comes last or before '--'.

After ± stands the expanded uncertainty (k = 2), where the regression has one.

With --json one object a line: image, method, accel_m_s2, accel_std_m_s2 (where the regression has one), distance (from
the pictures of the training, at most 1); or image and error.

Exit status: 0 all pictures measured, 1 some refused (the others are still reported), 2 usage.

Examples:
  accel predict fixed.json run*.png --backgrounds stills/
  accel predict fixed.json --backgrounds still1.png still2.png -- run.png";

/// Options of `accel predict`.
#[derive(clap::Args)]
#[command(after_help = GUIDE)]
pub(crate) struct Args {
    /// The model, as 'accel train' wrote it
    #[arg(value_name = "MODEL.json")]
    model: PathBuf,

    /// Pictures (PNG, JPEG, TIFF), folders of pictures, or patterns such as 'run*.png'
    #[arg(value_name = "IMAGE|DIR|GLOB", required = true)]
    pictures: Vec<PathBuf>,

    /// Still pictures of the scene: files, folders or patterns
    #[arg(long, value_name = "STILL", required = true, num_args = 1..)]
    backgrounds: Vec<PathBuf>,

    /// Print one JSON object for each picture
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let mut predictor = Predictor::new(predict::read(&args.model)?, &args.backgrounds)?;
    let mut status = ExitCode::SUCCESS;
    for input in input::expand(&args.pictures) {
        let image = input.name();
        let outcome = match input {
            Input::File(path) => predictor.predict(&path),
            Input::Failed { error, .. } => Err(error),
            Input::Sample => continue,
        };
        if let Err(error) = &outcome {
            status = ExitCode::FAILURE;
            // A closed standard error leaves nobody to tell.
            let _ = writeln!(io::stderr(), "accel: {image}: {}", error.one_line());
        }
        let method = &predictor.model().provenance().preset;
        match write(args.json, &image, method, outcome.as_ref()) {
            Ok(()) => {}
            // The reader has seen enough, as in `accel predict ... | head -1`.
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => break,
            Err(error) => return Err(Error::Write(error)),
        }
    }
    Ok(status)
}

fn write(json: bool, image: &str, method: &str, outcome: std::result::Result<&Prediction, &Error>) -> io::Result<()> {
    let mut out = io::stdout().lock();
    match outcome {
        Ok(prediction) if json => predict::write_json(&mut out, image, method, prediction)?,
        Ok(Prediction { accel_m_s2, std_m_s2, .. }) => {
            let expanded = std_m_s2.map(|std| COVERAGE_K * std);
            write!(out, "{image}  acceleration {} m/s2", text::with_uncertainty(*accel_m_s2, expanded, 3))?;
            if expanded.is_some() {
                write!(out, " (k = {COVERAGE_K})")?;
            }
            writeln!(out)?;
        }
        Err(error) if json => record::write_failure(&mut out, image, error)?,
        Err(_) => {}
    }
    out.flush()
}
