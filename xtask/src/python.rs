//! The Python package: its wheel, its tests, and the examples that use it.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use crate::run::{self, Result};
use crate::test::Counts;
use crate::venv::{self, Environment};

const PACKAGE: &str = "crates/blur-py";
const REQUIREMENTS: &str = "crates/blur-py/requirements-test.txt";
const DISTRIBUTED: &str = "examples/distributed";
const NOTEBOOK: &str = "examples/python/notebook.py";
/// Names the program that the tests compare with, bit for bit.
const ESTIMATE: &str = "BLUR_ESTIMATE";

/// What a newcomer tries first.
const FIRST_LINES: &str = "\
import motion_blur
picture = motion_blur.simulate((256, 256), 20.0, 30.0, noise_db=40.0, seed=1)
record = motion_blur.estimate(picture, exposure_s=0.01, scale_m_per_px=1e-3)
print(record.angle_deg, record.length_px, record.speed_m_s)
assert abs(record.length_px - 20.0) < 0.2 and abs(record.speed_m_s - 2.0) < 0.02
";

/// Finds Python and makes the environment of the tests, with the versions that they were written for.
pub(crate) fn provide() -> Result<Environment> {
    Environment::with("python", REQUIREMENTS)
}

/// The environment of the distributed examples, whose engines are large.
pub(crate) fn provide_engines() -> Result<Environment> {
    Environment::with("python-distributed", &format!("{DISTRIBUTED}/requirements-distributed.txt"))
}

/// Builds the wheel, installs it, and runs all that tests it.
pub(crate) fn test(environment: &Environment, data: Option<&Path>) -> Result<Counts> {
    let wheel = wheel(environment)?;
    starts_from_nothing(&wheel)?;
    environment.install_wheel(&wheel)?;
    run::build_programs(["estimate"])?;
    let estimate = run::target().join("debug").join(format!("estimate{}", env::consts::EXE_SUFFIX));
    let notebook = run::root().join(NOTEBOOK);

    let mut types = environment.module("mypy");
    run::succeed(types.args(["--strict", "tests", "benches"]).arg(&notebook).current_dir(run::root().join(PACKAGE)))?;
    run::succeed(environment.module("mypy.stubtest").arg("motion_blur"))?;
    let figures = run::target().join("artefacts/python");
    run::succeed(environment.python().arg(&notebook).arg(&figures))?;
    let mut tests = environment.module("pytest");
    tests.arg(PACKAGE).env(ESTIMATE, estimate);
    if let Some(data) = data {
        tests.env("BLUR_DATA", data);
    }
    venv::count(&mut tests)
}

/// Runs the distributed examples on local clusters of the real engines. The wheel has been built by [`test()`].
pub(crate) fn test_engines(engines: &Environment, wheel_by: &Environment) -> Result<Counts> {
    engines.install_wheel(&wheel(wheel_by)?)?;
    let mut types = engines.module("mypy");
    run::succeed(types.arg(".").current_dir(run::root().join(DISTRIBUTED)))?;
    venv::count(engines.module("pytest").arg(DISTRIBUTED))
}

/// The wheel, built anew where its sources changed.
fn wheel(environment: &Environment) -> Result<PathBuf> {
    let folder = run::target().join("wheels");
    // Wheels of other versions must not be taken for this one.
    if folder.exists() {
        fs::remove_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    }
    let manifest = run::root().join(PACKAGE).join("Cargo.toml");
    // With the profile that all else is tested with, so that nothing is built twice.
    let mut maturin = environment.module("maturin");
    maturin.args(["build", "--profile", "dev", "--locked", "--quiet", "--out"]).arg(&folder);
    run::succeed(maturin.arg("--manifest-path").arg(manifest))?;
    let mut files = fs::read_dir(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    match files.next() {
        Some(Ok(file)) => Ok(file.path()),
        _ => Err(format!("maturin left no wheel in {}", folder.display())),
    }
}

/// Installs the wheel where nothing else is and measures a picture.
fn starts_from_nothing(wheel: &Path) -> Result<()> {
    let clean = Environment::new("python-clean", true)?;
    run::succeed(clean.module("pip").args(["install", "-q", "--no-cache-dir"]).arg(wheel))?;
    run::succeed(clean.python().args(["-c", FIRST_LINES]))
}
