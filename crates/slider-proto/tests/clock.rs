//! Ticks are right whenever the counter overflows and however late that is noticed.

use proptest::prelude::*;
use slider_proto::clock::extend;
use slider_proto::{TICK_HZ, Unwrapper, ticks_between, ticks_from_ms};

/// Ticks from one overflow of the counter to the next.
const TURN: u64 = 1 << 16;
/// The latest that an overflow is counted, or a capture read, after it happened.
const LATEST: u64 = (1 << 15) - 1;

/// The microcontroller's clock as its data sheet has it: a true time that nobody sees, a counter that shows its low 16
/// bits, a flag that is set when it overflows, and a count of overflows that software raises later, clearing the flag.
struct Hardware {
    /// How late each overflow is counted.
    service: u64,
}

impl Hardware {
    /// What software sees that reads a capture of time `captured` at time `read`.
    ///
    /// The interrupt of the capture goes before that of the overflow: an overflow that came after a capture is not
    /// counted before that capture is read.
    fn read(&self, captured: u64, read: u64) -> (u16, u16, bool) {
        let overflowed = read / TURN;
        let last = overflowed * TURN;
        let counted = overflowed == 0 || (read >= last + self.service && captured >= last);
        let overflows = if counted { overflowed } else { overflowed - 1 };
        (overflows as u16, captured as u16, !counted)
    }
}

#[test]
fn capture_around_any_overflow_has_its_true_time() {
    // The first overflow, one amid, and those where the count of overflows itself wraps.
    for turn in [1, 2, 1000, 65_535, 65_536, 65_537] {
        let overflow = turn * TURN;
        for service in [0, 1, 7, 100, 12_345, LATEST - 1, LATEST] {
            let hardware = Hardware { service };
            for captured in overflow - TURN..overflow + TURN {
                for delay in [0, 1, 2, 50, 8000, LATEST - 1, LATEST] {
                    let (overflows, count, pending) = hardware.read(captured, captured + delay);
                    let found = extend(overflows, count, pending);
                    assert_eq!(found, captured as u32, "{captured}, read {delay} later, counted {service} later");
                }
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    #[test]
    fn capture_at_any_time_has_its_true_time(captured in 0..1_u64 << 40, service in 0..=LATEST, delay in 0..=LATEST) {
        let (overflows, count, pending) = Hardware { service }.read(captured, captured + delay);
        prop_assert_eq!(extend(overflows, count, pending), captured as u32);
    }

    #[test]
    fn difference_of_ticks_is_that_of_the_times(earlier in 0..1_u64 << 40, difference: u32) {
        let later = earlier + u64::from(difference);
        prop_assert_eq!(ticks_between(earlier as u32, later as u32), difference);
    }

    /// Steps of up to 2^31 - 1 ticks forward and 2^31 back, which are 17 min 53 s; time does not go below its first turn.
    #[test]
    fn unwrapped_ticks_are_the_times_less_the_turns_before_the_first(
        start in 1_u64 << 33..1 << 40,
        steps in prop::collection::vec(prop_oneof![any::<i32>(), 0..=i32::MAX, -2000..2000], 1..100),
    ) {
        let mut unwrapper = Unwrapper::default();
        let turns = start >> 32 << 32;
        prop_assert_eq!(unwrapper.unwrap(start as u32), start - turns);
        let mut time = start;
        for step in steps {
            // A step that would lead before the turn of the first tick is taken forward.
            let back = time.checked_add_signed(i64::from(step)).filter(|&then| then >= turns);
            time = back.unwrap_or(time + u64::from(step.unsigned_abs() & 0x7fff_ffff));
            prop_assert_eq!(unwrapper.unwrap(time as u32), time - turns);
        }
    }
}

#[test]
fn ticks_are_half_microseconds() {
    assert_eq!(TICK_HZ, 2_000_000);
    for ms in 0..=u16::MAX {
        assert_eq!(u64::from(ticks_from_ms(ms)), u64::from(ms) * u64::from(TICK_HZ) / 1000);
    }
}
