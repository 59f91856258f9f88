//! The power transfer function of a blur as a windowed picture shows it.

use std::f64::consts::PI;

use super::periodogram::{CellSums, MOST_FREQUENCY, Periodogram, WIDEST_CELL};
use crate::psf::{AcceleratedBlur, DiskBlur};

/// Points of the table per bin of the longer side.
const PER_BIN: usize = 4;
/// Reach of the window's lobe in points of the table: beyond five bins it has died away.
const LOBE: usize = 5 * PER_BIN;
/// Reach of the lobe smeared over a cell.
const REACH: usize = LOBE + PER_BIN * WIDEST_CELL / 2 + 1;
/// Lags over which the window's lobe is summed.
const LAGS: usize = 64;
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
    even: [Vec<f32>; COLUMNS],
    odd: [Vec<f32>; COLUMNS],
    lobe: [f32; REACH + 1],
    columns: usize,
}

const COLUMNS: usize = 3;

impl Response {
    /// For pictures whose longer side has `side` pixels.
    pub(super) fn new(side: usize) -> Self {
        let step = 1.0 / (PER_BIN * side) as f64;
        let len = (MOST_FREQUENCY / step).ceil() as usize + 2;
        let column = |n: usize| std::array::from_fn(|_| vec![0.0; n]);
        Self {
            step,
            len,
            used: len,
            // Mirrored at 0: `REACH` points on either side.
            raw: column(len + 2 * REACH),
            even: column(len),
            odd: column(len),
            lobe: [0.0; REACH + 1],
            columns: 2,
        }
    }

    /// Takes the window's lobe along the direction of `cells`, smeared over their width, for frequencies up to
    /// `most_frequency`.
    pub(super) fn set_direction(&mut self, periodogram: &Periodogram, cells: &CellSums, most_frequency: f64) {
        self.used = ((most_frequency / self.step).ceil() as usize + 4).min(self.len);
        let (sin, cos) = cells.angle.sin_cos();
        let (rows, columns) = periodogram.dim();
        let longest = (columns as f64 / cos.abs().max(1e-9)).min(rows as f64 / sin.abs().max(1e-9));
        let lag = longest / LAGS as f64;
        let mut lobe = [0.0; LOBE + 1];
        for (j, value) in lobe.iter_mut().enumerate() {
            let turn = 2.0 * PI * j as f64 * self.step * lag;
            *value = 0.5;
            // cos(i turn) by its recurrence.
            let (mut before, mut now) = (1.0, turn.cos());
            let twice = 2.0 * now;
            for i in 1..LAGS {
                let distance = i as f64 * lag;
                *value += periodogram.window_at(distance * cos, distance * sin) * now;
                (before, now) = (now, twice * now - before);
            }
        }
        // One bin's width is in the lobe already: a cell of one bin holds bins at their own places.
        let half = (cells.width() - 1) * PER_BIN / 2;
        let mut smeared = [0.0; REACH + 1];
        for (j, value) in smeared.iter_mut().enumerate() {
            for k in 0..=2 * half {
                *value += lobe.get((j + k).abs_diff(half)).copied().unwrap_or(0.0);
            }
        }
        let sum = smeared[0] + 2.0 * smeared[1..].iter().sum::<f64>();
        for (out, value) in self.lobe.iter_mut().zip(smeared) {
            *out = (value / sum) as f32;
        }
    }

    /// Fills the table for a uniform blur of `length` pixels.
    pub(super) fn set_uniform(&mut self, length: f64) {
        self.columns = 2;
        let turn = PI * length * self.step;
        // sin and cos of k turn by a rotation.
        let (sin_step, cos_step) = turn.sin_cos();
        let (mut sin, mut cos) = (0.0_f64, 1.0_f64);
        for k in 0..self.used + REACH {
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
        self.columns = COLUMNS;
        // Both ratios stay inside 0..1, so the difference is one-sided at the ends.
        let low = (ratio2 - RATIO2_STEP).max(0.0);
        let high = (low + 2.0 * RATIO2_STEP).min(1.0);
        let mtf2 = |ratio2: f64, q: f64| AcceleratedBlur::new(1.0, ratio2.sqrt()).map_or(1.0, |b| b.mtf(q).powi(2));
        for k in 0..self.used + REACH {
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
        self.columns = 2;
        let power = |q: f64| DiskBlur::new(1.0).map_or(1.0, |disk| disk.transfer(q).powi(2));
        for k in 0..self.used + REACH {
            let q = k as f64 * self.step * diameter;
            let slope = q * (power(q + 1e-4) - power((q - 1e-4).abs())) / 2e-4;
            self.put(k, [power(q) as f32, slope as f32, 0.0]);
        }
        self.smear();
    }

    fn put(&mut self, k: usize, values: [f32; COLUMNS]) {
        for (raw, value) in self.raw.iter_mut().zip(values).take(self.columns) {
            raw[REACH + k] = value;
            if (1..=REACH).contains(&k) {
                raw[REACH - k] = value;
            }
        }
    }

    fn smear(&mut self) {
        for ((raw, even), odd) in self.raw.iter().zip(&mut self.even).zip(&mut self.odd).take(self.columns) {
            let (even, odd) = (&mut even[..self.used], &mut odd[..self.used]);
            for ((out, out_odd), &value) in even.iter_mut().zip(odd.iter_mut()).zip(&raw[REACH..]) {
                (*out, *out_odd) = (self.lobe[0] * value, 0.0);
            }
            for (j, &weight) in self.lobe.iter().enumerate().skip(1) {
                let moment = weight * (j as f64 * self.step) as f32;
                let (below, above) = (&raw[REACH - j..], &raw[REACH + j..]);
                for (((out, out_odd), &a), &b) in even.iter_mut().zip(odd.iter_mut()).zip(below).zip(above) {
                    *out += weight * (a + b);
                    *out_odd += moment * (a - b);
                }
            }
        }
    }

    #[inline]
    /// The response at the frequency `s` (either sign), where the sharp spectrum falls by `beta` per cycle per pixel.
    pub(super) fn at(&self, s: f32, beta: f32) -> Value {
        let (beta, sign) = if s < 0.0 { (-beta, -1.0) } else { (beta, 1.0) };
        let x = s.abs() / self.step as f32;
        let below = (x as usize).min(self.used - 3);
        let share = x - below as f32;
        let column = |c: usize| {
            let (even, odd) = (&self.even[c][below..below + 2], &self.odd[c][below..below + 2]);
            (even[0] + beta * odd[0], even[1] + beta * odd[1])
        };
        let lerp = |(a, b): (f32, f32)| a + share * (b - a);
        let (a, b) = column(0);
        // Central differences at both ends of the interval; the table is even.
        let before = if below == 0 { b } else { self.even[0][below - 1] + beta * self.odd[0][below - 1] };
        let after = self.even[0][below + 2] + beta * self.odd[0][below + 2];
        let slope = 0.5 * lerp((b - before, after - a));
        Value {
            power: lerp((a, b)),
            per_log_length: lerp(column(1)),
            per_s: sign * slope / self.step as f32,
            per_ratio2: if self.columns > 2 { lerp(column(2)) } else { 0.0 },
        }
    }
}
