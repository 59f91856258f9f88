//! The toolchain of the firmware: what compiles for AVR, what is missing and how to get it.

use std::env;
use std::path::Path;
use std::process::Command;

use crate::debian;
use crate::run::{self, Result};

/// Names the compiler to be used instead of the first that is found.
const COMPILER: &str = "FIRMWARE_RUSTC";
/// Debian's compiler of the security channel, beside its sources.
const DEBIAN_COMPILER: &str = "/usr/bin/rustc";

/// A Debian package and a file that shows that it is there.
struct Package {
    name: &'static str,
    proof: &'static [&'static str],
}

/// What builds the firmware.
const BUILD: [Package; 3] = [
    Package { name: "gcc-avr", proof: &["/usr/bin/avr-gcc"] },
    Package { name: "binutils-avr", proof: &["/usr/bin/avr-objdump"] },
    Package { name: "avr-libc", proof: &["/usr/lib/avr/include/avr/io.h"] },
];

/// The compiler and its sources.
const COMPILER_PACKAGES: [&str; 2] = ["rustc-web", "rust-web-src"];

/// What builds the simulator.
const SIMULATE: [Package; 6] = [
    Package { name: "libelf-dev", proof: &["/usr/include/libelf.h"] },
    Package { name: "zlib1g-dev", proof: &["/usr/include/zlib.h"] },
    Package { name: "libzstd-dev", proof: &["/usr/include/zstd.h"] },
    Package { name: "pkg-config", proof: &["/usr/bin/pkg-config"] },
    Package { name: "make", proof: &["/usr/bin/make"] },
    Package {
        name: "libclang-dev",
        proof: &[
            "/usr/lib/llvm-14/lib/libclang.so",
            "/usr/lib/llvm-15/lib/libclang.so",
            "/usr/lib/llvm-16/lib/libclang.so",
            "/usr/lib/llvm-17/lib/libclang.so",
            "/usr/lib/llvm-18/lib/libclang.so",
            "/usr/lib/llvm-19/lib/libclang.so",
        ],
    },
];

/// How a compiler is started.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Compiler {
    /// A stable compiler that has its sources beside it.
    At(String),
    /// The nightly of rustup.
    Nightly,
}

impl Compiler {
    /// A cargo that builds with it, to be started in the firmware's folder.
    pub(crate) fn cargo<'a>(&self, arguments: impl IntoIterator<Item = &'a str>) -> Command {
        match self {
            Self::At(rustc) => {
                let mut command = run::cargo(arguments);
                command.env("RUSTC", rustc).env("RUSTC_BOOTSTRAP", "1");
                command
            }
            Self::Nightly => {
                // The cargo that runs this program is no proxy of rustup, so it cannot be told.
                let mut command = Command::new("rustup");
                command.args(["run", "nightly", "cargo"]).args(arguments).env_remove("RUSTC").env_remove("CARGO");
                command
            }
        }
    }
}

/// Finds what builds the firmware and, if asked for, the simulator; installs what is missing where that is allowed, and
/// otherwise says what to install.
pub(crate) fn provide(simulator: bool) -> Result<Compiler> {
    let mut missing: Vec<&str> = BUILD
        .iter()
        .chain(SIMULATE.iter().filter(|_| simulator))
        .filter(|package| !package.proof.iter().any(|file| Path::new(file).exists()))
        .map(|package| package.name)
        .collect();
    let compiler = find_compiler();
    if compiler.is_err() && env::var_os(COMPILER).is_none() {
        missing.extend(COMPILER_PACKAGES);
    }
    if missing.is_empty() {
        return compiler;
    }
    debian::install(&missing, "build and test the firmware")?;
    find_compiler()
}

/// The compiler that is named, or Debian's, or the nightly, whichever can build the core library.
fn find_compiler() -> Result<Compiler> {
    if let Ok(named) = env::var(COMPILER) {
        return has_sources(&named).map(|()| Compiler::At(named));
    }
    let debian = has_sources(DEBIAN_COMPILER);
    if debian.is_ok() {
        return Ok(Compiler::At(DEBIAN_COMPILER.to_owned()));
    }
    let nightly = run::printed(Command::new("rustup").args(["run", "nightly", "rustc", "--print", "sysroot"]));
    match nightly {
        Ok(sysroot) if Path::new(&sysroot).join("lib/rustlib/src/rust/library/core").is_dir() => Ok(Compiler::Nightly),
        Ok(_) => Err("the nightly has no sources: rustup component add rust-src --toolchain nightly".to_owned()),
        Err(_) => debian.map(|()| Compiler::At(DEBIAN_COMPILER.to_owned())),
    }
}

/// Whether the sources of the core library lie beside the compiler and are of the same version; with others the build
/// would fail after a minute with errors that do not say why.
fn has_sources(rustc: &str) -> Result<()> {
    let version = run::printed(Command::new(rustc).arg("-vV"))?;
    let sysroot = run::printed(Command::new(rustc).args(["--print", "sysroot"]))?;
    let sources = Path::new(&sysroot).join("lib/rustlib/src/rust");
    if !sources.join("library/core").is_dir() {
        return Err(format!("{rustc} has no sources of the core library at {}", sources.display()));
    }
    let release = version.lines().find_map(|line| line.strip_prefix("release: ")).unwrap_or_default();
    // Rustup's sources carry no version and always fit.
    let found = std::fs::read_to_string(sources.join("src/version")).unwrap_or_else(|_| release.to_owned());
    if found.trim() == release {
        Ok(())
    } else {
        Err(format!(
            "{rustc} is {release} and the sources at {} are {}: apt-get install --only-upgrade {}",
            sources.display(),
            found.trim(),
            COMPILER_PACKAGES.join(" ")
        ))
    }
}
