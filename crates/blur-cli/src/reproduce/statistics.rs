//! Summaries of errors, and how well a share or a root mean square is known.

use serde::Serialize;

/// Quantile 0.975 of the normal distribution: the half width of 95 % intervals in standard deviations.
pub(super) const Z_95: f64 = 1.959_963_984_540_054;

/// Quantile 0.95 of the chi-square distribution of two degrees of freedom, `-2 ln 0.05`: the squared radius of the
/// ellipse that holds 95 % of a normal distribution in the plane.
pub const ELLIPSE_95: f64 = 5.991_464_547_107_98;

/// Five-number summary, mean and share of gross errors of a list of absolute errors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Summary {
    /// How many.
    #[serde(skip)]
    pub n: usize,
    /// Mean.
    pub mean: f64,
    /// Smallest.
    pub min: f64,
    /// Lower quartile.
    pub q1: f64,
    /// Median.
    pub median: f64,
    /// Upper quartile.
    pub q3: f64,
    /// Quantile 0.9.
    pub p90: f64,
    /// Largest.
    pub max: f64,
    /// Share above the limit given.
    #[serde(skip)]
    pub gross: f64,
}

impl Summary {
    /// The summary of `errors`, of which those above `gross_above` are gross; `None` when there are none.
    pub fn of(errors: &[f64], gross_above: f64) -> Option<Self> {
        let mut sorted = errors.to_vec();
        sorted.sort_by(f64::total_cmp);
        let (&min, &max) = (sorted.first()?, sorted.last()?);
        let n = sorted.len();
        // Linear interpolation between order statistics, as numpy and R's default.
        let quantile = |p: f64| {
            let at = p * (n - 1) as f64;
            let (low, high) = (sorted[at.floor() as usize], sorted[at.ceil() as usize]);
            low + (high - low) * at.fract()
        };
        Some(Self {
            n,
            mean: sorted.iter().sum::<f64>() / n as f64,
            min,
            q1: quantile(0.25),
            median: quantile(0.5),
            q3: quantile(0.75),
            p90: quantile(0.9),
            max,
            gross: sorted.iter().filter(|&&e| e > gross_above).count() as f64 / n as f64,
        })
    }
}

/// Median of `values`; `None` when there are none.
pub fn median(values: &[f64]) -> Option<f64> {
    Summary::of(values, f64::INFINITY).map(|summary| summary.median)
}

/// A number and its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Interval {
    /// The number.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// The share `hits / n` with Wilson's interval of the probability behind it; `None` for `n = 0`.
///
/// # Reference
/// Wilson, *Probable inference, the law of succession, and statistical inference*, JASA 22 (1927) 209.
pub fn share(hits: usize, n: usize) -> Option<Interval> {
    if n == 0 {
        return None;
    }
    let (p, n) = (hits as f64 / n as f64, n as f64);
    let z2 = Z_95 * Z_95;
    let middle = (p + z2 / (2.0 * n)) / (1.0 + z2 / n);
    let half = Z_95 / (1.0 + z2 / n) * (p * (1.0 - p) / n + z2 / (4.0 * n * n)).sqrt();
    Some(Interval { value: p, low: (middle - half).max(0.0), high: (middle + half).min(1.0) })
}

/// The root mean square of normal errors about 0, with the chi-square interval of their standard deviation; `None` when
/// there are none.
pub fn rms(errors: &[f64]) -> Option<Interval> {
    let n = errors.len() as f64;
    let sum: f64 = errors.iter().map(|e| e * e).sum();
    let value = (sum / n).sqrt();
    let interval = Interval {
        value,
        low: (sum / chi_square_quantile(n, Z_95)).sqrt(),
        high: (sum / chi_square_quantile(n, -Z_95)).sqrt(),
    };
    (n > 0.0).then_some(interval)
}

/// The quantile of the chi-square distribution of `n` degrees of freedom at `z` normal standard deviations.
///
/// # Reference
/// Wilson & Hilferty, *The distribution of chi-square*, PNAS 17 (1931) 684.
fn chi_square_quantile(n: f64, z: f64) -> f64 {
    let spread = 2.0 / (9.0 * n);
    // Far below one degree of freedom the cube would turn over.
    n * (1.0 - spread + z * spread.sqrt()).max(0.0).powi(3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quartiles_are_those_of_numpy() {
        // numpy.percentile([1, 2, 3, 4, 10], [25, 50, 75, 90]) = 2, 3, 4, 7.6
        let summary = Summary::of(&[10.0, 1.0, 4.0, 2.0, 3.0], 5.0).unwrap();
        assert_eq!((summary.q1, summary.median, summary.q3), (2.0, 3.0, 4.0));
        assert!((summary.p90 - 7.6).abs() < 1e-12);
        assert_eq!((summary.mean, summary.gross), (4.0, 0.2));
        assert_eq!(Summary::of(&[], 1.0), None);
    }

    #[test]
    fn shares_have_the_interval_of_wilson() {
        // Newcombe, Statistics in Medicine 17 (1998) 857, table I, method 3.
        let some = share(81, 263).unwrap();
        assert!((some.low - 0.2553).abs() < 5e-5 && (some.high - 0.3662).abs() < 5e-5, "{some:?}");
        let none = share(0, 20).unwrap();
        assert!(none.low == 0.0 && (none.high - 0.1611).abs() < 5e-5, "{none:?}");
        assert_eq!(share(0, 0), None);
    }

    #[test]
    fn chi_square_quantiles_are_those_of_the_tables() {
        // Abramowitz and Stegun, table 26.8; a percent here is half a percent of a standard deviation.
        for (n, low, high) in [(10.0, 3.246_97, 20.4831), (30.0, 16.7908, 46.9792), (60.0, 40.4817, 83.2976)] {
            let (found_low, found_high) = (chi_square_quantile(n, -Z_95), chi_square_quantile(n, Z_95));
            assert!((found_low / low - 1.0).abs() < 1e-2, "{n}: {found_low}");
            assert!((found_high / high - 1.0).abs() < 1e-2, "{n}: {found_high}");
        }
    }

    #[test]
    fn the_root_mean_square_lies_in_its_interval() {
        let found = rms(&[3.0, -4.0, 3.0, -4.0]).unwrap();
        assert!((found.value - 12.5_f64.sqrt()).abs() < 1e-12);
        assert!(found.low < found.value && found.value < found.high);
        assert_eq!(rms(&[]), None);
    }
}
