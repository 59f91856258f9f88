//! The programs of the project, as a user runs them.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The root of the project.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The program `name` of a package, which is built if need be.
///
/// # Panics
///
/// When it cannot be built.
pub fn built(package: &str, name: &str) -> PathBuf {
    let built = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .args(["build", "--quiet", "--package", package, "--bin", name])
        .current_dir(root())
        .status()
        .is_ok_and(|status| status.success());
    assert!(built, "{name} cannot be built");
    // A test lies in the folder 'deps' of its profile, which lies beside the one that was built.
    let own = env::current_exe().unwrap_or_default();
    let target = own.ancestors().nth(3).unwrap_or(Path::new("")).join("debug");
    target.join(format!("{name}{}", env::consts::EXE_SUFFIX))
}
