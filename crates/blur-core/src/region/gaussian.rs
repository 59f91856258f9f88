//! Gaussian filters and their first derivatives, with the border pixels continued outwards.

use ndarray::Array2;

/// Where a filter is cut off, in standard deviations.
const REACH: f64 = 4.0;

/// Samples of the Gaussian of `sigma_px`, of sum 1; an odd number, the middle one at 0.
pub(super) fn gaussian(sigma_px: f64) -> Vec<f32> {
    let reach = (REACH * sigma_px).ceil() as i32;
    let values: Vec<f64> = (-reach..=reach).map(|i| (-0.5 * (f64::from(i) / sigma_px).powi(2)).exp()).collect();
    let sum: f64 = values.iter().sum();
    values.iter().map(|value| (value / sum) as f32).collect()
}

/// Samples of the derivative of that Gaussian.
pub(super) fn derivative(sigma_px: f64) -> Vec<f32> {
    let taps = gaussian(sigma_px);
    let reach = (taps.len() / 2) as f64;
    taps.iter().enumerate().map(|(i, tap)| ((i as f64 - reach) / (sigma_px * sigma_px)) as f32 * tap).collect()
}

/// `picture` filtered by `across` along its rows and by `down` along its columns. Taps are those of a correlation
/// whose middle is the pixel itself.
pub(super) fn filter(picture: &Array2<f32>, across: &[f32], down: &[f32]) -> Array2<f32> {
    let mut filter = RowFilter::new(picture, across, down);
    let mut filtered = Array2::zeros(picture.dim());
    for out in filtered.rows_mut() {
        out.into_iter().zip(filter.next_row()).for_each(|(out, &value)| *out = value);
    }
    filtered
}

/// A filtered picture, row by row from the top: what is read again soon is all that is kept.
#[derive(Debug)]
pub(super) struct RowFilter<'a> {
    picture: &'a Array2<f32>,
    across: &'a [f32],
    down: &'a [f32],
    padded: Vec<f32>,
    /// The last rows, filtered along themselves: row `r` is number `r` modulo the taps.
    along: Vec<f32>,
    /// Rows that were filtered along themselves.
    filtered: usize,
    sums: Vec<f32>,
    /// The next row to come.
    row: usize,
}

impl<'a> RowFilter<'a> {
    /// As [`filter`].
    pub(super) fn new(picture: &'a Array2<f32>, across: &'a [f32], down: &'a [f32]) -> Self {
        let columns = picture.ncols();
        Self {
            picture,
            across,
            down,
            padded: vec![0.0; columns + across.len() - 1],
            along: vec![0.0; down.len() * columns],
            filtered: 0,
            sums: vec![0.0; columns],
            row: 0,
        }
    }

    /// The next row; the last one again when there is none.
    pub(super) fn next_row(&mut self) -> &[f32] {
        let (rows, columns) = self.picture.dim();
        let reach = self.down.len() / 2;
        while self.filtered < rows.min(self.row + reach + 1) {
            let row = self.picture.row(self.filtered);
            let margin = self.across.len() / 2;
            for (i, value) in self.padded.iter_mut().enumerate() {
                *value = row[i.saturating_sub(margin).min(columns - 1)];
            }
            let out = &mut self.along[self.filtered % self.down.len() * columns..][..columns];
            out.fill(0.0);
            add_weighted(out, self.across, |k| &self.padded[k..k + columns]);
            self.filtered += 1;
        }
        self.sums.fill(0.0);
        add_weighted(&mut self.sums, self.down, |k| {
            let row = (self.row + k).saturating_sub(reach).min(rows - 1);
            &self.along[row % self.down.len() * columns..][..columns]
        });
        self.row = (self.row + 1).min(rows - 1);
        &self.sums
    }
}

/// Adds `taps[k] * line(k)` for every `k` to `out`, four lines at a time, so that `out` is loaded and stored less often than
/// it is added to. The order of the sums is that of the taps.
fn add_weighted<'a>(out: &mut [f32], taps: &[f32], line: impl Fn(usize) -> &'a [f32]) {
    let (fours, rest) = taps.as_chunks::<4>();
    for (i, &[a, b, c, d]) in fours.iter().enumerate() {
        let [p, q, r, s] = [0, 1, 2, 3].map(|k| line(4 * i + k));
        for ((((out, p), q), r), s) in out.iter_mut().zip(p).zip(q).zip(r).zip(s) {
            *out = *out + a * p + b * q + c * r + d * s;
        }
    }
    for (k, &tap) in rest.iter().enumerate() {
        for (out, value) in out.iter_mut().zip(line(4 * fours.len() + k)) {
            *out += tap * value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_derivative_of_a_ramp_is_its_slope() {
        let picture = Array2::from_shape_fn((60, 70), |(r, c)| 3.0 * c as f32 - 2.0 * r as f32);
        for sigma in [0.7, 2.8] {
            let (g, d) = (gaussian(sigma), derivative(sigma));
            let (x, y) = (filter(&picture, &d, &g)[(30, 35)], filter(&picture, &g, &d)[(30, 35)]);
            // Samples of a filter this narrow have the moment of the continuous one but for a few hundredths.
            assert!((x - 3.0).abs() < 0.06 && (y + 2.0).abs() < 0.04, "{sigma}: {x} {y}");
        }
    }
}
