//! The motor: an L298N with its enable input at D11 (PWM of timer 2, 977 Hz) and its direction inputs at A0 and A1, and
//! the limit switch at D2, which cuts it off.
//!
//! The switch is normally closed, to ground, with a pull-up: an open switch, a broken wire and a pulled plug all read
//! high, and high cuts.

use core::cell::Cell;

use avr_device::atmega328p::{EXINT, PORTB, PORTC, TC2};
use avr_device::interrupt::{self, CriticalSection, Mutex};
use slider_proto::Direction;
use slider_proto::drive::Port;

use crate::board::{A0, A1, D2, D11, Output, PullUp};
use crate::clock;

/// PB3, which is D11.
const ENABLE: u8 = 1 << 3;
/// PC0 and PC1, which are A0 and A1.
const FORWARD: u8 = 1 << 0;
const REVERSE: u8 = 1 << 1;

/// What the limit switch does.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Guard {
    /// Its opening cuts the motor off.
    On,
    /// Its opening is ignored: the carriage backs off it.
    Off,
    /// It has cut the motor off.
    Cut,
}

static GUARD: Mutex<Cell<Guard>> = Mutex::new(Cell::new(Guard::On));
/// When it cut the motor off, until the main loop has taken note.
static HIT: Mutex<Cell<Option<u32>>> = Mutex::new(Cell::new(None));

/// Switches the motor off at once: first the enable input, disconnected from the timer and low, then the directions.
///
/// The duty register is taken over at the end of a period, too late for this; it is cleared, and the period ended, so that
/// the next start does not begin with the old duty.
#[inline(always)]
pub fn cut() {
    // SAFETY: these pins and this timer belong to the motor, and every change is one instruction or made with interrupts
    // off.
    unsafe {
        (*TC2::ptr()).tccr2a.write(|w| w.wgm2().pwm_fast());
        (*PORTB::ptr()).portb.modify(|r, w| w.bits(r.bits() & !ENABLE));
        (*PORTC::ptr()).portc.modify(|r, w| w.bits(r.bits() & !FORWARD));
        (*PORTC::ptr()).portc.modify(|r, w| w.bits(r.bits() & !REVERSE));
        (*TC2::ptr()).ocr2a.write(|w| w.bits(0));
        (*TC2::ptr()).tcnt2.write(|w| w.bits(0xff));
    }
}

/// Cuts the motor off if it is guarded: the interrupt INT0.
#[inline(always)]
pub fn on_limit(cs: CriticalSection<'_>) {
    if GUARD.borrow(cs).get() == Guard::On {
        cut();
        GUARD.borrow(cs).set(Guard::Cut);
        HIT.borrow(cs).set(Some(clock::now(cs)));
    }
}

/// The pins and the timer of the motor.
pub struct Motor {
    pwm: TC2,
    limit: D2<PullUp>,
}

impl Motor {
    /// Takes the pins, which are low, and leaves the motor off.
    #[must_use]
    pub fn new(
        pwm: TC2,
        _enable: D11<Output>,
        _forward: A0<Output>,
        _reverse: A1<Output>,
        limit: D2<PullUp>,
        interrupts: &EXINT,
    ) -> Self {
        pwm.tccr2a.write(|w| w.wgm2().pwm_fast());
        pwm.tccr2b.write(|w| w.cs2().prescale_64());
        // The rising edge at D2.
        interrupts.eicra.modify(|_, w| w.isc0().val_0x03());
        interrupts.eimsk.modify(|_, w| w.int0().set_bit());
        Self { pwm, limit }
    }

    /// When the limit switch cut the motor off, once.
    #[inline]
    pub fn take_hit(&mut self) -> Option<u32> {
        interrupt::free(|cs| HIT.borrow(cs).take())
    }
}

impl Port for Motor {
    fn drive(&mut self, direction: Direction, duty: u8) {
        if duty == 0 {
            interrupt::free(|_| cut());
            return;
        }
        self.pwm.ocr2a.write(|w| w.bits(duty));
        interrupt::free(|cs| {
            if GUARD.borrow(cs).get() == Guard::Cut {
                return;
            }
            // SAFETY: these pins belong to the motor, and interrupts are off.
            let port = unsafe { &(*PORTC::ptr()).portc };
            let level = match direction {
                Direction::Forward => FORWARD,
                Direction::Reverse => REVERSE,
            };
            // SAFETY: all other pins of the port keep their level.
            port.modify(|r, w| unsafe { w.bits(r.bits() & !(FORWARD | REVERSE) | level) });
            self.pwm.tccr2a.write(|w| w.wgm2().pwm_fast().com2a().match_clear());
        });
    }

    fn release(&mut self, guard: bool) {
        interrupt::free(|cs| {
            GUARD.borrow(cs).set(if guard { Guard::On } else { Guard::Off });
            // An open switch has no edge to give any more.
            if self.limit() {
                on_limit(cs);
            }
        });
    }

    fn limit(&self) -> bool {
        self.limit.is_high()
    }
}
