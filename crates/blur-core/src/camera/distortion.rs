//! Lens distortion after Brown and Conrady, with its derivatives and its inverse.

use nalgebra::{Matrix2, SMatrix, Vector2};

use crate::{Error, Result};

/// Largest squared radius at which a point is looked for: a ray 84 degrees from the axis.
const MAX_RADIUS_SQUARED: f64 = 100.0;
const NEWTON_STEPS: usize = 50;
const BISECTIONS: usize = 200;

/// Coefficients `k1 k2 p1 p2 k3` of the model that maps an ideal point `(x, y)` of the plane `z = 1` to the distorted one:
///
/// `x' = x g + 2 p1 x y + p2 (r^2 + 2 x^2)`, `y' = y g + p1 (r^2 + 2 y^2) + 2 p2 x y`,
/// `g = 1 + k1 r^2 + k2 r^4 + k3 r^6`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Distortion {
    pub(super) k1: f64,
    pub(super) k2: f64,
    pub(super) p1: f64,
    pub(super) p2: f64,
    pub(super) k3: f64,
}

/// A distorted point and how it depends on the ideal one and on the coefficients `k1 k2 p1 p2 k3`.
pub(super) struct Distorted {
    pub(super) point: Vector2<f64>,
    pub(super) by_point: Matrix2<f64>,
    pub(super) by_coefficients: SMatrix<f64, 2, 5>,
}

impl Distortion {
    pub(super) fn distort(&self, ideal: Vector2<f64>) -> Distorted {
        let Self { k1, k2, p1, p2, k3 } = *self;
        let (x, y) = (ideal.x, ideal.y);
        let r2 = ideal.norm_squared();
        let gain = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
        let slope = k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3);
        let (along_x, along_y, cross) = (r2 + 2.0 * x * x, r2 + 2.0 * y * y, 2.0 * x * y);
        let mixed = cross * slope + 2.0 * (p1 * x + p2 * y);
        Distorted {
            point: Vector2::new(x * gain + p1 * cross + p2 * along_x, y * gain + p1 * along_y + p2 * cross),
            by_point: Matrix2::new(
                gain + 2.0 * x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x,
                mixed,
                mixed,
                gain + 2.0 * y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x,
            ),
            by_coefficients: SMatrix::from_row_slice(&[
                x * r2,
                x * r2 * r2,
                cross,
                along_x,
                x * r2 * r2 * r2,
                y * r2,
                y * r2 * r2,
                along_y,
                cross,
                y * r2 * r2 * r2,
            ]),
        }
    }

    /// The ideal point behind a distorted one: the radial part by bisection, where it is monotonic, then Newton's steps.
    ///
    /// # Errors
    /// [`Error::BeyondLens`] for a point farther out than the model reaches: there it folds back.
    pub(super) fn undistort(&self, distorted: Vector2<f64>) -> Result<Vector2<f64>> {
        let last2 = self.last_radius_squared();
        let radial = |r: f64| r * (1.0 + r * r * (self.k1 + r * r * (self.k2 + r * r * self.k3)));
        let (radius, last) = (distorted.norm(), last2.sqrt());
        let beyond = Error::BeyondLens { radius, limit: radial(last) };
        // Tangential terms may take a point a little beyond the radial limit; Newton's steps decide there.
        let (mut low, mut high) = (0.0, last);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if radial(middle) < radius { low = middle } else { high = middle }
        }
        let mut ideal = if radius > 0.0 { distorted * (0.5 * (low + high) / radius) } else { distorted };
        for _ in 0..NEWTON_STEPS {
            let Distorted { point, by_point, .. } = self.distort(ideal);
            let Some(step) = by_point.try_inverse().map(|inverse| inverse * (distorted - point)) else { break };
            ideal += step;
            let is_inside = ideal.norm_squared() <= last2;
            if !is_inside {
                return Err(beyond);
            }
            if step.norm() <= 4.0 * f64::EPSILON * (1.0 + ideal.norm()) {
                return if self.distort(ideal).by_point.determinant() > 0.0 { Ok(ideal) } else { Err(beyond) };
            }
        }
        Err(beyond)
    }

    /// The squared radius up to which the radial part grows: the first zero of `1 + 3 k1 s + 5 k2 s^2 + 7 k3 s^3`.
    fn last_radius_squared(&self) -> f64 {
        let growth = |s: f64| 1.0 + s * (3.0 * self.k1 + s * (5.0 * self.k2 + s * 7.0 * self.k3));
        // Between the extrema of the cubic it is monotonic.
        let (a, b, c) = (21.0 * self.k3, 10.0 * self.k2, 3.0 * self.k1);
        let root = (b * b - 4.0 * a * c).max(0.0).sqrt();
        let q = -0.5 * (b + root.copysign(b));
        let mut ends = [q / a, c / q, MAX_RADIUS_SQUARED];
        ends.sort_by(f64::total_cmp);
        let mut low = 0.0;
        for end in ends.into_iter().filter(|s| (0.0..=MAX_RADIUS_SQUARED).contains(s)) {
            if growth(end) <= 0.0 {
                let (mut inside, mut outside) = (low, end);
                for _ in 0..BISECTIONS {
                    let middle = 0.5 * (inside + outside);
                    if growth(middle) > 0.0 { inside = middle } else { outside = middle }
                }
                return inside;
            }
            low = end;
        }
        MAX_RADIUS_SQUARED
    }
}
