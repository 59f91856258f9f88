//! What the board may do to the core.

use super::{Context, VECTORS, hooks::on_event};
use simavr_ffi as ffi;
use std::marker::PhantomData;

/// What a device may do to the core it is called from.
#[derive(Clone, Copy)]
pub(crate) struct Bus<'a> {
    ctx: *mut Context,
    call: PhantomData<&'a ()>,
}

impl Bus<'_> {
    /// # Safety
    /// The context must live as long as the handle, and the caller must not hold a reference to its log.
    pub(super) unsafe fn new(ctx: *mut Context) -> Self {
        Self { ctx, call: PhantomData }
    }

    fn avr(self) -> *mut ffi::avr_t {
        // SAFETY: see `new`.
        unsafe { (*self.ctx).avr }
    }

    pub(crate) fn cycle(self) -> u64 {
        // SAFETY: see `new`.
        unsafe { (*self.avr()).cycle }
    }

    pub(crate) fn data(self, address: u16) -> u8 {
        assert!(address < 256, "an I/O register");
        // SAFETY: see `new`; the address was checked.
        unsafe { *(*self.avr()).data.add(usize::from(address)) }
    }

    pub(crate) fn set_data(self, address: u16, value: u8) {
        assert!(address < 256, "an I/O register");
        // SAFETY: see `new`; the address was checked.
        unsafe { *(*self.avr()).data.add(usize::from(address)) = value }
    }

    /// Puts a level on an input from outside; an output keeps its own until it is released.
    pub(crate) fn drive(self, port: usize, bit: u8, level: bool) {
        // SAFETY: see `new`; all three ports are connected.
        unsafe {
            let port = (*self.ctx).ports[port];
            let mask = 1 << bit;
            // simavr would lift a driven pin by its pull-up at the next write to PORT, were the level not "external".
            (*port).external.pull_mask |= mask;
            (*port).external.pull_value &= !mask;
            (*port).external.pull_value |= if level { mask } else { 0 };
            let driven_by_the_core = self.data((*port).r_ddr) & mask != 0;
            let now = self.data((*port).r_pin) & mask != 0;
            if !driven_by_the_core && now != level {
                ffi::avr_raise_irq((*port).io.irq.add(bit.into()), level.into());
            }
        }
    }

    /// Sets a vector's flag, and asks for its interrupt when it is enabled.
    pub(crate) fn raise(self, vector: usize) {
        // SAFETY: see `new`; simavr accepts null.
        unsafe { ffi::avr_raise_interrupt(self.avr(), (*self.ctx).vectors[vector]) };
    }

    /// Withdraws a vector's request; its flag falls too unless it follows a condition (RXC, UDRE).
    pub(crate) fn clear(self, vector: usize) {
        // SAFETY: see `new`; simavr accepts null.
        unsafe { ffi::avr_clear_interrupt(self.avr(), (*self.ctx).vectors[vector]) };
    }

    pub(crate) fn is_pending(self, vector: usize) -> bool {
        // SAFETY: see `new`.
        unsafe { (*self.ctx).vectors[vector].as_ref().is_some_and(|vector| vector.pending() != 0) }
    }

    pub(super) fn enabled(self, vector: *mut ffi::avr_int_vector_t) -> bool {
        // SAFETY: see `new`; `vector` is one of the core's.
        let enable = unsafe { (*vector).enable };
        enable.reg() != 0 && self.data(enable.reg() as u16) >> enable.bit() & 1 != 0
    }

    /// Clears the flags that are 1 in `bits`, as a write to a flag register does.
    pub(crate) fn clear_flags(self, register: u16, bits: u8) {
        for vector in 1..VECTORS {
            // SAFETY: see `new`.
            let Some(raised) = (unsafe { (*self.ctx).vectors[vector].as_ref() }).map(|vector| vector.raised) else {
                continue;
            };
            if raised.reg() as u16 == register && bits >> raised.bit() & 1 != 0 {
                self.clear(vector);
            }
        }
    }

    /// Asks for the interrupts whose flags were latched before the enable bit in `register` was set.
    pub(crate) fn serve_latched(self, register: u16) {
        for vector in 1..VECTORS {
            // SAFETY: see `new`.
            let pointer = unsafe { (*self.ctx).vectors[vector] };
            if pointer.is_null() {
                continue;
            }
            // SAFETY: a vector of the core.
            let (enable, raised) = unsafe { ((*pointer).enable, (*pointer).raised) };
            if enable.reg() as u16 == register
                && raised.reg() != 0
                && self.enabled(pointer)
                && self.data(raised.reg() as u16) >> raised.bit() & 1 != 0
                && !self.is_pending(vector)
            {
                self.raise(vector);
            }
        }
    }

    /// Has [`Board::event`] called when the clock reaches `due`; replaces what was asked before.
    pub(crate) fn schedule(self, due: Option<u64>) {
        // SAFETY: see `new`. A delay below zero wraps and is right again when simavr adds the clock.
        unsafe {
            match due {
                Some(due) => {
                    let delay = due.wrapping_sub(self.cycle());
                    ffi::avr_cycle_timer_register(self.avr(), delay, Some(on_event), self.ctx.cast());
                }
                None => ffi::avr_cycle_timer_cancel(self.avr(), Some(on_event), self.ctx.cast()),
            }
        }
    }
}
