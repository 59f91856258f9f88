//! Summaries of errors.

/// Five-number summary, mean and share of gross errors of a list of absolute errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Summary {
    /// How many.
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
    /// Largest.
    pub max: f64,
    /// Share above the limit given.
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
            max,
            gross: sorted.iter().filter(|&&e| e > gross_above).count() as f64 / n as f64,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quartiles_are_those_of_numpy() {
        // numpy.percentile([1, 2, 3, 4, 10], [25, 50, 75]) = 2, 3, 4
        let summary = Summary::of(&[10.0, 1.0, 4.0, 2.0, 3.0], 5.0).unwrap();
        assert_eq!((summary.q1, summary.median, summary.q3), (2.0, 3.0, 4.0));
        assert_eq!((summary.mean, summary.gross), (4.0, 0.2));
        assert_eq!(Summary::of(&[], 1.0), None);
    }
}
