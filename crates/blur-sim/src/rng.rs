//! Random numbers that are the same on every machine.
//!
//! The generator is `ChaCha8`, and every transcendental function comes from `libm` compiled into the program: no
//! result depends on the processor, the operating system or its mathematical library.

use crate::Result;
use crate::check;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};

/// Means below this are sampled by inversion, others by rejection (which needs a mean of at least 10).
const INVERSION_BELOW: f64 = 10.0;

/// A seeded source of random numbers.
///
/// ```
/// use blur_sim::rng::Rng;
/// assert_eq!(Rng::new(7, 0).uniform(), Rng::new(7, 0).uniform());
/// assert_ne!(Rng::new(7, 0).uniform(), Rng::new(7, 1).uniform());
/// ```
#[derive(Debug, Clone)]
pub struct Rng {
    source: ChaCha8Rng,
    spare_gaussian: Option<f64>,
}

impl Rng {
    /// The sequence number `stream` of a `seed`. Sequences of one seed are independent of each other, so that one
    /// seed can serve a scene and the noise on its picture.
    ///
    /// The 256-bit key is four outputs of `SplitMix64` (Steele, Lea & Flood 2014) started at `seed`.
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut state = seed;
        let mut key = [0_u8; 32];
        for chunk in key.chunks_exact_mut(8) {
            chunk.copy_from_slice(&split_mix(&mut state).to_le_bytes());
        }
        let mut source = ChaCha8Rng::from_seed(key);
        source.set_stream(stream);
        Self { source, spare_gaussian: None }
    }

    /// 64 random bits, such as the seed of another sequence.
    pub fn bits(&mut self) -> u64 {
        self.source.next_u64()
    }

    /// A number in `[0, 1)`: a multiple of `2^-53`, all equally likely.
    pub fn uniform(&mut self) -> f64 {
        const STEP: f64 = 1.0 / (1_u64 << 53) as f64;
        (self.bits() >> 11) as f64 * STEP
    }

    /// A number in `[low, high)`; `low` itself when the interval is empty.
    pub fn uniform_in(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low).max(0.0) * self.uniform()
    }

    /// A Gaussian number of mean 0 and standard deviation 1.
    ///
    /// *Reference*: the polar method of Marsaglia & Bray, SIAM Review 6 (1964) 260.
    pub fn gaussian(&mut self) -> f64 {
        if let Some(spare) = self.spare_gaussian.take() {
            return spare;
        }
        loop {
            let (x, y) = (2.0 * self.uniform() - 1.0, 2.0 * self.uniform() - 1.0);
            let square = x * x + y * y;
            if square > 0.0 && square < 1.0 {
                let scale = (-2.0 * libm::log(square) / square).sqrt();
                self.spare_gaussian = Some(y * scale);
                return x * scale;
            }
        }
    }

    /// A Poisson count of the given mean, in `0..=1e12`.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) when the mean is negative, NaN or above `1e12`.
    ///
    /// *Reference*: sequential search from 0 below a mean of 10 (Devroye, *Non-Uniform Random Variate Generation*,
    /// 1986, X.3.3); transformed rejection PTRS from there (Hörmann, Insurance: Mathematics and Economics 12 (1993)
    /// 39).
    pub fn poisson(&mut self, mean: f64) -> Result<u64> {
        check::range("mean of a Poisson count", mean, 0.0, 1e12, "0 to 1e12")?;
        Ok(if mean < INVERSION_BELOW { self.poisson_by_inversion(mean) } else { self.poisson_by_rejection(mean) })
    }

    fn poisson_by_inversion(&mut self, mean: f64) -> u64 {
        let mut left = self.uniform();
        let mut probability = libm::exp(-mean);
        let mut count = 0_u64;
        while left >= probability {
            left -= probability;
            count += 1;
            let next = probability * mean / count as f64;
            // The sum of the probabilities may round to less than the uniform number: stop where nothing is added.
            if next < f64::EPSILON * f64::EPSILON && count as f64 > mean {
                break;
            }
            probability = next;
        }
        count
    }

    fn poisson_by_rejection(&mut self, mean: f64) -> u64 {
        let log_mean = libm::log(mean);
        let b = 0.931 + 2.53 * mean.sqrt();
        let a = -0.059 + 0.02483 * b;
        let inverse_alpha = 1.1239 + 1.1328 / (b - 3.4);
        let v_r = 0.9277 - 3.6224 / (b - 2.0);
        loop {
            let u = self.uniform() - 0.5;
            let v = self.uniform();
            let us = 0.5 - u.abs();
            if us <= 0.0 {
                continue;
            }
            let k = ((2.0 * a / us + b) * u + mean + 0.43).floor();
            if us >= 0.07 && v <= v_r {
                return k as u64;
            }
            if k < 0.0 || (us < 0.013 && v > us) {
                continue;
            }
            let left = libm::log(v * inverse_alpha / (a / (us * us) + b));
            if left <= k * log_mean - mean - libm::lgamma(k + 1.0) {
                return k as u64;
            }
        }
    }
}

fn split_mix(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
