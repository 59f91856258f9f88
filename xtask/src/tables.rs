//! Accuracy tables.

use crate::run::{self, Result};

/// Runs the program that measures the accuracy of every method, with its own arguments.
pub(crate) fn make(arguments: &[String]) -> Result<()> {
    // 'cargo xtask tables -- ARGS' means the same as without the dashes.
    let arguments = arguments.strip_prefix(&["--".to_owned()]).unwrap_or(arguments);
    let mut command = run::cargo(["run", "--release", "-p", "e2e-tests", "--bin", "protocol-p", "--"]);
    run::succeed(command.args(arguments))
}
