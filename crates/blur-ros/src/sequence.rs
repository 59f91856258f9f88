//! How frames follow each other.

use std::collections::VecDeque;
use std::fmt;

/// Intervals that the usual one is the median of.
const INTERVALS: usize = 15;
/// Fewer do not tell what is usual.
const MIN_INTERVALS: usize = 3;
/// A gap of so many usual intervals lacks a frame.
const GAP: f64 = 1.5;

/// Watches the stamps and sizes of frames.
#[derive(Debug, Clone, Default)]
pub struct Sequence {
    last: Option<Last>,
    /// Stamp of the frame before, if that came late.
    late_ns: Option<i64>,
    /// Whether the next frame follows one that was measured.
    is_linked: bool,
    /// Frames since the latest that could not be measured: these are not missing.
    failed_since: u64,
    intervals_ns: VecDeque<i64>,
    counts: Counts,
}

/// The latest frame.
#[derive(Debug, Clone, Copy)]
struct Last {
    stamp_ns: i64,
    size: (usize, usize),
}

/// What is to be done with a frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Step {
    /// Whether it is to be measured at all.
    pub measure: bool,
    /// Whether it follows the frame measured before; if not, nothing may be concluded from that one.
    pub follows: bool,
    /// What is out of the ordinary.
    pub events: Vec<Event>,
}

/// Something out of the ordinary.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Event {
    /// Its stamp lies before that of an earlier frame.
    Late {
        /// By how many nanoseconds.
        by_ns: i64,
    },
    /// It has the stamp of the frame before.
    Repeated,
    /// Frames before it are missing.
    Missing {
        /// How many, as the usual interval has it.
        frames: u64,
        /// Nanoseconds since the frame before.
        gap_ns: i64,
    },
    /// The pictures have another size from here on.
    Resized {
        /// Width and height before.
        from: (usize, usize),
        /// Width and height now.
        to: (usize, usize),
    },
}

impl fmt::Display for Event {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Late { by_ns } => write!(f, "out of order: {:.6} s late", by_ns as f64 * 1e-9),
            Self::Repeated => write!(f, "has the stamp of the frame before, not measured again"),
            Self::Missing { frames, gap_ns } => {
                write!(f, "{frames} missing before it: gap of {:.6} s", gap_ns as f64 * 1e-9)
            }
            Self::Resized { from, to } => write!(f, "now {}x{} pixels, {}x{} before", to.0, to.1, from.0, from.1),
        }
    }
}

/// Numbers of frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// That came.
    pub frames: u64,
    /// Of these, without a picture that can be measured.
    pub failed: u64,
    /// Out of order.
    pub late: u64,
    /// With the stamp of the frame before.
    pub repeated: u64,
    /// That should have come.
    pub missing: u64,
    /// Changes of size.
    pub resized: u64,
}

/// In words.
impl fmt::Display for Counts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} frames: {} failed, {} out of order, {} repeated, {} missing, {} changes of size",
            self.frames, self.failed, self.late, self.repeated, self.missing, self.resized
        )
    }
}

impl Sequence {
    /// Numbers of frames so far.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// A frame came with a stamp in nanoseconds and a picture of `size`, width and height.
    ///
    /// One out of order is measured alone, and so is the next: neither follows the frame measured before it. A second one
    /// out of order tells that the clock was set back; the frames follow each other from there.
    pub fn next(&mut self, stamp_ns: i64, size: (usize, usize)) -> Step {
        self.counts.frames += 1;
        let mut step = Step { measure: true, follows: self.is_linked, events: Vec::new() };
        let late_before = self.late_ns.take();
        let Some(last) = self.last else {
            return self.taken(Last { stamp_ns, size }, step);
        };
        let interval_ns = stamp_ns.saturating_sub(last.stamp_ns);
        if interval_ns == 0 {
            self.counts.repeated += 1;
            step.measure = false;
            step.events.push(Event::Repeated);
            return step;
        }
        if size != last.size {
            self.counts.resized += 1;
            step.follows = false;
            step.events.push(Event::Resized { from: last.size, to: size });
        }
        if interval_ns < 0 {
            self.counts.late += 1;
            step.follows = false;
            step.events.push(Event::Late { by_ns: interval_ns.saturating_neg() });
            if late_before.is_some_and(|before| before < stamp_ns) {
                return self.taken(Last { stamp_ns, size }, step);
            }
            self.late_ns = Some(stamp_ns);
            self.is_linked = false;
            self.last = Some(Last { size, ..last });
            return step;
        }
        if let Some(usual_ns) = self.usual_ns()
            && interval_ns as f64 > GAP * usual_ns
        {
            let between = ((interval_ns as f64 / usual_ns).round() as u64).saturating_sub(1).max(1);
            let frames = between.saturating_sub(self.failed_since);
            step.follows = false;
            if frames > 0 {
                self.counts.missing += frames;
                step.events.push(Event::Missing { frames, gap_ns: interval_ns });
            }
        }
        if self.intervals_ns.len() == INTERVALS {
            self.intervals_ns.pop_front();
        }
        self.intervals_ns.push_back(interval_ns);
        self.taken(Last { stamp_ns, size }, step)
    }

    /// A frame came that cannot be measured: the next one follows none.
    pub fn failed(&mut self) {
        self.counts.frames += 1;
        self.failed_since += 1;
        self.unlink();
    }

    /// The frame announced last was not measured after all.
    pub fn unlink(&mut self) {
        self.counts.failed += 1;
        self.is_linked = false;
    }

    fn taken(&mut self, last: Last, step: Step) -> Step {
        self.last = Some(last);
        self.is_linked = true;
        self.failed_since = 0;
        step
    }

    /// The median interval in nanoseconds.
    fn usual_ns(&self) -> Option<f64> {
        let mut sorted: Vec<i64> = self.intervals_ns.iter().copied().collect();
        sorted.sort_unstable();
        (sorted.len() >= MIN_INTERVALS).then(|| sorted[sorted.len() / 2] as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (usize, usize) = (640, 480);
    const MS: i64 = 1_000_000;

    fn steps(stamps_ms: &[i64]) -> (Vec<Step>, Counts) {
        let mut sequence = Sequence::default();
        let steps = stamps_ms.iter().map(|&stamp| sequence.next(stamp * MS, SIZE)).collect();
        (steps, sequence.counts())
    }

    #[test]
    fn frames_at_even_intervals_follow_each_other() {
        let (steps, counts) = steps(&[0, 33, 66, 100, 133, 166]);
        assert!(steps.iter().all(|step| step.measure && step.events.is_empty()));
        assert!(!steps[0].follows && steps[1..].iter().all(|step| step.follows));
        assert_eq!(counts, Counts { frames: 6, ..Counts::default() });
    }

    #[test]
    fn neither_a_late_frame_nor_the_next_follows_the_one_before() {
        let (steps, counts) = steps(&[0, 10, 20, 40, 30, 50]);
        assert_eq!(steps.iter().map(|step| step.follows).collect::<Vec<_>>(), [false, true, true, true, false, false]);
        assert_eq!(steps[4].events, [Event::Late { by_ns: 10 * MS }]);
        assert!(steps[4].measure);
        assert_eq!((counts.late, counts.missing), (1, 0));
    }

    #[test]
    fn a_clock_that_is_set_back_starts_again() {
        let (steps, counts) = steps(&[1000, 1010, 1020, 0, 10, 20, 30]);
        assert_eq!(
            steps.iter().map(|step| step.follows).collect::<Vec<_>>(),
            [false, true, true, false, false, true, true]
        );
        assert_eq!(counts.late, 2);
    }

    #[test]
    fn gaps_lack_as_many_frames_as_fit_in() {
        let (steps, counts) = steps(&[0, 10, 20, 30, 60, 70, 84]);
        assert_eq!(steps[4].events, [Event::Missing { frames: 2, gap_ns: 30 * MS }]);
        assert!(!steps[4].follows && steps[5].follows && steps[6].follows);
        assert_eq!(counts.missing, 2);
    }

    #[test]
    fn frames_that_failed_are_not_missing() {
        let mut sequence = Sequence::default();
        for stamp in [0, 10, 20, 30] {
            sequence.next(stamp * MS, SIZE);
        }
        sequence.failed();
        let step = sequence.next(50 * MS, SIZE);
        assert!(!step.follows && step.events.is_empty());
        sequence.failed();
        let step = sequence.next(80 * MS, SIZE);
        assert_eq!(step.events, [Event::Missing { frames: 1, gap_ns: 30 * MS }]);
    }

    #[test]
    fn a_repeated_frame_is_not_measured_again() {
        let (steps, counts) = steps(&[0, 10, 10, 20]);
        assert!(!steps[2].measure && steps[3].measure && steps[3].follows);
        assert_eq!(counts.repeated, 1);
    }

    #[test]
    fn another_size_or_a_failure_starts_again() {
        let mut sequence = Sequence::default();
        sequence.next(0, SIZE);
        let step = sequence.next(10, (320, 240));
        assert!(!step.follows);
        assert_eq!(step.events, [Event::Resized { from: SIZE, to: (320, 240) }]);
        assert!(sequence.next(20, (320, 240)).follows);
        sequence.failed();
        assert!(!sequence.next(40, (320, 240)).follows);
        assert_eq!(sequence.counts(), Counts { frames: 5, failed: 1, resized: 1, ..Counts::default() });
    }

    #[test]
    fn extreme_stamps_do_no_harm() {
        let (extremes, mut sequence) = ([i64::MIN, i64::MAX, 0, i64::MAX, i64::MIN, 1, 2, 3], Sequence::default());
        for stamp in extremes {
            sequence.next(stamp, SIZE);
        }
        assert_eq!(sequence.counts().frames, 8);
    }
}
