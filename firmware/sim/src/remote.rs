//! Infrared remote controls as a TSOP receiver puts them out: demodulated, low while the carrier is there.

use crate::{micros, millis, random::Random};

/// 562.5 µs, the unit of NEC's protocol, in cycles.
const UNIT: u64 = 9000;
/// From the start of a frame to that of its repeat.
pub const REPEAT_CYCLES: u64 = millis(108);

/// A frame of NEC's protocol: 9 ms low, 4.5 ms high, then address, its complement, command, its complement, the low bits
/// first, and a last pulse.
///
/// The first fall is at `start_cycle`; the line ends high, 67.5 ms and the last pulse later at most.
///
/// # Reference
/// SB-Projects, NEC protocol: <https://www.sbprojects.net/knowledge/ir/nec.php>.
pub fn nec(address: u8, command: u8, start_cycle: u64) -> Vec<(u64, bool)> {
    let code = u32::from_le_bytes([address, !address, command, !command]);
    let bits = (0..32).map(|bit| if code >> bit & 1 == 0 { 1 } else { 3 });
    pulses(start_cycle, [(16, 8)].into_iter().chain(bits.map(|space| (1, space))))
}

/// The short frame that says that the key is still held: 9 ms low, 2.25 ms high, a last pulse.
pub fn nec_repeat(start_cycle: u64) -> Vec<(u64, bool)> {
    pulses(start_cycle, [(16, 4)])
}

/// A key that is held: a frame and `repeats` short ones, 108 ms apart.
pub fn nec_held(address: u8, command: u8, start_cycle: u64, repeats: u64) -> Vec<(u64, bool)> {
    let mut wave = nec(address, command, start_cycle);
    wave.extend((1..=repeats).flat_map(|n| nec_repeat(start_cycle + n * REPEAT_CYCLES)));
    wave
}

/// Low and high times in units, and a low unit to end with.
fn pulses(start_cycle: u64, times: impl IntoIterator<Item = (u64, u64)>) -> Vec<(u64, bool)> {
    let mut cycle = start_cycle;
    let mut wave = Vec::new();
    for (low, high) in times.into_iter().chain([(1, 0)]) {
        wave.push((cycle, false));
        cycle += low * UNIT;
        wave.push((cycle, true));
        cycle += high * UNIT;
    }
    wave
}

/// A wave as a cheap remote and receiver make it: all times longer by `error_percent`, and each edge off by at most
/// `jitter_cycles` either way, though never past its neighbours.
pub fn distorted(wave: &[(u64, bool)], error_percent: f64, jitter_cycles: u64, seed: u64) -> Vec<(u64, bool)> {
    let mut random = Random::new(seed);
    let Some(&(start, _)) = wave.first() else { return Vec::new() };
    let mut last = None;
    wave.iter()
        .map(|&(cycle, level)| {
            let stretched = start + ((cycle - start) as f64 * (1.0 + error_percent / 100.0)).round() as u64;
            let moved = (stretched + random.between(0, 2 * jitter_cycles + 1)).saturating_sub(jitter_cycles);
            let cycle = last.map_or(moved, |last| moved.max(last + 1));
            last = Some(cycle);
            (cycle, level)
        })
        .collect()
}

/// Noise for `duration_cycles`: low and high times of 10 µs to 20 ms, evenly spread on a logarithmic scale; ends high.
pub fn noise(start_cycle: u64, duration_cycles: u64, seed: u64) -> Vec<(u64, bool)> {
    let mut random = Random::new(seed);
    let (shortest, longest) = (micros(10) as f64, millis(20) as f64);
    let mut wave = Vec::new();
    let mut cycle = start_cycle;
    let mut level = false;
    while cycle < start_cycle + duration_cycles {
        wave.push((cycle, level));
        level = !level;
        cycle += (shortest * (longest / shortest).powf(random.unit())) as u64;
    }
    if wave.last().is_some_and(|(_, level)| !level) {
        wave.push((start_cycle + duration_cycles, true));
    }
    wave
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads a frame as the protocol's page describes it.
    fn decode(wave: &[(u64, bool)]) -> Option<u32> {
        let times: Vec<_> = wave.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
        let near = |time: u64, micro: f64| (time as f64 / 16.0 / micro - 1.0).abs() < 0.25;
        if times.len() != 67 || !near(times[0], 9000.0) || !near(times[1], 4500.0) {
            return None;
        }
        times[2..66].chunks(2).enumerate().try_fold(0, |code, (bit, pair)| {
            let one = near(pair[1], 1687.5);
            (near(pair[0], 562.5) && (one || near(pair[1], 562.5))).then_some(code | u32::from(one) << bit)
        })
    }

    #[test]
    fn a_frame_carries_address_and_command_with_their_complements() {
        let wave = nec(0x04, 0x1b, 777);
        assert_eq!((wave[0], wave[1], wave[2]), ((777, false), (777 + 144_000, true), (777 + 216_000, false)));
        assert_eq!(decode(&wave), Some(u32::from_le_bytes([0x04, 0xfb, 0x1b, 0xe4])));
        // Sixteen ones and sixteen zeros in any frame: 13.5 ms + 16 * 2.25 ms + 16 * 1.125 ms + 562.5 us.
        assert_eq!(wave.last(), Some(&(777 + 1_089_000, true)));
    }

    #[test]
    fn a_held_key_repeats_every_108_ms() {
        let wave = nec_held(1, 2, 0, 2);
        let frame = nec(1, 2, 0).len();
        assert_eq!(
            wave[frame..frame + 4],
            [1_728_000, 1_872_000, 1_908_000, 1_917_000].map(|c| (c, [1_872_000, 1_917_000].contains(&c)))
        );
        assert_eq!(wave[frame + 4], (2 * 1_728_000, false));
        assert_eq!(wave.len(), frame + 8);
    }

    #[test]
    fn distortion_stretches_and_jitters_within_its_bounds() {
        let clean = nec(0x10, 0x20, 5000);
        let dirty = distorted(&clean, 3.0, 400, 9);
        for (clean, dirty) in clean.iter().zip(&dirty) {
            let stretched = 5000.0 + (clean.0 as f64 - 5000.0) * 1.03;
            assert!((dirty.0 as f64 - stretched).abs() <= 400.5);
            assert_eq!(clean.1, dirty.1);
        }
        assert_eq!(decode(&dirty), decode(&clean));
        assert_eq!(dirty, distorted(&clean, 3.0, 400, 9));
    }

    #[test]
    fn noise_stays_in_its_time_and_range() {
        let wave = noise(1000, millis(500), 4);
        assert!(wave.len() > 50 && wave.last().is_some_and(|last| last.1 && last.0 <= 1000 + millis(500)));
        for pair in wave[..wave.len() - 1].windows(2) {
            assert!((micros(10)..=millis(20)).contains(&(pair[1].0 - pair[0].0)));
            assert_ne!(pair[0].1, pair[1].1);
        }
    }
}
