//! Everything that tests the project.

use std::env;
use std::fs;
use std::io::{BufRead, BufReader};
use std::ops::AddAssign;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::avr;
use crate::chromium;
use crate::firmware;
use crate::goldens;
use crate::native;
use crate::package;
use crate::python;
use crate::ros;
use crate::run::{self, Result};

const DATA: &str = "BLUR_DATA";
const REQUIRE_DATA: &str = "BLUR_REQUIRE_DATA";
/// Tells the tests that the firmware has been built, so none of them may skip for want of it.
const REQUIRE_FIRMWARE: &str = "BLUR_REQUIRE_FIRMWARE";
/// Where tests leave what people may want to look at.
const ARTEFACTS: &str = "BLUR_ARTEFACTS";
/// Set to `true` by most services that run tests: then nothing may be skipped.
const CI: &str = "CI";
/// Where the data are when nobody says where, from the root of the workspace.
const USUAL_DATA: &str = "../shared/data";

/// Runs every test, or the steps whose names contain `part`, and prints a summary; the error says how many steps failed.
pub(crate) fn all(part: Option<&str>) -> Result<()> {
    let data = find_data()?;
    match &data {
        Some(folder) => println!("data: {}", folder.display()),
        None => println!("data: {}", without_data()),
    }
    let mut workspace = run::workspace("test", ["--no-fail-fast"]);
    let mut long = run::workspace("test", ["--no-fail-fast"]);
    long.args(e2e_tests()?.iter().flat_map(|name| ["--test", name])).args(["--", "--ignored"]);
    let mut report = run::workspace("test", ["--test", "browser", "--", "--ignored"]);
    let artefacts =
        env::var_os(ARTEFACTS).map_or_else(|| run::target().join("artefacts"), |folder| run::root().join(folder));
    report.env(ARTEFACTS, &artefacts);
    for command in [&mut workspace, &mut long, &mut report] {
        command.env(REQUIRE_FIRMWARE, "1");
        if let Some(folder) = &data {
            command.env(DATA, folder);
        }
    }
    let may_skip = env::var_os(CI).is_none_or(|value| value != "true");
    let mut steps = Steps { part, may_skip, done: Vec::new(), skipped: Vec::new() };
    let none = |()| Counts::default();
    // The firmware first: a test of the workspace runs it.
    steps.run("firmware builds and keeps its budget", || firmware::build(&avr::provide(true)?).map(none));
    steps.run("firmware in the simulator", simulate);
    steps.run("tests and examples in the documentation", || count(&mut workspace));
    steps.run("long tests, which a plain 'cargo test' leaves out", || count(&mut long));
    steps.run("the sample can be remade byte by byte", || goldens::check_sample().map(none));
    steps.run_with("the report in a browser", chromium::provide, |browser| {
        println!("pictures of the report: {}", artefacts.join("report").display());
        count(report.env(chromium::BROWSER, browser))
    });
    let tools = || native::provide(!may_skip);
    steps.run_with("C and C++: the headers stand alone", tools, |()| native::check_headers().map(none));
    steps.run_with("C and C++: programs", tools, |()| count(&mut native::build_examples()?));
    steps.run_with("C and C++: sanitizers", tools, |()| native::sanitize().map(none));
    steps.run_with("ROS 2 bags and the node", ros::provide, |environment| ros::test(&environment));
    steps.run_with("Python: the package", python::provide, |package| python::test(&package, data.as_deref()));
    steps.run_with(
        "Python: the distributed examples",
        || Ok((python::provide_engines()?, python::provide()?)),
        |(engines, package)| python::test_engines(&engines, &package),
    );
    steps.run("crates: packages build by themselves", || package::build().map(none));
    steps.run_with("crates: the oldest compiler promised", package::oldest_compiler, |version| {
        package::check_with(&version).map(none)
    });
    match package::baseline() {
        Ok(baseline) => steps.run_with(
            "crates: interfaces keep what was promised",
            || package::semver(!may_skip),
            |program| package::compare(&program, &baseline).map(none),
        ),
        Err(why) => steps.skipped.push(("crates: interfaces keep what was promised", why)),
    }
    if data.is_none() {
        steps.skipped.push(("measurements of real photographs", without_data()));
    }
    steps.summarise()
}

/// Names of the tests in `tests/`.
fn e2e_tests() -> Result<Vec<String>> {
    let folder = run::root().join("tests/tests");
    let files = fs::read_dir(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut names: Vec<String> = files
        .filter_map(|file| Some(file.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|extension| extension == "rs"))
        .filter_map(|path| Some(path.file_stem()?.to_string_lossy().into_owned()))
        .collect();
    names.sort();
    Ok(names)
}

/// Runs the firmware and the simulator's own tests. That no test was run is an error.
fn simulate() -> Result<Counts> {
    let mut simulator = run::cargo(["test", "--release", "--locked", "--no-fail-fast"]);
    // Flash is scarce, the memory of this machine is not: its programs need not be small, and are built sooner.
    let soon = [("LTO", "off"), ("CODEGEN_UNITS", "16"), ("OPT_LEVEL", "2")];
    simulator.envs(soon.map(|(name, value)| (format!("CARGO_PROFILE_RELEASE_{name}"), value)));
    let counts = count(simulator.current_dir(firmware::folder().join("sim")))?;
    if counts.passed == 0 { Err("no test of the firmware was run".to_owned()) } else { Ok(counts) }
}

fn without_data() -> String {
    format!(
        "no real photographs at {USUAL_DATA}, so the tests in tests/ that measure them skip and pass; {DATA} says where \
         they are"
    )
}

/// The folder of real photographs as an absolute path, since each test runs in the folder of its own package.
fn find_data() -> Result<Option<PathBuf>> {
    let named = env::var_os(DATA);
    let folder = run::root().join(named.as_deref().unwrap_or(USUAL_DATA.as_ref()));
    match folder.canonicalize() {
        Ok(folder) if folder.is_dir() => Ok(Some(folder)),
        _ if named.is_some() => Err(format!("{DATA} names {}, which is not a folder", folder.display())),
        _ if env::var_os(REQUIRE_DATA).is_some() => {
            Err(format!("{REQUIRE_DATA} is set and there is no folder {}", folder.display()))
        }
        _ => Ok(None),
    }
}

/// Numbers of tests.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Counts {
    pub(crate) passed: u32,
    pub(crate) failed: u32,
    pub(crate) ignored: u32,
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.passed += other.passed;
        self.failed += other.failed;
        self.ignored += other.ignored;
    }
}

impl Counts {
    /// The counts of a line `test result: ok. 3 passed; 0 failed; 1 ignored; ...`, if it is one.
    fn from_line(line: &str) -> Option<Self> {
        let (_, counts) = line.strip_prefix("test result: ")?.split_once(". ")?;
        let count = |what: &str| {
            let field = counts.split("; ").find_map(|field| field.strip_suffix(what))?;
            field.trim().parse().ok()
        };
        Some(Self { passed: count("passed")?, failed: count("failed")?, ignored: count("ignored")? })
    }
}

/// Runs tests, shows what they print and counts them. The error holds what failed.
fn count(command: &mut Command) -> Result<Counts> {
    let shown = run::shown(command);
    let mut child =
        command.stdout(Stdio::piped()).spawn().map_err(|error| format!("'{shown}' cannot be started: {error}"))?;
    let mut counts = Counts::default();
    for line in child.stdout.take().into_iter().flat_map(|stdout| BufReader::new(stdout).split(b'\n')) {
        let line = line.map_err(|error| format!("'{shown}' cannot be read: {error}"))?;
        let line = String::from_utf8_lossy(&line);
        println!("{line}");
        if let Some(more) = Counts::from_line(&line) {
            counts += more;
        }
    }
    let status = child.wait().map_err(|error| format!("'{shown}' is lost: {error}"))?;
    if status.success() {
        Ok(counts)
    } else {
        Err(format!("'{shown}': {} passed, {} failed ({status})", counts.passed, counts.failed))
    }
}

/// One part of the tests, done.
struct Step {
    name: &'static str,
    outcome: Result<Counts>,
    took: Duration,
}

impl Step {
    fn print(&self) {
        let Self { name, took, .. } = self;
        let seconds = took.as_secs();
        match &self.outcome {
            Ok(Counts { passed: 0, .. }) => println!("  ok      {name}, {seconds} s"),
            Ok(Counts { passed, ignored: 0, .. }) => println!("  ok      {name}: {passed} passed, {seconds} s"),
            Ok(Counts { passed, ignored, .. }) => {
                println!("  ok      {name}: {passed} passed, {ignored} left out, {seconds} s");
            }
            Err(error) => println!("  FAILED  {name}, {seconds} s: {error}"),
        }
    }
}

/// All parts of the tests, those done and those left out.
struct Steps<'a> {
    /// Only those whose names contain it.
    part: Option<&'a str>,
    may_skip: bool,
    done: Vec<Step>,
    skipped: Vec<(&'static str, String)>,
}

impl Steps<'_> {
    fn run(&mut self, name: &'static str, work: impl FnOnce() -> Result<Counts>) {
        if !self.is_asked(name) {
            return;
        }
        println!("\n=== {name}");
        let start = Instant::now();
        let outcome = work();
        self.done.push(Step { name, outcome, took: start.elapsed() });
    }

    /// A part that needs something that not every machine has: without it the part is left out where that is allowed, and
    /// the summary tells what to install; else it is an error.
    fn run_with<T>(
        &mut self,
        name: &'static str,
        provide: impl FnOnce() -> Result<T>,
        work: impl FnOnce(T) -> Result<Counts>,
    ) {
        if !self.is_asked(name) {
            return;
        }
        match provide() {
            Err(why) if self.may_skip => self.skipped.push((name, why)),
            provided => self.run(name, || work(provided?)),
        }
    }

    fn is_asked(&self, name: &str) -> bool {
        self.part.is_none_or(|part| name.contains(part))
    }

    /// Prints what became of them; the error says how many failed.
    fn summarise(&self) -> Result<()> {
        println!("\nSummary");
        for step in &self.done {
            step.print();
        }
        for (name, why) in &self.skipped {
            println!("  skipped {name}: {why}");
        }
        match self.done.iter().filter(|step| step.outcome.is_err()).count() {
            0 if self.done.is_empty() && self.skipped.is_empty() => {
                Err(format!("no step has '{}' in its name", self.part.unwrap_or_default()))
            }
            0 => Ok(()),
            failed => Err(format!("{failed} of {} steps failed", self.done.len())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_counted_from_the_lines_of_the_test_harness() {
        let line = "test result: FAILED. 12 passed; 2 failed; 1 ignored; 0 measured; 3 filtered out; finished in 0.52s";
        assert_eq!(Counts::from_line(line), Some(Counts { passed: 12, failed: 2, ignored: 1 }));
        assert_eq!(Counts::from_line("test result_of_a_test ... ok"), None);
        assert_eq!(Counts::from_line("running 3 tests"), None);
    }

    #[test]
    fn a_command_that_fails_is_an_error() {
        assert!(count(&mut run::cargo(["no-such-command"])).is_err());
        assert!(count(&mut run::cargo(["--version"])).is_ok());
    }
}
