//! A logarithm and an exponential that are computed for many values at a time.

/// Natural logarithm of a positive normal number, to 3e-7 absolute near 1 and one part in ten million elsewhere.
///
/// `x = 2^k m` with `m` in `[sqrt 1/2, sqrt 2)`, then `ln m = 2 atanh((m - 1) / (m + 1))` by its series. No branch and no
/// call, so a loop over it runs on vectors; spectra take a logarithm of every bin.
pub(crate) fn ln(x: f32) -> f32 {
    const SQRT_HALF_BITS: u32 = 0x3f35_04f3;
    let shifted = x.to_bits().wrapping_sub(SQRT_HALF_BITS);
    let exponent = (shifted as i32) >> 23;
    let mantissa = f32::from_bits((shifted & 0x007f_ffff) + SQRT_HALF_BITS);
    let t = (mantissa - 1.0) / (mantissa + 1.0);
    let t2 = t * t;
    // |t| < 0.1716: the next term of the series is below 2e-9.
    let series = 2.0 * t * (1.0 + t2 * (1.0 / 3.0 + t2 * (1.0 / 5.0 + t2 * (1.0 / 7.0 + t2 / 9.0))));
    exponent as f32 * std::f32::consts::LN_2 + series
}

/// The exponential of a number in -87 to 88, to 4e-7 of its value; beyond these ends it stays what it is there.
///
/// `e^x = 2^k e^r` with `|r| <= ln 2 / 2` and the series of `e^r`. No branch and no call, as [`ln`].
pub(crate) fn exp(x: f32) -> f32 {
    // Adding and taking away 1.5 2^23 rounds to the nearest integer.
    const ROUND: f32 = 12_582_912.0;
    // ln 2 in two parts: the first has so few digits that k times it is exact.
    const LN_2_HIGH: f32 = 0.693_359_4;
    const LN_2_LOW: f32 = -2.121_944_4e-4;
    let x = x.clamp(-87.0, 88.0);
    let shifted = x * std::f32::consts::LOG2_E + ROUND;
    let k = shifted - ROUND;
    let r = (x - k * LN_2_HIGH) - k * LN_2_LOW;
    let series =
        1.0 + r * (1.0 + r * (0.5 + r * (1.0 / 6.0 + r * (1.0 / 24.0 + r * (1.0 / 120.0 + r * (1.0 / 720.0))))));
    // The low bits of `shifted` hold k.
    let power = f32::from_bits((shifted.to_bits().wrapping_shl(23)).wrapping_add(0x3f80_0000));
    series * power
}

#[cfg(test)]
mod tests {
    use super::{exp, ln};

    #[test]
    fn it_is_the_exponential_and_stays_at_its_ends() {
        let mut x = -87.0_f32;
        while x <= 88.0 {
            let exact = f64::from(x).exp();
            assert!((f64::from(exp(x)) / exact - 1.0).abs() < 4e-7, "{x}");
            x += 0.003_7;
        }
        assert_eq!(exp(0.0), 1.0);
        assert_eq!(exp(-1e9), exp(-87.0));
        assert_eq!(exp(1e9), exp(88.0));
    }

    #[test]
    fn it_is_the_logarithm_over_the_whole_range() {
        let mut x = f32::MIN_POSITIVE;
        while x < 1e38 {
            let exact = f64::from(x).ln();
            assert!((f64::from(ln(x)) - exact).abs() <= 3e-7 + 2e-7 * exact.abs(), "{x}: {} {exact}", ln(x));
            x *= 1.000_7;
        }
        assert_eq!(ln(1.0), 0.0);
    }
}
