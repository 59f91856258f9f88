//! Builds the small C programs that the harness is tried with; they share nothing with the firmware under test.

// Each test program uses only some of this.
#![allow(dead_code, unreachable_pub, clippy::expect_used)]

use slider_sim::Mcu;
use std::{path::PathBuf, process::Command};

/// Builds `tests/programs/<program>.c` with avr-gcc and the given macros.
pub fn build(program: &str, defines: &[&str]) -> PathBuf {
    let source = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/programs").join(program).with_extension("c");
    let suffix: String = defines.concat().chars().filter(char::is_ascii_alphanumeric).collect();
    // Two tests may build the same program at once.
    let unique = format!("{program}{suffix}-{}-{:?}.elf", std::process::id(), std::thread::current().id());
    let elf = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(unique);
    let done = Command::new("avr-gcc")
        .args(["-mmcu=atmega328p", "-DF_CPU=16000000UL", "-Os", "-Wall", "-Wextra", "-Werror", "-o"])
        .arg(&elf)
        .arg(&source)
        .args(defines.iter().map(|define| format!("-D{define}")))
        .status()
        .expect("avr-gcc is needed: apt-get install gcc-avr avr-libc");
    assert!(done.success(), "{} does not compile", source.display());
    elf
}

/// Builds and loads a program.
pub fn load(program: &str, defines: &[&str]) -> Mcu {
    let elf = build(program, defines);
    let mcu = Mcu::load(&elf).expect("a program");
    std::fs::remove_file(elf).expect("the file just made");
    mcu
}

/// A byte in RAM by the name of its variable.
pub fn variable(mcu: &Mcu, name: &str) -> u8 {
    bytes(mcu, name, 1)[0]
}

/// Bytes in RAM by the name of their variable.
pub fn bytes<'a>(mcu: &'a Mcu, name: &str, length: usize) -> &'a [u8] {
    let address = mcu.symbol(name).expect("a variable of the program") as usize;
    &mcu.memory()[address..address + length]
}
