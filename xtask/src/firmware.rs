//! Builds the firmware and holds it to its budget.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::avr::Compiler;
use crate::run::{self, Result};
use crate::stack::Program;

/// Both firmwares.
const PROGRAMS: [&str; 2] = ["timer", "drive"];

/// Flash of the `ATmega328P` that the larger of the two usual bootloaders leaves, in bytes.
const FLASH: u32 = 30 * 1024;
/// Its memory.
const RAM: u32 = 2048;
/// Shares that may be used, in per cent.
const MOST_FLASH: u32 = 50;
const MOST_RAM: u32 = 60;

/// The workspace of the firmware.
pub(crate) fn folder() -> PathBuf {
    run::root().join("firmware")
}

/// Builds both ELF files and prints what they take; the error says what is over its budget.
pub(crate) fn build(compiler: &Compiler) -> Result<()> {
    run::succeed(compiler.cargo(["build", "--release", "--locked"]).current_dir(folder()))?;
    println!("{:<6}  {:>16}  {:>14}  {:>14}  {:>16}", "", "flash", "static RAM", "stack", "RAM in all");
    let mut over = Vec::new();
    for program in PROGRAMS {
        let elf = elf(program);
        let size = Size::of(&elf)?;
        let disassembly = printed(Command::new("avr-objdump").arg("-d").arg(&elf))?;
        let multiplying = multiplying(&disassembly);
        if !multiplying.is_empty() {
            over.push(format!(
                "{program}: {} use the multiplier, whose product the compiler may lose (slider-fw/src/arithmetic.rs): \
                 is '-C target-feature=-mul' still in firmware/.cargo/config.toml?",
                multiplying.join(", ")
            ));
        }
        let depth = Program::parse(&disassembly).depth()?;
        let stack = depth.main + depth.interrupt;
        let ram = size.ram + stack;
        println!(
            "{program:<6}  {:>7} B {:>5.1} %  {:>12} B  {:>5} + {:>4} B  {:>7} B {:>5.1} %",
            size.flash,
            percent(size.flash, FLASH),
            size.ram,
            depth.main,
            depth.interrupt,
            ram,
            percent(ram, RAM),
        );
        if size.flash * 100 > FLASH * MOST_FLASH {
            over.push(format!("{program}: flash over {MOST_FLASH} % of {FLASH} B"));
        }
        if ram * 100 > RAM * MOST_RAM {
            over.push(format!("{program}: RAM over {MOST_RAM} % of {RAM} B"));
        }
    }
    println!("stack: the deepest chain of calls from reset and of one interrupt on top of it, from the disassembly");
    if over.is_empty() { Ok(()) } else { Err(over.join("; ")) }
}

/// Functions that multiply in hardware, but for those of libgcc.
fn multiplying(disassembly: &str) -> Vec<&str> {
    let mut name = "";
    let mut found = Vec::new();
    for line in disassembly.lines() {
        if let Some((_, label)) = line.strip_suffix(">:").and_then(|line| line.split_once(" <")) {
            name = label;
        }
        let mnemonic = line.split('\t').nth(2).unwrap_or_default();
        let multiplies = mnemonic.starts_with("mul") || mnemonic.starts_with("fmul");
        if multiplies && !name.starts_with("__") && found.last() != Some(&name) {
            found.push(name);
        }
    }
    found
}

/// Where a program is built.
pub(crate) fn elf(program: &str) -> PathBuf {
    let target =
        std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| folder().join("target"), |to| run::root().join(to));
    target.join("avr-none/release").join(format!("{program}.elf"))
}

/// What a program takes, in bytes.
#[derive(Debug, PartialEq, Eq)]
struct Size {
    flash: u32,
    ram: u32,
}

impl Size {
    fn of(elf: &Path) -> Result<Self> {
        Self::parse(&printed(Command::new("avr-size").arg("-A").arg(elf))?)
    }

    /// Reads what `avr-size -A` prints.
    fn parse(sections: &str) -> Result<Self> {
        let section = |name: &str| {
            let mut lines = sections.lines().map(str::split_whitespace);
            lines.find_map(|mut words| (words.next() == Some(name)).then(|| words.next()?.parse::<u32>().ok())?)
        };
        let text = section(".text").ok_or_else(|| format!("no section .text in\n{sections}"))?;
        let data = section(".data").unwrap_or(0);
        let zeroed = section(".bss").unwrap_or(0) + section(".noinit").unwrap_or(0);
        Ok(Self { flash: text + data, ram: data + zeroed })
    }
}

fn percent(part: u32, whole: u32) -> f64 {
    f64::from(part) * 100.0 / f64::from(whole)
}

fn printed(command: &mut Command) -> Result<String> {
    let shown = run::shown(command);
    let output =
        command.stderr(Stdio::inherit()).output().map_err(|error| format!("'{shown}' cannot be started: {error}"))?;
    if output.status.success() {
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    } else {
        Err(format!("'{shown}' failed ({})", output.status))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_library_may_multiply() {
        let disassembly = "\
00002f12 <__muluhisi3>:
    2f12:\ta2 9f       \tmul\tr26, r18
00000100 <index>:
     100:\t89 9f       \tmul\tr24, r25
     102:\t81 2d       \tmov\tr24, r1
     104:\t89 02       \tmuls\tr24, r25
";
        assert_eq!(multiplying(disassembly), ["index"]);
    }

    #[test]
    fn initialised_data_count_in_flash_and_in_ram() {
        let printed = "\
drive.elf  :
section        size      addr
.data           200   8388864
.text         12146         0
.bss            410   8389064
.comment         74         0
";
        assert_eq!(Size::parse(printed), Ok(Size { flash: 12_346, ram: 610 }));
        assert!(Size::parse("nothing").is_err());
    }
}
