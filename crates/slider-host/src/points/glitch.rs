//! Pulses that no tooth and no slit can make.

use super::Timed;

/// A section takes at least this share of what its neighbours take. Teeth of 3.1 mm beside slits of 4.9 mm take 0.63 of
/// theirs, seen through the sensor's window perhaps 0.4, and from rest the speed doubles within a section.
const SHARE: f64 = 0.12;
/// Intervals before and after that are looked at.
const REACH: usize = 5;

/// The edges without those of short pulses, and how many these were.
///
/// Edges with only short intervals between them belong together. An even number of them leads back to the same level: the
/// light flickered within a section, and all go. An odd number is one edge that bounced: the first stays.
///
/// What is short is judged by the upper quartile of the intervals around, which holds while less than three in four are
/// short.
pub(super) fn without_short_pulses(edges: &[Timed]) -> (Vec<Timed>, usize) {
    let intervals: Vec<f64> = edges.windows(2).map(|pair| pair[1].t_s - pair[0].t_s).collect();
    let short = |index: usize| {
        let around = index.saturating_sub(REACH)..(index + REACH + 1).min(intervals.len());
        let mut sorted = intervals[around].to_vec();
        sorted.sort_by(f64::total_cmp);
        intervals[index] < SHARE * sorted[(sorted.len() * 3 / 4).min(sorted.len() - 1)]
    };
    let mut kept = Vec::with_capacity(edges.len());
    let mut start = 0;
    for end in 0..edges.len() {
        if end + 1 < edges.len() && short(end) {
            continue;
        }
        if (end - start).is_multiple_of(2) {
            kept.push(edges[start]);
        }
        start = end + 1;
    }
    let dropped = edges.len() - kept.len();
    (kept, dropped)
}
