//! Matched filters on the projection of a spectrum.

use std::f64::consts::PI;

use super::radon::Profile;

/// A bank of patterns, one for each candidate length, that a [`Profile`] is compared with.
#[derive(Debug, Clone)]
pub struct PatternBank {
    lengths_px: Vec<f64>,
    /// Pattern by pattern, one value per line of the profile.
    patterns: Vec<f32>,
    lines: usize,
}

/// The pattern that fits a profile best.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Match {
    /// Length in pixels of the pattern.
    pub length_px: f64,
    /// Half the sum of squares that the pattern explains, its amplitude and a constant being free: the gain in log
    /// likelihood over no pattern when the values have unit variance and are independent.
    pub gain: f64,
}

/// Ratio of neighbouring lengths of a bank.
const LENGTH_RATIO: f64 = 1.08;
/// Fills the zeros of the sinc: noise, leakage and slight curvature keep real dark lines from being black.
const FLOOR: f64 = 0.05;
/// Width of a Gabor pattern: standard deviation of its envelope in periods.
const GABOR_PERIODS: f64 = 1.0;

impl PatternBank {
    /// `ln(sinc^2(L s) + 0.05)`, the dark lines of a uniform blur, for lengths from `least_px` to `most_px`.
    pub fn dark_lines(profile: &Profile, least_px: f64, most_px: f64) -> Self {
        Self::new(profile, least_px, most_px, |length, s| {
            let x = PI * length * s;
            let sinc = if x == 0.0 { 1.0 } else { x.sin() / x };
            (sinc * sinc + FLOOR).ln()
        })
    }

    /// Even Gabor functions at the origin, `exp(-(L s)^2 / 2) cos(2 pi L s)`, of period `1/L` for lengths from
    /// `least_px` to `most_px`.
    pub fn gabor(profile: &Profile, least_px: f64, most_px: f64) -> Self {
        Self::new(profile, least_px, most_px, |length, s| {
            let x = length * s;
            (-0.5 * (x / GABOR_PERIODS).powi(2)).exp() * (2.0 * PI * x).cos()
        })
    }

    fn new(profile: &Profile, least_px: f64, most_px: f64, pattern: impl Fn(f64, f64) -> f64) -> Self {
        let lines = profile.sum.len();
        let mut bank = Self { lengths_px: Vec::new(), patterns: Vec::new(), lines };
        let steps = ((most_px / least_px).ln() / LENGTH_RATIO.ln()).ceil().max(1.0) as i32;
        for i in 0..=steps {
            let length = least_px * (most_px / least_px).powf(f64::from(i) / f64::from(steps));
            bank.lengths_px.push(length);
            bank.patterns.extend((0..lines).map(|line| pattern(length, (line as f64 + 0.5) * profile.step()) as f32));
        }
        bank
    }

    /// The pattern of the bank that fits `profile` best.
    pub fn best_match(&self, profile: &Profile) -> Match {
        let weight: f32 = profile.weight.iter().sum();
        let sum: f32 = profile.sum.iter().sum();
        let mut best = Match { length_px: self.lengths_px.first().copied().unwrap_or(0.0), gain: 0.0 };
        for (&length_px, pattern) in self.lengths_px.iter().zip(self.patterns.chunks_exact(self.lines)) {
            let gain = gain_of(pattern, profile, f64::from(weight), f64::from(sum));
            if gain > best.gain {
                best = Match { length_px, gain };
            }
        }
        best
    }

    /// As [`best_match`](Self::best_match), with the length between the lengths of the bank by a parabola in `ln L`.
    pub fn refined_match(&self, profile: &Profile) -> Match {
        let best = self.best_match(profile);
        let weight: f64 = profile.weight.iter().map(|&w| f64::from(w)).sum();
        let sum: f64 = profile.sum.iter().map(|&w| f64::from(w)).sum();
        let Some(at) = self.lengths_px.iter().position(|&length| length == best.length_px) else { return best };
        if at == 0 || at + 1 == self.lengths_px.len() {
            return best;
        }
        let gain = |i: usize| gain_of(self.pattern(self.lengths_px[i]), profile, weight, sum);
        let (before, after) = (gain(at - 1), gain(at + 1));
        let curvature = before - 2.0 * best.gain + after;
        if curvature >= 0.0 {
            return best;
        }
        let shift = (0.5 * (before - after) / curvature).clamp(-1.0, 1.0);
        let ratio = self.lengths_px[at + 1] / self.lengths_px[at];
        Match {
            length_px: best.length_px * ratio.powf(shift),
            gain: best.gain - 0.125 * (before - after).powi(2) / curvature,
        }
    }

    /// The pattern of this length of the bank, one value per line of the profile; empty for a length not in the bank.
    pub fn pattern(&self, length_px: f64) -> &[f32] {
        let at = self.lengths_px.iter().position(|&length| length == length_px);
        at.map_or(&[], |at| &self.patterns[at * self.lines..(at + 1) * self.lines])
    }
}

/// Half the explained sum of squares of a pattern with free amplitude >= 0 over a constant.
fn gain_of(pattern: &[f32], profile: &Profile, weight: f64, sum: f64) -> f64 {
    // Eight sums side by side: the compiler may not reorder floating-point additions by itself.
    const LANES: usize = 8;
    let (mut wt, mut wtt, mut yt) = ([0.0_f32; LANES], [0.0_f32; LANES], [0.0_f32; LANES]);
    let whole = pattern.len() / LANES * LANES;
    let chunks = (pattern[..whole].chunks_exact(LANES))
        .zip(profile.weight[..whole].chunks_exact(LANES))
        .zip(profile.sum[..whole].chunks_exact(LANES));
    for ((t, w), y) in chunks {
        for i in 0..LANES {
            let weighted = w[i] * t[i];
            wt[i] += weighted;
            wtt[i] += weighted * t[i];
            yt[i] += y[i] * t[i];
        }
    }
    let rest = pattern[whole..].iter().zip(&profile.weight[whole..]).zip(&profile.sum[whole..]);
    for ((t, w), y) in rest {
        let weighted = w * t;
        wt[0] += weighted;
        wtt[0] += weighted * t;
        yt[0] += y * t;
    }
    let total = |lanes: [f32; LANES]| lanes.iter().map(|&x| f64::from(x)).sum::<f64>();
    let (wt, wtt, yt) = (total(wt), total(wtt), total(yt));
    let covariance = yt - sum * wt / weight;
    let variance = wtt - wt * wt / weight;
    if variance > 1e-9 * wtt && covariance > 0.0 { 0.5 * covariance * covariance / variance } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn profile_of(f: impl Fn(f64) -> f64) -> Profile {
        let mut profile = Profile::new(0.5 / 512.0, 0.4);
        for i in 0..profile.sum.len() {
            let s = (i as f64 + 0.5) * profile.step();
            profile.weight[i] = 20.0 + (i % 7) as f32;
            profile.sum[i] = profile.weight[i] * f(s) as f32;
        }
        profile
    }

    #[test]
    fn the_matched_length_is_that_of_the_dark_lines() {
        for length in [7.7_f64, 23.0, 55.5, 120.0] {
            let profile = profile_of(|s| {
                let x = PI * length * s;
                3.0 + 0.8 * ((x.sin() / x).powi(2) + 0.02).ln()
            });
            let bank = PatternBank::dark_lines(&profile, 4.0, 300.0);
            let found = bank.refined_match(&profile).length_px;
            assert!((found / length - 1.0).abs() < 0.02, "{length}: {found}");
        }
    }

    #[test]
    fn the_gain_is_half_the_explained_sum_of_squares() {
        // The pattern itself with amplitude 2: explained are 4 times its weighted variance.
        let bank = PatternBank::dark_lines(&profile_of(|_| 0.0), 10.0, 40.0);
        let pattern: Vec<f64> = bank.patterns[..bank.lines].iter().map(|&t| f64::from(t)).collect();
        let mut profile = profile_of(|_| 0.0);
        let (mut w, mut wt, mut wtt) = (0.0, 0.0, 0.0);
        for (i, &t) in pattern.iter().enumerate() {
            let weight = f64::from(profile.weight[i]);
            profile.sum[i] = (weight * (5.0 + 2.0 * t)) as f32;
            w += weight;
            wt += weight * t;
            wtt += weight * t * t;
        }
        let found = bank.best_match(&profile);
        assert_eq!(found.length_px, 10.0);
        let expected = 0.5 * 4.0 * (wtt - wt * wt / w);
        assert!((found.gain / expected - 1.0).abs() < 1e-3, "{} {expected}", found.gain);
    }

    #[test]
    fn a_flat_profile_and_bright_zeros_gain_nothing() {
        let flat = profile_of(|_| 1.0);
        let bank = PatternBank::dark_lines(&flat, 4.0, 100.0);
        assert!(bank.best_match(&flat).gain < 1e-3);
    }
}
