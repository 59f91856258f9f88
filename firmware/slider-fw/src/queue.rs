//! Small values on their way from an interrupt to the main loop.

use core::cell::Cell;

use avr_device::interrupt::{self, CriticalSection, Mutex};

/// A first-in, first-out queue of at most `N` values, a power of two up to 128.
pub struct Queue<T: Copy, const N: usize> {
    values: Mutex<[Cell<T>; N]>,
    next_in: Mutex<Cell<u8>>,
    next_out: Mutex<Cell<u8>>,
}

impl<T: Copy, const N: usize> Queue<T, N> {
    const MASK: u8 = {
        assert!(N.is_power_of_two() && N <= 128, "positions are counted in a byte");
        N as u8 - 1
    };

    /// An empty queue over `values`, which are never read.
    pub const fn new(values: [Cell<T>; N]) -> Self {
        Self { values: Mutex::new(values), next_in: Mutex::new(Cell::new(0)), next_out: Mutex::new(Cell::new(0)) }
    }

    /// Adds a value, or drops it if there is no room.
    #[inline(always)]
    pub fn push(&self, cs: CriticalSection<'_>, value: T) {
        let next = self.next_in.borrow(cs).get();
        if next.wrapping_sub(self.next_out.borrow(cs).get()) <= Self::MASK {
            self.values.borrow(cs)[usize::from(next & Self::MASK)].set(value);
            self.next_in.borrow(cs).set(next.wrapping_add(1));
        }
    }

    /// Takes the oldest value.
    #[inline]
    pub fn pop(&self) -> Option<T> {
        interrupt::free(|cs| {
            let next = self.next_out.borrow(cs).get();
            if next == self.next_in.borrow(cs).get() {
                return None;
            }
            self.next_out.borrow(cs).set(next.wrapping_add(1));
            Some(self.values.borrow(cs)[usize::from(next & Self::MASK)].get())
        })
    }
}
