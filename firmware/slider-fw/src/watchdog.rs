//! The watchdog: a main loop that hangs for a quarter of a second resets the board.

use avr_device::atmega328p::{CPU, WDT};

/// Register MCUSR as it was at reset, which says why there was one. Clears it, so that the watchdog can be set.
#[must_use]
pub fn take_reset_cause(cpu: &CPU) -> u8 {
    let cause = cpu.mcusr.read().bits();
    cpu.mcusr.reset();
    cause
}

/// The running watchdog.
pub struct Watchdog(());

impl Watchdog {
    /// Starts it, with 0.25 s. Interrupts have to be off: the change takes two writes within four cycles.
    #[must_use]
    pub fn start(registers: &WDT) -> Self {
        avr_device::asm::wdr();
        registers.wdtcsr.write(|w| w.wdce().set_bit().wde().set_bit());
        registers.wdtcsr.write(|w| w.wde().set_bit().wdpl().cycles_32k());
        Self(())
    }

    /// Tells that the main loop is alive.
    #[inline(always)]
    pub fn feed(&mut self) {
        avr_device::asm::wdr();
    }
}
