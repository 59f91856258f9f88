//! The cells of a spectrum in columns, and the patches of the plane that they lie in.

use super::periodogram::{CellSum, CellSums, MOST_FREQUENCY};
use super::scene::{self, TERMS};
use crate::products::{GROUP, LANES};

/// Patches of the plane of frequencies in which the scene's spectrum may differ from its mean form: this many a half
/// turn, two an octave.
const PATCHES_PER_RING: usize = 36;
/// Octaves below the highest frequency, each with its own scatter of the patches.
pub(super) const OCTAVES: usize = 5;
pub(super) const PATCHES: usize = 2 * OCTAVES * PATCHES_PER_RING;

/// Cells in columns, sorted by patch: each patch is padded to whole blocks of [`LANES`] with cells that weigh nothing.
#[derive(Debug)]
pub(super) struct Cells {
    pub(super) angle: f64,
    /// Independent bins.
    pub(super) count: Vec<f32>,
    pub(super) power: Vec<f32>,
    pub(super) weight: Vec<f32>,
    pub(super) s: Vec<f32>,
    pub(super) t: Vec<f32>,
    /// `TERMS` columns of lanes, block after block.
    pub(super) terms: Vec<f32>,
    /// Patch of each block.
    pub(super) patch: Vec<u16>,
    /// First cell of each patch, as long as they are sorted, ...
    first: Vec<u32>,
    /// ... and place and patch of each, as they come.
    places: Vec<(f64, f64, u16)>,
    peaks: f64,
}

impl Cells {
    /// How peaked the powers within the cells are, 1 for a smooth spectrum.
    pub(super) fn peaks(&self) -> f64 {
        self.peaks
    }

    pub(super) fn new(capacity: usize) -> Self {
        let padded = capacity + (PATCHES + GROUP) * LANES;
        let column = || Vec::with_capacity(padded);
        Self {
            angle: 0.0,
            count: column(),
            power: column(),
            weight: column(),
            s: column(),
            t: column(),
            terms: Vec::with_capacity(padded * TERMS),
            patch: Vec::with_capacity(padded / LANES),
            first: vec![0; PATCHES + 1],
            places: Vec::with_capacity(capacity),
            peaks: 1.0,
        }
    }

    /// Takes the cells of `sums`, of which a bin counts for `independence` independent ones, under the noise power
    /// `noise`.
    pub(super) fn set(&mut self, sums: &CellSums, independence: f64, noise: f32) {
        self.angle = sums.angle;
        self.peaks = peaks(sums, noise);
        let (sin, cos) = sums.angle.sin_cos();
        let place = |cell: &CellSum| {
            let (s, t) = (f64::from(cell.s / cell.count), f64::from(cell.t / cell.count));
            let (u, v) = (s * cos + t * sin, t * cos - s * sin);
            (u, v, patch_of(u, v) as u16)
        };
        self.places.clear();
        self.places.extend(sums.filled().map(place));
        self.first.fill(0);
        for &(_, _, patch) in &self.places {
            self.first[usize::from(patch)] += 1;
        }
        self.patch.clear();
        let mut total = 0;
        for (patch, first) in self.first.iter_mut().enumerate() {
            let blocks = (*first as usize).div_ceil(LANES);
            *first = total as u32;
            total += blocks * LANES;
            self.patch.extend(std::iter::repeat_n(patch as u16, blocks));
        }
        while !self.patch.len().is_multiple_of(GROUP) {
            self.patch.push(0);
        }
        let total = self.patch.len() * LANES;
        self.count.clear();
        self.count.resize(total, 0.0);
        for column in [&mut self.power, &mut self.weight, &mut self.s, &mut self.t] {
            column.clear();
            column.resize(total, 0.1);
        }
        self.terms.clear();
        self.terms.resize(total * TERMS, 0.0);
        for (cell, &(u, v, patch)) in sums.filled().zip(&self.places) {
            let slot = &mut self.first[usize::from(patch)];
            let i = *slot as usize;
            *slot += 1;
            let one = 1.0 / cell.count;
            self.count[i] = cell.count * independence as f32;
            self.power[i] = cell.power * one;
            self.weight[i] = cell.weight * one;
            self.s[i] = cell.s * one;
            self.t[i] = cell.t * one;
            let block = i / LANES * LANES * TERMS + i % LANES;
            for (k, term) in scene::terms(u, v).into_iter().enumerate() {
                self.terms[block + k * LANES] = term as f32;
            }
        }
    }
}

/// Bins that a cell must hold, and times that it must stand above the noise, to tell whether its powers are peaked.
const PEAK_BINS: f32 = 6.0;
const PEAK_CONTRAST: f32 = 3.0;

/// Mean over cells of the mean square power over twice the squared mean: 1 for a smooth spectrum, whose powers are
/// exponential variables, and more where a periodic texture puts its power into single bins.
fn peaks(sums: &CellSums, noise: f32) -> f64 {
    let (mut total, mut count) = (0.0_f32, 0.0_f32);
    for cell in sums.filled() {
        if cell.count >= PEAK_BINS && cell.power > PEAK_CONTRAST * noise * cell.weight {
            // n sum p^2 / (sum p)^2 has the mean 2 n / (n + 1).
            total += cell.square * (cell.count + 1.0) / (2.0 * cell.power * cell.power);
            count += 1.0;
        }
    }
    if count > 0.0 { f64::from(total / count) } else { 1.0 }
}

pub(super) fn patch_of(u: f64, v: f64) -> usize {
    let half_octave = (MOST_FREQUENCY * MOST_FREQUENCY / (u * u + v * v)).log2() as usize;
    let turn = (v.atan2(u) / std::f64::consts::PI + 0.5).rem_euclid(1.0);
    let sector = ((turn * PATCHES_PER_RING as f64) as usize).min(PATCHES_PER_RING - 1);
    half_octave.min(2 * OCTAVES - 1) * PATCHES_PER_RING + sector
}

pub(super) fn octave_of(patch: usize) -> usize {
    patch / (2 * PATCHES_PER_RING)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patches_are_halves_of_octaves() {
        assert_eq!(octave_of(patch_of(0.3, 0.0)), 0);
        assert_eq!(octave_of(patch_of(0.0, 0.2)), 1);
        // Below the last octave they stay in it.
        assert_eq!(octave_of(patch_of(0.001, 0.001)), OCTAVES - 1);
        assert!(patch_of(0.49, -1e-12) < PATCHES && patch_of(1e-12, 0.49) < PATCHES);
    }
}
