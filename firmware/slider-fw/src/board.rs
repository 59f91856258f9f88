//! The pins of an Arduino Nano by their names, in the manner of avr-hal.
//!
//! ```ignore
//! let pins = board::Pins::take();
//! let mut led = pins.d13.into_output();
//! led.set_high()?;
//! ```

use core::arch::asm;
use core::convert::Infallible;
use core::marker::PhantomData;

use embedded_hal::digital::{ErrorType, InputPin, OutputPin};

/// Cycles a second of the crystal.
pub const CLOCK_HZ: u32 = 16_000_000;

/// I/O addresses of the registers PINB, PINC and PIND; those of direction and output come after each.
const PORT_B: u8 = 0x03;
const PORT_C: u8 = 0x06;
const PORT_D: u8 = 0x09;

/// Mode of a pin: an input without pull-up, as at reset.
pub struct Floating;
/// Mode of a pin: an input with pull-up.
pub struct PullUp;
/// Mode of a pin: an output.
pub struct Output;

/// Pin number `BIT` of the port whose input register has the I/O address `PORT`.
///
/// Each change is one instruction (`sbi` or `cbi`), so an interrupt may change other pins of the port at any time.
pub struct Pin<const PORT: u8, const BIT: u8, MODE> {
    mode: PhantomData<MODE>,
}

impl<const PORT: u8, const BIT: u8, MODE> Pin<PORT, BIT, MODE> {
    const fn new() -> Self {
        Self { mode: PhantomData }
    }

    /// Whether the level at the pin is high.
    #[inline(always)]
    #[must_use]
    pub fn is_high(&self) -> bool {
        let port: u8;
        // SAFETY: reads an input register of this chip; that changes nothing.
        unsafe { asm!("in {}, {}", out(reg) port, const PORT, options(nomem, nostack, preserves_flags)) };
        port & (1 << BIT) != 0
    }

    #[inline(always)]
    #[expect(clippy::unused_self, reason = "who has the pin may change it")]
    fn set_output(&mut self, high: bool) {
        // SAFETY: sets one bit of an output register of this chip, which belongs to this pin alone.
        unsafe {
            if high {
                asm!("sbi {}, {}", const PORT + 2, const BIT, options(nomem, nostack, preserves_flags));
            } else {
                asm!("cbi {}, {}", const PORT + 2, const BIT, options(nomem, nostack, preserves_flags));
            }
        }
    }
}

impl<const PORT: u8, const BIT: u8> Pin<PORT, BIT, Floating> {
    /// Makes it an output, low.
    #[inline(always)]
    #[must_use]
    pub fn into_output(mut self) -> Pin<PORT, BIT, Output> {
        self.set_output(false);
        // SAFETY: sets one bit of a direction register of this chip, which belongs to this pin alone.
        unsafe { asm!("sbi {}, {}", const PORT + 1, const BIT, options(nomem, nostack, preserves_flags)) };
        Pin::new()
    }

    /// Makes it an input with pull-up.
    #[inline(always)]
    #[must_use]
    pub fn into_pull_up_input(mut self) -> Pin<PORT, BIT, PullUp> {
        self.set_output(true);
        Pin::new()
    }
}

impl<const PORT: u8, const BIT: u8, MODE> ErrorType for Pin<PORT, BIT, MODE> {
    type Error = Infallible;
}

impl<const PORT: u8, const BIT: u8> OutputPin for Pin<PORT, BIT, Output> {
    #[inline(always)]
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.set_output(false);
        Ok(())
    }

    #[inline(always)]
    fn set_high(&mut self) -> Result<(), Infallible> {
        self.set_output(true);
        Ok(())
    }
}

impl<const PORT: u8, const BIT: u8> InputPin for Pin<PORT, BIT, PullUp> {
    #[inline(always)]
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(Pin::is_high(self))
    }

    #[inline(always)]
    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(!Pin::is_high(self))
    }
}

macro_rules! pins {
    ($($(#[$meta:meta])* $field:ident $name:ident $port:ident $bit:literal,)+) => {
        $(
            $(#[$meta])*
            pub type $name<MODE> = Pin<$port, $bit, MODE>;
        )+

        /// All pins of the board.
        pub struct Pins {
            $($(#[$meta])* pub $field: $name<Floating>,)+
        }

        impl Pins {
            const NEW: Self = Self { $($field: Pin::new(),)+ };
        }
    };
}

pins! {
    /// PD0: serial in.
    d0 D0 PORT_D 0,
    /// PD1: serial out.
    d1 D1 PORT_D 1,
    /// PD2: INT0.
    d2 D2 PORT_D 2,
    /// PD3: INT1.
    d3 D3 PORT_D 3,
    /// PD4.
    d4 D4 PORT_D 4,
    /// PD5: OC0B.
    d5 D5 PORT_D 5,
    /// PD6.
    d6 D6 PORT_D 6,
    /// PD7.
    d7 D7 PORT_D 7,
    /// PB0: ICP1.
    d8 D8 PORT_B 0,
    /// PB1.
    d9 D9 PORT_B 1,
    /// PB2.
    d10 D10 PORT_B 2,
    /// PB3: OC2A.
    d11 D11 PORT_B 3,
    /// PB4.
    d12 D12 PORT_B 4,
    /// PB5: the LED of the board.
    d13 D13 PORT_B 5,
    /// PC0.
    a0 A0 PORT_C 0,
    /// PC1.
    a1 A1 PORT_C 1,
    /// PC2.
    a2 A2 PORT_C 2,
    /// PC3.
    a3 A3 PORT_C 3,
    /// PC4.
    a4 A4 PORT_C 4,
    /// PC5.
    a5 A5 PORT_C 5,
}

impl Pins {
    /// The pins, of which each exists once.
    ///
    /// # Safety
    ///
    /// To be called once, and no pin that [`crate::motor::cut`] or the capture interrupt changes may be used otherwise.
    #[must_use]
    pub const unsafe fn take() -> Self {
        Self::NEW
    }
}
