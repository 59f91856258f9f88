//! What is computed of a run.

use std::path::PathBuf;

use slider_host::Error;
use slider_host::fit::{EdgeShift, Fitted, Options, fit};
use slider_host::outcome::Kind;
use slider_host::points::Points;
use slider_host::run::Run;
use slider_host::sheet::Sheet;

use super::page::Page;

/// Probability of expanded uncertainties.
pub(crate) const COVERAGE: f64 = 0.95;

/// What the user says of the sheet and the fit.
#[derive(clap::Args)]
#[command(next_help_heading = "Evaluation")]
pub(crate) struct EvaluationArgs {
    /// Description of the encoder sheet [default: 13 teeth of 3.1 mm and slits of 4.9 mm, exactly known]
    #[arg(long, value_name = "FILE")]
    sheet: Option<PathBuf>,

    /// Degree of x(t): 1 for a speed, 2 for an acceleration [default: what the run shows]
    #[arg(long, value_name = "1|2", value_parser = clap::value_parser!(u8).range(1..=2))]
    degree: Option<u8>,

    /// Take the sensor to switch exactly at the edges of a tooth; without this, that teeth look narrower or wider by a
    /// constant is fitted too
    #[arg(long)]
    no_edge_shift: bool,

    /// Standard uncertainty of each time besides its resolution, us [default: 0.5 for a run, 0 for points]
    #[arg(long, value_name = "US")]
    jitter: Option<f64>,

    /// Relative standard uncertainty of the clock, parts per million [default: 30 for a run, as of a crystal; 0 for
    /// points]
    #[arg(long, value_name = "PPM")]
    clock_ppm: Option<f64>,

    /// Write an HTML page of the runs here, anew after each run
    #[arg(long, value_name = "FILE.html")]
    report: Option<PathBuf>,
}

impl EvaluationArgs {
    /// The page of the runs, if one was asked for.
    pub(crate) fn page(&self) -> Option<Page> {
        self.report.clone().map(Page::new)
    }

    /// Reads the sheet.
    pub(crate) fn read(&self) -> Result<Evaluation, Error> {
        let sheet = self.sheet.as_ref().map(|path| {
            let text = std::fs::read_to_string(path).map_err(|source| Error::File { path: path.clone(), source })?;
            Sheet::from_toml(&text)
        });
        let options = |jitter_us: f64, clock_ppm: f64| Options {
            edge_shift: if self.no_edge_shift { EdgeShift::None } else { EdgeShift::Fitted },
            jitter_std_s: self.jitter.unwrap_or(jitter_us) * 1e-6,
            clock_std: self.clock_ppm.unwrap_or(clock_ppm) * 1e-6,
            coverage: COVERAGE,
            ..Options::of_degree(1)
        };
        Ok(Evaluation {
            sheet: sheet.transpose()?.unwrap_or_else(Sheet::nominal),
            degree: self.degree,
            of_runs: options(0.5, 30.0),
            // What another instrument measured is taken as it is.
            of_points: Options { outlier_significance: 0.0, ..options(0.0, 0.0) },
        })
    }
}

/// How runs are evaluated.
pub(crate) struct Evaluation {
    /// The sheet.
    pub(crate) sheet: Sheet,
    degree: Option<u8>,
    of_runs: Options,
    of_points: Options,
}

impl Evaluation {
    /// The fit of a run.
    pub(crate) fn run(&self, run: &Run) -> Result<Fitted, Error> {
        self.fit(run.number, &Points::from_run(run, &self.sheet)?, &self.of_runs)
    }

    /// The fit of points that something else measured.
    pub(crate) fn points(&self, points: &Points) -> Result<Fitted, Error> {
        self.fit(0, points, &self.of_points)
    }

    /// The fit of the degree that was asked for, or else a speed where that explains the points and an acceleration where
    /// not.
    fn fit(&self, number: u16, points: &Points, options: &Options) -> Result<Fitted, Error> {
        let of_degree = |degree| fit(number, points, &Options { degree, ..*options });
        if let Some(degree) = self.degree {
            return of_degree(degree);
        }
        let speed = of_degree(1)?;
        if speed.outcome.kind == Kind::Uniform || points.t_s.len() < 4 { Ok(speed) } else { of_degree(2) }
    }
}
