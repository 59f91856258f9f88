//! Timer 1: free running at 2 MHz, extended to 32 bits.

use core::cell::Cell;

use avr_device::atmega328p::TC1;
use avr_device::interrupt::{self, CriticalSection, Mutex};
use slider_proto::clock::extend;

static OVERFLOWS: Mutex<Cell<u16>> = Mutex::new(Cell::new(0));

/// The running clock.
#[derive(Clone, Copy)]
pub struct Clock(());

/// Register block of timer 1.
#[inline(always)]
pub(crate) fn timer() -> &'static avr_device::atmega328p::tc1::RegisterBlock {
    // SAFETY: the address is that of the timer on this chip. Who touches which register: `Clock::start` sets it up, the
    // overflow interrupt is here, `capture` has ICES1, ICF1 and ICIE1 and changes them with interrupts off.
    unsafe { &*TC1::ptr() }
}

impl Clock {
    /// Starts the clock at 16 MHz / 8, with the noise canceller of the input capture on (an edge counts when four
    /// samples in a row agree: a constant delay of 0.25 us, and spikes shorter than that are not seen).
    #[must_use]
    pub fn start(_: TC1) -> Self {
        let timer = timer();
        timer.tccr1a.reset();
        timer.tccr1b.write(|w| w.icnc1().set_bit().cs1().prescale_8());
        timer.timsk1.write(|w| w.toie1().set_bit());
        Self(())
    }

    /// Time in ticks.
    #[inline]
    #[must_use]
    pub fn now(self) -> u32 {
        interrupt::free(now)
    }
}

/// Time in ticks, while interrupts are off.
#[inline(always)]
pub(crate) fn now(cs: CriticalSection<'_>) -> u32 {
    // The count first: if it wraps after that, it is large and the pending overflow is not for it.
    let count = timer().tcnt1.read().bits();
    at(cs, count)
}

/// Time in ticks of a count that was latched less than 16 ms ago, while interrupts are off.
#[inline(always)]
pub(crate) fn at(cs: CriticalSection<'_>, count: u16) -> u32 {
    extend(OVERFLOWS.borrow(cs).get(), count, timer().tifr1.read().tov1().bit_is_set())
}

/// Counts an overflow: the interrupt `TIMER1_OVF` of both boards.
#[inline(always)]
pub fn on_overflow(cs: CriticalSection<'_>) {
    let overflows = OVERFLOWS.borrow(cs);
    overflows.set(overflows.get().wrapping_add(1));
}
