//! Packages of Debian.

use std::path::Path;
use std::process::{Command, Stdio};

use crate::run::{self, Result};

/// Installs packages where that is allowed; the error says how to do it by hand. They are needed to `purpose`.
pub(crate) fn install(packages: &[&str], purpose: &str) -> Result<()> {
    let by_hand = format!("apt-get install -y --no-install-recommends {}", packages.join(" "));
    let is_root = run::printed(Command::new("id").arg("-u")).is_ok_and(|id| id == "0");
    if !is_root || !Path::new("/usr/bin/apt-get").exists() {
        return Err(format!("to {purpose}, on Debian: sudo {by_hand}"));
    }
    println!("installing to {purpose}: {}", packages.join(" "));
    let apt = || {
        let mut command = Command::new("apt-get");
        command.env("DEBIAN_FRONTEND", "noninteractive").stdout(Stdio::null());
        command
    };
    // What the machine knows of the packages may be too old to find them.
    run::succeed(apt().args(["update", "-q"]))?;
    run::succeed(apt().args(["install", "-y", "-q", "--no-install-recommends"]).args(packages))
        .map_err(|error| format!("{error}; by hand: {by_hand}"))
}
