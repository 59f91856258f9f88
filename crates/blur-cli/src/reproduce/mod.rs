//! Tables that judge a method: the library of the program `reproduce`.
//!
//! A [`Table`] makes a [`Report`] from a [`Plan`]; [`TABLES`] lists them. Each is a file of its own that
//! draws its cases with a seed, has them measured on several threads in a fixed order, and summarises them.
//!
//! [`pictures`] (sharp) → [`shots`] (blurred, recorded) → [`outcome`] (measured, beside the truth) → [`statistics`],
//! [`cramer_rao`] → [`coverage`], [`efficiency`], [`negatives`] → [`report`] → [`boxplot`]. The table [`acceleration`] takes
//! its pictures on a virtual rig.
//!
//! The tables of the thesis's chapters 4 and 5 compare all methods of the registries: [`pictures`] → [`protocol`], or the
//! virtual rig → [`candidates`] → [`answer`] → [`accuracy`], beside the figures of the [`thesis`] → [`synthetic`],
//! [`runtime`], [`slider`] → [`texture`], [`correlation`] → [`influence`], [`repeatability`]. Those of its chapter 7 cut their
//! pictures: [`shots`] → `segments` → [`strips`].

pub mod acceleration;
pub mod accuracy;
pub mod answer;
pub mod boxplot;
pub mod candidates;
pub mod correlation;
pub mod coverage;
pub mod cramer_rao;
pub mod efficiency;
pub mod influence;
pub mod negatives;
pub mod outcome;
pub mod pictures;
pub mod protocol;
pub mod repeatability;
pub mod report;
pub mod runtime;
mod segments;
pub mod shots;
pub mod slider;
pub mod statistics;
pub mod strips;
pub mod synthetic;
pub mod texture;
pub mod thesis;
mod thinning;

use std::fmt;
use std::path::PathBuf;

use rayon::prelude::*;

use crate::method::Method;
use crate::{Error, Result};
use answer::Measure;
use outcome::Judge;
use report::Report;

/// What to measure, and with which method.
#[derive(Clone)]
pub struct Plan {
    /// The data folder, or any folder of sharp pictures.
    pub images: PathBuf,
    /// The method that is judged by a table of [`Judged::Method`].
    pub method: Method,
    /// The only method of a table of [`Judged::All`], by its name; `None` for all.
    pub only: Option<String>,
    /// Pictures at each level of noise (`coverage`).
    pub per_level: usize,
    /// Fields in each cell (`efficiency`).
    pub fields: usize,
    /// Only one case in so many.
    pub step: usize,
    /// Seed of everything that is drawn.
    pub seed: u64,
}

impl Plan {
    /// How many of `cases` are measured, at least one.
    fn share_of(&self, cases: usize) -> usize {
        cases.div_ceil(self.step.max(1))
    }
}

/// Which methods a table judges.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Judged {
    /// The one that is named, which finds angle and length.
    Method,
    /// All methods of the registries that measure this, or the one that is named.
    All(Measure),
    /// Those that it brings itself.
    Own,
}

/// One table.
pub struct Table {
    /// Name on the command line.
    pub name: &'static str,
    /// What it tells, in one line.
    pub summary: &'static str,
    /// Which methods it judges.
    pub judged: Judged,
    make: fn(&Plan) -> Result<Report>,
}

impl Table {
    /// The table called `name`.
    ///
    /// # Errors
    /// [`Error::UnknownTable`] when there is none.
    pub fn named(name: &str) -> Result<&'static Self> {
        TABLES.iter().find(|table| table.name == name).ok_or_else(|| Error::UnknownTable {
            name: name.to_owned(),
            known: TABLES.iter().map(|table| table.name).collect::<Vec<_>>().join(", "),
        })
    }

    /// Measures all its pictures, on the threads of the rayon pool that this is called in.
    ///
    /// # Errors
    /// When there are no pictures, or one of them cannot be read, exposed or measured.
    pub fn make(&self, plan: &Plan) -> Result<Report> {
        (self.make)(plan)
    }
}

impl fmt::Debug for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Table").field("name", &self.name).finish_non_exhaustive()
    }
}

/// All tables.
pub const TABLES: &[Table] = &[
    Table {
        name: "4.1",
        summary: "angles of clean pictures by all methods, beside the thesis",
        judged: Judged::All(Measure::Angle),
        make: synthetic::angles_clean,
    },
    Table {
        name: "4.2",
        summary: "angles of noisy pictures by all methods, beside the thesis",
        judged: Judged::All(Measure::Angle),
        make: synthetic::angles_noisy,
    },
    Table {
        name: "4.3",
        summary: "times of the angle methods, beside the thesis",
        judged: Judged::All(Measure::Angle),
        make: runtime::angles,
    },
    Table {
        name: "4.4",
        summary: "lengths of clean pictures by all methods, beside the thesis",
        judged: Judged::All(Measure::Length),
        make: synthetic::lengths_clean,
    },
    Table {
        name: "4.5",
        summary: "lengths of noisy pictures by all methods, beside the thesis",
        judged: Judged::All(Measure::Length),
        make: synthetic::lengths_noisy,
    },
    Table {
        name: "4.6",
        summary: "times of the length methods, beside the thesis",
        judged: Judged::All(Measure::Length),
        make: runtime::lengths,
    },
    Table {
        name: "5.2",
        summary: "angles on the rig of the thesis's chapter 5 by all methods, beside the thesis",
        judged: Judged::All(Measure::Angle),
        make: slider::angles,
    },
    Table {
        name: "5.3",
        summary: "speeds on that rig by all methods, beside the thesis",
        judged: Judged::All(Measure::Speed),
        make: slider::speeds,
    },
    Table {
        name: "5.4.3",
        summary: "what the errors of those speeds go together with: texture, brightness, speed",
        judged: Judged::All(Measure::Speed),
        make: influence::table,
    },
    Table {
        name: "5.4.4",
        summary: "spread of repeated pictures beside the uncertainty stated with each",
        judged: Judged::All(Measure::Speed),
        make: repeatability::table,
    },
    Table {
        name: "6.2",
        summary: "nineteen regressions, length alone and physics on the rig of the thesis's chapter 6",
        judged: Judged::Own,
        make: acceleration::table,
    },
    Table {
        name: "7.1",
        summary: "errors of the length in segments 256 px wide and 256 to 2 px high",
        judged: Judged::Own,
        make: strips::heights,
    },
    Table {
        name: "7.2",
        summary: "least width of a segment in which the length is known to 1 %",
        judged: Judged::Own,
        make: strips::widths,
    },
    Table {
        name: "edges",
        summary: "errors of the length in segments with a soft and with a hard edge",
        judged: Judged::Own,
        make: strips::edges,
    },
    Table {
        name: "coverage",
        summary: "errors and stated uncertainties on photographs of any blur, by noise",
        judged: Judged::Method,
        make: coverage::table,
    },
    Table {
        name: "efficiency",
        summary: "errors on Gaussian fields beside the Cramér-Rao bound",
        judged: Judged::Method,
        make: efficiency::table,
    },
    Table {
        name: "negatives",
        summary: "sharp and defocused pictures that are taken for moved ones",
        judged: Judged::Method,
        make: negatives::table,
    },
];

/// Asks about every case on all threads, each with estimators and an `S` of its own; answers in the order of the cases.
fn ask_all<C: Sync, S, A: Send>(
    cases: &[C],
    method: &Method,
    state: impl Fn() -> S + Sync + Send,
    ask: impl Fn(&mut Judge, &mut S, &C) -> Result<A> + Sync + Send,
) -> Result<Vec<A>> {
    cases
        .par_iter()
        .map_init(|| (Judge::new(method), state()), |(judge, state), case| ask(judge, state, case))
        .collect()
}

/// A simulator's refusal of a picture.
fn simulating(image: &str) -> impl Fn(blur_sim::Error) -> Error + '_ {
    move |source| Error::Simulating { image: image.to_owned(), source }
}
