//! The fuzz target's promise, kept for seeded inputs so that the target cannot rot: bytes that are anything, damaged
//! frames, and intact frames with any content.

#[path = "../fuzz/decode.rs"]
mod decode;

use decode::{decode, naive};

/// `SplitMix64` (Steele, Lea & Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, bound: usize) -> usize {
        (self.next() % bound as u64) as usize
    }

    fn bytes(&mut self, most: usize) -> Vec<u8> {
        // Small bytes are codes and counts more often than large ones.
        let mask = if self.below(2) == 0 { 0xff } else { 0x07 };
        (0..self.below(most + 1)).map(|_| self.next() as u8 & mask).collect()
    }

    /// Version, sequence number, a kind that exists, and any payload; some batches of edges have a count that fits.
    fn content(&mut self) -> Vec<u8> {
        let kind = if self.below(2) == 0 { 1 + self.below(7) } else { 128 + self.below(10) } as u8;
        let mut content = vec![1, self.next() as u8, kind];
        content.extend(self.bytes(50));
        if kind == 130 && content.len() >= 14 {
            let steps = content.len() - 14;
            content[7] = (1 + steps).min(8) as u8;
        }
        content
    }
}

#[test]
fn any_bytes_are_borne() {
    let mut random = Random(1);
    for _ in 0..100_000 {
        decode(&random.bytes(200));
    }
}

#[test]
fn intact_frames_of_any_content_are_borne() {
    let mut random = Random(2);
    for _ in 0..200_000 {
        decode(&random.content());
    }
}

#[test]
fn damaged_frames_are_borne() {
    let mut random = Random(3);
    for _ in 0..50_000 {
        let mut bytes: Vec<u8> = (0..4).flat_map(|_| naive::frame(&random.content())).collect();
        for _ in 0..random.below(4) {
            let at = random.below(bytes.len());
            match random.below(4) {
                0 => bytes[at] ^= 1 << random.below(8),
                1 => bytes[at] = random.next() as u8,
                2 => drop(bytes.remove(at)),
                _ => bytes.insert(at, random.next() as u8),
            }
        }
        decode(&bytes);
    }
}
