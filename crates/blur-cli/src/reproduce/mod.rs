//! Tables that judge a method: the library of the program `reproduce`.
//!
//! A [`Table`] makes a [`Report`] from a [`Plan`]; [`TABLES`] lists them. Each is a file of its own that
//! draws its cases with a seed, has them measured on several threads in a fixed order, and summarises them.
//!
//! [`pictures`] (sharp) → [`shots`] (blurred, recorded) → [`outcome`] (measured, beside the truth) → [`statistics`],
//! [`cramer_rao`] → [`coverage`], [`efficiency`], [`negatives`] → [`report`] → [`boxplot`]. The table [`acceleration`] takes
//! its pictures on a virtual rig.

pub mod acceleration;
pub mod boxplot;
pub mod coverage;
pub mod cramer_rao;
pub mod efficiency;
pub mod negatives;
pub mod outcome;
pub mod pictures;
pub mod report;
pub mod shots;
pub mod statistics;

use std::fmt;
use std::path::PathBuf;

use rayon::prelude::*;

use crate::method::Method;
use crate::{Error, Result};
use outcome::Judge;
use report::Report;

/// What to measure, and with which method.
#[derive(Clone)]
pub struct Plan {
    /// The data folder, or any folder of sharp pictures.
    pub images: PathBuf,
    /// The method that is judged.
    pub method: Method,
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

/// One table.
pub struct Table {
    /// Name on the command line.
    pub name: &'static str,
    /// What it tells, in one line.
    pub summary: &'static str,
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
        name: "6.2",
        summary: "nineteen regressions, length alone and physics on the rig of the thesis's chapter 6",
        make: acceleration::table,
    },
    Table {
        name: "coverage",
        summary: "errors and stated uncertainties on photographs of any blur, by noise",
        make: coverage::table,
    },
    Table {
        name: "efficiency",
        summary: "errors on Gaussian fields beside the Cramér-Rao bound",
        make: efficiency::table,
    },
    Table {
        name: "negatives",
        summary: "sharp and defocused pictures that are taken for moved ones",
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
