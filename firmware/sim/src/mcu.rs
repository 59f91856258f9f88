//! The controller on its rig.

use crate::{
    CYCLES_PER_SECOND, SimError,
    avr::{Core, Stop},
    elf::Image,
    interrupts::InterruptLog,
    memory,
    pin::{Change, Delivered, Pin},
    pwm::PwmChange,
    uart::{Sent, Uart},
};
use std::{collections::BTreeMap, path::Path};

/// A simulated ATmega328P at 16 MHz that runs a program. Several may live at once, in any threads.
pub struct Mcu {
    core: Core,
    symbols: BTreeMap<String, u32>,
}

impl Mcu {
    /// Loads a program from an ELF file; the first instruction is at address 0, no bootloader before it.
    ///
    /// Free SRAM is painted for [`Mcu::stack_high_water`]; all of it is undefined to the program, as after power-up.
    pub fn load(elf: &Path) -> Result<Self, SimError> {
        let image = Image::read(elf)?;
        let mut core = Core::new(&image, CYCLES_PER_SECOND as u32).ok_or(SimError::Core)?;
        memory::paint(core.memory_mut());
        Ok(Self { core, symbols: image.symbols })
    }

    /// Cycles since power-up; a reset does not set it back.
    pub fn cycle(&self) -> u64 {
        self.core.cycle()
    }

    /// Address of the next instruction, bytes.
    pub fn pc(&self) -> u32 {
        self.core.pc()
    }

    /// Goes on at a symbol of the program, as a program that has run wild might; `None` when there is no such symbol.
    pub fn jump(&mut self, name: &str) -> Option<()> {
        self.core.set_pc(self.symbol(name)?);
        Some(())
    }

    /// Resets since power-up, by the watchdog.
    pub fn resets(&self) -> u32 {
        self.core.resets()
    }

    /// Runs to the first instruction boundary at `cycle` or later.
    pub fn run_until(&mut self, cycle: u64) -> Result<(), SimError> {
        while self.cycle() < cycle {
            self.step(cycle, false)?;
        }
        Ok(())
    }

    /// Runs for some cycles.
    pub fn run_for(&mut self, cycles: u64) -> Result<(), SimError> {
        self.run_until(self.cycle() + cycles)
    }

    /// Runs while `condition` holds, which is asked after every instruction, and for at most `limit` cycles; says whether
    /// the condition ended it.
    pub fn run_while(&mut self, mut condition: impl FnMut(&Self) -> bool, limit: u64) -> Result<bool, SimError> {
        let end = self.cycle() + limit;
        while condition(self) {
            if self.cycle() >= end {
                return Ok(false);
            }
            self.step(end, true)?;
        }
        Ok(true)
    }

    fn step(&mut self, until: u64, single: bool) -> Result<(), SimError> {
        let cycle = self.cycle();
        self.core.step(until, single).map_err(|stop| match stop {
            Stop::Crashed { pc } => SimError::Crashed { pc, cycle },
            Stop::BadInstruction { pc, opcode } => SimError::BadInstruction { pc, opcode, cycle },
            Stop::Asleep { pc } => SimError::Asleep { pc, cycle },
        })
    }

    /// Puts a level on a pin from outside, now and until something else is put on it; where the pin is an output it
    /// waits until the pin is released. A pin on which nothing was ever put reads its pull-up, or what it last was.
    pub fn set(&mut self, pin: Pin, level: bool) {
        self.core.with(|board, bus| board.ports.drive(bus, pin, level));
    }

    /// Plays levels into a pin at absolute cycles, those in the past at once; may be called again while the last play is
    /// running, for the same pin or others. At one cycle the order of the calls holds.
    pub fn play(&mut self, pin: Pin, levels: impl IntoIterator<Item = (u64, bool)>) {
        self.core.with(|board, bus| {
            board.ports.play(bus.cycle(), pin, levels);
            board.reschedule(bus);
        });
    }

    /// Whether something is still to be played into the pin.
    pub fn is_playing(&self, pin: Pin) -> bool {
        self.core.board().ports.is_playing(pin)
    }

    /// What was played into the pin so far.
    pub fn delivered(&self, pin: Pin) -> &[Delivered] {
        self.core.board().ports.delivered(pin)
    }

    /// Logs from now on what the controller does to the pin's level.
    pub fn watch(&mut self, pin: Pin) {
        self.core.with(|board, _| board.ports.watch(pin));
    }

    /// Changes of a watched pin's level by the controller: by PORT, by DDR (a released pin falls back to what is put on
    /// it from outside, then to its pull-up) and by the timers' compare outputs.
    pub fn changes(&self, pin: Pin) -> &[Change] {
        self.core.board().ports.changes(pin)
    }

    /// The level of the pin's line, whoever drives it.
    pub fn level(&self, pin: Pin) -> bool {
        self.core.board().ports.level(pin)
    }

    /// Whether the controller drives the pin.
    pub fn is_output(&self, pin: Pin) -> bool {
        self.core.board().ports.is_output(pin)
    }

    /// What the timer behind a pin did to it since power-up, the first entry at the first connection; empty for a pin
    /// without a timer. Recorded without [`Mcu::watch`].
    pub fn pwm(&self, pin: Pin) -> Vec<PwmChange> {
        self.core.board().timers.changes(pin).to_vec()
    }

    /// Joins an output to an input: whatever level the controller drives on `from` is put on `to` in the same cycle.
    pub fn wire(&mut self, from: Pin, to: Pin) {
        self.core.with(|board, bus| board.ports.wire(bus, from, to));
    }

    /// Sends bytes to the controller, one after the other at the rate of the line, behind those not through yet. The
    /// rate is read from the controller's registers at each byte, unless [`Mcu::set_host_baud`] gave one.
    pub fn send(&mut self, bytes: &[u8]) {
        self.core.with(|board, bus| {
            board.uart.send(bus, bytes);
            board.reschedule(bus);
        });
    }

    /// Gives the rate at which the host sends, Bd; `None` follows the controller's registers.
    pub fn set_host_baud(&mut self, baud: Option<f64>) {
        self.core.with(|board, _| board.uart.set_host_baud(baud));
    }

    /// Bytes of [`Mcu::send`] that are not through yet.
    pub fn unsent(&self) -> usize {
        self.core.board().uart.unsent()
    }

    /// Bytes of [`Mcu::send`] that came to a receiver that was off or full.
    pub fn lost(&self) -> u64 {
        self.core.board().uart.lost()
    }

    /// The bytes that the controller sent since the last [`Mcu::take_sent`]; one that is on the line is not yet there.
    pub fn sent(&self) -> &[Sent] {
        self.core.board().uart.sent()
    }

    /// Takes the bytes that the controller sent.
    pub fn take_sent(&mut self) -> Vec<Sent> {
        self.core.with(|board, _| board.uart.take_sent())
    }

    /// Cycles that a byte takes on the line with the controller's present registers, start and stop bits included.
    pub fn byte_cycles(&mut self) -> u64 {
        self.core.with(|_, bus| Uart::byte_cycles(bus))
    }

    /// Counts of the interrupts.
    pub fn interrupts(&self) -> &InterruptLog {
        self.core.log()
    }

    /// Begins to keep every run of every interrupt, or stops and forgets them.
    pub fn record_interrupts(&mut self, on: bool) {
        self.core.log_mut().record(on);
    }

    /// Most bytes that the stack ever held, to the byte of the deepest write.
    pub fn stack_high_water(&self) -> usize {
        let free_from = ["__heap_start", "_end", "__bss_end"].iter().find_map(|name| self.symbols.get(*name));
        memory::stack_high_water(self.core.memory(), free_from.map(|address| *address as usize))
    }

    /// Registers, I/O registers and SRAM by data address (0x00, 0x20 and 0x100 on), as last written; I/O registers that
    /// change by themselves, as TCNT1, are as of their last access by the program.
    pub fn memory(&self) -> &[u8] {
        self.core.memory()
    }

    /// Address of a symbol: in RAM as data address, in flash as byte address.
    pub fn symbol(&self, name: &str) -> Option<u32> {
        self.symbols.get(name).copied()
    }
}

impl std::fmt::Debug for Mcu {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Mcu").field("cycle", &self.cycle()).field("pc", &self.pc()).finish_non_exhaustive()
    }
}
