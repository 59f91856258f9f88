//! Ticks of the 16-bit hardware counter, extended.

/// Ticks a second: 16 MHz divided by 8.
pub const TICK_HZ: u32 = 2_000_000;

/// Half of the counter's range: how late a capture may be read and still be told from one after the overflow.
const HALF: u16 = 0x8000;

/// Time of a capture in ticks, from `overflows` counted so far, the `captured` count and whether an overflow is
/// `pending`, that is, has happened and is not yet counted.
///
/// A pending overflow came before the capture if the count is small, and after it if the count is large. This is right
/// as long as a capture is read within 32768 ticks (16.4 ms) of its happening.
///
/// ```
/// use slider_proto::clock::extend;
/// assert_eq!(extend(7, 3, true), 8 * 65536 + 3); // the counter wrapped, then the edge came
/// assert_eq!(extend(7, 65_534, true), 7 * 65536 + 65_534); // the edge came, then the counter wrapped
/// ```
#[inline]
#[must_use]
pub const fn extend(overflows: u16, captured: u16, pending: bool) -> u32 {
    let overflows = if pending && captured < HALF { overflows.wrapping_add(1) } else { overflows };
    ((overflows as u32) << 16) | captured as u32
}

/// Ticks from `earlier` to `later`, right across the wrap of the counter; both less than 35 min apart.
#[inline]
#[must_use]
pub const fn ticks_between(earlier: u32, later: u32) -> u32 {
    later.wrapping_sub(earlier)
}

/// Ticks from `then` to `now`, 0 if `then` is later: what an interrupt has stamped can be younger than the time that the
/// main loop has read.
pub(crate) const fn age(then: u32, now: u32) -> u32 {
    let age = ticks_between(then, now);
    if age > u32::MAX / 2 { 0 } else { age }
}

/// Ticks in `ms` milliseconds.
#[inline]
#[must_use]
pub const fn ticks_from_ms(ms: u16) -> u32 {
    ms as u32 * (TICK_HZ / 1000)
}

/// Gives 64-bit ticks to a host that sees every 32-bit tick in order, each less than 17 min from the one before it.
///
/// ```
/// let mut unwrapper = slider_proto::Unwrapper::default();
/// assert_eq!(unwrapper.unwrap(0xffff_fff0), 0xffff_fff0);
/// assert_eq!(unwrapper.unwrap(0x0000_0010), 0x1_0000_0010);
/// assert_eq!(unwrapper.unwrap(0xffff_fff8), 0xffff_fff8); // a little earlier, before the wrap
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Unwrapper {
    last: Option<u64>,
}

impl Unwrapper {
    /// The tick with as many turns of the 32-bit counter before it as have been seen.
    pub fn unwrap(&mut self, tick: u32) -> u64 {
        let unwrapped = match self.last {
            None => u64::from(tick),
            Some(last) => {
                // The low half of `last` is what the counter showed.
                let step = tick.wrapping_sub(last as u32).cast_signed();
                last.saturating_add_signed(i64::from(step))
            }
        };
        self.last = Some(unwrapped);
        unwrapped
    }
}
