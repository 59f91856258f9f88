//! `accel simulate`.

use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::str::FromStr;

use blur_cli::accel::simulate::{self, Written};
use blur_cli::{Error, Result};
use blur_sim::rig::{Design, Rig};
use blur_sim::sensor::Sensor;
use clap::builder::{PossibleValuesParser, TypedValueParser};

const GUIDE: &str = "\
A camera on an inclined slider photographs five posters while it accelerates: five accelerations from 0.644 to
2.463 m/s2, five shots of every poster at each, 125 blurred pictures, and five still backgrounds of every poster.

Designs:
  fixed-release   the carriage always starts 5 cm before the shutter opens: the blur is the longer the greater the
                  acceleration (26 to 56 px), so that its length alone tells the acceleration
  random-release  the start is chosen so that every acceleration has the same 25 lengths (30 to 70 px): the length
                  tells nothing, only the acceleration itself does

The folder then holds the pictures and pictures.csv, with the columns
  image kind scene accel_m_s2 preset_accel_m_s2 length_px accel_ratio exposure_s scale_m_per_px release_m v0_m_s
  right_px down_px gain kappa
Pictures of a real rig are described by a file of the same name, of which only image, kind (still or blurred), scene
and accel_m_s2 are needed.

Examples:
  accel simulate --design fixed-release -o fixed          the rig of the thesis
  accel simulate --design random-release -o random        nothing to learn from the length
  accel simulate --design fixed-release --psnr-db none --seed 2 -o clean";

/// Options of `accel simulate`.
#[derive(clap::Args)]
#[command(after_help = GUIDE)]
pub(crate) struct Args {
    /// How the carriage is released
    #[arg(long, value_name = "DESIGN", value_parser = design())]
    design: Design,

    /// Peak signal-to-noise ratio of the noise in dB, or none for nothing but rounding
    #[arg(long, value_name = "DB|none", default_value = "40", allow_hyphen_values = true)]
    psnr_db: Noise,

    /// Rows and columns of the pictures
    #[arg(long, value_name = "PX", default_value_t = 512, value_parser = clap::value_parser!(u16).range(32..=4096))]
    side: u16,

    /// Seed of everything that is drawn
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,

    /// Pictures to work on at a time [default: one for each processor]
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,

    /// Folder to write into; it must be empty, or not exist yet
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

/// PSNR in dB, `None` for no noise.
#[derive(Debug, Clone, Copy)]
struct Noise(Option<f64>);

impl FromStr for Noise {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        if text == "none" {
            return Ok(Self(None));
        }
        let psnr_db = text.parse().map_err(|_| "write a number of decibels, such as 40, or none".to_owned())?;
        Sensor::ideal().with_psnr_db(psnr_db).map_err(|error| error.to_string())?;
        Ok(Self(Some(psnr_db)))
    }
}

fn design() -> impl TypedValueParser<Value = Design> {
    PossibleValuesParser::new(Design::NAMED.map(|(name, _)| name)).try_map(|name| {
        let found = Design::NAMED.iter().find(|(known, _)| *known == name);
        found.map(|(_, design)| *design).ok_or("no such design")
    })
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let rig = Rig { psnr_db: args.psnr_db.0, side_px: args.side.into(), ..Rig::default() };
    let threads = rayon::ThreadPoolBuilder::new().num_threads(args.jobs.map_or(0, NonZeroUsize::get)).build()?;
    let Written { blurred, stills } =
        threads.install(|| simulate::write(&rig, args.design, args.seed, &args.output))?;
    let folder = args.output.display();
    writeln!(io::stdout(), "{blurred} blurred pictures, {stills} stills and pictures.csv written to {folder}")
        .map_err(Error::Write)
}
