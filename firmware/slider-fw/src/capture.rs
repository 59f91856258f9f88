//! The timer's input: edges at D8, stamped by timer 1, and the camera's trigger at D9.
//!
//! # Latency
//!
//! The time of an edge is latched by hardware and no latency enters it. The trigger pin is raised by the first two
//! instructions of the interrupt, in `timer`, before any register is saved. See `firmware/README.md` for the bounds.

use core::arch::asm;
use core::cell::UnsafeCell;

use avr_device::atmega328p::{CPU, EXINT, TC0};
use avr_device::interrupt::{self, CriticalSection};
use embedded_hal::digital::OutputPin;
use slider_proto::ring::EdgeRing;
use slider_proto::timer::Port;
use slider_proto::{Edge, Level};

use crate::board::{D2, D5, D8, D9, Output, PullUp};
use crate::clock::{self, timer};

/// Without the run-time check of a `RefCell`, which would cost every edge 1 us.
struct Ring(UnsafeCell<EdgeRing>);

// SAFETY: there is one core, and the ring is touched by `on_ring` alone, which wants interrupts off.
unsafe impl Sync for Ring {}

static RING: Ring = Ring(UnsafeCell::new(EdgeRing::new()));

/// Bit 0 of register GPIOR0: the next edge raises the trigger.
pub const ARMED: u8 = 1;
/// PB0, which is D8, in register PINB.
const SENSOR: u8 = 1;
/// INT0, which is D2, in register EIFR.
const LIMIT_FLAG: u8 = 1;
/// More edges than this while one is served are given up as lost: the input is not an encoder.
const MOST_LATE: u8 = 6;

/// Stamps an edge: the interrupt `TIMER1_CAPT`, once the trigger pin has been raised if [`ARMED`].
///
/// Kept short: it is what limits how close edges may follow each other. That one has come meanwhile is rare and is
/// [`on_late`]'s work, a function that saves all registers itself, since saving them here would cost every edge 3 us.
pub extern "avr-interrupt" fn on_capture() {
    // SAFETY: an interrupt is served with interrupts off.
    let cs = unsafe { CriticalSection::new() };
    disarm();
    let tick = clock::at(cs, timer().icr1.read().bits());
    if !stamp(cs, tick, false) {
        // SAFETY: the function leaves all registers and flags as they were but the interrupt flag, which it sets as it
        // returns; `cli` comes before any interrupt.
        unsafe { asm!("call {}", "cli", sym on_late) };
    }
}

/// Stamps edges that the hardware has not captured, because they came while another was served.
extern "avr-interrupt" fn on_late() {
    // SAFETY: called by an interrupt, with interrupts off.
    let cs = unsafe { CriticalSection::new() };
    // The noise canceller is four cycles behind the level: an edge seen there may have been captured meanwhile.
    if timer().tifr1.read().icf1().bit_is_set() {
        return;
    }
    for _ in 0..MOST_LATE {
        if stamp(cs, clock::now(cs), true) {
            return;
        }
    }
    on_ring(cs, |ring| ring.lose(1));
}

/// Keeps the edge that was looked for, looks for the next, and tells whether that is still to come.
#[inline(always)]
fn stamp(cs: CriticalSection<'_>, tick: u32, late: bool) -> bool {
    let timer = timer();
    let control = timer.tccr1b.read();
    let rising = control.ices1().bit_is_set();
    // SAFETY: all bits but the one flipped are those that were read.
    timer.tccr1b.write(|w| unsafe { w.bits(control.bits()) }.ices1().bit(!rising));
    // Flipping the edge may set the flag; it is cleared by writing a one to it and to nothing else.
    timer.tifr1.write(|w| w.icf1().set_bit());
    let level = if rising { Level::High } else { Level::Low };
    on_ring(cs, |ring| ring.push(Edge { tick, level, late }));
    // An edge that came before the flag was cleared will not set it again, but the level shows it. One that came since
    // has set the flag and is served next. The level is read first: an edge between the two reads is of that kind.
    is_high() == rising || timer.tifr1.read().icf1().bit_is_set()
}

/// Whether the sensor is high.
#[inline(always)]
fn is_high() -> bool {
    // SAFETY: reads an input register; that changes nothing.
    unsafe { (*avr_device::atmega328p::PORTB::ptr()).pinb.read().bits() & SENSOR != 0 }
}

/// The next edge raises no trigger.
#[inline(always)]
fn disarm() {
    // SAFETY: register GPIOR0 belongs to this module, and interrupts are off where this is called.
    unsafe { (*CPU::ptr()).gpior0.write(|w| w.bits(0)) };
}

/// Does `work` on the ring.
#[inline(always)]
fn on_ring<R>(_: CriticalSection<'_>, work: impl FnOnce(&mut EdgeRing) -> R) -> R {
    // SAFETY: interrupts are off, and none of the few pieces of work in this module comes here again.
    work(unsafe { &mut *RING.0.get() })
}

/// The pins of the timer, and timer 0 for the self-test.
pub struct Capture {
    sensor: D8<PullUp>,
    trigger: D9<Output>,
    limit: D2<PullUp>,
    reference: TC0,
    _reference_pin: D5<Output>,
}

impl Capture {
    /// Takes the pins: sensor, camera trigger, end of travel and reference signal, and the timer of the latter.
    #[must_use]
    pub fn new(
        sensor: D8<PullUp>,
        trigger: D9<Output>,
        limit: D2<PullUp>,
        reference_pin: D5<Output>,
        reference: TC0,
        interrupts: &EXINT,
    ) -> Self {
        // The falling edge at D2 sets a flag, which needs no interrupt.
        interrupts.eicra.write(|w| w.isc0().val_0x02());
        interrupts.eifr.write(|w| w.intf().bits(LIMIT_FLAG));
        Self { sensor, trigger, limit, reference, _reference_pin: reference_pin }
    }

    /// Whether the end of travel has been reached since the last call.
    #[inline]
    pub fn take_limit(&mut self, interrupts: &EXINT) -> bool {
        let reached = interrupts.eifr.read().intf().bits() & LIMIT_FLAG != 0;
        if reached {
            interrupts.eifr.write(|w| w.intf().bits(LIMIT_FLAG));
        }
        reached
    }

    /// Starts to capture at the next falling edge.
    fn start(armed: u8) {
        interrupt::free(|cs| {
            on_ring(cs, EdgeRing::clear);
            let timer = timer();
            timer.tccr1b.modify(|_, w| w.ices1().clear_bit());
            timer.tifr1.write(|w| w.icf1().set_bit());
            // SAFETY: register GPIOR0 belongs to this module, and interrupts are off.
            unsafe { (*CPU::ptr()).gpior0.write(|w| w.bits(armed)) };
            timer.timsk1.modify(|_, w| w.icie1().set_bit());
        });
    }
}

impl Port for Capture {
    fn arm(&mut self) -> Level {
        Self::start(ARMED);
        self.sensor()
    }

    fn start_self_test(&mut self) {
        Self::start(0);
        // Fast PWM at 16 MHz / 64 / 256, half of it high.
        self.reference.tcnt0.write(|w| w.bits(0));
        self.reference.ocr0b.write(|w| w.bits(127));
        self.reference.tccr0a.write(|w| w.wgm0().pwm_fast().com0b().match_clear());
        self.reference.tccr0b.write(|w| w.cs0().prescale_64());
    }

    fn stop_capture(&mut self) {
        interrupt::free(|_| {
            timer().timsk1.modify(|_, w| w.icie1().clear_bit());
            disarm();
        });
        self.reference.tccr0b.reset();
        self.reference.tccr0a.reset();
    }

    fn next_edge(&mut self) -> Option<Edge> {
        interrupt::free(|cs| on_ring(cs, EdgeRing::pop))
    }

    fn waiting(&self) -> u8 {
        interrupt::free(|cs| on_ring(cs, |ring| ring.len()))
    }

    fn lost(&self) -> u16 {
        interrupt::free(|cs| on_ring(cs, |ring| ring.lost()))
    }

    fn release_trigger(&mut self) {
        let Ok(()) = self.trigger.set_low();
    }

    fn sensor(&self) -> Level {
        if self.sensor.is_high() { Level::High } else { Level::Low }
    }

    fn limit(&self) -> bool {
        !self.limit.is_high()
    }
}
