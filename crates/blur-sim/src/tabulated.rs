//! The transfer function of one motion at very many frequencies.

use crate::motion::Motion;
use rustfft::num_complex::Complex;

/// Nodes for each cycle per path.
const NODES_PER_CYCLE: f64 = 64.0;
/// Nodes of one interpolation.
const POINTS: usize = 8;
/// Nodes below the interval that is interpolated.
const BELOW: usize = POINTS / 2 - 1;
/// `1 / prod (k - j)` over the nodes `j` other than `k`.
const SCALES: [f64; POINTS] =
    [-1.0 / 5040.0, 1.0 / 720.0, -1.0 / 240.0, 1.0 / 144.0, -1.0 / 144.0, 1.0 / 240.0, -1.0 / 720.0, 1.0 / 5040.0];

/// [`Motion::transfer`] between the nodes of a table, to 4e-14.
///
/// With acceleration the function itself takes some 0.3 microseconds, most of the time of an exposure; the bins of a
/// spectrum are many, but all of them lie on one axis along the motion. There the function is the transform of a path
/// within half a cycle of its middle, so its eighth derivative by the node number is at most `(pi / 64)^8` and
/// Lagrange's interpolation through eight nodes errs by at most `(0.5 1.5 2.5 3.5)^2 / 8! (pi / 64)^8 = 4e-14`.
pub(crate) struct Tabulated<'a> {
    motion: &'a Motion,
    /// Values at the nodes `-BELOW, ...`; empty: no table.
    nodes: Vec<Complex<f64>>,
}

impl<'a> Tabulated<'a> {
    /// For about `uses` frequencies of at most `max_s` cycles per pixel; where a table would be hardly shorter than that,
    /// there is none, and none is needed at constant speed.
    pub(crate) fn new(motion: &'a Motion, max_s: f64, uses: usize) -> Self {
        let last = motion.length_px() * max_s * NODES_PER_CYCLE;
        if motion.accel_ratio() == 0.0 || last > 0.25 * uses as f64 {
            return Self { motion, nodes: Vec::new() };
        }
        let count = last.ceil() as usize + POINTS;
        let per_node = if last > 0.0 { max_s / last } else { 0.0 };
        let nodes = (0..count).map(|i| motion.transfer((i as f64 - BELOW as f64) * per_node)).collect();
        Self { motion, nodes }
    }

    /// The transfer function at `s` cycles per pixel.
    pub(crate) fn at(&self, s: f64) -> Complex<f64> {
        let node = (self.motion.length_px() * s).abs() * NODES_PER_CYCLE;
        let first = node.floor();
        match self.nodes.get(first as usize..).and_then(<[_]>::first_chunk) {
            Some(nodes) => {
                let value = interpolated(nodes, node - first);
                if s < 0.0 { value.conj() } else { value }
            }
            None => self.motion.transfer(s),
        }
    }
}

/// The polynomial through `nodes` at `t` in `[0, 1)`, between the two middle ones.
fn interpolated(nodes: &[Complex<f64>; POINTS], t: f64) -> Complex<f64> {
    let distance = |k: usize| t + BELOW as f64 - k as f64;
    // Products of the distances to the nodes above k; those to the nodes below k join on the way up.
    let mut above = [1.0; POINTS];
    for k in (0..POINTS - 1).rev() {
        above[k] = above[k + 1] * distance(k + 1);
    }
    let mut below = 1.0;
    let mut sum = Complex::new(0.0, 0.0);
    for k in 0..POINTS {
        sum += nodes[k] * (below * above[k] * SCALES[k]);
        below *= distance(k);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use blur_core::estimate::AxialAngle;

    #[test]
    fn the_table_is_the_transfer_function() {
        for (length, r) in [(0.0, 0.5), (1e-3, 0.5), (24.5, 1.0), (24.5, -0.3), (60.0, 1e-7), (80.0, -1.0)] {
            let motion = Motion::new(length, AxialAngle::from_deg(30.0), r).unwrap();
            let table = Tabulated::new(&motion, 0.75, 1_000_000);
            assert!(!table.nodes.is_empty());
            for i in 0..=3000 {
                let s = 0.75 * (f64::from(i) / 1500.0 - 1.0);
                let error = (table.at(s) - motion.transfer(s)).norm();
                assert!(error < 5e-14, "{length} px, r {r}, s {s}: {error:e}");
            }
        }
    }

    #[test]
    fn beyond_its_end_and_without_a_table_the_function_is_used() {
        let motion = Motion::new(24.5, AxialAngle::from_deg(30.0), 0.3).unwrap();
        assert_eq!(Tabulated::new(&motion, 0.1, 1_000_000).at(0.7), motion.transfer(0.7));
        assert_eq!(Tabulated::new(&motion, 0.75, 100).at(0.3), motion.transfer(0.3));
    }
}
