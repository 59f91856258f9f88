//! What the spectra of sharp pictures look like: the prior of the fit.

/// Terms of the mean log spectrum.
pub(super) const TERMS: usize = 18;
/// Width of the ridges that horizontal and vertical edges draw along the axes, as the tangent of an angle.
const RIDGE: f64 = 0.052;

/// Amplitudes in log power of the whitened spectra of sharp pictures, and their standard deviations over pictures. The
/// level itself is free.
pub(super) const MEAN: [f64; TERMS] =
    [0.0, 0.16, -0.17, -0.10, 0.20, 0.32, -0.01, -0.25, 0.01, 0.03, 0.05, -0.03, -0.02, -0.07, -0.21, 0.0, 0.38, 0.17];
pub(super) const STD: [f64; TERMS] =
    [1e3, 0.65, 0.21, 0.31, 0.29, 0.43, 0.15, 0.19, 0.14, 0.09, 0.13, 0.12, 0.23, 0.15, 0.21, 0.08, 1.03, 0.72];

/// The terms at a frequency: `1, x, x^2`, `cos` and `sin` of twice and four times the direction `phi`, `x^3`, six and
/// eight times `phi`, `x` times the first four, then a ridge along each axis; `x = ln(f / 0.1)`.
pub(super) fn terms(u: f64, v: f64) -> [f64; TERMS] {
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
