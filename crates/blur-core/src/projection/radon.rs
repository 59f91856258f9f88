//! Radon transform of a spectrum.

use crate::spectrum::SpectrumBins;

/// Projection of a spectrum onto one direction: sums over the lines `|s| = const`, with the number of bins in each.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Sum of the values on each line.
    pub sum: Vec<f32>,
    /// Number of bins on each line.
    pub weight: Vec<f32>,
    step: f64,
}

impl Profile {
    /// An empty profile of lines `step` cycles per pixel apart, up to the frequency `most`.
    pub fn new(step: f64, most: f64) -> Self {
        let lines = ((most / step).ceil() as usize).max(1) + 1;
        Self { sum: vec![0.0; lines], weight: vec![0.0; lines], step }
    }

    /// A profile fit for `bins`: lines half a DFT bin apart.
    pub fn fitting(bins: &SpectrumBins, rows: usize, columns: usize) -> Self {
        Self::new(0.5 / rows.max(columns) as f64, bins.band.max)
    }

    /// Distance of the lines in cycles per pixel; line `i` holds the bins with `|s|` in `[i, i + 1) * step`.
    pub fn step(&self) -> f64 {
        self.step
    }

    /// Mean on line `i`, 0 where there is no bin.
    pub fn mean(&self, i: usize) -> f32 {
        if self.weight[i] > 0.0 { self.sum[i] / self.weight[i] } else { 0.0 }
    }

    fn clear(&mut self) {
        self.sum.fill(0.0);
        self.weight.fill(0.0);
    }
}

/// The Radon transform of `bins` at one angle (thesis eq. 4.13): sums over the lines on which the frequency along a
/// motion of that angle, `s = u cos(angle) - v sin(angle)`, is constant. `s` and `-s` are added, as the spectrum of a
/// real picture is the same there. On these lines, perpendicular to the motion, a uniform blur is constant.
///
/// For the quadrant of a DCT the lines are those of one of the two directions `angle` and `180 - angle` that a DCT
/// cannot tell apart.
pub fn project(bins: &SpectrumBins, angle_rad: f64, profile: &mut Profile) {
    profile.clear();
    let (sin, cos) = (angle_rad.sin() as f32, angle_rad.cos() as f32);
    let per_step = (1.0 / profile.step) as f32;
    let (du, dv) = (bins.du * cos * per_step, sin * per_step);
    let last = profile.sum.len() as u32 - 1;
    let mut lines = [0_u32; LINES_AT_ONCE];
    for row in &bins.rows {
        let offset = row.first_column as f32 * du - row.v * dv;
        let values = &bins.values[row.start..row.start + row.length];
        for (chunk, values) in values.chunks(LINES_AT_ONCE).enumerate() {
            let first = (chunk * LINES_AT_ONCE) as f32;
            for (i, line) in lines.iter_mut().enumerate() {
                *line = floor_of((offset + (first + i as f32) * du).abs()).min(last);
            }
            for (&line, &value) in lines.iter().zip(values) {
                profile.sum[line as usize] += value;
                profile.weight[line as usize] += 1.0;
            }
        }
    }
}

/// Bins whose lines are worked out in one go, so that it runs on vectors.
const LINES_AT_ONCE: usize = 32;

/// Largest whole number up to `x` in `[0, 2^22)`, by the place of the last bit of a large number: unlike a cast it needs
/// no checks of the range and runs on vectors. A thousandth below a whole number counts as that number.
fn floor_of(x: f32) -> u32 {
    const TWO_TO_23: f32 = 8_388_608.0;
    ((x + 0.501) + TWO_TO_23).to_bits().wrapping_sub(TWO_TO_23.to_bits()).saturating_sub(1)
}

/// Means over blocks of neighbouring bins: a coarse copy of a spectrum for a quick first search over angles.
#[derive(Debug, Clone)]
pub struct Blocks {
    side: usize,
    /// Block of the first bin of each row of bins.
    first: Vec<usize>,
    u: Vec<f32>,
    v: Vec<f32>,
    count: Vec<f32>,
    sum: Vec<f32>,
}

/// Blocks that a coarse copy has, at most about.
const BLOCKS: f64 = 8192.0;

impl Blocks {
    /// Blocks for the layout of `bins`, at most about 8 thousand.
    pub fn new(bins: &SpectrumBins) -> Self {
        let side = (bins.len() as f64 / BLOCKS).sqrt().ceil().max(1.0) as usize;
        let width = bins.rows.iter().map(|row| (row.first_column + row.length) / side + 1).max().unwrap_or(0);
        let first: Vec<usize> = (0..bins.rows.len()).map(|i| i / side * width).collect();
        let blocks = first.last().map_or(0, |&last| last + width);
        let mut new = Self {
            side,
            first,
            u: vec![0.0; blocks],
            v: vec![0.0; blocks],
            count: vec![0.0; blocks],
            sum: vec![0.0; blocks],
        };
        for (row, &first) in bins.rows.iter().zip(&new.first) {
            for i in 0..row.length {
                let block = first + (row.first_column + i) / side;
                new.u[block] += (row.first_column + i) as f32 * bins.du;
                new.v[block] += row.v;
                new.count[block] += 1.0;
            }
        }
        for ((u, v), count) in new.u.iter_mut().zip(&mut new.v).zip(&new.count) {
            *u /= count.max(1.0);
            *v /= count.max(1.0);
        }
        new
    }

    /// A profile fit for these blocks of `bins`: lines half a block apart.
    pub fn profile(&self, bins: &SpectrumBins, rows: usize, columns: usize) -> Profile {
        Profile::new(0.5 * self.side as f64 / rows.max(columns) as f64, bins.band.max)
    }

    /// Takes over the values of `bins`, which must have the layout given to [`new`](Self::new).
    pub fn set(&mut self, bins: &SpectrumBins) {
        self.sum.fill(0.0);
        for (row, &first) in bins.rows.iter().zip(&self.first) {
            for (i, &value) in bins.values[row.start..row.start + row.length].iter().enumerate() {
                self.sum[first + (row.first_column + i) / self.side] += value;
            }
        }
    }

    /// Where each block falls at one angle: its line, and the number of bins on each line.
    pub fn lines(&self, angle_rad: f64, profile: &Profile) -> BlockLines {
        let per_step = 1.0 / profile.step;
        let (sin, cos) = ((angle_rad.sin() * per_step) as f32, (angle_rad.cos() * per_step) as f32);
        let last = profile.sum.len() - 1;
        let mut weight = vec![0.0; profile.sum.len()];
        let line = (self.u.iter().zip(&self.v).zip(&self.count))
            .map(|((u, v), &count)| {
                let line = ((u * cos - v * sin).abs() as usize).min(last);
                weight[line] += count;
                line as u32
            })
            .collect();
        BlockLines { line, weight }
    }

    /// The Radon transform of the blocks at the angle of `lines`, as [`project`].
    pub fn project(&self, lines: &BlockLines, profile: &mut Profile) {
        profile.weight.copy_from_slice(&lines.weight);
        profile.sum.fill(0.0);
        for (&line, &sum) in lines.line.iter().zip(&self.sum) {
            profile.sum[line as usize] += sum;
        }
    }
}

/// The lines on which [`Blocks`] fall at one angle, worked out once.
#[derive(Debug, Clone)]
pub struct BlockLines {
    line: Vec<u32>,
    weight: Vec<f32>,
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::spectrum::Levelled;

    /// Bins of the half plane with the values of `f(u, v)`.
    fn bins_of(rows: usize, columns: usize, f: impl Fn(f32, f32) -> f32) -> SpectrumBins {
        let mut bins = Levelled::for_dft(rows, columns).bins().clone();
        bins.update(|u, v, _| f(u, v));
        bins
    }

    #[test]
    fn the_projection_of_a_gaussian_is_a_gaussian_at_every_angle() {
        // Radon transform of exp(-(u^2 + v^2) / 2 sigma^2): sigma sqrt(2 pi) exp(-s^2 / 2 sigma^2).
        let sigma = 0.07_f64;
        // Eight bins a line along the axes, so that none has a bin more than its neighbour.
        let (rows, columns, step) = (320, 320, 0.025);
        let bins = bins_of(rows, columns, |u, v| (-0.5 * f64::from(u * u + v * v) / (sigma * sigma)).exp() as f32);
        let expected = |s: f64| sigma * (2.0 * PI).sqrt() * (-0.5 * s * s / (sigma * sigma)).exp();
        for angle in [0.0, 17.0, 45.0, 90.0, 133.3_f64] {
            let mut profile = Profile::new(step, 0.4);
            project(&bins, angle.to_radians(), &mut profile);
            for line in 1..10 {
                // Bins have the area 1 / (rows columns). On the half plane the lines at +s and at -s are half a line
                // each. Bins at the left edge of a line belong to it: their mean place is half a bin further left.
                let found = f64::from(profile.sum[line]) / (rows * columns) as f64 / step;
                let low = line as f64 * step;
                let mean = (expected(low) + 4.0 * expected(low + 0.5 * step) + expected(low + step)) / 6.0;
                assert!((found - mean).abs() < 0.03 * expected(0.0), "{angle} {line}: {found} {mean}");
            }
        }
    }

    #[test]
    fn the_floor_is_the_floor() {
        for i in 0..20_000 {
            let x = i as f32 * 0.25;
            assert_eq!(floor_of(x), x as u32, "{x}");
        }
    }

    #[test]
    fn a_pattern_along_the_motion_is_sharp_only_at_its_angle() {
        let angle = 27.0_f64.to_radians();
        let pattern =
            |u: f32, v: f32| (2.0 * PI * 20.0 * (f64::from(u) * angle.cos() - f64::from(v) * angle.sin())).cos() as f32;
        let bins = bins_of(128, 200, pattern);
        let contrast = |deg: f64| {
            let mut profile = Profile::fitting(&bins, 128, 200);
            project(&bins, deg.to_radians(), &mut profile);
            (0..profile.sum.len()).map(|i| profile.mean(i) * profile.sum[i]).sum::<f32>() / bins.len() as f32
        };
        // The mean square of a cosine.
        assert!((contrast(27.0) - 0.5).abs() < 0.05, "{}", contrast(27.0));
        for deg in [17.0, 37.0, 117.0, 153.0] {
            assert!(contrast(deg) < 0.1, "{deg}");
        }
    }

    #[test]
    fn blocks_keep_every_value() {
        let bins = bins_of(400, 500, |u, v| 1.0 + u - 2.0 * v);
        let mut blocks = Blocks::new(&bins);
        assert!(blocks.side > 1);
        blocks.set(&bins);
        assert_eq!(blocks.count.iter().sum::<f32>(), bins.len() as f32);
        let (mut fine, mut coarse) = (Profile::new(0.05, 0.4), Profile::new(0.05, 0.4));
        project(&bins, 0.7, &mut fine);
        let lines = blocks.lines(0.7, &coarse);
        blocks.project(&lines, &mut coarse);
        for line in 0..8 {
            assert!((fine.mean(line) - coarse.mean(line)).abs() < 0.05);
        }
    }
}
