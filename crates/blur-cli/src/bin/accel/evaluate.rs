//! `accel evaluate`.

use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::path::PathBuf;

use blur_accel::reduce::Components;
use blur_accel::regression::{PRESETS, Preset};
use blur_accel::validate::Folds;
use blur_cli::accel::evaluate::{Options, evaluate};
use blur_cli::accel::study::Study;
use blur_cli::accel::{plot, table};
use blur_cli::{Error, Result};

use crate::recipe::{self, Transform};

const GUIDE: &str = "\
Every picture is measured in four ways: by the regressions, which learn from the other folds; by a parabola of the blur
length alone, which a regression must beat to have learnt more than lengths; by physics from the picture alone (blind,
without a sign); and by physics from the picture and the stills of its scene (reference). The last two need the columns
exposure_s and scale_m_per_px of pictures.csv.

beats length   whether the mean square error is smaller than that of the length alone, one-sided 5 % (corrected
               resampled t-test over the folds)
within k = 2   share of the answers within two stated standard uncertainties of the truth
right sign     share of the answers with the sign of the truth
detected       answers that stand out from a uniform motion

With --group scene no scene is both learnt from and tested: how good the regressions are on scenes never seen.

Examples:
  accel evaluate --data fixed
  accel evaluate --data random --group scene --model gpr-matern52 --plots plots";

/// Options of `accel evaluate`.
#[derive(clap::Args)]
#[command(after_help = GUIDE)]
pub(crate) struct Args {
    /// Folder of pictures with their table, pictures.csv
    #[arg(long, value_name = "DIR")]
    data: PathBuf,

    /// A regression; can be given several times [default: all]
    #[arg(long = "model", value_name = "NAME", value_parser = recipe::preset())]
    models: Vec<&'static Preset>,

    /// Parts that the pictures are divided in, each predicted from the others
    #[arg(long, value_name = "N", default_value_t = 5)]
    folds: usize,

    /// What stays together in a fold
    #[arg(long, value_name = "WHAT", default_value = "picture")]
    group: Group,

    /// Principal components to keep: so many, or as many as explain a share of the variance such as 0.99
    #[arg(long, value_name = "N|SHARE", default_value = "76", value_parser = recipe::components)]
    components: Components,

    /// Transform of the pictures
    #[arg(long, value_name = "NAME", default_value = "dft")]
    variant: Transform,

    /// Seed of everything that is drawn
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,

    /// Scenes to work on at a time [default: one for each processor]
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,

    /// One JSON object a line
    #[arg(long)]
    json: bool,

    /// Write plots of answers, residuals and response into this folder (SVG)
    #[arg(long, value_name = "DIR")]
    plots: Option<PathBuf>,
}

/// What stays together in a fold.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum Group {
    /// Single pictures
    Picture,
    /// All pictures of a scene
    Scene,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(args.jobs.map_or(0, NonZeroUsize::get)).build()?;
    let study = pool.install(|| Study::read(&args.data, args.variant.into()))?;
    let folds = match args.group {
        Group::Picture => Folds::random(study.len(), args.folds, args.seed)?,
        Group::Scene => Folds::grouped(&study.scenes, args.folds, args.seed)?,
    };
    let all: Vec<&'static Preset> = PRESETS.iter().collect();
    let presets = if args.models.is_empty() { &all } else { &args.models };
    let lines = evaluate(&study, &folds, &Options { presets, components: args.components, seed: args.seed })?;
    if let Some(folder) = &args.plots {
        plot::write_all(&lines, folder)?;
    }
    let mut out = io::stdout().lock();
    if args.json {
        for line in &lines {
            let row = serde_json::to_string(&table::Row::from(line))?;
            writeln!(out, "{row}").map_err(Error::Write)?;
        }
        Ok(())
    } else {
        write!(out, "{}", table::table(&lines)).map_err(Error::Write)
    }
}
