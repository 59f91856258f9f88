//! The infra-red remote: NEC pulses to keys.
//!
//! The receiver's output is high at rest and low while it sees the carrier. A frame is a leader of 9 ms low and 4.5 ms
//! high and 32 bits of 562.5 us low and 562.5 us (0) or 1687.5 us (1) high, low bit first: address, its inverse,
//! command, its inverse; then 562.5 us low. A key held down repeats 9 ms low, 2.25 ms high, 562.5 us low every 108 ms.
//!
//! A receiver stretches or shrinks the bursts by up to 200 us, with less effect on the time from burst to burst, and a
//! cheap remote's clock is off by several per cent: so bits are told by that time, with a border half way between them,
//! and bursts only have to be bursts. The inverse bytes guard against what gets through. (Crates that decode NEC were
//! tried: they accept 5 %, do not compare the inverse bytes and, where they give the raw bits, cannot tell a repeat from
//! a new key.)

use core::ops::RangeInclusive;

/// A key that means something to the drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Key {
    /// 0 to 9: that preset.
    Digit(u8),
    /// Stop.
    Stop,
}

/// NEC address of the remote: the 21-key one that comes with Arduino kits.
pub const ADDRESS: u8 = 0x00;

/// Commands of the digits 0 to 9.
pub const DIGITS: [u8; 10] = [0x16, 0x0c, 0x18, 0x5e, 0x08, 0x1c, 0x5a, 0x42, 0x52, 0x4a];

/// Commands that stop: play/pause, and the keys around it that a hand in haste may hit (channel down, channel, channel
/// up, previous, next, minus, plus, EQ).
pub const STOPS: [u8; 9] = [0x43, 0x45, 0x46, 0x47, 0x44, 0x40, 0x07, 0x15, 0x09];

impl Key {
    /// The key of an NEC `command` from the remote's own address.
    #[must_use]
    pub fn from_command(command: u8) -> Option<Self> {
        if STOPS.contains(&command) {
            return Some(Self::Stop);
        }
        let digit = DIGITS.iter().position(|&code| code == command)?;
        Some(Self::Digit(digit as u8))
    }
}

// All in ticks of 0.5 us.
const LEADER_BURST: RangeInclusive<u16> = 15_300..=20_700;
const LEADER: RangeInclusive<u16> = 22_950..=31_050;
const BURST: RangeInclusive<u16> = 600..=1800;
const ZERO: RangeInclusive<u16> = 1700..=3300;
const ONE: RangeInclusive<u16> = 3400..=5700;

/// Bits of a frame.
const BITS: u8 = 32;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    /// Waiting for the burst of a leader.
    Rest,
    /// That burst has ended.
    Leader,
    /// So many bits are there.
    Bits(u8),
}

/// Decodes the receiver's output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Remote {
    state: State,
    bits: u32,
    burst: u16,
}

impl Default for Remote {
    fn default() -> Self {
        Self::new()
    }
}

impl Remote {
    /// A decoder that waits for a frame.
    #[must_use]
    pub const fn new() -> Self {
        Self { state: State::Rest, bits: 0, burst: 0 }
    }

    /// Takes a change of the receiver's output: its new level, and the time since the change before it in ticks, 65535
    /// if more. Returns the key at the end of a whole and intact frame of the right remote. Repeats are no keys.
    pub fn change(&mut self, high: bool, since_ticks: u16) -> Option<Key> {
        if high { self.burst_ends(since_ticks) } else { self.next_burst(since_ticks) }
    }

    fn burst_ends(&mut self, ticks: u16) -> Option<Key> {
        self.burst = ticks;
        match self.state {
            _ if LEADER_BURST.contains(&ticks) => self.state = State::Leader,
            State::Bits(BITS) => {
                self.state = State::Rest;
                return BURST.contains(&ticks).then(|| self.key()).flatten();
            }
            State::Bits(_) if BURST.contains(&ticks) => {}
            _ => self.state = State::Rest,
        }
        None
    }

    fn next_burst(&mut self, ticks: u16) -> Option<Key> {
        let period = self.burst.saturating_add(ticks);
        self.state = match self.state {
            State::Leader if LEADER.contains(&period) => State::Bits(0),
            State::Bits(count) if count < BITS && (ZERO.contains(&period) || ONE.contains(&period)) => {
                // The first bit ends up lowest.
                self.bits = self.bits >> 1 | u32::from(ONE.contains(&period)) << 31;
                State::Bits(count + 1)
            }
            _ => State::Rest,
        };
        None
    }

    fn key(self) -> Option<Key> {
        let [address, not_address, command, not_command] = self.bits.to_le_bytes();
        let intact = not_address == !address && not_command == !command;
        if intact && address == ADDRESS { Key::from_command(command) } else { None }
    }
}
