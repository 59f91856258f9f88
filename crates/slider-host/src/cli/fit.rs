//! `slider fit`.

use std::path::{Path, PathBuf};

use metrology::Measurement;
use serde_json::json;
use slider_host::fit::{Fitted, pool};
use slider_host::points::Points;
use slider_host::{Error, log};

use super::evaluate::{COVERAGE, Evaluation, EvaluationArgs};
use super::outcome;
use super::output::Output;
use super::tell::{Received, report_run};

#[derive(clap::Args)]
pub(crate) struct Args {
    #[arg(
        help = "Saved runs, or points of any instrument as columns t_s,x_m[,u_x_m] of a .csv file",
        value_name = "RUN.jsonl|POINTS.csv",
        required = true
    )]
    files: Vec<PathBuf>,

    #[command(flatten)]
    evaluation: EvaluationArgs,

    /// One JSON object a run on standard output, and one more for all of them if there are several
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args, output: &mut Output) -> Result<bool, Error> {
    output.json = args.json;
    let evaluation = args.evaluation.read()?;
    let mut page = args.evaluation.page();
    let mut fitted = Vec::new();
    let mut well = true;
    for file in &args.files {
        let is_csv = file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"));
        let of_file = if is_csv { fit_points(file, &evaluation, output) } else { fit_runs(file, &evaluation, output) };
        match of_file {
            Ok(runs) => {
                well &= !runs.is_empty();
                for run in runs {
                    if let Some(page) = &mut page {
                        page.add(run.clone(), &evaluation)?;
                    }
                    fitted.push(run);
                }
            }
            // The others are fitted all the same.
            Err(error) if args.files.len() > 1 => {
                output.tell(&error.to_string());
                well = false;
            }
            Err(error) => return Err(error),
        }
    }
    if fitted.len() > 1 {
        report_pool(&fitted, output)?;
    }
    Ok(well)
}

fn fit_runs(file: &Path, evaluation: &Evaluation, output: &Output) -> Result<Vec<Fitted>, Error> {
    let runs = log::read(file)?;
    if runs.is_empty() {
        output.tell(&format!("{}: there is no run in it", file.display()));
    }
    let mut fitted = Vec::new();
    for logged in &runs {
        let received = Received { run: &logged.run, incomplete: logged.incomplete.clone(), file: Some(file) };
        fitted.extend(report_run(&received, evaluation, output)?);
    }
    Ok(fitted)
}

fn fit_points(path: &Path, evaluation: &Evaluation, output: &Output) -> Result<Vec<Fitted>, Error> {
    let file = |source| Error::File { path: path.to_owned(), source };
    let text = std::fs::read_to_string(path).map_err(file)?;
    let points = Points::from_csv(&text).map_err(|error| match error {
        Error::Points { line, reason } => Error::Log { path: path.to_owned(), line, why: reason },
        other => other,
    })?;
    let fitted = evaluation.points(&points)?;
    output.result(&format!("{}\n{}", path.display(), outcome::text(&fitted)), &outcome::fields(&fitted))?;
    Ok(vec![fitted])
}

/// What the runs say together, if they can be taken together.
fn report_pool(fitted: &[Fitted], output: &Output) -> Result<(), Error> {
    let pooled = match pool(fitted, COVERAGE) {
        Ok(pooled) => pooled,
        Err(error) => {
            output.tell(&format!("not pooled: {error}"));
            return Ok(());
        }
    };
    let accelerated = fitted.first().is_some_and(|run| run.outcome.degree == 2);
    let (name, unit, shown) = if accelerated { ("accel", "m_s2", "m/s²") } else { ("speed", "m_s", "m/s") };
    let value = pooled.value;
    let concise = Measurement::new(value.value, value.std).map_err(Error::Evaluation)?;
    let text = format!(
        "{} runs together: {name} {concise} {shown}   U = {:.2e} {shown} (k = {:.2}, 95 %)\n  standard deviation of a run \
         {:.2e}, of it within runs {:.2e} and between runs {:.2e}; common to all {:.2e} {shown}",
        fitted.len(),
        value.expanded,
        value.coverage_k,
        pooled.scatter_std,
        pooled.within_std,
        pooled.between_std,
        pooled.common_std,
    );
    let json = json!({
        "pooled": fitted.len(),
        format!("{name}_{unit}"): value.value,
        format!("{name}_std_{unit}"): value.std,
        format!("{name}_expanded_{unit}"): value.expanded,
        "coverage_k": value.coverage_k,
        "scatter_std": pooled.scatter_std,
        "within_std": pooled.within_std,
        "between_std": pooled.between_std,
        "common_std": pooled.common_std,
        "birge_ratio": pooled.birge_ratio,
        "weights": pooled.weights,
    });
    output.result(&text, &json)
}
