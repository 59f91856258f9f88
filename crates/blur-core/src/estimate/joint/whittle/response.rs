//! The power transfer function of a blur as a windowed picture shows it.

use std::f64::consts::PI;

use super::periodogram::{CellSums, MOST_FREQUENCY, Periodogram, WIDEST_CELL};
use crate::psf::{AcceleratedBlur, DiskBlur};

/// Points of the table per bin of the longer side.
const PER_BIN: usize = 4;
/// Lags over which the window's lobe is summed: this many, and no fewer for a bin that it reaches.
const LAGS: usize = 64;
const LAGS_PER_BIN: usize = 12;
/// Step in `r^2` of the derivative.
const RATIO2_STEP: f64 = 1e-3;

/// Values of the response at one frequency.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Value {
    /// The power transfer `T`.
    pub(super) power: f32,
    /// `dT / d ln L`.
    pub(super) per_log_length: f32,
    /// `dT / ds`.
    pub(super) per_s: f32,
    /// `dT / d r^2`.
    pub(super) per_ratio2: f32,
}

/// Table over `s`, the frequency along the motion, of `|H(s)|^2` seen through the window.
///
/// The window smears the spectrum over its lobe `K`: `T(s) = int K(x) |H(s - x)|^2 S(s - x)/S(s) dx`. Spectra fall
/// steeply, so more leaks into a dark line from its bright side, and ignoring that shortens blurs: to first order
/// `S(s - x)/S(s) = 1 + beta x` with `beta = -d ln S / ds`, hence `T = T0 + beta T1` with two tables.
#[derive(Debug)]
pub(super) struct Response {
    step: f64,
    len: usize,
    /// Points in use: up to the highest frequency asked for.
    used: usize,
    /// `|H|^2`, `d/d ln L`, `d/d r^2` on the lattice.
    raw: [Vec<f32>; COLUMNS],
    /// The same as the window shows them, `T0` and `T1`.
    even: [Vec<f32>; COLUMNS],
    odd: [Vec<f32>; COLUMNS],
    /// Those side by side, with the slope along `s`.
    rows: Vec<Row>,
    /// The window's lobe from its middle to where it has died away, in points of the table, ...
    lobe: Vec<f64>,
    /// ... and smeared over a cell.
    smeared: Vec<f64>,
    columns: usize,
    /// Length and squared ratio of the accelerated blur that the table holds, the costliest to compute.
    accelerated: Option<(f64, f64)>,
}

const COLUMNS: usize = 3;

/// `T0` and `T1` at one point of the table: power, `d/d ln L`, `d/d r^2` and `d/ds`.
#[derive(Debug, Clone, Copy, Default)]
struct Row {
    even: [f32; 4],
    odd: [f32; 4],
}

/// Where frequencies lie in the table.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lattice {
    per_step: f32,
    last: f32,
}

impl Lattice {
    /// The point of the table below the frequency `s`, which is not negative, and what share of a step it is beyond it. No branch
    /// and no call, so that loops over it run on vectors.
    pub(super) fn place(self, s: f32) -> (u32, f32) {
        // Added to this, a number up to 2^22 is rounded to the nearest integer, which the low bits hold.
        const INTEGERS: f32 = 8_388_608.0;
        let x = (s * self.per_step).min(self.last);
        let shifted = (x - 0.5).max(0.0) + INTEGERS;
        (shifted.to_bits() & 0x007f_ffff, x - (shifted - INTEGERS))
    }
}

impl Response {
    /// For pictures whose longer side has `side` pixels, under a window whose lobe has died away beyond `lobe_bins` bins.
    pub(super) fn new(side: usize, lobe_bins: usize) -> Self {
        let reach = PER_BIN * lobe_bins + PER_BIN * WIDEST_CELL / 2 + 1;
        let step = 1.0 / (PER_BIN * side) as f64;
        let len = (MOST_FREQUENCY / step).ceil() as usize + 2;
        let column = |n: usize| std::array::from_fn(|_| vec![0.0; n]);
        Self {
            step,
            len,
            used: len,
            // Mirrored at 0, with the lobe's reach on either side.
            raw: column(len + 2 * reach),
            even: column(len),
            odd: column(len),
            rows: vec![Row::default(); len],
            lobe: vec![0.0; PER_BIN * lobe_bins + 1],
            smeared: vec![0.0; reach + 1],
            columns: 2,
            accelerated: None,
        }
    }

    /// Takes the window's lobe along the direction of `cells`, smeared over their width, for frequencies up to
    /// `most_frequency`.
    pub(super) fn set_direction(&mut self, periodogram: &Periodogram, cells: &CellSums, most_frequency: f64) {
        self.accelerated = None;
        self.used = ((most_frequency / self.step).ceil() as usize + 4).min(self.len);
        let (sin, cos) = cells.angle.sin_cos();
        let (rows, columns) = periodogram.dim();
        let longest = (columns as f64 / cos.abs().max(1e-9)).min(rows as f64 / sin.abs().max(1e-9));
        let lags = LAGS.max(LAGS_PER_BIN * self.lobe.len() / PER_BIN);
        let lag = longest / lags as f64;
        for (j, value) in self.lobe.iter_mut().enumerate() {
            let turn = 2.0 * PI * j as f64 * self.step * lag;
            *value = 0.5;
            // cos(i turn) by its recurrence.
            let (mut before, mut now) = (1.0, turn.cos());
            let twice = 2.0 * now;
            for i in 1..lags {
                let distance = i as f64 * lag;
                *value += periodogram.window_at(distance * cos, -distance * sin) * now;
                (before, now) = (now, twice * now - before);
            }
        }
        // One bin's width is in the lobe already: a cell of one bin holds bins at their own places.
        let half = (cells.width() - 1) * PER_BIN / 2;
        let lobe = &self.lobe;
        for (j, value) in self.smeared.iter_mut().enumerate() {
            *value = (0..=2 * half).map(|k| lobe.get((j + k).abs_diff(half)).copied().unwrap_or(0.0)).sum();
        }
        let sum = self.smeared[0] + 2.0 * self.smeared[1..].iter().sum::<f64>();
        for value in &mut self.smeared {
            *value /= sum;
        }
    }

    /// Points of the table that the smeared lobe reaches.
    fn reach(&self) -> usize {
        self.smeared.len() - 1
    }

    /// Fills the table for a uniform blur of `length` pixels.
    pub(super) fn set_uniform(&mut self, length: f64) {
        (self.columns, self.accelerated) = (2, None);
        let turn = PI * length * self.step;
        // sin and cos of k turn by a rotation.
        let (sin_step, cos_step) = turn.sin_cos();
        let (mut sin, mut cos) = (0.0_f64, 1.0_f64);
        for k in 0..self.used + self.reach() {
            let (power, slope) = if k == 0 {
                (1.0, 0.0)
            } else {
                let x = k as f64 * turn;
                let sinc = sin / x;
                (sinc * sinc, 2.0 * sinc * (cos - sinc))
            };
            self.put(k, [power as f32, slope as f32, 0.0]);
            (sin, cos) = (sin * cos_step + cos * sin_step, cos * cos_step - sin * sin_step);
        }
        self.smear();
    }

    /// Fills the table for an accelerated blur of `length` pixels and the squared acceleration ratio `ratio2`, 0 to 1.
    pub(super) fn set_accelerated(&mut self, length: f64, ratio2: f64) {
        if self.accelerated.replace((length, ratio2)) == Some((length, ratio2)) {
            return;
        }
        self.columns = COLUMNS;
        // Both ratios stay inside 0..1, so the difference is one-sided at the ends.
        let low = (ratio2 - RATIO2_STEP).max(0.0);
        let high = (low + 2.0 * RATIO2_STEP).min(1.0);
        let mtf2 = |ratio2: f64, q: f64| AcceleratedBlur::new(1.0, ratio2.sqrt()).map_or(1.0, |b| b.mtf(q).powi(2));
        for k in 0..self.used + self.reach() {
            let q = k as f64 * self.step * length;
            let power = mtf2(ratio2, q);
            let slope = q * (mtf2(ratio2, q + 1e-4) - mtf2(ratio2, (q - 1e-4).abs())) / 2e-4;
            let per_ratio2 = (mtf2(high, q) - mtf2(low, q)) / (high - low);
            self.put(k, [power as f32, slope as f32, per_ratio2 as f32]);
        }
        self.smear();
    }

    /// Fills the table for a disk of `diameter` pixels; `s` is then the radius.
    pub(super) fn set_disk(&mut self, diameter: f64) {
        (self.columns, self.accelerated) = (2, None);
        for k in 0..self.used + self.reach() {
            // 2 J1(x)/x and its derivative -2 J2(x)/x.
            let x = PI * k as f64 * self.step * diameter;
            let transfer = DiskBlur::new(diameter).map_or(1.0, |disk| disk.transfer(k as f64 * self.step));
            let slope = -4.0 * transfer * (transfer - libm::j0(x));
            self.put(k, [(transfer * transfer) as f32, slope as f32, 0.0]);
        }
        self.smear();
    }

    fn put(&mut self, k: usize, values: [f32; COLUMNS]) {
        let reach = self.reach();
        for (raw, value) in self.raw.iter_mut().zip(values).take(self.columns) {
            raw[reach + k] = value;
            if (1..=reach).contains(&k) {
                raw[reach - k] = value;
            }
        }
    }

    fn smear(&mut self) {
        let reach = self.reach();
        for ((raw, even), odd) in self.raw.iter().zip(&mut self.even).zip(&mut self.odd).take(self.columns) {
            let (even, odd) = (&mut even[..self.used], &mut odd[..self.used]);
            for ((out, out_odd), &value) in even.iter_mut().zip(odd.iter_mut()).zip(&raw[reach..]) {
                (*out, *out_odd) = (self.smeared[0] as f32 * value, 0.0);
            }
            for (j, &weight) in self.smeared.iter().enumerate().skip(1) {
                let weight = weight as f32;
                let moment = weight * (j as f64 * self.step) as f32;
                let (below, above) = (&raw[reach - j..], &raw[reach + j..]);
                for (((out, out_odd), &a), &b) in even.iter_mut().zip(odd.iter_mut()).zip(below).zip(above) {
                    *out += weight * (a + b);
                    *out_odd += moment * (a - b);
                }
            }
        }
        self.arrange();
    }

    /// Copies the columns into rows, with the slope by central differences.
    fn arrange(&mut self) {
        let per_step = (0.5 / self.step) as f32;
        let last = self.used - 1;
        let side_by_side = |columns: &[Vec<f32>; COLUMNS], k: usize| {
            let power = &columns[0];
            // The table is even.
            let slope = if k == 0 { 0.0 } else { per_step * (power[(k + 1).min(last)] - power[k - 1]) };
            [power[k], columns[1][k], if self.columns > 2 { columns[2][k] } else { 0.0 }, slope]
        };
        for (k, row) in self.rows[..self.used].iter_mut().enumerate() {
            *row = Row { even: side_by_side(&self.even, k), odd: side_by_side(&self.odd, k) };
        }
    }

    /// Where frequencies lie in the table.
    pub(super) fn lattice(&self) -> Lattice {
        Lattice { per_step: (1.0 / self.step) as f32, last: (self.used - 2) as f32 }
    }

    /// The response at a place of the [`lattice`](Self::lattice), where the sharp spectrum falls by `beta` per cycle per pixel.
    pub(super) fn at_place(&self, (below, share): (u32, f32), beta: f32) -> Value {
        let below = below as usize;
        let [a, b] = [&self.rows[below], &self.rows[below + 1]];
        let mut values = [0.0; 4];
        for (i, value) in values.iter_mut().enumerate() {
            let (a, b) = (a.even[i] + beta * a.odd[i], b.even[i] + beta * b.odd[i]);
            *value = a + share * (b - a);
        }
        let [power, per_log_length, per_ratio2, per_s] = values;
        Value { power, per_log_length, per_s, per_ratio2 }
    }

    /// The response at the frequency `s` (either sign), where the sharp spectrum falls by `beta` per cycle per pixel.
    pub(super) fn at(&self, s: f32, beta: f32) -> Value {
        let sign = 1.0_f32.copysign(s);
        let value = self.at_place(self.lattice().place(s.abs()), sign * beta);
        Value { per_s: sign * value.per_s, ..value }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Window;

    const TUKEY: Window = Window::Tukey { taper: 0.25 };
    const SIZES: [(usize, usize); 2] = [(64, 96), (101, 67)];
    const ANGLES_DEG: [f64; 4] = [0.0, 33.0, 90.0, 152.0];
    const LENGTHS: [f64; 3] = [6.3, 11.0, 19.7];

    fn response(window: Window, (rows, columns): (usize, usize), deg: f64) -> Response {
        let mut periodogram = Periodogram::new(rows, columns, window);
        let mut sums = CellSums::new(rows.max(columns));
        periodogram.set_powers(|_, _| 1.0);
        periodogram.gather(deg.to_radians(), 1, MOST_FREQUENCY, &mut sums);
        let mut response = Response::new(rows.max(columns), periodogram.lobe_bins());
        response.set_direction(&periodogram, &sums, MOST_FREQUENCY);
        response
    }

    /// Autocorrelation of the window along an axis of `n` pixels, 1 at lag 0 and linear between whole lags.
    fn autocorrelation(window: Window, n: usize) -> impl Fn(f64) -> f64 {
        let at = |lag: usize| (lag..n).map(|i| window.weight(i, n) * window.weight(i - lag, n)).sum::<f64>();
        let values: Vec<f64> = (0..n + 2).map(|lag| at(lag) / at(0)).collect();
        move |lag| {
            let below = (lag as usize).min(n);
            let share = (lag - below as f64).min(1.0);
            (1.0 - share) * values[below] + share * values[below + 1]
        }
    }

    /// Autocorrelation of the window at a lag along `deg`.
    fn along(window: Window, (rows, columns): (usize, usize), deg: f64) -> impl Fn(f64) -> f64 {
        let (sin, cos) = deg.to_radians().sin_cos();
        let (in_column, in_row) = (autocorrelation(window, rows), autocorrelation(window, columns));
        move |lag| in_row(lag * cos.abs()) * in_column(lag * sin.abs())
    }

    /// The window's autocorrelation times the triangle that a box of `length` has for its own, at the midpoints of
    /// small pieces: the transfer as the window shows it is their cosine transform.
    fn lags(window: impl Fn(f64) -> f64, length: f64) -> Vec<(f64, f64)> {
        const PIECES: usize = 200;
        let piece = length / PIECES as f64;
        let value = |lag: f64| 2.0 * piece / length * (1.0 - lag / length) * window(lag);
        (0..PIECES).map(|i| (i as f64 + 0.5) * piece).map(|lag| (lag, value(lag))).collect()
    }

    /// Share of the window's lobe farther out than `reach` cycles per pixel.
    fn tail(window: impl Fn(f64) -> f64, longest: f64, reach: f64) -> f64 {
        let piece = longest / 4000.0;
        let within = (0..4000).map(|i| (f64::from(i) + 0.5) * piece);
        1.0 - within.map(|lag| 2.0 * piece * window(lag) * (2.0 * PI * reach * lag).sin() / (PI * lag)).sum::<f64>()
    }

    /// Holds the table of a uniform blur against the cosine transform; `bound` takes the envelope of the transfer and
    /// the share of the lobe that the table leaves out.
    fn assert_uniform(window: Window, bound: impl Fn(f64, f64) -> f64) {
        for dim in SIZES {
            for deg in ANGLES_DEG {
                let mut response = response(window, dim, deg);
                let along = along(window, dim, deg);
                let reach = ((response.lobe.len() - 1) as f64 + 0.5) * response.step;
                let left_out = tail(&along, 200.0, reach).abs();
                for length in LENGTHS {
                    response.set_uniform(length);
                    let lags = lags(&along, length);
                    // At points of the table: between them it is linear.
                    for k in 0..2 * dim.0.min(dim.1) {
                        let s = k as f64 * response.step;
                        let expected: f64 = lags.iter().map(|(lag, value)| value * (2.0 * PI * s * lag).cos()).sum();
                        let envelope = 1.0_f64.min((PI * length * s).powi(-2));
                        let found = f64::from(response.at(s as f32, 0.0).power);
                        assert!(
                            (found - expected).abs() < bound(envelope, left_out),
                            "{dim:?} {deg} deg {length} px at {s}: {found} not {expected}; {left_out} left out"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn a_uniform_blur_is_the_cosine_transform_of_its_lags_under_the_window() {
        // The lobe of Hann's window is as good as nothing beyond five bins.
        assert_uniform(Window::Hann, |envelope, _| 2e-3 * envelope + 1e-4);
    }

    #[test]
    fn a_uniform_blur_lacks_no_more_than_the_far_end_of_the_lobe() {
        // No more can be missing than is left out, the transfer being at most 1.
        assert_uniform(TUKEY, |_, left_out| left_out + 1e-4);
    }

    #[test]
    fn the_derivative_along_the_motion_is_that_of_the_cosine_transform() {
        let (dim, deg, length) = ((128, 192), 33.0, 11.0);
        let mut response = response(TUKEY, dim, deg);
        response.set_uniform(length);
        let lags = lags(along(TUKEY, dim, deg), length);
        for k in 1..380 {
            let s = f64::from(k) * response.step;
            let expected: f64 =
                lags.iter().map(|(lag, value)| -2.0 * PI * lag * value * (2.0 * PI * s * lag).sin()).sum();
            let found = f64::from(response.at(s as f32, 0.0).per_s);
            let mirrored = f64::from(response.at(-s as f32, 0.0).per_s);
            assert_eq!(found, -mirrored, "{s}");
            // Half a per cent of the steepest slopes, which are of the order of the length.
            assert!((found - expected).abs() < 5e-3 * length, "{s}: {found} instead of {expected}");
        }
    }

    /// Largest difference of a derivative from the central difference of the power over the step `h` either way.
    fn miss(
        dim: (usize, usize),
        derivative: impl Fn(Value) -> f32,
        h: f64,
        mut fill: impl FnMut(&mut Response, f64),
    ) -> f64 {
        let (mut here, mut low, mut high) =
            (response(TUKEY, dim, 33.0), response(TUKEY, dim, 33.0), response(TUKEY, dim, 33.0));
        fill(&mut here, 0.0);
        fill(&mut low, -h);
        fill(&mut high, h);
        (1..470)
            .map(|k| {
                // Off the points of the table, with leakage from the bright side.
                let (s, beta) = (k as f32 * 1e-3, 7.0);
                let difference = f64::from(high.at(s, beta).power) - f64::from(low.at(s, beta).power);
                (f64::from(derivative(here.at(s, beta))) - difference / (2.0 * h)).abs()
            })
            .fold(0.0, f64::max)
    }

    #[test]
    fn derivatives_are_the_limits_of_differences() {
        let dim = (64, 96);
        // Values of the order of 1 in single precision over a step of 2e-3, and the third derivative.
        let uniform = miss(dim, |value| value.per_log_length, 1e-3, |r, h| r.set_uniform(12.0 * h.exp()));
        assert!(uniform < 5e-4, "{uniform}");
        let disk = miss(dim, |value| value.per_log_length, 1e-3, |r, h| r.set_disk(12.0 * h.exp()));
        assert!(disk < 5e-4, "{disk}");
        let accelerated = |r: &mut Response, h: f64| r.set_accelerated(12.0 * h.exp(), 0.36);
        let accelerated = miss(dim, |value| value.per_log_length, 1e-3, accelerated);
        assert!(accelerated < 5e-4, "{accelerated}");
        for ratio2 in [0.1, 0.36, 0.9] {
            let ratio = miss(dim, |value| value.per_ratio2, 1e-2, |r, h| r.set_accelerated(12.0, ratio2 + h));
            assert!(ratio < 5e-4, "{ratio2}: {ratio}");
        }
    }

    #[test]
    fn no_acceleration_is_the_uniform_blur() {
        let (mut uniform, mut accelerated) = (response(TUKEY, (64, 96), 33.0), response(TUKEY, (64, 96), 33.0));
        uniform.set_uniform(12.0);
        accelerated.set_accelerated(12.0, 0.0);
        for k in 0..480 {
            let (a, b) = (uniform.at(k as f32 * 1e-3, 5.0), accelerated.at(k as f32 * 1e-3, 5.0));
            assert!((a.power - b.power).abs() < 1e-6, "{k}: {a:?} {b:?}");
            assert!((a.per_log_length - b.per_log_length).abs() < 1e-4, "{k}: {a:?} {b:?}");
        }
    }

    #[test]
    fn an_accelerated_blur_is_r_over_pi_at_the_first_dark_line() {
        // |H(1/L)| = |r|/pi [1 - (21/(2 pi^2) - 1) r^2 + O(r^4)], 6.2 % below |r|/pi at |r| = 1.
        let cubic = 21.0 / (2.0 * PI * PI) - 1.0;
        let mut response = response(TUKEY, (64, 96), 0.0);
        // A point of the table, before the window smears it, lies on the line.
        let length = 12.0;
        let on_line = response.reach() + PER_BIN * 96 / 12;
        let mut relative = |ratio: f64| {
            response.set_accelerated(length, ratio * ratio);
            f64::from(response.raw[0][on_line]).sqrt() / (ratio.abs() / PI)
        };
        for ratio in [0.01, 0.03] {
            assert!((relative(ratio) - 1.0).abs() < 1e-3, "{ratio}");
        }
        for ratio in [0.1, 0.2, 0.4_f64] {
            let expected = 1.0 - cubic * ratio.powi(2);
            assert!((relative(ratio) - expected).abs() < 0.05 * ratio.powi(4) + 1e-6, "{ratio}: {}", relative(ratio));
        }
        assert!((relative(1.0) - 0.938).abs() < 1e-3, "{}", relative(1.0));
        for ratio in [0.05, 0.5, 1.0] {
            let mtf = |ratio| AcceleratedBlur::new(length, ratio).unwrap().mtf(1.0 / length);
            assert!((mtf(ratio) - mtf(-ratio)).abs() < 1e-12, "{ratio}");
        }
    }
}
