//! What is published: packages that build by themselves, with the oldest compiler promised, and keep their interface.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::run::{self, Result};

/// Members of the workspace that are never published to the registry of crates.
const PRIVATE: [&str; 4] = ["blur-benches", "blur-py", "e2e-tests", "xtask"];
/// Those whose interface is compared with that of the last release: what others build upon.
const INTERFACES: [&str; 3] = ["metrology", "blur-core", "blur-sim"];
/// The program that compares interfaces.
const SEMVER: &str = "cargo-semver-checks";
const SEMVER_VERSION: &str = "0.51.0";

/// Packs every crate that is published and builds it from its package.
pub(crate) fn build() -> Result<()> {
    let mut command = run::cargo(["package", "--workspace", "--locked", "--quiet"]);
    // What is not committed yet is packed too: a test must see it.
    command.arg("--allow-dirty").args(without_private());
    run::succeed(&mut command)
}

/// Whether the oldest compiler promised can be had.
pub(crate) fn oldest_compiler() -> Result<String> {
    let version = setting("rust-version")?;
    let mut rustup = Command::new("rustup");
    run::succeed(rustup.args(["toolchain", "install", &version, "--profile", "minimal", "--no-self-update"]))
        .map_err(|error| format!("Rust {version} by rustup (https://rustup.rs): {error}"))?;
    Ok(version)
}

/// Checks what is published with that compiler.
pub(crate) fn check_with(version: &str) -> Result<()> {
    let mut command = Command::new("rustup");
    command.current_dir(run::root()).args(["run", version, "cargo", "check", "--workspace", "--locked", "--quiet"]);
    // The compiler of the caller must not build it instead.
    command.env_remove("CARGO").env_remove("RUSTC").env("CARGO_TARGET_DIR", run::target().join("oldest"));
    run::succeed(command.args(without_private()))
}

/// The revision of the last release, when the history reaches back to it.
pub(crate) fn baseline() -> Result<String> {
    let revision = setting("baseline")?;
    let git = |arguments: &[&str]| run::printed(Command::new("git").current_dir(run::root()).args(arguments));
    let commit = format!("{revision}^{{commit}}");
    if git(&["cat-file", "-e", &commit]).is_err() {
        // A clone without its history; without a network this does nothing.
        let _ = git(&["fetch", "-q", "--unshallow"]);
    }
    let found = git(&["cat-file", "-e", &commit]);
    found.map(|_| revision.clone()).map_err(|_| format!("the history lacks the last release, revision {revision}"))
}

/// The program that compares interfaces.
pub(crate) fn semver(may_install: bool) -> Result<PathBuf> {
    if run::printed(Command::new(SEMVER).arg("--version")).is_ok() {
        return Ok(SEMVER.into());
    }
    let tools = run::target().join("tools");
    let program = tools.join("bin").join(SEMVER);
    if program.exists() {
        return Ok(program);
    }
    let install = ["install", SEMVER, "--version", SEMVER_VERSION, "--locked"];
    if !may_install {
        return Err(format!("{SEMVER}: cargo {}", install.join(" ")));
    }
    let mut command = run::cargo(install);
    // It runs once or twice: a quick build is better than a quick program.
    run::succeed(command.arg("--debug").arg("--root").arg(&tools).env("CARGO_TARGET_DIR", tools.join("build")))?;
    Ok(program)
}

/// Compares the interfaces with those of the last release, as far as the version in `Cargo.toml` allows changes.
pub(crate) fn compare(program: &Path, baseline: &str) -> Result<()> {
    let mut command = Command::new(program);
    command.current_dir(run::root()).args(["semver-checks", "--baseline-rev", baseline]);
    run::succeed(command.args(INTERFACES.into_iter().flat_map(|name| ["--package", name])))
}

fn without_private() -> impl Iterator<Item = &'static str> {
    PRIVATE.into_iter().flat_map(|name| ["--exclude", name])
}

/// A quoted setting of the workspace's manifest.
fn setting(name: &str) -> Result<String> {
    let path = run::root().join("Cargo.toml");
    let manifest = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let value = manifest.lines().find_map(|line| line.strip_prefix(name)?.trim_start().strip_prefix('='));
    value.map(|value| value.trim().trim_matches('"').to_owned()).ok_or(format!("{} has no {name}", path.display()))
}
