//! simavr's callbacks: where they are hooked in, and what they pass on to the board.

use super::{Bus, Context, Hook, Stop, Write};
use simavr_ffi as ffi;
use std::{ffi::c_void, os::raw::c_int};

/// Hooks the context into a fresh core.
pub(super) unsafe fn connect(ctx: *mut Context) {
    // SAFETY: called once with a live context; the lists walked are simavr's own, ended by null, and an `avr_io_t` is
    // the first member of the peripheral that its kind names.
    unsafe {
        let avr = (*ctx).avr;
        (*avr).reset = Some(on_reset);
        (*avr).custom.data = ctx.cast();
        ffi::avr_irq_register_notify((*avr).irq, Some(on_bad_instruction), ctx.cast());
        for i in 0..usize::from((*avr).interrupts.vector_count) {
            let vector = (*avr).interrupts.vector[i];
            (*ctx).vectors[usize::from((*vector).vector)] = vector;
            for kind in [ffi::AVR_INT_IRQ_PENDING, ffi::AVR_INT_IRQ_RUNNING] {
                let irq = (&raw mut (*vector).irq).cast::<ffi::avr_irq_t>().add(kind as usize);
                ffi::avr_irq_register_notify(irq, Some(on_interrupt), ctx.cast());
            }
        }
        let mut io = (*avr).io_port;
        while !io.is_null() {
            let kind = std::ffi::CStr::from_ptr((*io).kind);
            if kind == c"port" {
                connect_port(ctx, io.cast());
            } else if kind == c"timer" {
                correct_timer(ctx, io.cast());
            }
            io = (*io).next;
        }
        for address in crate::board::HOOKED_WRITES {
            let slot = &raw mut (*avr).io[usize::from(address) - 32].w;
            (*ctx).writes[usize::from(address)] = ((*slot).c, (*slot).param);
            (*slot).c = Some(on_write);
            (*slot).param = ctx.cast();
        }
        for address in crate::board::HOOKED_READS {
            let slot = &raw mut (*avr).io[usize::from(address) - 32].r;
            (*slot).c = Some(on_read);
            (*slot).param = ctx.cast();
        }
        for i in 0..(*ctx).flag_hooks.len() {
            let hook = &raw mut (*ctx).flag_hooks[i];
            (*hook).ctx = ctx;
            let slot = &raw mut (*avr).bit_io[usize::from((*hook).index) - 32];
            (*slot).c = Some(on_flag_bit);
            (*slot).param = hook.cast();
        }
    }
}

unsafe fn connect_port(ctx: *mut Context, port: *mut ffi::avr_ioport_t) {
    // SAFETY: `port` is one of simavr's three; its interrupt lines are an array of `IOPORT_IRQ_COUNT`.
    unsafe {
        let index = ((*port).name as u8 - b'B') as usize;
        (*ctx).ports[index] = port;
        let hook = &raw mut (*ctx).port_hooks[index];
        (*hook).ctx = ctx;
        for (kind, call) in [
            (ffi::IOPORT_IRQ_DIRECTION_ALL, on_direction as unsafe extern "C" fn(_, _, _)),
            (ffi::IOPORT_IRQ_REG_PORT, on_port as unsafe extern "C" fn(_, _, _)),
        ] {
            let irq = (*port).io.irq.add(kind as usize);
            // A filter would swallow the first write after a reset when it repeats the last one before.
            (*irq).flags &= !(ffi::IRQ_FLAG_FILTERED as u8);
            ffi::avr_irq_register_notify(irq, Some(call), hook.cast());
        }
    }
}

/// Takes simavr's compare outputs off the pins: they would overwrite PORT; [`crate::pwm`] drives the pins instead. And
/// gives the fast PWM modes with TOP in OCRA their TOP, which simavr takes for 0: its modes with a "PWM" that counts up
/// to OCRA do just that.
unsafe fn correct_timer(ctx: *mut Context, timer: *mut ffi::avr_timer_t) {
    // SAFETY: a timer's compare outputs follow each other in its interrupt lines; a pin's line is one of its port's.
    unsafe {
        for i in 0..2 {
            let pin = (*timer).comp[i].com_pin;
            let output = (*timer).io.irq.add(ffi::TIMER_IRQ_OUT_COMP as usize + i);
            for port in (*ctx).ports.into_iter().filter(|port| !port.is_null()) {
                if u32::from((*port).r_port) == pin.reg() {
                    ffi::avr_unconnect_irq(output, (*port).io.irq.add(pin.bit() as usize));
                }
            }
            (*timer).comp[i].com_pin.set_reg(0);
        }
        let (broken, like) = if (*timer).r_tcnth == 0 { (7, 5) } else { (15, 9) };
        (*timer).wgm_op[broken] = (*timer).wgm_op[like];
    }
}

unsafe extern "C" fn on_reset(avr: *mut ffi::avr_t) {
    // SAFETY: `custom.data` is the context since `connect`.
    unsafe {
        let ctx = (*avr).custom.data.cast::<Context>();
        (*ctx).reset_at = Some((*avr).cycle);
    }
}

unsafe extern "C" fn on_bad_instruction(_: *mut ffi::avr_irq_t, opcode: u32, param: *mut c_void) {
    // SAFETY: registered with the context as parameter.
    unsafe {
        let ctx = param.cast::<Context>();
        (*ctx).bad = Some(Stop::BadInstruction { pc: (*(*ctx).avr).pc, opcode: opcode as u16 });
    }
}

unsafe extern "C" fn on_interrupt(irq: *mut ffi::avr_irq_t, value: u32, param: *mut c_void) {
    // SAFETY: registered with the context as parameter; simavr numbers the line `256 * vector + kind`.
    unsafe {
        let ctx = param.cast::<Context>();
        let (vector, kind, cycle) = ((*irq).irq >> 8, (*irq).irq & 0xff, (*(*ctx).avr).cycle);
        let index = vector as usize;
        if kind == ffi::AVR_INT_IRQ_PENDING {
            let enabled = Bus::new(ctx).enabled((*ctx).vectors[index]);
            (*ctx).log.pending(index, value != 0 && enabled, cycle);
        } else if value != 0 {
            (*ctx).entered = true;
            (*ctx).log.enter(index, cycle);
        } else {
            (*ctx).log.leave(index, cycle);
        }
    }
}

unsafe extern "C" fn on_direction(_: *mut ffi::avr_irq_t, value: u32, param: *mut c_void) {
    // SAFETY: registered with a port's hook, which lives in the context.
    unsafe {
        let hook = param.cast::<Hook>();
        let bus = Bus::new((*hook).ctx);
        (*(*hook).ctx).board.direction((*hook).index.into(), value as u8, bus);
    }
}

unsafe extern "C" fn on_port(_: *mut ffi::avr_irq_t, value: u32, param: *mut c_void) {
    // SAFETY: as in `on_direction`.
    unsafe {
        let hook = param.cast::<Hook>();
        let bus = Bus::new((*hook).ctx);
        (*(*hook).ctx).board.port((*hook).index.into(), value as u8, bus);
    }
}

unsafe extern "C" fn on_write(avr: *mut ffi::avr_t, address: u16, value: u8, param: *mut c_void) {
    // SAFETY: installed with the context as parameter; the original callback is called as simavr would have.
    unsafe {
        let ctx = param.cast::<Context>();
        let bus = Bus::new(ctx);
        if (*ctx).board.before_write(bus, address, value) == Write::Taken {
            return;
        }
        match (*ctx).writes[usize::from(address)] {
            (Some(original), parameter) => original(avr, address, value, parameter),
            (None, _) => bus.set_data(address, value),
        }
        (*ctx).board.after_write(bus, address);
    }
}

unsafe extern "C" fn on_read(_: *mut ffi::avr_t, address: u16, param: *mut c_void) -> u8 {
    // SAFETY: installed with the context as parameter.
    unsafe {
        let ctx = param.cast::<Context>();
        (*ctx).board.read(Bus::new(ctx), address)
    }
}

/// SBI and CBI on a flag register: one bit only, where simavr would write all flags back.
unsafe extern "C" fn on_flag_bit(_: *mut ffi::avr_t, bit: u8, value: u8, param: *mut c_void) -> c_int {
    // SAFETY: installed with a flag hook, which lives in the context.
    unsafe {
        let hook = param.cast::<Hook>();
        if value != 0 {
            Bus::new((*hook).ctx).clear_flags((*hook).index, 1 << bit);
        }
        1
    }
}

pub(super) unsafe extern "C" fn on_until(_: *mut ffi::avr_t, _: u64, _: *mut c_void) -> u64 {
    0
}

pub(super) unsafe extern "C" fn on_event(avr: *mut ffi::avr_t, due: u64, param: *mut c_void) -> u64 {
    // SAFETY: registered with the context as parameter. The clock is set back to the event's own time while it is
    // delivered, so that what the hardware would latch (ICR1, flags) is exact and not an instruction late.
    unsafe {
        let ctx = param.cast::<Context>();
        let now = (*avr).cycle;
        (*avr).cycle = due;
        (*ctx).board.event(Bus::new(ctx), due, now);
        (*avr).cycle = now;
        0
    }
}
