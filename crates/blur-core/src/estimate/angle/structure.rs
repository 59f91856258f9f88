//! What the spectra of sharp pictures may look like, as a contribution to the uncertainty.

/// The anisotropies that the spectra of sharp pictures show and that levelling does not take out, tabulated on blocks of
/// bins.
///
/// Each is a function of the frequency whose amplitude in the log power varies from picture to picture with a known
/// standard deviation: a Type B contribution (GUM 4.3). The standard deviations are those of the sharp centre crops
/// of seventeen photographs and textures, widened by 1.3 for so small a number.
#[derive(Debug, Clone)]
pub(super) struct Structure {
    terms: Vec<[f32; TERMS]>,
}

const TERMS: usize = 10;

/// Standard deviations of the amplitudes, in log power, of: `cos 6 phi, sin 6 phi, cos 8 phi, sin 8 phi`, then
/// `x cos 2 phi, x sin 2 phi, x cos 4 phi, x sin 4 phi` with `x = ln(f / 0.1)`, then ridges of 3 degrees along the two
/// axes, which horizontal and vertical edges draw.
const STD: [f64; TERMS] = [0.14, 0.09, 0.13, 0.12, 0.23, 0.15, 0.21, 0.08, 1.03, 0.72];
const RIDGE_RAD: f64 = 0.052_36;

impl Structure {
    /// For blocks of bins at these mean frequencies `(u, v)`.
    pub(super) fn new(frequencies: impl Iterator<Item = (f64, f64)>) -> Self {
        Self { terms: frequencies.map(|(u, v)| terms(u, v).map(|term| term as f32)).collect() }
    }

    /// Variance over pictures of a sum over bins whose coefficients, summed over each block, are `coefficients`.
    pub(super) fn variance(&self, coefficients: &[f64]) -> f64 {
        let mut sums = [0.0_f64; TERMS];
        for (terms, coefficient) in self.terms.iter().zip(coefficients) {
            for (sum, &term) in sums.iter_mut().zip(terms) {
                *sum += coefficient * f64::from(term);
            }
        }
        sums.iter().zip(STD).map(|(sum, std)| (sum * std).powi(2)).sum()
    }
}

fn terms(u: f64, v: f64) -> [f64; TERMS] {
    let r2 = u * u + v * v;
    if r2 == 0.0 {
        return [0.0; TERMS];
    }
    // The direction with y up has -v.
    let (c2, s2) = ((u * u - v * v) / r2, -2.0 * u * v / r2);
    let (c4, s4) = (c2 * c2 - s2 * s2, 2.0 * c2 * s2);
    let (c6, s6) = (c4 * c2 - s4 * s2, s4 * c2 + c4 * s2);
    let (c8, s8) = (c4 * c4 - s4 * s4, 2.0 * c4 * s4);
    let x = 0.5 * (r2 / 0.01).ln();
    let ridge = |tangent: f64| (-0.5 * (tangent.atan() / RIDGE_RAD).powi(2)).exp();
    let (along_u, along_v) = (ridge((v / u).abs()), ridge((u / v).abs()));
    [c6, s6, c8, s8, x * c2, x * s2, x * c4, x * s4, along_u, along_v]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_harmonics_are_those_of_the_direction() {
        for (u, v) in [(0.1_f64, 0.0_f64), (0.05, -0.2), (0.2, 0.07), (0.0, 0.3)] {
            let phi = (-v).atan2(u);
            let x = (f64::hypot(u, v) / 0.1).ln();
            let found = terms(u, v);
            let expected = [(6.0 * phi).cos(), (6.0 * phi).sin(), (8.0 * phi).cos(), (8.0 * phi).sin()];
            for (a, b) in found.iter().zip(expected) {
                assert!((a - b).abs() < 1e-12);
            }
            assert!((found[6] - x * (4.0 * phi).cos()).abs() < 1e-12);
            assert!(found.iter().all(|term| term.is_finite()));
        }
        assert!((terms(0.1, 0.0)[8] - 1.0).abs() < 1e-12 && terms(0.1, 0.0)[9] < 1e-12);
    }
}
