//! The bins of a spectrum that a method looks at, with their frequencies.

/// Band of spatial frequencies in cycles per pixel, `min < max <= 0.5`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Band {
    pub(crate) min: f64,
    pub(crate) max: f64,
}

/// One row of bins: neighbours along `u` at one `v`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BinRow {
    /// Row of the spectrum that it was taken from.
    pub(crate) source_row: usize,
    /// First column of the spectrum.
    pub(crate) first_column: usize,
    /// Where its values start in [`SpectrumBins::values`].
    pub(crate) start: usize,
    pub(crate) length: usize,
    /// Frequency along rows (downwards), cycles per pixel.
    pub(crate) v: f32,
}

/// Values on the bins of a spectrum inside a band of radii: the quadrant of a DCT, or the half plane of a real picture's DFT
/// with the origin at its centre.
///
/// The frequency of bin `i` of a row is `u = (first_column + i) * du`, in cycles per pixel; see the crate's conventions.
#[derive(Debug, Clone)]
pub struct SpectrumBins {
    pub(crate) rows: Vec<BinRow>,
    pub(crate) values: Vec<f32>,
    pub(crate) du: f32,
    pub(crate) band: Band,
}

impl SpectrumBins {
    /// Bins of the DCT quadrant of a picture of `rows` x `columns` pixels: coefficient `[m, n]` has `v = m / 2 rows`
    /// and `u = n / 2 columns`.
    pub(crate) fn quadrant(rows: usize, columns: usize, band: Band) -> Self {
        let (dv, du) = (0.5 / rows as f64, 0.5 / columns as f64);
        let sources = (0..rows).map(|m| (m, m as f64 * dv));
        Self::collect(sources, columns, du, band, |_| true)
    }

    /// Bins of the half plane `u >= 0` of the DFT of a picture of `rows` x `columns` pixels; of the axis `u = 0`, where
    /// both halves would be the same values, only `v > 0`.
    pub(crate) fn half_plane(rows: usize, columns: usize, band: Band) -> Self {
        let (dv, du) = (1.0 / rows as f64, 1.0 / columns as f64);
        let sources = (0..rows).map(|j| {
            let signed = if 2 * j > rows { j as f64 - rows as f64 } else { j as f64 };
            (j, signed * dv)
        });
        Self::collect(sources, columns / 2 + 1, du, band, |v| v > 0.0)
    }

    fn collect(
        sources: impl Iterator<Item = (usize, f64)>,
        columns: usize,
        du: f64,
        band: Band,
        keeps_axis: impl Fn(f64) -> bool,
    ) -> Self {
        let mut rows = Vec::new();
        let mut start = 0;
        for (source_row, v) in sources {
            if v.abs() > band.max {
                continue;
            }
            let least = (band.min * band.min - v * v).max(0.0).sqrt();
            let most = (band.max * band.max - v * v).max(0.0).sqrt();
            let mut first_column = (least / du).ceil() as usize;
            if first_column == 0 && !keeps_axis(v) {
                first_column = 1;
            }
            let end = ((most / du).floor() as usize + 1).min(columns);
            if end > first_column {
                let length = end - first_column;
                rows.push(BinRow { source_row, first_column, start, length, v: v as f32 });
                start += length;
            }
        }
        Self { rows, values: vec![0.0; start], du: du as f32, band }
    }

    /// Number of bins.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Whether the band holds no bin at all.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Calls `f(u, v, value)` for every bin; frequencies in cycles per pixel.
    pub fn for_each(&self, mut f: impl FnMut(f32, f32, f32)) {
        for row in &self.rows {
            for (i, &value) in self.values[row.start..row.start + row.length].iter().enumerate() {
                f((row.first_column + i) as f32 * self.du, row.v, value);
            }
        }
    }

    /// Number of the blocks of `side` x `side` bins that [`for_each_in_block`](Self::for_each_in_block) counts.
    pub(crate) fn blocks_of(&self, side: usize) -> usize {
        self.rows.len().div_ceil(side) * self.blocks_across(side)
    }

    fn blocks_across(&self, side: usize) -> usize {
        self.rows.iter().map(|row| (row.first_column + row.length).div_ceil(side)).max().unwrap_or(0)
    }

    /// Calls `f(block, u, v, value)` for every bin, with the number of the block of `side` x `side` bins it lies in.
    pub(crate) fn for_each_in_block(&self, side: usize, mut f: impl FnMut(usize, f32, f32, f32)) {
        let across = self.blocks_across(side);
        for (index, row) in self.rows.iter().enumerate() {
            let first_block = index / side * across;
            for (i, &value) in self.values[row.start..row.start + row.length].iter().enumerate() {
                let column = row.first_column + i;
                f(first_block + column / side, column as f32 * self.du, row.v, value);
            }
        }
    }

    /// Replaces every value by `f(u, v, value)`.
    pub(crate) fn update(&mut self, mut f: impl FnMut(f32, f32, f32) -> f32) {
        for row in &self.rows {
            for (i, value) in self.values[row.start..row.start + row.length].iter_mut().enumerate() {
                *value = f((row.first_column + i) as f32 * self.du, row.v, *value);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BAND: Band = Band { min: 0.05, max: 0.4 };

    #[test]
    fn every_bin_lies_in_the_band_and_none_is_missing() {
        for (rows, columns) in [(64, 64), (37, 50), (48, 31)] {
            let quadrant = SpectrumBins::quadrant(rows, columns, BAND);
            let mut seen = 0;
            quadrant.for_each(|u, v, _| {
                let radius = f64::from(u.hypot(v));
                assert!((0.05 - 1e-6..=0.4 + 1e-6).contains(&radius));
                assert!(u >= 0.0 && v >= 0.0);
                seen += 1;
            });
            let expected = (0..rows * columns)
                .filter(|i| {
                    let (v, u) =
                        (0.5 * (i / columns) as f64 / rows as f64, 0.5 * (i % columns) as f64 / columns as f64);
                    (0.05..=0.4).contains(&u.hypot(v))
                })
                .count();
            assert_eq!(seen, expected);
        }
    }

    #[test]
    fn the_half_plane_holds_each_pair_of_opposite_frequencies_once() {
        for (rows, columns) in [(32, 32), (33, 45)] {
            let half = SpectrumBins::half_plane(rows, columns, BAND);
            // Above 0.4 nothing touches the Nyquist rows, so the whole plane is exactly two half planes.
            let mut whole = 0;
            for j in 0..rows {
                for k in 0..columns {
                    let fold = |i: usize, n: usize| if 2 * i > n { i as f64 - n as f64 } else { i as f64 } / n as f64;
                    if (0.05..=0.4).contains(&fold(k, columns).hypot(fold(j, rows))) {
                        whole += 1;
                    }
                }
            }
            assert_eq!(2 * half.len(), whole);
        }
    }
}
