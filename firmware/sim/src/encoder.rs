//! Waveforms of the slider's encoder: a rail of teeth that pass a light barrier.
//!
//! A tooth is low, a slit is high. Crossing times come from the motion's formula, not from steps.

use crate::random::Random;

/// Teeth and slits in the order in which they pass, m.
///
/// The rail begins and ends with a tooth; before and behind it the barrier is open. Slits beyond one fewer than the teeth
/// are ignored, and teeth without a slit before them too.
#[derive(Debug, Clone, PartialEq)]
pub struct Encoder {
    /// Widths of the teeth, m, greater than 0.
    pub tooth_m: Vec<f64>,
    /// Widths of the slits between them, m, greater than 0.
    pub slit_m: Vec<f64>,
}

/// How the rail moves; its first edge is at the barrier at time 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motion {
    /// Uniform motion.
    Constant {
        /// Speed, m/s, greater than 0.
        speed_m_s: f64,
    },
    /// Uniformly accelerated motion; with an acceleration below 0 it ends where it comes to rest.
    Accelerated {
        /// Speed at the first edge, m/s, at least 0.
        start_m_s: f64,
        /// Acceleration, m/s².
        acceleration_m_s2: f64,
    },
    /// Goes forward ever slower, turns and comes back over the same edges.
    Reversed {
        /// Speed at the first edge, m/s, greater than 0.
        start_m_s: f64,
        /// Deceleration, m/s², greater than 0; the rail turns `start²/(2 deceleration)` behind its first edge.
        deceleration_m_s2: f64,
    },
}

impl Encoder {
    /// Teeth and slits of unequal widths: each between half and one and a half times the mean.
    ///
    /// `mean_m` is in m; the same `seed` gives the same rail.
    pub fn uneven(teeth: usize, mean_m: f64, seed: u64) -> Self {
        let mut random = Random::new(seed);
        let mut widths = |n| (0..n).map(|_| mean_m * (0.5 + random.unit())).collect();
        Self { tooth_m: widths(teeth), slit_m: widths(teeth.saturating_sub(1)) }
    }

    /// Places of the edges from the first on, m, and the level behind each.
    pub fn edges_m(&self) -> Vec<(f64, bool)> {
        let mut place = 0.0;
        let mut edges = Vec::with_capacity(2 * self.tooth_m.len());
        for (i, tooth) in self.tooth_m.iter().enumerate() {
            if i > 0 {
                let Some(slit) = self.slit_m.get(i - 1) else { break };
                place += slit;
            }
            edges.push((place, false));
            place += tooth;
            edges.push((place, true));
        }
        edges
    }

    /// From the first to the last edge, m.
    pub fn length_m(&self) -> f64 {
        self.edges_m().last().map_or(0.0, |(place, _)| *place)
    }

    /// The rail with a tooth broken off, counted from 0: one long slit. Without an end tooth the rail is shorter, and
    /// what was its second tooth may be the first.
    #[must_use]
    pub fn missing_tooth(&self, tooth: usize) -> Self {
        let mut rail = self.clone();
        if tooth >= rail.tooth_m.len() {
            return rail;
        }
        let gone = rail.tooth_m.remove(tooth);
        if tooth == 0 || tooth >= rail.tooth_m.len() {
            let slit = tooth.saturating_sub(1);
            if slit < rail.slit_m.len() {
                rail.slit_m.remove(slit);
            }
        } else if tooth < rail.slit_m.len() {
            let behind = rail.slit_m.remove(tooth);
            rail.slit_m[tooth - 1] += gone + behind;
        }
        rail
    }
}

impl Motion {
    /// Time at which the rail has first moved by `place_m`, s, and the time at which it is there again if it turns.
    ///
    /// The roots of `start t + a t²/2 = place` are written so that nothing cancels: for a speed `root` at the place it is
    /// `2 place/(start + root)` on the way out.
    fn times_s(self, place_m: f64) -> [Option<f64>; 2] {
        let (start, acceleration) = match self {
            Self::Constant { speed_m_s } => (speed_m_s, 0.0),
            Self::Accelerated { start_m_s, acceleration_m_s2 } => (start_m_s, acceleration_m_s2),
            Self::Reversed { start_m_s, deceleration_m_s2 } => (start_m_s, -deceleration_m_s2),
        };
        if place_m == 0.0 {
            let back = 2.0 * start / -acceleration;
            let returns = matches!(self, Self::Reversed { .. }) && back.is_finite() && back > 0.0;
            return [Some(0.0), returns.then_some(back)];
        }
        let root = (start * start + 2.0 * acceleration * place_m).sqrt();
        let out = 2.0 * place_m / (start + root);
        if !(start >= 0.0 && out.is_finite() && out > 0.0) {
            return [None, None];
        }
        let back = (start + root) / -acceleration;
        [Some(out), (matches!(self, Self::Reversed { .. }) && back > out).then_some(back)]
    }
}

/// The levels of the barrier as the rail passes: absolute cycles, and the level from then on.
///
/// The first edge is at `start_cycle`; `cycles_per_second` is in Hz. Edges that the motion does not reach are left out,
/// so a rail that stands gives the first edge only. Times are rounded to the nearest cycle.
///
/// # Example
/// ```
/// use slider_sim::encoder::{Encoder, Motion, edges};
///
/// let rail = Encoder { tooth_m: vec![0.002, 0.001], slit_m: vec![0.003] };
/// let wave = edges(&rail, &Motion::Constant { speed_m_s: 0.5 }, 1000, 16e6);
/// assert_eq!(wave, [(1000, false), (65_000, true), (161_000, false), (193_000, true)]);
/// ```
pub fn edges(encoder: &Encoder, motion: &Motion, start_cycle: u64, cycles_per_second: f64) -> Vec<(u64, bool)> {
    let places = encoder.edges_m();
    let cycle = |time: f64| start_cycle + (time * cycles_per_second).round() as u64;
    let times: Vec<_> = places.iter().map(|(place, level)| (motion.times_s(*place), *level)).collect();
    let out = times.iter().filter_map(|([out, _], level)| out.map(|time| (cycle(time), *level)));
    let back = times.iter().rev().filter_map(|([_, back], level)| back.map(|time| (cycle(time), !*level)));
    out.chain(back).collect()
}

/// Adds `pulses` short pulses behind each edge, at random within `window_cycles` and within half of the time to the next
/// edge; where there is no room for them there are fewer.
pub fn bounce(wave: &[(u64, bool)], pulses: usize, window_cycles: u64, seed: u64) -> Vec<(u64, bool)> {
    let mut random = Random::new(seed);
    let mut bounced = Vec::with_capacity(wave.len() * (1 + 2 * pulses));
    for (i, &(cycle, level)) in wave.iter().enumerate() {
        let room = wave.get(i + 1).map_or(window_cycles, |next| window_cycles.min((next.0 - cycle) / 2));
        bounced.push((cycle, level));
        let mut moments: Vec<_> = (0..2 * pulses).map(|_| cycle + random.between(1, room)).collect();
        moments.sort_unstable();
        moments.dedup();
        moments.retain(|moment| *moment > cycle && *moment < cycle + room);
        moments.truncate(moments.len() / 2 * 2);
        bounced.extend((0..).zip(moments).map(|(n, moment)| (moment, level ^ (n % 2 == 0))));
    }
    bounced
}

/// Adds up to `count` pulses of `width_cycles` at random between the first and the last edge, none over an edge.
pub fn glitches(wave: &[(u64, bool)], count: usize, width_cycles: u64, seed: u64) -> Vec<(u64, bool)> {
    let mut random = Random::new(seed);
    let mut wave = wave.to_vec();
    for _ in 0..count {
        let (Some(first), Some(last)) = (wave.first(), wave.last()) else { break };
        let from = random.between(first.0, last.0);
        let behind = wave.partition_point(|(cycle, _)| *cycle <= from);
        let Some(&(next, _)) = wave.get(behind) else { continue };
        let (before, level) = wave[behind - 1];
        if before < from && from + width_cycles < next {
            wave.splice(behind..behind, [(from, !level), (from + width_cycles, level)]);
        }
    }
    wave
}

#[cfg(test)]
mod tests {
    use super::*;

    const HZ: f64 = 16e6;

    fn rail() -> Encoder {
        Encoder::uneven(13, 0.002, 7)
    }

    fn alternates(wave: &[(u64, bool)]) -> bool {
        wave.windows(2).all(|pair| pair[0].0 < pair[1].0 && pair[0].1 != pair[1].1)
    }

    #[test]
    fn thirteen_teeth_make_twenty_six_edges_at_their_places() {
        let rail = rail();
        let speed = 0.7;
        let wave = edges(&rail, &Motion::Constant { speed_m_s: speed }, 500, HZ);
        assert_eq!(wave.len(), 26);
        assert!(alternates(&wave) && !wave[0].1);
        let mut place = 0.0;
        for (i, edge) in wave.iter().enumerate() {
            assert_eq!(edge.0, 500 + (place / speed * HZ).round() as u64);
            place += if i % 2 == 0 { rail.tooth_m[i / 2] } else { rail.slit_m.get(i / 2).copied().unwrap_or(0.0) };
        }
    }

    #[test]
    fn accelerated_crossings_put_the_rail_where_the_edge_is() {
        for (start, acceleration) in [(0.0, 1.5), (0.3, 2.0), (0.5, -0.2)] {
            let motion = Motion::Accelerated { start_m_s: start, acceleration_m_s2: acceleration };
            let wave = edges(&rail(), &motion, 0, HZ);
            assert_eq!(wave.len(), 26);
            for (edge, (place, _)) in wave.iter().zip(rail().edges_m()) {
                let time = edge.0 as f64 / HZ;
                let there = start * time + acceleration / 2.0 * time * time;
                // Half a cycle of rounding at the speed there.
                let bound = (start + acceleration.abs() * time + 1e-9) / HZ;
                assert!((there - place).abs() <= bound, "{there} {place}");
            }
        }
    }

    #[test]
    fn a_rail_that_comes_to_rest_ends_there() {
        // It rests after 0.1² / 2 / 1 = 5 mm.
        let motion = Motion::Accelerated { start_m_s: 0.1, acceleration_m_s2: -1.0 };
        let reached = rail().edges_m().iter().filter(|(place, _)| *place < 0.005).count();
        assert_eq!(edges(&rail(), &motion, 0, HZ).len(), reached);
        assert!(reached > 2 && reached < 26);
    }

    #[test]
    fn a_reversed_rail_meets_its_edges_in_mirrored_order_and_time() {
        let motion = Motion::Reversed { start_m_s: 0.1, deceleration_m_s2: 1.0 };
        let wave = edges(&rail(), &motion, 1000, HZ);
        assert!(alternates(&wave));
        assert_eq!(wave.len() % 2, 0);
        // The turn is at v/a = 0.1 s.
        let turn = 2 * (1000 + 1_600_000);
        for (out, back) in wave.iter().zip(wave.iter().rev()) {
            assert!((out.0 + back.0).abs_diff(turn) <= 1);
            assert_eq!(out.1, !back.1, "crossed the other way");
        }
        assert_eq!(wave.last(), Some(&(1000 + 3_200_000, true)), "open again");
    }

    #[test]
    fn a_standing_rail_gives_no_pass() {
        for speed_m_s in [0.0, -1.0, f64::NAN] {
            assert!(edges(&rail(), &Motion::Constant { speed_m_s }, 0, HZ).len() <= 1);
        }
    }

    #[test]
    fn a_missing_tooth_leaves_the_others_where_they_were() {
        let whole = rail().edges_m();
        for tooth in 1..12 {
            let broken = rail().missing_tooth(tooth).edges_m();
            let mut expected = whole.clone();
            expected.drain(2 * tooth..2 * tooth + 2);
            assert_eq!(broken.len(), 24);
            for (edge, expected) in broken.iter().zip(expected) {
                assert!((edge.0 - expected.0).abs() < 1e-15 && edge.1 == expected.1);
            }
        }
        assert_eq!(rail().missing_tooth(12).edges_m(), whole[..24]);
        let first = rail().missing_tooth(0).edges_m();
        assert!((first[1].0 - (whole[3].0 - whole[2].0)).abs() < 1e-15 && first.len() == 24);
        assert_eq!(rail().missing_tooth(13), rail());
    }

    #[test]
    fn bounces_come_in_pairs_behind_their_edges() {
        let clean = edges(&rail(), &Motion::Constant { speed_m_s: 0.5 }, 0, HZ);
        let bounced = bounce(&clean, 3, 800, 1);
        assert!(alternates(&bounced));
        assert_eq!(bounced.len(), 26 * 7);
        for pulses in bounced.chunks(7) {
            assert!(clean.contains(&pulses[0]) && pulses[6].0 - pulses[0].0 < 800 && pulses[6].1 == pulses[0].1);
        }
        assert_eq!(bounced, bounce(&clean, 3, 800, 1));
        assert_ne!(bounced, bounce(&clean, 3, 800, 2));
    }

    #[test]
    fn glitches_have_their_width_and_touch_no_edge() {
        let clean = edges(&rail(), &Motion::Constant { speed_m_s: 0.5 }, 0, HZ);
        let dirty = glitches(&clean, 20, 48, 3);
        assert!(alternates(&dirty));
        assert!(dirty.len() > 26 + 30);
        let extra: Vec<_> = dirty.iter().filter(|edge| !clean.contains(edge)).collect();
        assert!(extra.chunks(2).all(|pulse| pulse[1].0 - pulse[0].0 == 48));
        assert_eq!(dirty.len() - extra.len(), 26);
    }
}
