//! The pins of an Arduino Nano and what is logged of them.

/// A pin by its name on the Nano's board; the comment gives the port bit and what the slider's timers have there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Pin {
    /// PD0, RXD.
    D0,
    /// PD1, TXD.
    D1,
    /// PD2, INT0.
    D2,
    /// PD3, INT1 and OC2B.
    D3,
    /// PD4.
    D4,
    /// PD5, OC0B.
    D5,
    /// PD6, OC0A.
    D6,
    /// PD7.
    D7,
    /// PB0, ICP1.
    D8,
    /// PB1, OC1A.
    D9,
    /// PB2, OC1B.
    D10,
    /// PB3, OC2A.
    D11,
    /// PB4.
    D12,
    /// PB5, the board's LED.
    D13,
    /// PC0.
    A0,
    /// PC1.
    A1,
    /// PC2.
    A2,
    /// PC3.
    A3,
    /// PC4.
    A4,
    /// PC5.
    A5,
}

impl Pin {
    /// All pins, D0 first and A5 last.
    pub const ALL: [Self; 20] = [
        Self::D0,
        Self::D1,
        Self::D2,
        Self::D3,
        Self::D4,
        Self::D5,
        Self::D6,
        Self::D7,
        Self::D8,
        Self::D9,
        Self::D10,
        Self::D11,
        Self::D12,
        Self::D13,
        Self::A0,
        Self::A1,
        Self::A2,
        Self::A3,
        Self::A4,
        Self::A5,
    ];

    /// The port's letter, `'B'`, `'C'` or `'D'`.
    pub fn port(self) -> char {
        char::from(b'B' + self.port_index() as u8)
    }

    /// The bit in the port, 0 to 7.
    pub fn bit(self) -> u8 {
        match self as u8 {
            n @ 0..=7 => n,
            n @ 8..=13 => n - 8,
            n => n - 14,
        }
    }

    pub(crate) fn port_index(self) -> usize {
        match self as u8 {
            0..=7 => 2,
            8..=13 => 0,
            _ => 1,
        }
    }

    pub(crate) fn index(self) -> usize {
        self as usize
    }

    pub(crate) fn of_port(port: usize) -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(move |pin| pin.port_index() == port)
    }
}

/// A level that was played into a pin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Delivered {
    /// Cycle at which the level was asked for, and which the hardware's latches (ICR1, flags) see.
    pub asked: u64,
    /// Cycle of the instruction boundary at which the core could first act on it.
    pub cycle: u64,
    /// The level.
    pub level: bool,
}

/// A level that the controller put on a pin, or left it to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Change {
    /// For a write of a register, the cycle in which the writing instruction starts (the pin moves 1 cycle later for
    /// OUT, 2 for SBI, CBI and STS); for a compare output, the timer's own cycle.
    pub cycle: u64,
    /// The level from then on.
    pub level: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pins_are_the_port_bits_of_the_nano() {
        assert_eq!((Pin::D2.port(), Pin::D2.bit()), ('D', 2));
        assert_eq!((Pin::D8.port(), Pin::D8.bit()), ('B', 0));
        assert_eq!((Pin::D13.port(), Pin::D13.bit()), ('B', 5));
        assert_eq!((Pin::A5.port(), Pin::A5.bit()), ('C', 5));
        for (i, pin) in Pin::ALL.into_iter().enumerate() {
            assert_eq!(pin.index(), i);
        }
    }
}
