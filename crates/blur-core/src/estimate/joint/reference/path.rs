//! A straight path and its transfer function.

use std::f64::consts::PI;

use rustfft::num_complex::{Complex32, Complex64};

use crate::psf::AcceleratedBlur;

/// A straight path of the picture over the sensor during the exposure, relative to the stills.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Path {
    /// Middle of the path in pixels, to the right and down.
    pub(super) centre: [f64; 2],
    /// Its length in pixels.
    pub(super) length: f64,
    /// Its direction in radians, counter-clockwise as seen.
    pub(super) angle: f64,
    /// The acceleration ratio along the direction.
    pub(super) ratio: f64,
}

impl Path {
    /// No motion, displaced by `centre`.
    pub(super) fn still(centre: [f64; 2]) -> Self {
        Self { centre, length: 0.0, angle: 0.0, ratio: 0.0 }
    }

    /// Unit vector of the direction, to the right and down.
    pub(super) fn direction(&self) -> [f64; 2] {
        let (sin, cos) = self.angle.sin_cos();
        [cos, -sin]
    }

    /// A path of `factor` times the length, at most `most_length`, and another ratio, that shares the slow end with this
    /// one: the begin when it speeds up.
    pub(super) fn stretched(&self, factor: f64, ratio: f64, most_length: f64) -> Self {
        let length = (factor * self.length).min(most_length);
        let shift = 0.5 * (length - self.length) * ratio.signum();
        let direction = self.direction();
        Self { centre: std::array::from_fn(|i| self.centre[i] + shift * direction[i]), length, ratio, ..*self }
    }

    /// Begin and end of the path.
    pub(super) fn ends(&self) -> [[f64; 2]; 2] {
        let direction = self.direction();
        [-0.5, 0.5].map(|share| std::array::from_fn(|i| self.centre[i] + share * self.length * direction[i]))
    }
}

/// Points of the table for each cycle along the path: the transfer function of a centred path of length 1 is band-limited
/// to half a cycle, and cubic interpolation at this density is exact to 3e-6.
const PER_CYCLE: f64 = 32.0;
/// Step of the difference that gives the derivative by the acceleration ratio.
const RATIO_STEP: f64 = 1e-4;
/// Points beyond either end that interpolation and differences reach.
const BEYOND: usize = 4;

/// Values of the transfer function of a centred path at one frequency, and its derivatives.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Transfer {
    /// `F(z)` at `z` cycles along the path.
    pub(super) value: Complex32,
    /// `dF / dz`.
    pub(super) slope: Complex32,
    /// `d^2 F / dz^2`.
    pub(super) bend: Complex32,
    /// `dF / dr`.
    pub(super) per_ratio: Complex32,
}

/// The transfer function of a path of length 1 about its middle, `F(z) = int exp(-2 pi i z (q(t) - 1/2)) dt` with
/// `q = (1 - r) t + r t^2`, tabulated over the cycles `z` along the path.
#[derive(Debug)]
pub(super) struct TransferTable {
    points: Vec<Transfer>,
    /// `F` on the lattice, for the differences.
    values: Vec<Complex64>,
}

impl TransferTable {
    /// With room for `most_cycles` along the path.
    pub(super) fn new(most_cycles: f64) -> Self {
        let room = (most_cycles * PER_CYCLE).ceil() as usize + 4 * BEYOND;
        Self { points: Vec::with_capacity(room), values: Vec::with_capacity(room) }
    }

    /// Fills the table for the ratio `r`, in `[-1, 1]`, and up to `most_cycles`.
    pub(super) fn set(&mut self, ratio: f64, most_cycles: f64) {
        let ratio = ratio.clamp(-1.0, 1.0);
        let count = (most_cycles * PER_CYCLE).ceil() as usize + 2 * BEYOND;
        // The first point stands at -BEYOND steps.
        let cycles = |i: usize| (i as f64 - BEYOND as f64) / PER_CYCLE;
        let (below, above) = ((ratio - RATIO_STEP).max(-1.0), (ratio + RATIO_STEP).min(1.0));
        let per_step = 1.0 / (above - below);
        self.values.clear();
        self.values.extend((0..count + BEYOND).map(|i| centred(cycles(i), ratio)));
        self.points.clear();
        for i in 0..count {
            let at = |k: isize| {
                let index = i as isize + k;
                // Below the first point the function is the conjugate of its mirror image.
                if index < 0 {
                    self.values[(2 * BEYOND as isize - index) as usize].conj()
                } else {
                    self.values[index as usize]
                }
            };
            let slope = ((at(1) - at(-1)) * 8.0 - (at(2) - at(-2))) * (PER_CYCLE / 12.0);
            let bend = ((at(1) + at(-1)) * 16.0 - (at(2) + at(-2)) - at(0) * 30.0) * (PER_CYCLE * PER_CYCLE / 12.0);
            let per_ratio = (centred(cycles(i), above) - centred(cycles(i), below)) * per_step;
            self.points.push(Transfer {
                value: single(at(0)),
                slope: single(slope),
                bend: single(bend),
                per_ratio: single(per_ratio),
            });
        }
    }

    /// At `z >= 0` cycles within the range last set; the values at `-z` are `conj F`, `-conj F'`, `conj F''` and
    /// `conj dF/dr`.
    pub(super) fn at(&self, z: f64) -> Transfer {
        let place = z * PER_CYCLE;
        let cell = (place as usize).min(self.points.len() - BEYOND - 3);
        let x = (place - cell as f64) as f32;
        // Cubic Lagrange weights of the points at -1, 0, 1 and 2.
        let weights = [
            -x * (x - 1.0) * (x - 2.0) / 6.0,
            (x + 1.0) * (x - 1.0) * (x - 2.0) / 2.0,
            -(x + 1.0) * x * (x - 2.0) / 2.0,
            (x + 1.0) * x * (x - 1.0) / 6.0,
        ];
        let mut sum = Transfer::default();
        for (point, weight) in self.points[cell + BEYOND - 1..].iter().zip(weights) {
            sum.value += point.value * weight;
            sum.slope += point.slope * weight;
            sum.bend += point.bend * weight;
            sum.per_ratio += point.per_ratio * weight;
        }
        sum
    }
}

/// `F` of a path of length 1, by its exact transfer function from the begin of the path.
fn centred(z: f64, ratio: f64) -> Complex64 {
    // Ratios in range are never refused.
    AcceleratedBlur::new(1.0, ratio).map_or(Complex64::ONE, |blur| Complex64::cis(PI * z) * blur.transfer(z))
}

fn single(value: Complex64) -> Complex32 {
    Complex32::new(value.re as f32, value.im as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `int exp(-2 pi i z (q(t) - 1/2)) dt` by the midpoint rule, exact to 1e-7 with so many points.
    fn integral(z: f64, ratio: f64) -> Complex64 {
        const POINTS: usize = 20_000;
        let at = |i: usize| {
            let t = (i as f64 + 0.5) / POINTS as f64;
            Complex64::cis(-2.0 * PI * z * ((1.0 - ratio) * t + ratio * t * t - 0.5))
        };
        (0..POINTS).map(at).sum::<Complex64>() / POINTS as f64
    }

    #[test]
    fn the_table_holds_the_transfer_function_and_its_derivatives() {
        let mut table = TransferTable::new(30.0);
        for ratio in [0.0, 0.3, -0.7, 1.0, -1.0] {
            table.set(ratio, 30.0);
            for z in [0.0, 0.013, 0.5, 1.0, 3.777, 17.3, 29.99] {
                let found = table.at(z);
                let step = 1e-3;
                let (below, here, above) = (integral(z - step, ratio), integral(z, ratio), integral(z + step, ratio));
                let inner = |r: f64| r.clamp(-1.0, 1.0);
                let (less, more) = (inner(ratio - step), inner(ratio + step));
                let per_ratio = (integral(z, more) - integral(z, less)) / (more - less);
                let close = |found: Complex32, exact: Complex64, tolerance: f64| {
                    let error = (Complex64::new(f64::from(found.re), f64::from(found.im)) - exact).norm();
                    assert!(error < tolerance, "r = {ratio}, z = {z}: {found} for {exact}");
                };
                // Cubic interpolation, see PER_CYCLE; the derivatives lose a factor pi * 32 / 2 at most for each order.
                close(found.value, here, 5e-6);
                close(found.slope, (above - below) / (2.0 * step), 5e-4);
                close(found.bend, (above + below - here * 2.0) / (step * step), 5e-2);
                // A one-sided difference at the ends of the range has an error of the step times half the curvature,
                // (2 pi z / 4)^2 at most.
                let one_sided = if ratio.abs() == 1.0 { step * (1.6 * z).powi(2) } else { 0.0 };
                close(found.per_ratio, per_ratio, 1e-3 + one_sided);
            }
        }
    }

    #[test]
    fn a_path_ends_where_its_direction_leads() {
        let path = Path { centre: [3.0, -2.0], length: 10.0, angle: PI / 2.0, ratio: 0.0 };
        // Upwards as seen: the row numbers fall.
        let [begin, end] = path.ends();
        assert!((begin[0] - 3.0).abs() < 1e-12 && (begin[1] - 3.0).abs() < 1e-12);
        assert!((end[0] - 3.0).abs() < 1e-12 && (end[1] + 7.0).abs() < 1e-12);
        // What is stretched keeps the end where it is slow.
        for (ratio, kept) in [(0.5, 0), (-0.5, 1)] {
            let longer = path.stretched(2.0, ratio, 100.0);
            let (before, after) = (path.ends()[kept], longer.ends()[kept]);
            assert_eq!(longer.length, 20.0);
            assert!((before[0] - after[0]).abs() < 1e-12 && (before[1] - after[1]).abs() < 1e-12);
        }
    }
}
