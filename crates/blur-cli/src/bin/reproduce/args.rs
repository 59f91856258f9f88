//! The command line of `reproduce`.

use std::fmt::Write;
use std::num::NonZeroUsize;
use std::path::PathBuf;

use blur_cli::Result;
use blur_cli::method::Method;
use blur_cli::reproduce::candidates::candidates;
use blur_cli::reproduce::{Judged, Plan, TABLES, Table, pictures};
use clap::Parser;

/// Judges a method on pictures of known truth, one table at a time.
#[derive(Parser)]
#[command(name = "reproduce", version, after_help = guide(), max_term_width = 110)]
pub(crate) struct Args {
    /// The table to make
    #[arg(value_name = "TABLE", value_parser = table)]
    pub(crate) table: String,

    #[arg(
        long,
        value_name = "DIR",
        help = "Data folder with kodak and skimage, or any folder of sharp pictures; not for 5.2 to 6.2, whose pictures are made [default: the folder named by \
                BLUR_DATA, else ../shared/data]"
    )]
    images: Option<PathBuf>,

    /// 4.1 to 5.4.4: only this method; coverage, efficiency and negatives: a method that finds angle and length together,
    /// or a pair ANGLE+LENGTH; not for 6.2, which compares its own [default: all; that of estimate]
    #[arg(long, value_name = "NAME")]
    method: Option<String>,

    /// coverage: pictures at each level of noise
    #[arg(long, value_name = "N", default_value = "216")]
    per_level: NonZeroUsize,

    /// efficiency: fields in each cell
    #[arg(long, value_name = "N", default_value = "60")]
    fields: NonZeroUsize,

    /// Only one case in N, evenly over pictures, blurs and shots, for a quick look
    #[arg(long, value_name = "N", default_value = "1")]
    step: NonZeroUsize,

    /// Seed of everything that is drawn
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,

    /// Pictures to work on at a time [default: one for each processor]
    #[arg(long, value_name = "N")]
    pub(crate) jobs: Option<NonZeroUsize>,

    /// One JSON object a row
    #[arg(long)]
    pub(crate) json: bool,

    /// After the table one line for each picture (with --json an object, which has the field image)
    #[arg(long)]
    pub(crate) pictures: bool,

    /// Write boxplots of the absolute errors into this folder (SVG)
    #[arg(long, value_name = "DIR")]
    pub(crate) plots: Option<PathBuf>,
}

impl Args {
    /// What is to be measured. What is refused here is a mistake on the command line.
    pub(crate) fn plan(&self) -> Result<Plan> {
        let (mut method, mut only) = (Method::recommended(), None);
        if let Some(name) = &self.method {
            match Table::named(&self.table)?.judged {
                Judged::Method | Judged::Own => method = Method::named(name)?,
                Judged::All(measure) => {
                    candidates(measure, Some(name))?;
                    only = Some(name.clone());
                }
            }
        }
        Ok(Plan {
            images: self.images.clone().unwrap_or_else(pictures::default_folder),
            method,
            only,
            per_level: self.per_level.get(),
            fields: self.fields.get(),
            step: self.step.get(),
            seed: self.seed,
        })
    }
}

fn table(name: &str) -> Result<String> {
    Table::named(name).map(|table| table.name.to_owned())
}

/// The part of the help that explains; the list of tables comes from the registry.
fn guide() -> String {
    let mut text = String::from("Tables:\n");
    for table in TABLES {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "  {:<12} {}", table.name, table.summary);
    }
    text.push_str(
        "
Minutes for all of a table on two processors: 4.1 5, 4.2 9, 4.4 2, 4.5 5, 5.2 6,
5.3 1, 4.3, 4.6, 5.4.3 and 5.4.4 less than one; --step 10 takes a tenth of that

JSON fields of a row (--json):
  table method level quantity n n_ok mean min q1 median q3 p90 max thesis, and
  those of the table; the errors are absolute, in 4.1 to 5.4.4 of all answers,
  else of the answers called ok

Exit status:
  0  the table was made
  1  a picture could not be read or measured
  2  the command line is wrong",
    );
    text
}
