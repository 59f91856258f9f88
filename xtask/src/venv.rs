//! Environments of Python for tests, and what they count.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::debian;
use crate::run::{self, Result};
use crate::test::Counts;

const OLDEST: &str = "import sys; sys.exit(sys.version_info < (3, 10))";

/// A virtual environment under the target folder.
#[derive(Debug, Clone)]
pub(crate) struct Environment {
    folder: PathBuf,
}

impl Environment {
    /// One that has what a file of requirements lists.
    pub(crate) fn with(name: &str, requirements: &str) -> Result<Self> {
        let environment = Self::new(name, false)?;
        let mut install = environment.module("pip");
        run::succeed(install.args(["install", "-q", "--no-cache-dir", "-r", requirements]))?;
        Ok(environment)
    }

    /// An empty one, or the one of that name unless it is to be made `anew`.
    pub(crate) fn new(name: &str, anew: bool) -> Result<Self> {
        let folder = run::target().join(name);
        let environment = Self { folder };
        if !anew && environment.module("pip").arg("--version").stdout(Stdio::null()).status().is_ok_and(|s| s.success())
        {
            return Ok(environment);
        }
        let make = || run::succeed(Command::new("python3").args(["-m", "venv", "--clear"]).arg(&environment.folder));
        if run::printed(Command::new("python3").args(["-c", OLDEST])).is_err() || make().is_err() {
            debian::install(&["python3", "python3-venv"], "test the Python package")?;
            run::printed(Command::new("python3").args(["-c", OLDEST]))
                .map_err(|_| "python3 is older than 3.10".to_owned())?;
            make()?;
        }
        Ok(environment)
    }

    /// Its interpreter, started from the root of the workspace.
    pub(crate) fn python(&self) -> Command {
        let mut command = Command::new(self.folder.join(if cfg!(windows) { "Scripts/python" } else { "bin/python" }));
        command.current_dir(run::root()).env("PIP_DISABLE_PIP_VERSION_CHECK", "1");
        command
    }

    /// A module run as a program.
    pub(crate) fn module(&self, name: &str) -> Command {
        let mut command = self.python();
        command.args(["-m", name]);
        command
    }

    /// Installs a wheel whatever is installed already, without what it requires.
    pub(crate) fn install_wheel(&self, wheel: &Path) -> Result<()> {
        let mut install = self.module("pip");
        run::succeed(install.args(["install", "-q", "--no-deps", "--force-reinstall"]).arg(wheel))
    }
}

/// Runs pytest, shows what it prints and counts the tests.
pub(crate) fn count(pytest: &mut Command) -> Result<Counts> {
    let shown = run::shown(pytest);
    let output = pytest
        .args(["-q", "-rs", "-p", "no:cacheprovider"])
        .stderr(Stdio::inherit())
        .output()
        .map_err(|error| format!("'{shown}' cannot be started: {error}"))?;
    let printed = String::from_utf8_lossy(&output.stdout);
    println!("{printed}");
    let counts = printed.lines().rev().find_map(counts_of).unwrap_or_default();
    if output.status.success() && counts.passed > 0 {
        Ok(counts)
    } else {
        Err(format!("'{shown}': {} passed, {} failed ({})", counts.passed, counts.failed, output.status))
    }
}

/// The counts of a last line `1 failed, 59 passed, 2 skipped in 26.72s`, if it is one.
fn counts_of(line: &str) -> Option<Counts> {
    let (counts, _) = line.trim_matches(['=', ' ']).rsplit_once(" in ")?;
    let mut found = Counts::default();
    for count in counts.split(", ") {
        let (number, what) = count.split_once(' ')?;
        let number = number.parse().ok()?;
        match what {
            "passed" => found.passed = number,
            "failed" | "error" | "errors" => found.failed += number,
            "skipped" => found.ignored = number,
            _ => {}
        }
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_counted_from_the_last_line_of_pytest() {
        let expected = Counts { passed: 59, failed: 3, ignored: 2 };
        assert_eq!(counts_of("1 failed, 59 passed, 2 skipped, 4 warnings, 2 errors in 26.72s"), Some(expected));
        assert_eq!(counts_of("=== 1 passed in 0.01s ===").map(|counts| counts.passed), Some(1));
        assert_eq!(counts_of("a line in between"), None);
    }
}
