//! Which starts are tried with which accelerations.

use super::shot::Start;
use super::{POSTERS, Rig, SHOTS, Shot};
use crate::Result;
use crate::rng::Rng;

/// Distance in metres between the release and the shutter in [`Design::FixedRelease`]: with the default rig lengths are
/// 26 px at 0.644 m/s² to 56 px at 2.463 m/s².
pub const FIXED_RELEASE_M: f64 = 0.05;

/// Shortest and longest blur in pixels of [`Design::RandomRelease`].
pub const LENGTHS_PX: (f64, f64) = (30.0, 70.0);

/// Streams of the seed: the lengths, and their order at each preset from here on.
const LENGTHS_STREAM: u64 = 0x0716_0003_0000_0000;
const ORDER_STREAM: u64 = 0x0716_0004_0000_0000;

/// How the carriage is released: what the length of the blur says about the acceleration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Design {
    /// Always [`FIXED_RELEASE_M`] before the shutter, as on the rig of the thesis: the blur is the longer the greater the
    /// acceleration, and a method that knows only the length knows the acceleration.
    FixedRelease,
    /// From wherever the blur gets its length. One set of lengths, stratified over [`LENGTHS_PX`] (one uniform number in
    /// each of as many equal strata as there are shots of an acceleration, 25), serves every preset, in an order of its
    /// own: length and preset acceleration have correlation 0, and a method that knows only the length knows nothing of
    /// the acceleration. The release is 0.009 m (30 px at 2.463 m/s²) to 0.42 m (70 px at 0.644 m/s²) before the shutter.
    RandomRelease,
}

impl Design {
    /// All designs with their names.
    pub const NAMED: [(&'static str, Self); 2] =
        [("fixed-release", Self::FixedRelease), ("random-release", Self::RandomRelease)];
}

impl Rig {
    /// All shots of an experiment, [`SHOTS`] for each preset and poster, in the order of presets, then posters.
    ///
    /// This is the truth only and takes no time; the pictures are taken by [`Studio`](super::Studio). One `seed` draws the
    /// same true accelerations and settings in every design.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) when a value of the rig is out of its range, or the exposure so
    /// long that a carriage released at rest makes a longer blur than wanted.
    pub fn shots(&self, design: Design, seed: u64) -> Result<Vec<Shot>> {
        self.check()?;
        let each = POSTERS.len() * SHOTS;
        let lengths = stratified(&mut Rng::new(seed, LENGTHS_STREAM), each, LENGTHS_PX);
        let mut shots = Vec::with_capacity(self.presets.len() * each);
        for preset in 0..self.presets.len() {
            let order = shuffled(&mut Rng::new(seed, ORDER_STREAM + preset as u64), &lengths);
            for (number, length_px) in order.into_iter().enumerate() {
                let start = match design {
                    Design::FixedRelease => Start::Release(FIXED_RELEASE_M),
                    Design::RandomRelease => Start::Length(length_px),
                };
                shots.push(self.shot(number / SHOTS, preset, number % SHOTS, start, seed)?);
            }
        }
        Ok(shots)
    }
}

/// A uniform number in each of `count` equal strata of an interval, in their order.
fn stratified(rng: &mut Rng, count: usize, (low, high): (f64, f64)) -> Vec<f64> {
    let width = (high - low) / count as f64;
    (0..count).map(|stratum| low + width * (stratum as f64 + rng.uniform())).collect()
}

/// The values in random order (Fisher and Yates).
fn shuffled(rng: &mut Rng, values: &[f64]) -> Vec<f64> {
    let mut order = values.to_vec();
    for last in (1..order.len()).rev() {
        let other = (rng.uniform() * (last + 1) as f64) as usize;
        order.swap(other, last);
    }
    order
}
