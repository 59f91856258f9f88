use crate::{Error, Measurement, error};

/// Model values of all trials in ascending order: the discrete representation of the output's distribution function
/// (JCGM 101 7.5).
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    sorted: Vec<f64>,
    mean: f64,
    std: f64,
}

impl Sample {
    /// Takes at least two finite values in any order.
    pub fn new(mut values: Vec<f64>) -> Result<Self, Error> {
        let count = values.len();
        if count < 2 {
            return Err(Error::TooFew { what: "trials", count, least: 2 });
        }
        if let Some(&value) = values.iter().find(|x| !x.is_finite()) {
            return Err(Error::ModelNotFinite { value });
        }
        values.sort_unstable_by(f64::total_cmp);
        let statistics = crate::TypeA::of(&values)?;
        Ok(Self { sorted: values, mean: statistics.mean(), std: statistics.sample_std() })
    }

    /// Number of trials.
    pub fn trials(&self) -> usize {
        self.sorted.len()
    }

    /// The values in ascending order.
    pub fn sorted(&self) -> &[f64] {
        &self.sorted
    }

    /// Mean, the estimate of the output (JCGM 101 eq. 16).
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// Standard deviation, the standard uncertainty of the output (JCGM 101 eq. 17).
    pub fn std(&self) -> f64 {
        self.std
    }

    /// Mean and standard deviation alone.
    pub fn measurement(&self) -> Result<Measurement, Error> {
        Measurement::new(self.mean, self.std)
    }

    /// Ends of the interval of a probability in (0, 1) that leaves as many values below as above (JCGM 101 7.7.2).
    pub fn symmetric_interval(&self, probability: f64) -> Result<(f64, f64), Error> {
        let (trials, inside) = (self.trials(), self.inside(probability)?);
        let below = (trials - inside).div_ceil(2);
        // The r-th value of the standard is the one before it here.
        Ok((self.sorted[below - 1], self.sorted[below - 1 + inside]))
    }

    /// Ends of the shortest interval of a probability in (0, 1) (JCGM 101 7.7.4).
    pub fn shortest_interval(&self, probability: f64) -> Result<(f64, f64), Error> {
        let inside = self.inside(probability)?;
        let ends = self.sorted.iter().zip(&self.sorted[inside..]).map(|(&low, &high)| (low, high));
        let shortest = ends.min_by(|a, b| f64::total_cmp(&(a.1 - a.0), &(b.1 - b.0)));
        Ok(shortest.unwrap_or((self.sorted[0], self.sorted[inside])))
    }

    /// The `q` of JCGM 101 7.7.1: `p M` rounded, with at least one value left outside.
    fn inside(&self, probability: f64) -> Result<usize, Error> {
        let trials = self.trials();
        let inside = (error::probability(probability)? * trials as f64 + 0.5).floor() as usize;
        if inside == 0 || inside >= trials {
            let least = (1.0 / probability.min(1.0 - probability)).ceil() as usize;
            return Err(Error::TooFew { what: "trials", count: trials, least });
        }
        Ok(inside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_leave_what_they_should() {
        // 0, 1, ... 99 squared: symmetric 90 % leaves 5 below; the shortest starts at the dense end.
        let sample = Sample::new((0..100).rev().map(|x| f64::from(x * x)).collect()).unwrap();
        assert_eq!(sample.symmetric_interval(0.9).unwrap(), (16.0, 94.0 * 94.0));
        assert_eq!(sample.shortest_interval(0.9).unwrap(), (0.0, 8100.0));
        assert!(sample.symmetric_interval(0.999).is_err());
        assert!(sample.shortest_interval(1.0).is_err());
    }

    #[test]
    fn too_little_and_impossible_values_are_refused() {
        assert!(Sample::new(vec![1.0]).is_err());
        assert!(Sample::new(vec![1.0, f64::NAN]).is_err());
    }
}
