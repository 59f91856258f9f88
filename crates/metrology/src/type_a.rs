//! Type A evaluation: uncertainty from repeated observations.

use crate::{Correlation, Error, Measurement};

/// Statistics of repeated independent observations of one quantity.
///
/// ```
/// // Five voltages of GUM table H.2, in V.
/// let a = metrology::TypeA::of(&[5.007, 4.994, 5.005, 4.990, 4.999])?;
/// assert!((a.mean() - 4.9990).abs() < 1e-12);
/// assert!((a.std() - 0.0032).abs() < 5e-5);
/// assert_eq!(a.dof(), 4.0);
/// # Ok::<(), metrology::Error>(())
/// ```
///
/// # Reference
///
/// GUM 4.2.1 to 4.2.3 (eq. 3 to 5); thesis eq. 8.2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TypeA {
    mean: f64,
    sample_std: f64,
    count: usize,
}

impl TypeA {
    /// Evaluates at least two finite observations, all in one unit.
    pub fn of(observations: &[f64]) -> Result<Self, Error> {
        let count = observations.len();
        if count < 2 {
            return Err(Error::TooFew { what: "observations", count, least: 2 });
        }
        if let Some(&value) = observations.iter().find(|x| !x.is_finite()) {
            return Err(Error::ValueNotFinite { value });
        }
        let (mean, squares) = moments(observations);
        Ok(Self { mean, sample_std: (squares / (count - 1) as f64).sqrt(), count })
    }

    /// Arithmetic mean (GUM eq. 3).
    pub fn mean(self) -> f64 {
        self.mean
    }

    /// Experimental standard deviation `s` of one observation, with divisor `n - 1` (GUM eq. 4).
    pub fn sample_std(self) -> f64 {
        self.sample_std
    }

    /// Standard uncertainty of the mean, `s / sqrt(n)` (GUM eq. 5; thesis eq. 8.2).
    pub fn std(self) -> f64 {
        self.sample_std / (self.count as f64).sqrt()
    }

    /// Degrees of freedom, `n - 1`.
    pub fn dof(self) -> f64 {
        (self.count - 1) as f64
    }

    /// Number of observations.
    pub fn count(self) -> usize {
        self.count
    }

    /// The mean with its standard uncertainty.
    pub fn measurement(self) -> Result<Measurement, Error> {
        Measurement::new(self.mean, self.std())
    }
}

/// Mean, and sum of squared deviations from it, in two passes: one pass would cancel when the scatter is small.
fn moments(x: &[f64]) -> (f64, f64) {
    let n = x.len() as f64;
    let rough = x.iter().sum::<f64>() / n;
    let mean = rough + x.iter().map(|x| x - rough).sum::<f64>() / n;
    (mean, x.iter().map(|x| (x - mean).powi(2)).sum())
}

/// Correlation matrix of the means of quantities that were observed simultaneously.
///
/// `series[i][k]` is the `k`-th observation of quantity `i`; every series has the same length, at least 2. A quantity
/// whose observations are all equal has no scatter to be correlated: its coefficients are 0.
///
/// # Reference
///
/// GUM 5.2.3 eq. 17 and 5.2.2 eq. 14; example H.2.
pub fn correlation_of_means(series: &[&[f64]]) -> Result<Correlation, Error> {
    let length = series.first().map_or(0, |s| s.len());
    let mut moments_of = Vec::with_capacity(series.len());
    for s in series {
        if s.len() != length {
            return Err(Error::Count { what: "simultaneous observations", expected: length, found: s.len() });
        }
        TypeA::of(s)?;
        let (mean, squares) = moments(s);
        moments_of.push((mean, squares));
    }
    let n = series.len();
    let mut pairs = Vec::new();
    for i in 0..n {
        for j in i + 1..n {
            let ((mi, si), (mj, sj)) = (moments_of[i], moments_of[j]);
            let cross: f64 = series[i].iter().zip(series[j]).map(|(x, y)| (x - mi) * (y - mj)).sum();
            let scale = si.sqrt() * sj.sqrt();
            pairs.push((i, j, if scale > 0.0 { (cross / scale).clamp(-1.0, 1.0) } else { 0.0 }));
        }
    }
    Correlation::from_pairs(n, &pairs)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_large_offset_does_not_spoil_the_scatter() {
        // 1, 2, 3 scatter by 1; so do they beside 1e9.
        let a = TypeA::of(&[1e9 + 1.0, 1e9 + 2.0, 1e9 + 3.0]).unwrap();
        assert_eq!((a.mean(), a.sample_std()), (1e9 + 2.0, 1.0));
        assert_eq!(a.std(), 1.0 / 3.0_f64.sqrt());
    }

    #[test]
    fn equal_observations_are_correlated_with_nothing() {
        let r = correlation_of_means(&[&[1.0, 2.0, 4.0], &[3.0, 3.0, 3.0], &[-1.0, -2.0, -4.0]]).unwrap();
        assert_eq!((r.get(0, 1), r.get(1, 2)), (0.0, 0.0));
        assert!((r.get(0, 2) + 1.0).abs() < 1e-15);
        assert!(correlation_of_means(&[&[1.0, 2.0], &[1.0]]).is_err());
    }

    #[test]
    fn one_observation_has_no_scatter() {
        assert_eq!(TypeA::of(&[1.0]), Err(Error::TooFew { what: "observations", count: 1, least: 2 }));
        assert!(TypeA::of(&[1.0, f64::NAN]).is_err());
    }
}
