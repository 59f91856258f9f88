//! The highest peak of a circular autocorrelation.

use ndarray::ArrayView2;

use crate::estimate::LengthRange;

/// The highest peak of an autocorrelation, the origin apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LagPeak {
    /// Its lag in pixels, between samples; of the two mirror images the upper one.
    pub(super) up_px: f64,
    pub(super) right_px: f64,
    /// Its height over the root mean square of the lags around its length.
    pub(super) contrast: f64,
    /// The highest contrast elsewhere, relative to the peak's.
    pub(super) rival: f64,
}

/// Finds peaks in autocorrelations of pictures of one size.
#[derive(Debug)]
pub(super) struct LagPeaks {
    shape: (usize, usize),
    /// Lags shorter than 0, 1, 2, ... pixels.
    counts: Vec<f64>,
    /// The sums of their squares.
    squares: Vec<f64>,
}

/// The scatter of a lag is taken from lags of these multiples of its length.
const AROUND: (f64, f64) = (0.7, 1.4);
/// Lags nearer than this to a peak belong to it.
const APART_PX: f64 = 4.0;

impl LagPeaks {
    /// For autocorrelations of `rows` x `columns` lags.
    pub(super) fn new(rows: usize, columns: usize) -> Self {
        let rings = (rows as f64 / 2.0).hypot(columns as f64 / 2.0) as usize + 1;
        let mut peaks = Self { shape: (rows, columns), counts: vec![0.0; rings + 1], squares: vec![0.0; rings + 1] };
        for (up, right) in peaks.half_plane() {
            peaks.counts[ring_of(up, right) + 1] += 1.0;
        }
        accumulate(&mut peaks.counts);
        peaks
    }

    /// The highest local maximum of `lags` with a length in `range`; `None` when there is none above 0.
    ///
    /// Element `[j, k]` of `lags` is the lag of `j` rows and `k` columns, both modulo its size, which is that of
    /// [`new`](Self::new).
    pub(super) fn highest(&mut self, lags: ArrayView2<'_, f32>, range: LengthRange) -> Option<LagPeak> {
        let (rows, columns) = (self.shape.0 as isize, self.shape.1 as isize);
        let at = |up: isize, right: isize| {
            f64::from(lags[[(-up).rem_euclid(rows) as usize, right.rem_euclid(columns) as usize]])
        };
        self.squares.fill(0.0);
        for (up, right) in self.half_plane() {
            self.squares[ring_of(up, right) + 1] += at(up, right).powi(2);
        }
        accumulate(&mut self.squares);

        let places = || {
            self.half_plane()
                .filter(move |&(up, right)| (range.min_px()..=range.max_px()).contains(&length_px(up, right)))
        };
        let contrast = |up: isize, right: isize| {
            let scatter = self.scatter_around(length_px(up, right));
            if scatter > 0.0 { at(up, right) / scatter } else { 0.0 }
        };
        let is_peak = |up: isize, right: isize| {
            let height = at(up, right);
            (-1..=1).all(|i| (-1..=1).all(|j| at(up + i, right + j) <= height))
        };
        let mut highest = (0.0, 0, 0);
        for (up, right) in places() {
            let contrast = contrast(up, right);
            if contrast > highest.0 && is_peak(up, right) {
                highest = (contrast, up, right);
            }
        }
        let (height, up, right) = highest;
        if height <= 0.0 {
            return None;
        }
        // Near the axis the mirror image of the peak's flank lies in this half plane too.
        let apart = |u: isize, r: isize| {
            let distance = |sign: isize| length_px(u - sign * up, r - sign * right);
            distance(1).min(distance(-1)) > APART_PX
        };
        let rival = places().filter(|&(u, r)| apart(u, r)).map(|(u, r)| contrast(u, r)).fold(0.0, f64::max);
        let (up_shift, right_shift) = vertex(|i, j| at(up + i, right + j));
        Some(LagPeak {
            up_px: up as f64 + up_shift,
            right_px: right as f64 + right_shift,
            contrast: height,
            rival: rival / height,
        })
    }

    /// Every lag once, `(up, right)` in pixels, without its mirror image and the origin; half the size is the longest.
    fn half_plane(&self) -> impl Iterator<Item = (isize, isize)> + use<> {
        let (most_up, most_aside) = ((self.shape.0 as isize - 1) / 2, (self.shape.1 as isize - 1) / 2);
        (0..=most_up).flat_map(move |up| {
            let first = if up == 0 { 1 } else { -most_aside };
            (first..=most_aside).map(move |right| (up, right))
        })
    }

    /// Root mean square of the lags of about this length in pixels.
    fn scatter_around(&self, lag_px: f64) -> f64 {
        let last = self.squares.len() - 1;
        let from = ((AROUND.0 * lag_px) as usize).min(last);
        let to = ((AROUND.1 * lag_px).ceil() as usize + 1).min(last);
        let count = self.counts[to] - self.counts[from];
        if count > 0.0 { ((self.squares[to] - self.squares[from]) / count).max(0.0).sqrt() } else { 0.0 }
    }
}

fn length_px(up: isize, right: isize) -> f64 {
    ((up * up + right * right) as f64).sqrt()
}

/// Lags of one length, to the pixel.
fn ring_of(up: isize, right: isize) -> usize {
    length_px(up, right) as usize
}

fn accumulate(values: &mut [f64]) {
    let mut sum = 0.0;
    for value in values {
        sum += *value;
        *value = sum;
    }
}

/// Place of the maximum of the paraboloid through the values at `(-1..=1, -1..=1)`, derivatives by central differences,
/// at most one half away; a peak is often an ellipse at an angle, which a parabola along each axis would misplace.
fn vertex(at: impl Fn(isize, isize) -> f64) -> (f64, f64) {
    let middle = at(0, 0);
    let (slope_0, slope_1) = (0.5 * (at(1, 0) - at(-1, 0)), 0.5 * (at(0, 1) - at(0, -1)));
    let (bend_0, bend_1) = (at(1, 0) - 2.0 * middle + at(-1, 0), at(0, 1) - 2.0 * middle + at(0, -1));
    let twist = 0.25 * (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1));
    let determinant = bend_0 * bend_1 - twist * twist;
    if bend_0 < 0.0 && determinant > 0.0 {
        let shift = |a: f64| (a / determinant).clamp(-0.5, 0.5);
        (shift(twist * slope_1 - bend_1 * slope_0), shift(twist * slope_0 - bend_0 * slope_1))
    } else {
        (0.0, 0.0)
    }
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use super::*;

    /// Weak ripples with peaks of these heights at these lags `(up, right)`, and their mirror images.
    fn lags((rows, columns): (usize, usize), peaks: &[(f64, f64, f64)]) -> Array2<f32> {
        let signed = |i: usize, n: usize| if 2 * i > n { i as f64 - n as f64 } else { i as f64 };
        Array2::from_shape_fn((rows, columns), |(j, k)| {
            let (up, right) = (-signed(j, rows), signed(k, columns));
            let bumps: f64 = (peaks.iter())
                .flat_map(|&(height, u, r)| [(height, u, r), (height, -u, -r)])
                .map(|(height, u, r)| height * (-((up - u).powi(2) + (right - r).powi(2)) / 2.0).exp())
                .sum();
            (bumps + 0.02 * (1.3 * up).cos() * (1.7 * right).cos()) as f32
        })
    }

    fn range() -> LengthRange {
        LengthRange::new(4.0, 30.0).unwrap()
    }

    #[test]
    fn the_peak_is_placed_between_samples() {
        for (up, right) in [(12.3, 8.6), (0.0, 20.4), (17.5, -3.2), (25.0, 0.2)] {
            let lags = lags((81, 96), &[(1.0, up, right)]);
            let peak = LagPeaks::new(81, 96).highest(lags.view(), range()).unwrap();
            // A Gaussian of standard deviation 1 is no parabola: 0.04 at the worst place; the slope of the ripple moves
            // the top of its curvature 1 by up to 0.02 * 1.7.
            assert!((peak.up_px - up).abs() < 0.08 && (peak.right_px - right).abs() < 0.08, "{up} {right}: {peak:?}");
        }
    }

    #[test]
    fn an_ellipse_at_an_angle_has_its_top_where_it_is() {
        for (up, right) in [(0.3, -0.2), (-0.4, 0.4), (0.0, 0.0)] {
            let bowl = |i: isize, j: isize| {
                let (u, r) = (i as f64 - up, j as f64 - right);
                7.0 - (1.1 * u * u - 1.6 * u * r + 0.9 * r * r)
            };
            let (found_up, found_right) = vertex(bowl);
            assert!((found_up - up).abs() < 1e-12 && (found_right - right).abs() < 1e-12, "{found_up} {found_right}");
        }
        // A saddle has no top.
        assert_eq!(vertex(|i, j| (i * i - j * j + i) as f64), (0.0, 0.0));
    }

    #[test]
    fn the_rival_is_the_next_peak_and_not_the_flank_or_the_mirror_image() {
        let one = lags((80, 80), &[(1.0, 0.0, 20.0)]);
        let alone = LagPeaks::new(80, 80).highest(one.view(), range()).unwrap();
        assert!(alone.rival < 0.2, "{alone:?}");
        let two = lags((80, 80), &[(1.0, 0.0, 20.0), (0.7, 20.0, 0.0)]);
        let contested = LagPeaks::new(80, 80).highest(two.view(), range()).unwrap();
        // The ripple adds 0.02 to one and takes it from the other at most.
        assert!((contested.rival - 0.7).abs() < 0.04, "{contested:?}");
    }

    #[test]
    fn the_range_is_kept_and_its_ends_are_no_peaks() {
        let two = lags((80, 80), &[(1.0, 3.0, 0.0), (0.5, 20.0, 9.0), (0.9, 36.0, 0.0)]);
        let peak = LagPeaks::new(80, 80).highest(two.view(), range()).unwrap();
        assert!((peak.up_px - 20.0).abs() < 0.1 && (peak.right_px - 9.0).abs() < 0.1, "{peak:?}");
    }

    #[test]
    fn where_nothing_is_there_is_no_peak() {
        assert_eq!(LagPeaks::new(40, 50).highest(Array2::zeros((40, 50)).view(), range()), None);
    }
}
