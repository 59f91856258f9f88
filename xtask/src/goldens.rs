//! The files that the project made itself: what stands in `fixtures` and the picture of the README.

use std::env::consts::EXE_SUFFIX;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::run::{self, Result};

const SAMPLE: &str = "fixtures/sample.png";
const README_PICTURE: &str = "docs/sample.png";

/// Of the format that is written; those of earlier versions can no longer be remade, and stay as they are.
const MODELS: &str = "fixtures/model/v1";

/// Goldens computed by an independent program: the script that prints each, and the file.
const BY_MPMATH: [(&str, &str); 4] = [
    ("fixtures/psf/make_figures.py", "fixtures/psf/figures.csv"),
    ("fixtures/psf/make_special.py", "fixtures/psf/special.csv"),
    ("fixtures/metrology/make_quantiles.py", "fixtures/metrology/quantiles.csv"),
    ("fixtures/least_squares/make_generalised.py", "fixtures/least_squares/generalised.csv"),
];
const MPMATH: &str = "mpmath==1.3.0";

/// Remakes all of them. Without Python or mpmath the others are made all the same, and the end is an error that says
/// what to install.
pub(crate) fn make() -> Result<()> {
    write_sample(&run::root().join(SAMPLE))?;
    // The program that draws the picture holds the sample, so the order matters.
    run::succeed(&mut run::cargo([
        "run",
        "-q",
        "-p",
        "blur-cli",
        "--example",
        "readme_picture",
        "--",
        README_PICTURE,
    ]))?;
    run::succeed(&mut run::cargo(["run", "-q", "-p", "blur-accel", "--example", "model_goldens", "--", MODELS]))?;
    has_mpmath()?;
    for (script, golden) in BY_MPMATH {
        print_to(script, golden)?;
    }
    println!("done; 'git diff --stat' shows what changed");
    Ok(())
}

/// Remakes the sample elsewhere and compares it with the committed file, byte by byte.
pub(crate) fn check_sample() -> Result<()> {
    let remade = run::target().join("sample.png");
    // Built for the whole workspace, as the tests were, nothing has to be built again: the features are the same.
    run::succeed(&mut run::workspace("build", ["--example", "sample"]))?;
    let program = run::target().join("debug/examples").join(format!("sample{EXE_SUFFIX}"));
    run::succeed(Command::new(program).arg(&remade))?;
    let read = |path: &Path| fs::read(path).map_err(|error| format!("{}: {error}", path.display()));
    if read(&remade)? == read(&run::root().join(SAMPLE))? {
        Ok(())
    } else {
        Err(format!("{SAMPLE} is not what the sources make; 'cargo xtask goldens' remakes it"))
    }
}

fn write_sample(path: &Path) -> Result<()> {
    run::succeed(run::cargo(["run", "-q", "-p", "blur-sim", "--example", "sample", "--"]).arg(path))
}

fn has_mpmath() -> Result<()> {
    let (_, wanted) = MPMATH.split_once("==").unwrap_or((MPMATH, ""));
    let check = format!("import mpmath; assert mpmath.__version__ == '{wanted}'");
    let status = Command::new("python3").args(["-c", &check]).stderr(Stdio::null()).status();
    if status.is_ok_and(|status| status.success()) {
        return Ok(());
    }
    let goldens: Vec<_> = BY_MPMATH.iter().map(|(_, golden)| *golden).collect();
    Err(format!(
        "not remade: {}; they need Python 3 and its package mpmath in the version of the goldens: pip install {MPMATH}",
        goldens.join(", ")
    ))
}

/// Writes what `script` prints to `golden`, and nothing at all if the script fails.
fn print_to(script: &str, golden: &str) -> Result<()> {
    let output = Command::new("python3")
        .arg(script)
        .current_dir(run::root())
        .stderr(Stdio::inherit())
        .output()
        .map_err(|error| format!("python3 cannot be started: {error}"))?;
    if !output.status.success() {
        return Err(format!("'python3 {script}' failed ({})", output.status));
    }
    fs::write(run::root().join(golden), output.stdout).map_err(|error| format!("{golden}: {error}"))?;
    println!("{golden}: by {script}");
    Ok(())
}
