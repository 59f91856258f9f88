//! What the spectra of sharp pictures look like: the prior of the fit.

/// Terms of the mean log spectrum.
pub(crate) const TERMS: usize = 18;
/// Width of the ridges that horizontal and vertical edges draw along the axes, as the tangent of an angle.
const RIDGE: f64 = 0.052;

/// Amplitudes in log power of the whitened spectra of sharp pictures, and their standard deviations over pictures. The
/// level itself is free.
///
/// From twelve photographs and five textures by a fit with ridges of another shape. The program `learn-prior` of the tests
/// prints the table that the present terms give: it differs by up to 0.4 in the fall with the radius, within the standard
/// deviations here.
pub(crate) const MEAN: [f64; TERMS] =
    [0.0, 0.16, -0.17, -0.10, 0.20, 0.32, -0.01, -0.25, 0.01, 0.03, 0.05, -0.03, -0.02, -0.07, -0.21, 0.0, 0.38, 0.17];
pub(crate) const STD: [f64; TERMS] =
    [1e3, 0.65, 0.21, 0.31, 0.29, 0.43, 0.15, 0.19, 0.14, 0.09, 0.13, 0.12, 0.23, 0.15, 0.21, 0.08, 1.03, 0.72];

/// Which of the terms is the logarithm of the frequency over 0.1 cycles per pixel.
pub(super) const LOG_RADIUS: usize = 1;

/// The terms at a frequency: `1, x, x^2`, `cos` and `sin` of twice and four times the direction `phi`, `x^3`, six and
/// eight times `phi`, `x` times the first four, then a ridge along each axis; `x = ln(f / 0.1)`.
pub(crate) fn terms(u: f64, v: f64) -> [f64; TERMS] {
    let r2 = u * u + v * v;
    let x = 0.5 * (100.0 * r2).ln();
    // The direction with y up has -v.
    let (c2, s2) = ((u * u - v * v) / r2, -2.0 * u * v / r2);
    let (c4, s4) = (c2 * c2 - s2 * s2, 2.0 * c2 * s2);
    let (c6, s6) = (c4 * c2 - s4 * s2, s4 * c2 + c4 * s2);
    let (c8, s8) = (c4 * c4 - s4 * s4, 2.0 * c4 * s4);
    // Lorentzians squared: no call, and as narrow as a Gaussian where it matters.
    let ridge = |across2: f64, along2: f64| (along2 / (along2 + across2 / (2.0 * RIDGE * RIDGE))).powi(2);
    let (along_u, along_v) = (ridge(v * v, u * u), ridge(u * u, v * v));
    [1.0, x, x * x, c2, s2, c4, s4, x * x * x, c6, s6, c8, s8, x * c2, x * s2, x * c4, x * s4, along_u, along_v]
}

/// Fall of the log spectrum with `x` that the amplitudes `c` mean, whitening undone: `-d ln S / d x` is
/// `a[0] - x (a[1] + x a[2])`.
pub(super) fn falls(c: &[f64; TERMS]) -> [f64; 3] {
    [super::periodogram::FALL - c[1], 2.0 * c[2], 3.0 * c[7]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_are_powers_of_the_logarithm_and_harmonics_of_the_direction() {
        for deg in [0.0_f64, 7.0, 45.0, 90.0, 133.0, 179.0] {
            for radius in [0.02_f64, 0.1, 0.43] {
                // The direction has y up, the frequency v down.
                let phi = deg.to_radians();
                let found = terms(radius * phi.cos(), -radius * phi.sin());
                let x = (radius / 0.1).ln();
                let harmonic = |n: f64| ((n * phi).cos(), (n * phi).sin());
                let ((c2, s2), (c4, s4), (c6, s6), (c8, s8)) =
                    (harmonic(2.0), harmonic(4.0), harmonic(6.0), harmonic(8.0));
                let expected =
                    [1.0, x, x * x, c2, s2, c4, s4, x.powi(3), c6, s6, c8, s8, x * c2, x * s2, x * c4, x * s4];
                for (k, (found, expected)) in found.iter().zip(expected).enumerate() {
                    assert!((found - expected).abs() < 1e-12, "{deg} deg {radius}, term {k}: {found} {expected}");
                }
            }
        }
    }

    #[test]
    fn ridges_lie_along_the_axes_and_are_narrow() {
        let ridges = |deg: f64| {
            let (sin, cos) = deg.to_radians().sin_cos();
            let terms = terms(0.2 * cos, -0.2 * sin);
            [terms[TERMS - 2], terms[TERMS - 1]]
        };
        assert_eq!(ridges(0.0), [1.0, 0.0]);
        let [across, along] = ridges(90.0);
        assert!(across < 1e-12 && (along - 1.0).abs() < 1e-12);
        // Each falls to a quarter where the tangent is sqrt(2) times its width: at 4.2 degrees.
        let edge = (2.0_f64.sqrt() * RIDGE).atan().to_degrees();
        assert!((ridges(edge)[0] - 0.25).abs() < 1e-12);
        assert!((ridges(90.0 - edge)[1] - 0.25).abs() < 1e-12);
        assert!(ridges(45.0)[0] < 1e-4);
    }

    #[test]
    fn the_fall_is_the_derivative_of_the_log_spectrum() {
        let mut amplitudes = [0.0; TERMS];
        (amplitudes[1], amplitudes[2], amplitudes[7]) = (0.3, -0.17, -0.25);
        let log_spectrum = |x: f64| {
            let terms = terms(0.1 * x.exp(), 0.0);
            terms.iter().zip(&amplitudes).map(|(term, c)| term * c).sum::<f64>() - super::super::periodogram::FALL * x
        };
        let falls = falls(&amplitudes);
        for x in [-1.3, 0.0, 0.8] {
            let difference = (log_spectrum(x - 1e-5) - log_spectrum(x + 1e-5)) / 2e-5;
            let fall = falls[0] - x * (falls[1] + x * falls[2]);
            assert!((fall - difference).abs() < 1e-8, "{x}: {fall} {difference}");
        }
    }
}
