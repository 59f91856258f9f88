//! Blocks of the DCT that slide over a periodic picture.

use std::f64::consts::PI;

use ndarray::{Array2, ArrayView2, Zip};
use rustfft::num_complex::Complex32;

use super::wiener::add;

/// Side of a block in pixels, and the distance from one to the next.
const SIDE: usize = 16;
const STEP: usize = 4;
/// Least sum of variances that a block is weighted by, relative to white noise.
const LEAST: f32 = 1e-6;

type Block = [[f32; SIDE]; SIDE];

/// Sums over blocks of a periodic picture.
///
/// What blocks that lie side by side have in common is done once: sixteen rows are transformed down as a whole. Such a band
/// has the columns of the picture and the first sixteen once more.
#[derive(Debug)]
pub(super) struct Blocks {
    /// The orthonormal DCT-II, a wave in each row, and its transpose.
    waves: Block,
    transposed: Block,
    /// Power of the waves at the frequencies of each row of the half spectrum, and of each column, as shares of the variance
    /// in white noise.
    down: Vec<[f32; SIDE]>,
    across: Vec<[f32; SIDE]>,
    /// Variances of the coefficients when the noise in a pixel has 1.
    variances: Block,
    /// Bands of the picture, of what guides the shrinkage, and of the weighted result; the weights of its columns.
    seen: Vec<f32>,
    guide: Vec<f32>,
    shrunk: Vec<f32>,
    weights: Vec<f32>,
    /// The result times its weights, and their sums.
    sum: Array2<f32>,
    weight: Array2<f32>,
}

impl Blocks {
    /// For pictures of `rows` x `columns` pixels, both even.
    pub(super) fn new(rows: usize, columns: usize) -> Self {
        let waves = waves();
        let transposed = std::array::from_fn(|i| waves.map(|wave| wave[i]));
        let power = |waves: &Block, bin: usize, period: usize| {
            let turn = -2.0 * PI * bin as f64 / period as f64;
            waves.map(|wave| {
                let terms = (0..).zip(wave).map(|(i, x)| Complex32::cis((turn * f64::from(i)) as f32) * x);
                terms.sum::<Complex32>().norm_sqr() / period as f32
            })
        };
        // The other half of the spectrum is alike.
        let twice = |bin: usize| if bin == 0 || 2 * bin == columns { 1.0 } else { 2.0 };
        let band = || vec![0.0; SIDE * (columns + SIDE)];
        Self {
            waves,
            transposed,
            down: (0..rows).map(|bin| power(&waves, bin, rows)).collect(),
            across: (0..=columns / 2).map(|bin| power(&waves, bin, columns).map(|x| twice(bin) * x)).collect(),
            variances: Block::default(),
            seen: band(),
            guide: band(),
            shrunk: band(),
            weights: vec![0.0; columns + SIDE],
            sum: Array2::zeros((rows, columns)),
            weight: Array2::zeros((rows, columns)),
        }
    }

    /// Learns the colour of the noise: its power at each bin of the half spectrum over that of white noise.
    pub(super) fn expect(&mut self, power: impl Fn(usize) -> f32) {
        self.variances = Block::default();
        for (row, down) in self.down.iter().enumerate() {
            let mut sums = [0.0; SIDE];
            for (column, across) in self.across.iter().enumerate() {
                accumulate(&mut sums, power(row * self.across.len() + column), across);
            }
            for (variances, &down) in self.variances.iter_mut().zip(down) {
                accumulate(variances, down, &sums);
            }
        }
    }

    /// Replaces `guide` by `seen` with each coefficient of a block times `gain(square, variance)`, of the guide's coefficient
    /// and of the noise, which would have the variance `noise` if it were white. The mean of a block stays.
    pub(super) fn shrink(
        &mut self,
        seen: ArrayView2<'_, f32>,
        guide: &mut Array2<f32>,
        noise: f32,
        gain: impl Fn(f32, f32) -> f32,
    ) {
        let (rows, columns) = guide.dim();
        let mut doubts = self.variances.map(|row| row.map(|variance| noise * variance));
        doubts[0][0] = 0.0;
        self.sum.fill(0.0);
        self.weight.fill(0.0);
        for top in (0..rows).step_by(STEP) {
            transform_down(&self.waves, seen, top, &mut self.seen);
            transform_down(&self.waves, guide.view(), top, &mut self.guide);
            self.shrunk.fill(0.0);
            self.weights.fill(0.0);
            for left in (0..columns).step_by(STEP) {
                let mut block = product(&cut(&self.seen, left), &self.transposed);
                let guide = product(&cut(&self.guide, left), &self.transposed);
                let kept = shrink_block(&mut block, &guide, &doubts, &self.variances, &gain);
                // Of several estimates the noise of each sets its weight.
                let weight = 1.0 / kept.max(LEAST);
                let block = product(&block, &self.waves);
                for (out, row) in self.shrunk.chunks_exact_mut(columns + SIDE).zip(&block) {
                    add(&mut out[left..left + SIDE], weight, row);
                }
                add(&mut self.weights[left..left + SIDE], weight, &[1.0; SIDE]);
            }
            self.add_band(top);
        }
        Zip::from(guide).and(&self.sum).and(&self.weight).for_each(|out, &sum, &weight| *out = sum / weight);
    }

    /// Transforms the band of the result back and adds it to the sums from the row `top` on.
    fn add_band(&mut self, top: usize) {
        let (rows, columns) = self.sum.dim();
        for (i, wave) in self.transposed.iter().enumerate() {
            let row = (top + i) % rows;
            if let (Some(sum), Some(weight)) =
                (self.sum.row_mut(row).as_slice_mut(), self.weight.row_mut(row).as_slice_mut())
            {
                for (shrunk, &x) in self.shrunk.chunks_exact(columns + SIDE).zip(wave) {
                    add(sum, x, shrunk);
                    add(sum, x, &shrunk[columns..]);
                }
                add(weight, 1.0, &self.weights);
                add(weight, 1.0, &self.weights[columns..]);
            }
        }
    }
}

/// The waves of the orthonormal DCT-II.
fn waves() -> Block {
    std::array::from_fn(|k| {
        let scale = if k == 0 { 1.0 } else { 2.0_f64.sqrt() } / (SIDE as f64).sqrt();
        let step = PI * k as f64 / SIDE as f64;
        std::array::from_fn(|i| (scale * (step * (i as f64 + 0.5)).cos()) as f32)
    })
}

/// Transforms the sixteen rows from `top` on down each column.
fn transform_down(waves: &Block, picture: ArrayView2<'_, f32>, top: usize, band: &mut [f32]) {
    let (rows, columns) = picture.dim();
    for (wave, out) in waves.iter().zip(band.chunks_exact_mut(columns + SIDE)) {
        out.fill(0.0);
        for (i, &x) in wave.iter().enumerate() {
            add(out, x, picture.row((top + i) % rows).to_slice().unwrap_or_default());
        }
        out.copy_within(..SIDE, columns);
    }
}

/// The block of `band` whose first column is `left`.
fn cut(band: &[f32], left: usize) -> Block {
    let mut block = Block::default();
    for (out, row) in block.iter_mut().zip(band.chunks_exact(band.len() / SIDE)) {
        out.copy_from_slice(&row[left..left + SIDE]);
    }
    block
}

/// Shrinks `block` and returns the variance that it keeps, of `variances`.
fn shrink_block(
    block: &mut Block,
    guide: &Block,
    doubts: &Block,
    variances: &Block,
    gain: impl Fn(f32, f32) -> f32,
) -> f32 {
    let mut kept = [0.0; SIDE];
    for (((row, guide), doubts), variances) in block.iter_mut().zip(guide).zip(doubts).zip(variances) {
        let gains: [f32; SIDE] = std::array::from_fn(|i| gain(guide[i] * guide[i], doubts[i]));
        *row = std::array::from_fn(|i| gains[i] * row[i]);
        kept = std::array::from_fn(|i| kept[i] + gains[i] * gains[i] * variances[i]);
    }
    kept.iter().sum()
}

/// The matrix `a b`.
fn product(a: &Block, b: &Block) -> Block {
    a.map(|a| {
        let mut out = [0.0; SIDE];
        for (a, b) in a.into_iter().zip(b) {
            accumulate(&mut out, a, b);
        }
        out
    })
}

/// Adds `factor * what` to `to`; of a length that is known, which is much faster.
fn accumulate(to: &mut [f32; SIDE], factor: f32, what: &[f32; SIDE]) {
    for (to, what) in to.iter_mut().zip(what) {
        *to += factor * what;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_that_keep_all_give_the_picture_back() {
        // No multiple of the step, so that blocks overlap unevenly where the picture comes round.
        let picture = Array2::from_shape_fn((42, 38), |(r, c)| ((r * 31 + c * 17) % 23) as f32);
        let mut blocks = Blocks::new(42, 38);
        blocks.expect(|_| 1.0);
        let mut out = Array2::zeros((42, 38));
        blocks.shrink(picture.view(), &mut out, 1.0, |_, _| 1.0);
        assert!(out.iter().zip(&picture).all(|(a, b)| (a - b).abs() < 1e-3));
    }

    #[test]
    fn variances_are_those_of_the_noise() {
        let mut blocks = Blocks::new(40, 50);
        blocks.expect(|_| 1.0);
        assert!(blocks.variances.iter().flatten().all(|variance| (variance - 1.0).abs() < 1e-4));
        // A brightness of variance 1 has all its power, one a pixel, in one bin, and its coefficient is 16 times as large.
        blocks.expect(|i| if i == 0 { 40.0 * 50.0 } else { 0.0 });
        let sum: f32 = blocks.variances.iter().flatten().sum();
        assert!((blocks.variances[0][0] - 256.0).abs() < 1e-2 && (sum - 256.0).abs() < 1e-2, "{sum}");
    }
}
