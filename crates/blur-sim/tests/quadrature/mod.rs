//! Gauss-Legendre quadrature, the tests' own way to average over the exposure.

use std::f64::consts::PI;

/// Nodes and weights on `[0, 1]`; the nodes are the zeros of the Legendre polynomial, found by Newton's method.
pub(crate) fn gauss_legendre(order: usize) -> Vec<(f64, f64)> {
    (0..order)
        .map(|i| {
            let mut x = (PI * (i as f64 + 0.75) / (order as f64 + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..20 {
                let (mut p, mut before) = (1.0, 0.0);
                for k in 0..order {
                    let k = k as f64;
                    (p, before) = (((2.0 * k + 1.0) * x * p - k * before) / (k + 1.0), p);
                }
                slope = order as f64 * (x * p - before) / (x * x - 1.0);
                x -= p / slope;
            }
            (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}
