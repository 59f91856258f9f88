//! The scaled tail of the Fresnel integral.

use rustfft::num_complex::Complex;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Terms of the trapezium rule: the truncation and the discretisation error are both about `exp(-A^2) = 1e-17`.
const TERMS: usize = 12;

/// `exp(i y^2)` times the integral of `exp(-i x^2)` over `x` from `y` to infinity, for `y >= 0`.
///
/// The factor takes out the oscillation: the result falls smoothly from `sqrt(pi)/2 exp(-i pi/4)` at 0 like
/// `1/(2 i y)`. The error is about 1e-15 for every `y`.
///
/// *Reference*: Alazah, Chandler-Wilde & La Porte, *Computing Fresnel integrals via modified trapezium rules*,
/// Numerische Mathematik 128 (2014) 635, equation (4), conjugated.
pub(crate) struct FresnelTail {
    /// `A_N = sqrt((N + 1/2) pi)`.
    a: f64,
    /// `(t_k^2, exp(-t_k^2))` at the nodes `t_k = (k - 1/2) pi / A_N`.
    nodes: [(f64, f64); TERMS],
}

impl FresnelTail {
    pub(crate) fn new() -> Self {
        let a = ((TERMS as f64 + 0.5) * PI).sqrt();
        let nodes = std::array::from_fn(|k| {
            let t = (k as f64 + 0.5) * PI / a;
            (t * t, libm::exp(-t * t))
        });
        Self { a, nodes }
    }

    pub(crate) fn at(&self, y: f64) -> Complex<f64> {
        let square = y * y;
        let sum: Complex<f64> = self
            .nodes
            .iter()
            .map(|&(t2, weight)| Complex::new(square, t2) * (weight / (square * square + t2 * t2)))
            .sum();
        let trapezium = Complex::new(sum.im, -sum.re) * (y / self.a);
        (trapezium + self.pole_correction(y, square)) * PI.sqrt()
    }

    /// What the poles of the integrand near the real axis add: `exp(i y^2 - i pi/4) / (1 + exp(q + i q))` with
    /// `q = sqrt(2) A y`. It is below rounding from `q = 40` on.
    fn pole_correction(&self, y: f64, square: f64) -> Complex<f64> {
        let q = std::f64::consts::SQRT_2 * self.a * y;
        if q > 40.0 {
            return Complex::new(0.0, 0.0);
        }
        let turn = |angle: f64| {
            let (sin, cos) = libm::sincos(angle);
            Complex::new(cos, sin)
        };
        let decay = turn(-q) * libm::exp(-q);
        turn(square) * Complex::new(FRAC_1_SQRT_2, -FRAC_1_SQRT_2) * decay / (decay + 1.0)
    }
}
