//! A run as the user is told it.

use std::fmt::Write;
use std::path::Path;

use serde_json::json;
use slider_host::Error;
use slider_host::fit::Fitted;
use slider_host::run::{End, Run};
use slider_proto::section::Sections;

use super::evaluate::Evaluation;
use super::outcome;
use super::output::Output;

/// A run with where it comes from.
pub(crate) struct Received<'a> {
    pub(crate) run: &'a Run,
    /// Why its end is missing, if it is.
    pub(crate) incomplete: Option<String>,
    /// Its file, if it is saved.
    pub(crate) file: Option<&'a Path>,
}

/// Tells a run; returns what was computed of it.
///
/// A run that cannot be fitted is told all the same, with the reason.
pub(crate) fn report_run(
    received: &Received<'_>,
    evaluation: &Evaluation,
    output: &Output,
) -> Result<Option<Fitted>, Error> {
    let Received { run, incomplete, file } = received;
    let late = run.edges.iter().filter(|edge| edge.late).count();
    let mut sections = Sections::default();
    let intervals: Vec<_> = run.edges.iter().filter_map(|&edge| sections.push(edge).ok().flatten()).collect();
    let mut json = json!({
        "run": run.number,
        "complete": run.is_complete(),
        "edges": run.edges.len(),
        "late": late,
        "tick_hz": run.tick_hz,
        "interval_ticks": intervals.iter().map(|interval| interval.ticks).collect::<Vec<_>>(),
    });
    let end = match (run.end, incomplete) {
        (End::Told { reason, lost, .. }, _) => {
            let reason = slider_host::log::reason_word(reason);
            json["end"] = json!(reason);
            json["lost"] = json!(lost);
            if lost > 0 { format!("incomplete: {lost} edges lost by overrun") } else { format!("complete ({reason})") }
        }
        (End::Missing, reason) => {
            let reason = reason.as_deref().unwrap_or("its end is missing");
            json["incomplete"] = json!(reason);
            format!("incomplete: {reason}")
        }
    };
    let mut text = format!("run {}: {} edges, {late} late, {end}", run.number, run.edges.len());
    // Writing to a String cannot fail.
    if let Some(file) = file {
        json["file"] = json!(file);
        let _ = write!(text, "\n  saved in {}", file.display());
    }
    json["sheet"] = json!(evaluation.sheet.name);
    let fitted = match evaluation.run(run) {
        Ok(fitted) => {
            let _ = write!(text, "\n{}", outcome::text(&fitted));
            json.as_object_mut().into_iter().for_each(|json| json.extend(outcome::fields(&fitted)));
            Some(fitted)
        }
        Err(error) => {
            let _ = write!(text, "\n  not fitted: {error}");
            json["error"] = json!(error.to_string());
            None
        }
    };
    output.result(&text, &json)?;
    Ok(fitted)
}
