//! The HTML report of the runs so far.

use std::path::PathBuf;

use slider_host::Error;
use slider_host::fit::{Fitted, pool};
use slider_host::report::{Context, Pooled, html};

use super::evaluate::Evaluation;

/// Where the report goes, and what is in it.
pub(crate) struct Page {
    file: PathBuf,
    runs: Vec<Fitted>,
}

impl Page {
    pub(crate) fn new(file: PathBuf) -> Self {
        Self { file, runs: Vec::new() }
    }

    /// Adds a run and writes the page.
    pub(crate) fn add(&mut self, fitted: Fitted, evaluation: &Evaluation) -> Result<(), Error> {
        self.runs.push(fitted);
        let outcomes: Vec<_> = self.runs.iter().map(|run| run.outcome.clone()).collect();
        let context = Context {
            title: "Runs of the slider".to_owned(),
            subtitle: evaluation.sheet.name.clone(),
            sheet: Some(evaluation.sheet.clone()),
            // Runs of different degrees cannot be pooled, nor can one run.
            pooled: pool(&self.runs, super::evaluate::COVERAGE)
                .map(|pooled| self.pooled(pooled.value))
                .unwrap_or_default(),
            versions: vec![("slider".to_owned(), env!("CARGO_PKG_VERSION").to_owned())],
            command: std::env::args().collect::<Vec<_>>().join(" "),
        };
        std::fs::write(&self.file, html(&outcomes, &context))
            .map_err(|source| Error::File { path: self.file.clone(), source })
    }

    fn pooled(&self, value: slider_host::outcome::Value) -> Vec<Pooled> {
        let accelerated = self.runs.first().is_some_and(|run| run.outcome.degree == 2);
        let (label, unit) = if accelerated { ("acceleration", "m/s²") } else { ("speed", "m/s") };
        vec![Pooled { label: label.to_owned(), unit: unit.to_owned(), value }]
    }
}
