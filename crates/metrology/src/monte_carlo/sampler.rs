use super::random::Random;
use crate::{Correlation, Distribution, Error, Input};

/// Draws the inputs of one trial after the other.
pub(super) struct Sampler<'a> {
    inputs: &'a [Input],
    correlation: &'a Correlation,
    correlated: Vec<bool>,
    random: Random,
    /// Independent standard normals that correlated inputs are made of.
    normals: Vec<f64>,
    drawn: Vec<f64>,
}

impl<'a> Sampler<'a> {
    pub(super) fn new(inputs: &'a [Input], correlation: &'a Correlation, seed: u64) -> Result<Self, Error> {
        correlation.check_size(inputs.len())?;
        let correlated: Vec<bool> = (0..inputs.len()).map(|i| correlation.is_correlated(i)).collect();
        for (index, input) in inputs.iter().enumerate() {
            if correlated[index] && input.distribution() != Distribution::Normal {
                return Err(Error::CorrelatedNotNormal { index });
            }
        }
        let normals = vec![0.0; if correlated.contains(&true) { inputs.len() } else { 0 }];
        Ok(Self { inputs, correlation, correlated, random: Random::new(seed), normals, drawn: vec![0.0; inputs.len()] })
    }

    /// The inputs of the next trial.
    pub(super) fn draw(&mut self) -> &[f64] {
        for z in &mut self.normals {
            *z = self.random.normal();
        }
        for (i, input) in self.inputs.iter().enumerate() {
            let deviation = if self.correlated[i] {
                self.correlation.factor_row(i).iter().zip(&self.normals).map(|(l, z)| l * z).sum()
            } else {
                let shape = input.distribution();
                shape.half_width_per_std() * standard(&mut self.random, shape, input.dof())
            };
            self.drawn[i] = input.value() + input.std() * deviation;
        }
        &self.drawn
    }
}

/// A draw with the limits -1 and 1, or with standard deviation 1 (Student's t: scale 1) if there are none.
fn standard(random: &mut Random, shape: Distribution, dof: f64) -> f64 {
    match shape {
        Distribution::Normal => random.normal(),
        Distribution::StudentT => random.student_t(dof),
        Distribution::Rectangular => 2.0 * random.uniform() - 1.0,
        Distribution::Triangular => random.uniform() + random.uniform() - 1.0,
        // JCGM 101 6.4.6.5.
        Distribution::Arcsine => libm::sin(2.0 * std::f64::consts::PI * random.uniform()),
        // JCGM 101 6.4.4.4.
        Distribution::Trapezoidal { beta } => (1.0 + beta) * random.uniform() + (1.0 - beta) * random.uniform() - 1.0,
        // JCGM 101 6.4.3.4: the lower limit is uncertain, and the upper one its mirror image.
        Distribution::Curvilinear { inexactness } => {
            let limit = 1.0 + inexactness * (2.0 * random.uniform() - 1.0);
            limit * (2.0 * random.uniform() - 1.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shape_has_the_standard_deviation_of_its_input() {
        // The bound is four standard errors of the sample variance; the kurtosis of none exceeds that of t with 10
        // degrees of freedom, 4.
        let shapes = [
            Distribution::Normal,
            Distribution::StudentT,
            Distribution::Rectangular,
            Distribution::Triangular,
            Distribution::Arcsine,
            Distribution::Trapezoidal { beta: 0.4 },
            Distribution::Curvilinear { inexactness: 0.5 },
        ];
        for (seed, shape) in shapes.into_iter().enumerate() {
            let input = Input::new("x", 5.0, 0.3).unwrap().with_dof(10.0).unwrap().with_distribution(shape).unwrap();
            let inputs = [input];
            let correlation = Correlation::independent(1);
            let mut sampler = Sampler::new(&inputs, &correlation, seed as u64).unwrap();
            let n = 200_000;
            let draws: Vec<f64> = (0..n).map(|_| (sampler.draw()[0] - 5.0) / 0.3).collect();
            let mean = draws.iter().sum::<f64>() / f64::from(n);
            let variance = draws.iter().map(|x| x * x).sum::<f64>() / f64::from(n);
            let expected = if shape == Distribution::StudentT { 10.0 / 8.0 } else { 1.0 };
            assert!(mean.abs() < 4.0 * (expected / f64::from(n)).sqrt(), "{shape}: mean {mean}");
            let bound = 4.0 * expected * (3.0 / f64::from(n)).sqrt();
            assert!((variance - expected).abs() < bound, "{shape}: variance {variance}");
        }
    }

    #[test]
    fn correlated_normals_are_correlated_as_told() {
        let r = Correlation::from_pairs(3, &[(0, 2, -0.8)]).unwrap();
        let inputs: Vec<Input> = (0..3).map(|_| Input::new("x", 0.0, 1.0).unwrap()).collect();
        let mut sampler = Sampler::new(&inputs, &r, 3).unwrap();
        let n = 100_000;
        let mut products = [0.0; 3];
        for _ in 0..n {
            let x = sampler.draw();
            for (product, (i, j)) in products.iter_mut().zip([(0, 2), (0, 1), (1, 2)]) {
                *product += x[i] * x[j] / f64::from(n);
            }
        }
        // Standard error of a mean product: sqrt((1 + r^2) / n) = 0.004.
        for (product, expected) in products.into_iter().zip([-0.8, 0.0, 0.0]) {
            assert!((product - expected).abs() < 0.016, "{product} {expected}");
        }
    }

    #[test]
    fn correlated_rectangles_are_refused() {
        let r = Correlation::from_pairs(2, &[(0, 1, 0.5)]).unwrap();
        let inputs = [Input::new("a", 0.0, 1.0).unwrap(), Input::rectangular("b", 0.0, 1.0).unwrap()];
        assert_eq!(Sampler::new(&inputs, &r, 0).err(), Some(Error::CorrelatedNotNormal { index: 1 }));
    }
}
