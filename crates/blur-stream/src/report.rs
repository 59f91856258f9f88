//! What became of the frames of a stream.

use std::fmt;
use std::time::Duration;

use hdrhistogram::Histogram;

/// Numbers of frames and quantiles of the latency, the time from the arrival of a frame to the end of its work.
///
/// Every frame that was received is done, dropped, late, or still waiting.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct Report {
    /// Frames that came.
    pub received: u64,
    /// Frames that the worker has done.
    pub done: u64,
    /// Frames that newer ones displaced, and those that waited when the stream was cut off.
    pub dropped: u64,
    /// Frames that had waited beyond their deadline when their turn came.
    pub late: u64,
    /// Half of the latencies are shorter; 0 without any. Quantiles are right to three digits.
    pub p50: Duration,
    /// 99 of 100 are shorter.
    pub p99: Duration,
    /// None is longer.
    pub longest: Duration,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ms = |time: Duration| time.as_secs_f64() * 1e3;
        write!(
            f,
            "{} frames received, {} done, {} dropped, {} late; latency p50 {:.1} ms, p99 {:.1} ms, longest {:.1} ms",
            self.received,
            self.done,
            self.dropped,
            self.late,
            ms(self.p50),
            ms(self.p99),
            ms(self.longest)
        )
    }
}

/// The counters behind a [`Report`]; they take no memory when they grow.
#[derive(Debug)]
pub(crate) struct Tally {
    pub(crate) received: u64,
    pub(crate) done: u64,
    pub(crate) dropped: u64,
    pub(crate) late: u64,
    /// Microseconds.
    latencies: Histogram<u64>,
}

/// Longest latency that is told apart from longer ones: ten minutes, in microseconds.
const LONGEST_US: u64 = 600_000_000;
/// Digits of a latency that are kept.
const DIGITS: u8 = 3;

impl Tally {
    /// `None` never happens with these bounds.
    pub(crate) fn new() -> Option<Self> {
        let latencies = Histogram::new_with_bounds(1, LONGEST_US, DIGITS).ok()?;
        Some(Self { received: 0, done: 0, dropped: 0, late: 0, latencies })
    }

    pub(crate) fn count_done(&mut self, latency: Duration) {
        self.done += 1;
        self.latencies.saturating_record(u64::try_from(latency.as_micros()).unwrap_or(u64::MAX));
    }

    pub(crate) fn report(&self) -> Report {
        let quantile = |q: f64| Duration::from_micros(self.latencies.value_at_quantile(q));
        Report {
            received: self.received,
            done: self.done,
            dropped: self.dropped,
            late: self.late,
            p50: quantile(0.5),
            p99: quantile(0.99),
            longest: Duration::from_micros(self.latencies.max()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_latencies() {
        let mut tally = Tally::new().unwrap();
        assert_eq!(tally.report(), Report::default());
        for ms in 1..=1000 {
            tally.count_done(Duration::from_millis(ms));
        }
        let report = tally.report();
        let close = |found: Duration, ms: f64| (found.as_secs_f64() * 1e3 / ms - 1.0).abs() < 2e-3;
        assert!(close(report.p50, 500.0) && close(report.p99, 990.0) && close(report.longest, 1000.0), "{report}");
        assert_eq!(report.done, 1000);
    }
}
