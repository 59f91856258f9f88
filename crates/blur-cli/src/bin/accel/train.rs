//! `accel train`.

use std::io::{self, Write};
use std::path::PathBuf;

use blur_accel::reduce::Components;
use blur_accel::regression::Preset;
use blur_accel::validate::Recipe;
use blur_cli::accel::train::{self, Options};
use blur_cli::{Error, Result};

use crate::recipe::{self, Transform};

const GUIDE: &str = "\
The folder holds pictures of known acceleration and the table pictures.csv, as 'accel simulate' writes them: for each
scene some still pictures and the blurred ones. From each blurred picture and the stills of its scene the shape of the
blur is computed, and the regression learns the acceleration from it. A fifth of the pictures at a time is held out to
tell how good that is on pictures not seen, and which pictures are too unlike them to be measured.

Examples:
  accel train --data fixed -o fixed.json
  accel train --data fixed --model linear --components 0.99 -o linear.json";

/// Options of `accel train`.
#[derive(clap::Args)]
#[command(after_help = GUIDE)]
pub(crate) struct Args {
    /// Folder of pictures with their table, pictures.csv
    #[arg(long, value_name = "DIR")]
    data: PathBuf,

    /// The regression
    #[arg(long, value_name = "NAME", default_value = "gpr-matern52", value_parser = recipe::preset())]
    model: &'static Preset,

    /// Principal components to keep: so many, or as many as explain a share of the variance such as 0.99
    #[arg(long, value_name = "N|SHARE", default_value = "76", value_parser = recipe::components)]
    components: Components,

    /// Transform of the pictures
    #[arg(long, value_name = "NAME", default_value = "dft")]
    variant: Transform,

    /// Seed of everything that is drawn
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,

    /// File to write the model to
    #[arg(short, long, value_name = "MODEL.json")]
    output: PathBuf,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let recipe = Recipe { components: args.components, preset: args.model };
    let options = Options { variant: args.variant.into(), recipe, seed: args.seed };
    let model = train::train(&args.data, &options)?;
    train::write(&model, &args.output)?;
    let provenance = model.provenance();
    let metrics = &provenance.validation.metrics;
    writeln!(
        io::stdout(),
        "{}: {} trained on {} pictures; on those held out of {} parts RMSE {:.4} m/s2, MAE {:.4} m/s2, R2 {:.3}",
        args.output.display(),
        provenance.preset,
        provenance.pictures,
        provenance.validation.folds,
        metrics.rmse,
        metrics.mae,
        metrics.r_squared
    )
    .map_err(Error::Write)
}
