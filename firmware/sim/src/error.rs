//! What can go wrong in a run.

use std::path::PathBuf;

/// Why a program could not be loaded, or why a run ended early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimError {
    /// The ELF file could not be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is not a program for the ATmega328P.
    #[error("{}: not a program for an ATmega328P: {reason}", path.display())]
    Elf {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A line of a waveform's file cannot be used.
    #[error("{}:{line}: {reason}", path.display())]
    Wave {
        /// The file.
        path: PathBuf,
        /// Number of the line, from 1; 0 in an empty file.
        line: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// The simulator does not know the ATmega328P, or had no memory for it.
    #[error("the simulator has no atmega328p")]
    Core,
    /// The program ran out of its code, or the core gave up.
    #[error("crashed at {pc:#06x} in cycle {cycle}")]
    Crashed {
        /// Program counter, bytes.
        pc: u32,
        /// Cycle of the crash.
        cycle: u64,
    },
    /// The program met an instruction that the ATmega328P does not have.
    #[error("bad instruction {opcode:#06x} at {pc:#06x} in cycle {cycle}")]
    BadInstruction {
        /// Program counter, bytes.
        pc: u32,
        /// The instruction's first word.
        opcode: u16,
        /// Cycle of the instruction.
        cycle: u64,
    },
    /// The program sleeps with interrupts off: only a reset would wake it.
    #[error("asleep for good (interrupts are off) at {pc:#06x} in cycle {cycle}")]
    Asleep {
        /// Program counter, bytes.
        pc: u32,
        /// Cycle at which it fell asleep.
        cycle: u64,
    },
    /// The simulated serial line could not be offered to the host, or failed.
    #[error("serial line: {0}")]
    Line(#[from] std::io::Error),
}
