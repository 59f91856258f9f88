//! The periodogram of a picture, whitened, and its bins summed into cells along a direction.

use ndarray::ArrayView2;

use super::overlay::Overlay;
use crate::image::Window;
use crate::spectrum::{Dft2, exp, ln};

/// Radii of the bins used: above this many bins of the shorter side, where the window's own lobe ends ...
const LEAST_BINS: f64 = 3.0;
/// Bins of the longer side, or of the least extent of weights, beyond which the lobe has died away ...
const LOBE_BINS: f64 = 5.0;
/// ... up to so many times as much.
const MOST_LOBE: f64 = 8.0;
/// ... up to this frequency in cycles per pixel.
pub(crate) const MOST_FREQUENCY: f64 = 0.5;
/// Powers are multiplied by `(f / 0.1)^2.2`, the fall of the spectra of photographs, so that a cell may hold bins of
/// different radii.
pub(crate) const FALL: f64 = 2.2;
/// The noise is first guessed beyond this frequency.
const NOISE_FREQUENCY: f64 = 0.4;
const SECTORS: usize = 36;
/// A sector with fewer bins says nothing about the noise.
const LEAST_OF_SECTOR: u32 = 16;
/// Least noise power for a picture of variance 1.
const LEAST_NOISE: f64 = 1e-8;

/// Periodograms of pictures of one size: `|DFT(g w)|^2 / sum w^2` of the picture `g` scaled to variance 1 under the
/// window `w`, so that white noise of variance `s^2` has the mean power `s^2`.
#[derive(Debug)]
pub(super) struct Periodogram {
    overlay: Overlay,
    dft: Dft2,
    /// Bins of the longer side beyond which the lobe of the window has died away.
    lobe_bins: usize,
    /// Frequencies of the bins in cycles per pixel; `v` points down.
    pub(super) u: Vec<f32>,
    pub(super) v: Vec<f32>,
    /// `(f / 0.1)^FALL`.
    weight: Vec<f32>,
    /// First bin and frequency of each row, in the order of the bins; the last entry ends them.
    rows: Vec<(usize, f32)>,
    /// Place in the half spectrum.
    index: Vec<u32>,
    /// Power times weight.
    whitened: Vec<f32>,
    /// Bins beyond [`NOISE_FREQUENCY`] and the sector of each.
    noise_bins: Vec<(u32, u8)>,
}

impl Periodogram {
    /// Under a window over the whole picture.
    pub(super) fn new(rows: usize, columns: usize, window: Window) -> Self {
        let overlay = Overlay::window(rows, columns, window);
        Self::under(overlay, (rows, columns), rows.min(columns) as f64, LOBE_BINS as usize)
    }

    /// Under weights that measure `extent_px` where they are narrowest, transformed in `rows` x `columns` pixels.
    pub(super) fn weighted(rows: usize, columns: usize, extent_px: f64) -> Self {
        let wider = (rows.max(columns) as f64 / extent_px).clamp(1.0, MOST_LOBE);
        let lobe_bins = (LOBE_BINS * wider).ceil() as usize;
        Self::under(Overlay::weights(rows, columns, extent_px), (rows, columns), extent_px, lobe_bins)
    }

    fn under(overlay: Overlay, (rows, columns): (usize, usize), side: f64, lobe_bins: usize) -> Self {
        let half = columns / 2 + 1;
        let column = || Vec::with_capacity(rows * half);
        let (mut u, mut v, mut weight, mut index) = (column(), column(), column(), Vec::with_capacity(rows * half));
        let mut noise_bins = Vec::new();
        let mut starts = Vec::with_capacity(rows + 1);
        for row in 0..rows {
            let signed = if row <= rows / 2 { row as f64 } else { row as f64 - rows as f64 };
            let y = signed / rows as f64;
            starts.push((u.len(), y as f32));
            for column in 0..half {
                let x = column as f64 / columns as f64;
                // The column u = 0 holds each bin twice.
                if column == 0 && y <= 0.0 {
                    continue;
                }
                let radius = (x * x + y * y).sqrt();
                if radius < LEAST_BINS / side || radius >= MOST_FREQUENCY {
                    continue;
                }
                if radius > NOISE_FREQUENCY {
                    let turn = y.atan2(x) / std::f64::consts::PI + 0.5;
                    noise_bins.push((u.len() as u32, ((turn * SECTORS as f64) as usize % SECTORS) as u8));
                }
                u.push(x as f32);
                v.push(y as f32);
                weight.push(exp(FALL as f32 * ln(10.0 * radius as f32)));
                index.push((row * half + column) as u32);
            }
        }
        starts.push((u.len(), 0.0));
        Self {
            overlay,
            dft: Dft2::new(rows, columns),
            lobe_bins,
            whitened: vec![0.0; u.len()],
            rows: starts,
            u,
            v,
            weight,
            index,
            noise_bins,
        }
    }

    /// Bins.
    pub(super) fn len(&self) -> usize {
        self.u.len()
    }

    /// Rows and columns.
    pub(super) fn dim(&self) -> (usize, usize) {
        self.dft.dim()
    }

    /// Independent bins per bin: the window correlates neighbours.
    pub(super) fn independence(&self) -> f64 {
        self.overlay.independence()
    }

    /// Bins of the longer side beyond which the lobe of the window has died away.
    pub(super) fn lobe_bins(&self) -> usize {
        self.lobe_bins
    }

    /// The picture's power spectrum under weights of its size takes the place of the last one; for periodograms of
    /// weighted pictures.
    pub(super) fn set_weighted(&mut self, image: ArrayView2<'_, f32>, weights: ArrayView2<'_, f32>) {
        if let Overlay::Weights(overlay) = &mut self.overlay {
            overlay.set(weights);
        }
        self.set(image);
    }

    /// The picture's power spectrum takes the place of the last one.
    pub(super) fn set(&mut self, image: ArrayView2<'_, f32>) {
        self.overlay.apply(image, self.dft.input());
        let scale = self.overlay.scale();
        let spectrum = self.dft.transform();
        let Some(spectrum) = spectrum.as_slice() else { return };
        for ((out, &index), &weight) in self.whitened.iter_mut().zip(&self.index).zip(&self.weight) {
            *out = spectrum[index as usize].norm_sqr() * scale * weight;
        }
    }

    /// Powers by their frequency, not whitened, take the place of a picture's.
    #[cfg(test)]
    pub(super) fn set_powers(&mut self, mut power: impl FnMut(f64, f64) -> f64) {
        for (((out, &weight), &u), &v) in self.whitened.iter_mut().zip(&self.weight).zip(&self.u).zip(&self.v) {
            *out = power(f64::from(u), f64::from(v)) as f32 * weight;
        }
    }

    /// Power of each bin, not whitened.
    pub(super) fn powers(&self) -> impl Iterator<Item = f32> {
        self.whitened.iter().zip(&self.weight).map(|(power, weight)| power / weight)
    }

    /// A first guess of the noise power: the mean of the calmest sector of the highest frequencies.
    pub(super) fn noise(&self) -> f64 {
        let mut sectors = [(0_u32, 0.0_f64); SECTORS];
        for &(bin, sector) in &self.noise_bins {
            let (count, sum) = &mut sectors[usize::from(sector)];
            *count += 1;
            *sum += f64::from(self.whitened[bin as usize] / self.weight[bin as usize]);
        }
        let calmest = sectors
            .iter()
            .filter(|(count, _)| *count >= LEAST_OF_SECTOR)
            .map(|(count, sum)| sum / f64::from(*count))
            .fold(f64::INFINITY, f64::min);
        if calmest.is_finite() { calmest.max(LEAST_NOISE) } else { LEAST_NOISE }
    }

    /// Autocorrelation of the window at the lag `(x, y)` in pixels, `y` downwards.
    pub(super) fn window_at(&self, x: f64, y: f64) -> f64 {
        self.overlay.autocorrelation(x, y)
    }

    /// Sums the bins up to `most_frequency` into cells along the direction `angle` (radians), `width` bins wide.
    pub(super) fn gather(&self, angle: f64, width: usize, most_frequency: f64, sums: &mut CellSums) {
        sums.clear(angle, width);
        let (sin, cos) = (angle.sin() as f32, angle.cos() as f32);
        let most = (most_frequency * most_frequency) as f32;
        let per_step = sums.per_step;
        for (&(start, v), &(end, _)) in self.rows.iter().zip(&self.rows[1..]) {
            if v * v > most {
                continue;
            }
            let columns = &self.u[start..end];
            let end = start + columns.partition_point(|&u| u * u + v * v <= most);
            let bins = start..end;
            for ((&u, &power), &weight) in
                self.u[bins.clone()].iter().zip(&self.whitened[bins.clone()]).zip(&self.weight[bins])
            {
                let (mut s, mut t) = (u * cos - v * sin, u * sin + v * cos);
                if s < 0.0 {
                    (s, t) = (-s, -t);
                }
                let band = usize::from(sums.band_of[((t.abs() * BANDS_PER_UNIT) as usize).min(BAND_ENTRIES - 1)]);
                let band = if t < 0.0 { BANDS - 1 - band } else { BANDS + band };
                if let Some(sum) = sums.cells.get_mut(band * sums.steps + (s * per_step) as usize) {
                    sum.count += 1.0;
                    sum.power += power;
                    sum.square += power * power;
                    sum.weight += weight;
                    sum.s += s;
                    sum.t += t;
                }
            }
        }
    }
}

/// Upper edges of the cells across the direction, in cycles per pixel: narrow where spectra are steep.
const EDGES: [f32; 13] = [0.006, 0.012, 0.024, 0.04, 0.06, 0.085, 0.115, 0.15, 0.19, 0.24, 0.3, 0.37, 0.45];
const BANDS: usize = EDGES.len() + 1;
const BAND_ENTRIES: usize = 1024;
const BANDS_PER_UNIT: f32 = 2000.0;

/// Most bins across a cell along the motion.
pub(super) const WIDEST_CELL: usize = 4;

/// Bins of a cell, summed.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct CellSum {
    pub(super) count: f32,
    /// Whitened power.
    pub(super) power: f32,
    /// Sum of the squares of the whitened powers.
    pub(super) square: f32,
    /// Whitening weight, by which white noise counts.
    pub(super) weight: f32,
    /// Frequency along the motion, never negative, and across it.
    pub(super) s: f32,
    pub(super) t: f32,
}

/// A spectrum summed into cells: one bin wide along a direction, where the blur's pattern lies, and wide across it.
#[derive(Debug)]
pub(super) struct CellSums {
    pub(super) angle: f64,
    /// Bins across a cell along the motion.
    width: usize,
    side: usize,
    steps: usize,
    per_step: f32,
    band_of: Vec<u8>,
    cells: Vec<CellSum>,
}

impl CellSums {
    /// For spectra of pictures whose longer side has `side` pixels.
    pub(super) fn new(side: usize) -> Self {
        let steps = (MOST_FREQUENCY * side as f64) as usize + 2;
        let band_of = (0..BAND_ENTRIES)
            .map(|i| EDGES.iter().take_while(|&&edge| edge * BANDS_PER_UNIT < i as f32).count() as u8)
            .collect();
        Self {
            angle: 0.0,
            width: 1,
            side,
            steps,
            per_step: side as f32,
            band_of,
            cells: vec![CellSum::default(); 2 * BANDS * steps],
        }
    }

    /// Cells at most.
    pub(super) fn capacity(&self) -> usize {
        self.cells.len()
    }

    /// Bins across a cell along the motion.
    pub(super) fn width(&self) -> usize {
        self.width
    }

    fn clear(&mut self, angle: f64, width: usize) {
        (self.angle, self.width) = (angle, width.clamp(1, WIDEST_CELL));
        self.per_step = (self.side as f64 / self.width as f64) as f32;
        self.cells.fill(CellSum::default());
    }

    /// The cells that hold a bin.
    pub(super) fn filled(&self) -> impl Iterator<Item = &CellSum> {
        self.cells.iter().filter(|cell| cell.count > 0.0)
    }
}
