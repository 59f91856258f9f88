//! The bags and the node of ROS 2, tried by programs in Python that know nothing of this project.

use crate::run::{self, Result};
use crate::test::Counts;
use crate::venv::{self, Environment};

const TESTS: &str = "crates/blur-ros/tests/python";
const REQUIREMENTS: &str = "crates/blur-ros/requirements-test.txt";
/// Tells the tests where the programs are.
const PROGRAMS: &str = "BLUR_PROGRAMS";

/// The environment that has what the tests require.
pub(crate) fn provide() -> Result<Environment> {
    Environment::with("python-ros", REQUIREMENTS)
}

/// Builds the programs and runs the tests.
pub(crate) fn test(environment: &Environment) -> Result<Counts> {
    run::build_programs(["estimate", "blur-node"])?;
    venv::count(environment.module("pytest").arg(TESTS).env(PROGRAMS, run::target().join("debug")))
}
