//! The only unsafe code, with its two children: simavr's core behind a handle that owns it, and the callbacks from it into [`Board`].
//!
//! Ownership: a [`Core`] owns one heap block, the [`Context`], for as long as it lives; simavr's callbacks carry its
//! address. References into the context are made for one statement at a time and never span a call into simavr from
//! which simavr can call back into the same field: [`Board`] may call [`Bus`], whose calls come back at most into
//! [`InterruptLog`], which calls nobody.

mod bus;
mod hooks;

pub(crate) use bus::Bus;

use crate::{board::Board, elf::Image, interrupts::InterruptLog};
use simavr_ffi as ffi;
use std::{
    ffi::c_void,
    os::raw::c_int,
    ptr::{self, NonNull},
};

unsafe extern "C" {
    /// Runs instructions until `run_cycle_count` is used up or something happens; from `sim_core.h`, which the bindings
    /// leave out.
    fn avr_run_one(avr: *mut ffi::avr_t) -> u32;
}

/// Vectors of the ATmega328P, reset included.
pub(crate) const VECTORS: usize = 26;
/// Cycles from the decision to serve an interrupt to the vector's first instruction (datasheet, 7.7.1), which simavr
/// leaves out; again as many when it wakes the core.
const ENTRY_CYCLES: u64 = 4;
/// Cycles to run at most before control returns to Rust.
const BATCH_CYCLES: u64 = 4096;
const RUNNING: c_int = ffi::cpu_Running as c_int;
const SLEEPING: c_int = ffi::cpu_Sleeping as c_int;
const SREG_I: usize = ffi::S_I as usize;

/// Why the core does not go on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stop {
    Crashed { pc: u32 },
    BadInstruction { pc: u32, opcode: u16 },
    Asleep { pc: u32 },
}

/// Whether a device keeps a register write to itself or lets simavr see it too.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Write {
    Taken,
    Pass,
}

/// The parameter of a callback that needs a number besides its context.
struct Hook {
    ctx: *mut Context,
    index: u16,
}

struct Context {
    avr: *mut ffi::avr_t,
    ports: [*mut ffi::avr_ioport_t; 3],
    vectors: [*mut ffi::avr_int_vector_t; VECTORS],
    writes: [(ffi::avr_io_write_t, *mut c_void); 256],
    port_hooks: [Hook; 3],
    flag_hooks: [Hook; 4],
    code_end: u32,
    board: Board,
    log: InterruptLog,
    resets: u32,
    reset_at: Option<u64>,
    bad: Option<Stop>,
    entered: bool,
    /// The cycle at which simavr was told to pause.
    until: u64,
}

/// A simulated ATmega328P with its board.
pub(crate) struct Core {
    ctx: NonNull<Context>,
}

// SAFETY: nothing in a context is bound to a thread: simavr keeps everything in `avr_t` (its only mutable global, the
// logger, is never set here), and the boards are plain data that nobody else points to.
unsafe impl Send for Core {}

impl Core {
    /// A core at reset with the image in its flash; `None` when simavr cannot make one.
    pub(crate) fn new(image: &Image, frequency_hz: u32) -> Option<Self> {
        // SAFETY: the name is a C string; the core is used only after `avr_init`, and every pointer taken from it lives
        // until `avr_terminate` in `drop`.
        unsafe {
            let avr = ffi::avr_make_mcu_by_name(c"atmega328p".as_ptr());
            if avr.is_null() {
                return None;
            }
            (*avr).frequency = frequency_hz;
            ffi::avr_init(avr);
            (*avr).set_log(0);
            ptr::copy_nonoverlapping(image.flash.as_ptr(), (*avr).flash, image.flash.len());
            let ctx = Box::into_raw(Box::new(Context {
                avr,
                ports: [ptr::null_mut(); 3],
                vectors: [ptr::null_mut(); VECTORS],
                writes: [(None, ptr::null_mut()); 256],
                port_hooks: [0, 1, 2].map(|index| Hook { ctx: ptr::null_mut(), index }),
                flag_hooks: crate::board::FLAG_REGISTERS.map(|index| Hook { ctx: ptr::null_mut(), index }),
                code_end: image.code_end,
                board: Board::default(),
                log: InterruptLog::default(),
                resets: 0,
                reset_at: None,
                bad: None,
                entered: false,
                until: u64::MAX,
            }));
            hooks::connect(ctx);
            (*ctx).board.reset(Bus::new(ctx));
            Some(Self { ctx: NonNull::new_unchecked(ctx) })
        }
    }

    pub(crate) fn board(&self) -> &Board {
        // SAFETY: the context lives as long as `self`, and simavr runs only under `&mut self`.
        unsafe { &(*self.ctx.as_ptr()).board }
    }

    pub(crate) fn log(&self) -> &InterruptLog {
        // SAFETY: as in `board`.
        unsafe { &(*self.ctx.as_ptr()).log }
    }

    pub(crate) fn log_mut(&mut self) -> &mut InterruptLog {
        // SAFETY: as in `board`; `&mut self` makes the reference unique.
        unsafe { &mut (*self.ctx.as_ptr()).log }
    }

    /// Lets `act` change the board from outside, between instructions.
    pub(crate) fn with<R>(&mut self, act: impl FnOnce(&mut Board, Bus<'_>) -> R) -> R {
        // SAFETY: `&mut self` makes the reference unique; the bus never comes back into the board.
        unsafe {
            let bus = Bus::new(self.ctx.as_ptr());
            act(&mut (*self.ctx.as_ptr()).board, bus)
        }
    }

    pub(crate) fn resets(&self) -> u32 {
        // SAFETY: as in `board`.
        unsafe { (*self.ctx.as_ptr()).resets }
    }

    pub(crate) fn cycle(&self) -> u64 {
        // SAFETY: `avr` is valid until `drop`.
        unsafe { (*(*self.ctx.as_ptr()).avr).cycle }
    }

    pub(crate) fn set_pc(&mut self, pc: u32) {
        // SAFETY: as in `pc`; the core reads it before its next instruction and checks it against the end of the code.
        unsafe { (*(*self.ctx.as_ptr()).avr).pc = pc };
    }

    pub(crate) fn pc(&self) -> u32 {
        // SAFETY: `avr` is valid until `drop`.
        unsafe { (*(*self.ctx.as_ptr()).avr).pc }
    }

    /// Registers, I/O and SRAM as the core sees them, by data address.
    pub(crate) fn memory(&self) -> &[u8] {
        // SAFETY: simavr allocates `ramend + 1` bytes, which only run under `&mut self`.
        unsafe {
            let avr = (*self.ctx.as_ptr()).avr;
            std::slice::from_raw_parts((*avr).data, usize::from((*avr).ramend) + 1)
        }
    }

    pub(crate) fn memory_mut(&mut self) -> &mut [u8] {
        // SAFETY: as in `memory`.
        unsafe {
            let avr = (*self.ctx.as_ptr()).avr;
            std::slice::from_raw_parts_mut((*avr).data, usize::from((*avr).ramend) + 1)
        }
    }

    /// Runs one instruction when `single`, else what fits before the next event or `until`; or sleeps as long.
    pub(crate) fn step(&mut self, until: u64, single: bool) -> Result<(), Stop> {
        let ctx = self.ctx.as_ptr();
        // SAFETY: `avr` is valid until `drop`, and no reference into the context is alive across these calls.
        unsafe {
            let avr = (*ctx).avr;
            let was_asleep = (*avr).state == SLEEPING;
            if (*ctx).until != until {
                (*ctx).until = until;
                let delay = until.saturating_sub((*avr).cycle);
                ffi::avr_cycle_timer_register(avr, delay, Some(hooks::on_until), ctx.cast());
            }
            if (*avr).state == RUNNING {
                (*avr).run_cycle_limit = if single { 1 } else { BATCH_CYCLES };
                (*avr).run_cycle_count = (*avr).run_cycle_count.min((*avr).run_cycle_limit);
                let pc = avr_run_one(avr);
                // A crash returns 0 and leaves the program counter where it happened.
                if (*avr).state != ffi::cpu_Crashed as c_int {
                    (*avr).pc = pc;
                }
            }
            let idle = process(ctx);
            if (*avr).state == SLEEPING {
                if (*avr).sreg[SREG_I] == 0 {
                    return Err(Stop::Asleep { pc: (*avr).pc });
                }
                (*avr).cycle += idle.max(1);
            }
            if (*avr).interrupt_state != 0 && ((*avr).state == RUNNING || (*avr).state == SLEEPING) {
                ffi::avr_service_interrupts(avr);
                if std::mem::take(&mut (*ctx).entered) {
                    (*avr).cycle += ENTRY_CYCLES * if was_asleep { 2 } else { 1 };
                    Board::refresh(Bus::new(ctx));
                    process(ctx);
                }
            }
            if let Some(bad) = (*ctx).bad {
                return Err(bad);
            }
            let lost = (*avr).state != RUNNING && (*avr).state != SLEEPING;
            if lost || (*avr).pc >= (*ctx).code_end {
                return Err(Stop::Crashed { pc: (*avr).pc });
            }
            Ok(())
        }
    }
}

impl Drop for Core {
    fn drop(&mut self) {
        // SAFETY: the context came from a box, `avr` from simavr; nobody uses either afterwards. What `avr_terminate`
        // forgets is freed here, by its own allocator.
        unsafe {
            let ctx = Box::from_raw(self.ctx.as_ptr());
            let avr = ctx.avr;
            for vector in ctx.vectors.into_iter().filter(|vector| !vector.is_null()) {
                ffi::avr_free_irq((&raw mut (*vector).irq).cast(), ffi::AVR_INT_IRQ_COUNT);
            }
            ffi::avr_free_irq((&raw mut (*avr).interrupts.irq).cast(), ffi::AVR_INT_IRQ_COUNT);
            ffi::avr_free_irq((*avr).irq, 1);
            for i in 0..(*avr).io.len() {
                // Eight bits and the byte; simavr has no name for the nine.
                ffi::avr_free_irq((*avr).io[i].irq, 9);
            }
            ffi::avr_terminate(avr);
            libc::free((*avr).irq_pool.irq.cast());
            libc::free((*avr).data_names.cast());
            libc::free(avr.cast());
        }
    }
}

/// Runs what is due, and puts the clock right after a reset, which simavr starts again at 0.
unsafe fn process(ctx: *mut Context) -> u64 {
    // SAFETY: called with a live context and no reference into it.
    unsafe {
        let avr = (*ctx).avr;
        let idle = ffi::avr_cycle_timer_process(avr);
        if let Some(cycle) = (*ctx).reset_at.take() {
            (*avr).cycle = cycle;
            (*ctx).resets += 1;
            (*ctx).until = u64::MAX;
            (*ctx).log.reset();
            (*ctx).board.reset(Bus::new(ctx));
        }
        idle
    }
}
