//! The noise floor of a spectrum.

/// Distribution of the powers of a spectrum of white noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Powers {
    /// Squares of real coefficients (DCT): chi-square with one degree of freedom.
    OfReal,
    /// Squared moduli of complex coefficients (DFT): exponential.
    OfComplex,
}

impl Powers {
    /// Median over mean.
    fn median_over_mean(self) -> f32 {
        match self {
            Self::OfReal => 0.454_936,
            Self::OfComplex => std::f32::consts::LN_2,
        }
    }
}

/// Reads the mean power of the noise where blurred pictures have next to no signal: 0.4 to 0.5 cycles per pixel.
#[derive(Debug, Clone)]
pub struct NoiseFloor {
    samples: Vec<f32>,
}

/// Powers that the floor is read from, at most: its scatter is then 1 %.
const SAMPLES: usize = 8192;
const BAND: std::ops::RangeInclusive<f64> = 0.4..=0.5;
/// Least floor for a picture of variance 1: far below 8-bit rounding, only there to keep logarithms finite.
const LEAST: f32 = 1e-8;

impl Default for NoiseFloor {
    fn default() -> Self {
        Self::new()
    }
}

impl NoiseFloor {
    /// Buffers for any number of spectra.
    pub fn new() -> Self {
        Self { samples: Vec::with_capacity(SAMPLES) }
    }

    /// The mean noise power of a spectrum of `rows` x `columns` bins: `radius(row, column)` gives a bin's radius in
    /// cycles per pixel, `power(row, column)` its power, scaled so that a picture of variance 1 has mean power 1. The
    /// median is blind to what signal is left in the band.
    pub fn read(
        &mut self,
        (rows, columns): (usize, usize),
        powers: Powers,
        radius: impl Fn(usize, usize) -> f64,
        power: impl Fn(usize, usize) -> f32,
    ) -> f32 {
        let stride = ((rows * columns) as f64 / SAMPLES as f64).sqrt().ceil().max(1.0) as usize;
        self.samples.clear();
        for row in (0..rows).step_by(stride) {
            for column in (0..columns).step_by(stride) {
                if self.samples.len() < SAMPLES && BAND.contains(&radius(row, column)) {
                    self.samples.push(power(row, column));
                }
            }
        }
        if self.samples.is_empty() {
            return LEAST;
        }
        let middle = self.samples.len() / 2;
        let (_, &mut median, _) = self.samples.select_nth_unstable_by(middle, f32::total_cmp);
        (median / powers.median_over_mean()).max(LEAST)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_floor_of_exponential_powers_is_their_mean() {
        // Quantiles of an exponential distribution of mean 3, in a scrambled order.
        let power = |row: usize, column: usize| {
            let i = ((row * 64 + column) * 2741) % 4096;
            -3.0 * (1.0 - (i as f32 + 0.5) / 4096.0).ln()
        };
        let floor = NoiseFloor::new().read((64, 64), Powers::OfComplex, |_, _| 0.45, power);
        assert!((floor - 3.0).abs() < 0.01, "{floor}");
    }

    #[test]
    fn low_frequencies_do_not_count() {
        let radius = |row: usize, _: usize| row as f64 / 100.0;
        let power = |row: usize, _: usize| if row < 40 { 1e9 } else { 0.454_936 };
        let floor = NoiseFloor::new().read((50, 50), Powers::OfReal, radius, power);
        assert!((floor - 1.0).abs() < 1e-6);
    }
}
