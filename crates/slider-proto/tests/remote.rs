//! Keys of the remote are read through the receiver's distortions, and nothing else is.

use proptest::prelude::*;
use slider_proto::remote::{Key, Remote};

/// Microseconds that the receiver's output stays low and then high.
type Pulses = Vec<(f64, f64)>;

/// Longer than any frame.
const REST: f64 = 40_000.0;

/// NEC (data sheet of the uPD6121): a burst of 9 ms and 4.5 ms of rest, 32 bits, low bit first, each a burst of 562.5 us
/// and a rest to 1.125 ms (0) or 2.25 ms (1), and a last burst.
fn pulses(bits: u32) -> Pulses {
    let mut pulses = vec![(9000.0, 4500.0)];
    for i in 0..32 {
        let period = if bits >> i & 1 == 1 { 2250.0 } else { 1125.0 };
        pulses.push((562.5, period - 562.5));
    }
    pulses.push((562.5, REST));
    pulses
}

/// Address, its inverse, command, its inverse, first to last.
fn bits(address: u8, command: u8) -> u32 {
    u32::from(address) | u32::from(!address) << 8 | u32::from(command) << 16 | u32::from(!command) << 24
}

/// A clock that runs by `scale`, and a receiver that lengthens each burst by `stretch_us` at the cost of the rest.
fn distorted(pulses: &Pulses, scale: f64, stretch_us: f64) -> Pulses {
    pulses.iter().map(|&(low, high)| (low * scale + stretch_us, high * scale - stretch_us)).collect()
}

/// As the firmware stamps: ticks of 0.5 us, the longest 32767.
fn ticks(us: f64) -> u16 {
    (us * 2.0).round().min(32_767.0) as u16
}

/// All keys that `remote` reads.
fn keys(remote: &mut Remote, pulses: &Pulses) -> Vec<Key> {
    keys_after(REST, remote, pulses)
}

/// Likewise, so many microseconds after the burst before them.
fn keys_after(mut rest: f64, remote: &mut Remote, pulses: &Pulses) -> Vec<Key> {
    let mut keys = Vec::new();
    for &(low, high) in pulses {
        keys.extend(remote.change(false, ticks(rest)));
        keys.extend(remote.change(true, ticks(low)));
        rest = high;
    }
    keys
}

fn keys_of(bits: u32) -> Vec<Key> {
    keys(&mut Remote::new(), &pulses(bits))
}

/// What the 21 keys of the remote send, as found in print with every Arduino kit, row by row.
const LAYOUT: [(u8, &str); 21] = [
    (0x45, "CH-"),
    (0x46, "CH"),
    (0x47, "CH+"),
    (0x44, "prev"),
    (0x40, "next"),
    (0x43, "play/pause"),
    (0x07, "-"),
    (0x15, "+"),
    (0x09, "EQ"),
    (0x16, "0"),
    (0x19, "100+"),
    (0x0d, "200+"),
    (0x0c, "1"),
    (0x18, "2"),
    (0x5e, "3"),
    (0x08, "4"),
    (0x1c, "5"),
    (0x5a, "6"),
    (0x42, "7"),
    (0x52, "8"),
    (0x4a, "9"),
];

/// A digit is that preset, 100+ and 200+ are nothing, and all other keys stop.
fn key(command: u8) -> Option<Key> {
    let &(_, label) = LAYOUT.iter().find(|(code, _)| *code == command)?;
    match label {
        "100+" | "200+" => None,
        _ => Some(label.parse().map_or(Key::Stop, Key::Digit)),
    }
}

#[test]
fn each_command_of_the_remote_is_its_key_or_none() {
    for command in 0..=255 {
        assert_eq!(keys_of(bits(0, command)), key(command).as_slice(), "{command:#04x}");
    }
}

#[test]
fn other_remotes_are_not_obeyed() {
    for address in 1..=255 {
        for (command, _) in LAYOUT {
            assert_eq!(keys_of(bits(address, command)), [], "{address:#04x}, {command:#04x}");
        }
    }
}

#[test]
fn one_or_two_flipped_bits_are_never_the_key() {
    for (command, _) in LAYOUT {
        let right = bits(0, command);
        for i in 0..32 {
            for j in 0..=i {
                // With i = j, one bit.
                let flipped = right ^ (1 << i | 1 << j);
                // A bit of the command together with its inverse makes another command: the code has no more in it.
                let other = if j >= 16 && i == j + 8 { key(command ^ 1 << (j - 16)) } else { None };
                assert_eq!(keys_of(flipped), other.as_slice(), "{command:#04x}, bits {i} and {j}");
            }
        }
    }
}

#[test]
fn inverses_have_to_be_inverses() {
    for (command, _) in LAYOUT {
        for inverse in 0..=255 {
            let other = u32::from(inverse) << 24 | bits(0, command) & 0x00ff_ffff;
            assert_eq!(keys_of(other).is_empty(), inverse != !command || key(command).is_none());
            let other = u32::from(inverse) << 8 | bits(0, command) & 0xffff_00ff;
            assert_eq!(keys_of(other).is_empty(), inverse != 0xff || key(command).is_none());
        }
    }
}

#[test]
fn keys_are_read_through_every_clock_and_receiver() {
    // A resonator 10 % off, and a receiver that makes bursts 200 us longer or shorter, and all between.
    for (command, _) in LAYOUT {
        for percent in 90..=110 {
            for stretch_us in (-200..=200).step_by(50) {
                let pulses = distorted(&pulses(bits(0, command)), f64::from(percent) / 100.0, f64::from(stretch_us));
                let found = keys(&mut Remote::new(), &pulses);
                assert_eq!(found, key(command).as_slice(), "{command:#04x}, {percent} %, {stretch_us} us");
            }
        }
    }
}

#[test]
fn bits_of_other_lengths_are_no_key() {
    // Half as long again, or half as long: not NEC.
    for scale in [0.5, 0.7, 0.8, 1.2, 1.3, 1.5, 2.0] {
        assert_eq!(keys(&mut Remote::new(), &distorted(&pulses(bits(0, 0x16)), scale, 0.0)), [], "{scale}");
    }
    let with = |at: usize, odd: (f64, f64)| {
        let mut pulses = pulses(bits(0, 0x16));
        pulses[at] = odd;
        keys(&mut Remote::new(), &pulses)
    };
    // Bits 25 % too short, one between a 0 and a 1, bits 27 % too long and more, and bursts that are none.
    for at in 1..=32 {
        for period in [700.0, 843.75, 1675.0, 2860.0, 3500.0] {
            assert_eq!(with(at, (562.5, period - 562.5)), [], "bit {at}: {period} us");
        }
        for burst in [100.0, 250.0, 950.0] {
            assert_eq!(with(at, (burst, 1125.0 - burst)), [], "bit {at}: a burst of {burst} us");
        }
    }
    for burst in [100.0, 250.0, 950.0, 2000.0] {
        assert_eq!(with(33, (burst, REST)), [], "the last burst: {burst} us");
    }
    // Leaders 20 % off, and that of a repetition.
    for leader in [(7200.0, 6300.0), (10_800.0, 2700.0), (9000.0, 1800.0), (9000.0, 7200.0), (9000.0, 2250.0)] {
        assert_eq!(with(0, leader), [], "{leader:?}");
    }
}

#[test]
fn frames_with_a_bit_too_few_or_too_many_are_no_key() {
    for at in 1..=32 {
        let mut fewer = pulses(bits(0, 0x16));
        fewer.remove(at);
        assert_eq!(keys(&mut Remote::new(), &fewer), []);
        // The key is out at the burst after the 32nd bit, so a 33rd can only be told by the bits before it.
        let mut more = pulses(bits(0, 0x16));
        more.insert(at, more[at]);
        let first = (0..32).map(|i| u32::from(more[i + 1].1 > 1000.0) << i).sum::<u32>();
        let shifted = first != bits(0, 0x16);
        assert_eq!(keys(&mut Remote::new(), &more).is_empty(), shifted, "bit {at}");
    }
}

#[test]
fn held_key_is_one_key() {
    for scale in [0.9, 1.0, 1.1] {
        let mut remote = Remote::new();
        assert_eq!(keys(&mut remote, &distorted(&pulses(bits(0, 0x0c)), scale, 0.0)), [Key::Digit(1)]);
        let repeat = vec![(9000.0, 2250.0), (562.5, REST)];
        for _ in 0..100 {
            assert_eq!(keys(&mut remote, &distorted(&repeat, scale, 0.0)), []);
        }
        assert_eq!(keys(&mut remote, &pulses(bits(0, 0x18))), [Key::Digit(2)]);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn frame_right_after_noise_is_read(
        noise in prop::collection::vec((any::<bool>(), any::<u16>()), 0..80),
        rest in 0.0..20_000.0,
        cut in 0..34_usize,
        command in prop::sample::select(LAYOUT.map(|(command, _)| command).to_vec()),
    ) {
        let mut remote = Remote::new();
        for (high, ticks) in noise {
            remote.change(high, ticks);
        }
        // A frame that breaks off, and the next without a rest.
        let mut both = pulses(bits(0, 0x16))[..cut].to_vec();
        both.extend(pulses(bits(0, command)));
        assert_eq!(keys_after(rest, &mut remote, &both), key(command).as_slice());
    }
}

/// `SplitMix64` (Steele, Lea & Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, bound: u64) -> u64 {
        self.next() % bound
    }

    /// One of the protocol's own lengths, in ticks, up to 20 % off.
    fn near(&mut self, lengths: &[u64]) -> u16 {
        let length = lengths[self.below(lengths.len() as u64) as usize];
        (length * (800 + self.below(400)) / 1000) as u16
    }
}

#[test]
fn hours_of_noise_are_no_key() {
    let mut random = Random(1);
    let mut remote = Remote::new();
    let mut ticks = 0_u64;
    for i in 0..12_000_000_u64 {
        let since = match random.below(16) {
            0 => random.below(32_768) as u16,
            _ => random.near(&[18_000, 9000, 4500, 3375, 1125, 1125, 1125]),
        };
        // Some changes are missed, so that two of the same kind follow each other.
        let high = (i % 2 == 0) ^ (random.below(1000) == 0);
        assert_eq!(remote.change(high, since), None, "change {i}");
        ticks += u64::from(since);
    }
    assert!(ticks > 2 * 3600 * 2_000_000, "{} h", ticks / 3600 / 2_000_000);
}

#[test]
fn frames_of_random_bits_are_no_key() {
    // As of other remotes. Of 2^32 words, 19 are keys: 200000 random ones hit one with a chance of 1 in 1100.
    let mut random = Random(2);
    let mut remote = Remote::new();
    for _ in 0..200_000 {
        let word = random.next() as u32;
        assert_eq!(keys(&mut remote, &pulses(word)), [], "{word:#010x}");
    }
}
